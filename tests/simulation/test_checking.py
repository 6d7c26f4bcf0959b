"""What does not hold together is refused when the simulation is made."""

import pytest

from gaitdisc.errors import SimulationError
from gaitdisc.simulation.parts import Input, Parameter, Port, Sensor, State, Term
from gaitdisc.simulation.simulation import Simulation

X, V = State("x", "m"), State("v", "m/s")
PLAIN = {
    "states": (X, V),
    "inputs": (Input("u", "N"),),
    "parameters": (Parameter("k", 3.0), Parameter("d", 0.1)),
    "ports": (Port("force", "N"),),
    "definitions": (("spring", "k*x"),),
    "equations": (("x", "v"), ("v", "u + force - spring")),
}


def _made(**changed):
    return Simulation("plain", **{**PLAIN, **changed})


@pytest.mark.parametrize(
    ("changed", "place", "words"),
    [
        ({"states": (), "equations": ()}, (), "at least one state"),
        ({"parameters": (Parameter("x", 1.0), *PLAIN["parameters"])}, ("parameters", "x"), "[states] and in [param"),
        (
            {"parameters": (Parameter("sin", 1.0), *PLAIN["parameters"])},
            ("parameters", "sin"),
            "not be t or that of a function",
        ),
        ({"parameters": (Parameter("t", 1.0), *PLAIN["parameters"])}, ("parameters", "t"), "not be t"),
        ({"states": (*PLAIN["states"], State("__class__"))}, ("states", "__class__"), "a name must be a letter"),
        ({"states": (*PLAIN["states"], State("lambda"))}, ("states", "lambda"), "not a Python keyword"),
        ({"states": (*PLAIN["states"], State("µ"))}, ("states", "µ"), "a name must be a letter"),
        ({"parameters": (Parameter("k", float("inf")), PLAIN["parameters"][1])}, ("parameters", "k"), "finite"),
        ({"parameters": (Parameter("k", 1, "1", 5, 2), PLAIN["parameters"][1])}, ("parameters", "k"), "low is 5"),
        ({"states": (X, State("v", "m/s", "", float("nan")))}, ("states", "v"), "initial is nan"),
        ({"equations": (("x", "v"),)}, ("equations",), "'v' must have one equation"),
        ({"equations": (*PLAIN["equations"], ("vv", "1"))}, ("equations", "vv"), "Did you mean 'v'"),
        ({"equations": (("x", "v"), ("v", "force - sprin"))}, ("equations", "v"), "Did you mean 'spring'"),
        ({"equations": (("x", "v"), ("v", "u - spring"))}, ("ports", "force"), "'force' is not used"),
        ({"definitions": (("spring", "spring*x"),)}, ("definitions", "spring"), "unknown name 'spring'"),
        ({"definitions": (("spring", "after"), ("after", "x"))}, ("definitions", "spring"), "unknown name 'after'"),
        ({"observations": (("y", "z"),)}, ("observations", "y"), "unknown name 'z'"),
        ({"observations": (("y", "x"), ("y", "v"))}, ("observations",), "'y' occurs twice"),
        ({"effects": (Term("forse", "port", "a", "1"),)}, ("effects", "0"), "'forse'"),
        ({"effects": (Term("force", "input", "a", "1"),)}, ("effects", "0"), "at a port or in an equation"),
        ({"effects": (Term("force", "port", "a", "spring"),)}, ("effects", "0"), "unknown name 'spring'"),
        ({"effects": (Term("v", "equation", "a", "delay(x + v, 1)"),)}, ("effects", "0"), "must be a state or an"),
        ({"effects": (Term("v", "equation", "a", "delay(k, 1)"),)}, ("effects", "0"), "Delay one of: x, v, u"),
        ({"effects": (Term("v", "equation", "a", "delay(x, v)"),)}, ("effects", "0"), "they use 'v'"),
        ({"effects": (Term("v", "equation", "a", "delay(x, t)"),)}, ("effects", "0"), "they use 't'"),
        ({"definitions": (*PLAIN["definitions"], *((f"d{i}", "1") for i in range(600)))}, (), "at most 500 parts"),
        ({"observations": tuple((f"y{i}", "x" + " " * 1999) for i in range(101))}, (), "200000 characters in total"),
    ],
)
def test_what_does_not_hold_together(changed, place, words):
    with pytest.raises(SimulationError) as refusal:
        _made(**changed)
    assert refusal.value.place == place
    assert words in str(refusal.value)


def test_an_equation_effect_may_use_definitions_and_a_delay_parameters():
    made = _made(effects=(Term("v", "equation", "a", "-0.1*spring + delay(v, 2*d)"),))
    assert made.effects[0].kind == "equation"


def test_a_sensor_belongs_to_an_observation_and_its_numbers_are_above_0():
    with pytest.raises(SimulationError, match="must record an observation; 'y'"):
        _made(sensors=(Sensor("y", sd=1.0),))
    with pytest.raises(SimulationError, match=r"above 0 \[mm\].*= nan"):
        _made(sensors=(Sensor("x", "mm", float("nan")),))
