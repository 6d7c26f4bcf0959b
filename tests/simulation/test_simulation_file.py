"""Reading: every part arrives, every fault is told with its file and line."""

import re
from dataclasses import replace

import numpy as np
import pytest
from made_simulation import effect_text

from gaitdisc.errors import GaitdiscError, ReadError, SchemaError
from gaitdisc.simulation.parts import Input, Parameter, Sensor, Term
from gaitdisc.simulation.simulation_file import parse_simulation, read_simulation
from gaitdisc.simulation.writing import simulation_text


def test_every_part_is_read(ankle, ankle_text, tmp_path):
    path = tmp_path / "ankle.toml"
    spring = Term("ankle_moment", "port", "spring", "-286*max(0, theta)")
    path.write_text(ankle_text + effect_text(spring))
    read = read_simulation(path)
    assert read.title == "Ankle"
    assert [state.unit for state in read.states] == ["rad", "rad/s"]
    assert read.parameters[2] == Parameter("k", 25.0, "1", 10.0, 60.0)
    assert read.effects == (spring,)
    assert read.source == path and read.layout.startswith("\ntitle")
    assert read.without_effects() == ankle


def test_a_number_is_an_expression():
    assert parse_simulation("[states.x]\n[equations]\nx = 1.5\n").equations == (("x", "1.5"),)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("[states.theta]", "[states.theta", "must be a TOML file"),
        (
            "[inputs.tau]",
            "[input.tau]",
            "line 7, [input]: only keys of the simulation file are allowed; found 'input'. Did you mean 'inputs'",
        ),
        (
            'unit = "rad/s"',
            'units = "rad/s"',
            "line 5, [states] omega: only keys of the simulation file are allowed; found 'units'. Did you mean 'unit'",
        ),
        ("value = 1.1", "value = nan", "line 13, [parameters] b: value"),
        ("value = 1.1", "value = true", "a finite number; found True"),
        ("value = 1.1", "value = 1" + "0" * 400, "the number exceeds 1e300"),
        ("value = 1.1", 'unit = "N"', "a parameter must have a value"),
        ('unit = "rad/s"', "unit = 3", "unit must be text; found 3"),
        ('theta = "omega"', 'theta = "omegga"', "ankle.toml, line 24, [equations] theta: expressions must be"),
        ('theta = "omega"', 'theta = "omegga"', "Did you mean 'omega'"),
        ('theta = "omega"', "theta = [1]", "expressions must be text"),
        ('"k*theta"', '"k theta"', "line 22, [definitions] spring"),
        ("[definitions]", "[[effects]]\nport = 1\n[definitions]", "an effect must have a term"),
        ("[definitions]", '[[effects]]\nport = "ankle"\nterm = "1"\n[definitions]', "line 21, [effects] 0: effect ''"),
        ("[definitions]", "[states.x.y]\n[definitions]", "found 'y'"),
        ("[ports.ankle_moment]", "[ports]\nankle_moment = 3\n[ports.other]", "entry must be a table; found '3'"),
        ("ankle_moment - b", "b", "'ankle_moment' is not used"),
    ],
)
def test_a_fault_is_told_with_its_place(ankle_text, old, new, words):
    with pytest.raises(GaitdiscError) as refusal:
        parse_simulation(ankle_text.replace(old, new, 1), "ankle.toml")
    assert "ankle.toml" in str(refusal.value)
    assert words in str(refusal.value)


def test_files_that_cannot_be_read(tmp_path):
    with pytest.raises(ReadError, match=r"absent\.toml: No such file"):
        read_simulation(tmp_path / "absent.toml")
    with pytest.raises(ReadError, match="is a folder"):
        read_simulation(tmp_path)
    (tmp_path / "latin.toml").write_bytes(b'title = "caf\xe9"')
    with pytest.raises(ReadError, match="invalid byte at offset 12"):
        read_simulation(tmp_path / "latin.toml")


HEAD = '[states.x]\nunit = "1"\n[equations]\nx = "-x"\n'


@pytest.mark.parametrize(
    "text",
    [
        "",
        "x" * 300_000,
        "a = " + "[" * 100_000,
        "a = " + "{a=" * 20_000,
        ".".join(["a"] * 100_000) + " = 1",
        "[" + ".".join(["a"] * 100_000) + "]",
        "".join(f"[a{i}.b.c.d]\n" for i in range(15_000)),
        "a = " + "9" * 200_000,
        "a = " + '"' * 200_000,
        HEAD + "[definitions]\n" + "".join(f'd{i} = "x"\n' for i in range(14_000)),
        HEAD + "[definitions]\n" + "".join(f'd{i} = "d{i - 1}*d{i - 1}"\n' for i in range(1, 5000)),
        HEAD.replace('"-x"', '"' + "x+" * 120_000 + 'x"'),
        HEAD.replace('"-x"', '"' + "(" * 100_000 + 'x"'),
        HEAD.replace('"-x"', '"x.__class__.__bases__"'),
        HEAD.replace('"-x"', '"().__class__"'),
        HEAD.replace('"-x"', '"__import__(x)"'),
        HEAD.replace('"-x"', '"(lambda x: x)(x)"'),
        HEAD.replace('"-x"', '"х"'),
        HEAD.replace('"-x"', '"1e400*x"'),
        HEAD.replace('"-x"', '"delay(x, delay(x, 1))"'),
        HEAD.replace('"-x"', '"d"') + '[definitions]\nd = "d"\n',
        HEAD.replace('"-x"', "inf"),
        HEAD.replace('"-x"', "9" * 4000),
        HEAD + "[parameters.k]\nvalue = inf\n",
        HEAD + "[parameters.k]\nvalue = 1e400\n",
        HEAD + "[parameters.__builtins__]\nvalue = 1\n",
        HEAD + '[parameters."k; import os"]\nvalue = 1\n',
    ],
)
def test_a_hostile_file_is_refused(text, tmp_path):
    path = tmp_path / "hostile.toml"
    path.write_text(text)
    with pytest.raises(GaitdiscError) as refusal:
        read_simulation(path)
    assert len(str(refusal.value)) < 2500


def test_doubling_definitions_stay_small():
    """d399 written out would have 2^399 parts; compiled, it has one product for each definition."""
    from gaitdisc.simulation.running import compile_simulation

    lines = "\n".join(f'd{i} = "d{i - 1}*d{i - 1}"' for i in range(1, 400))
    text = HEAD.replace('"-x"', '"d399"') + f'[definitions]\nd0 = "x"\n{lines}\n'
    assert len(compile_simulation(parse_simulation(text)).right_hand_side.code) == 400


def test_an_exponent_without_end_is_a_row_without_end():
    text = HEAD.replace('"-x"', '"9**9**9**9*x"')
    from gaitdisc.simulation.running import compile_simulation

    assert np.isinf(
        compile_simulation(parse_simulation(text)).rates(np.zeros(1), np.ones((1, 1)), np.empty((1, 0)))[0, 0]
    )


ERRING = """
[inputs.motor]
unit = "N m"
gain = 0.1
sd = 3.0
wander = 0.5   # s
"""


def test_the_errors_of_an_input_are_read_and_written_back(ankle_text):
    text = ankle_text.replace("[inputs.tau]", ERRING + "[inputs.tau]")
    read = parse_simulation(text)
    assert read.inputs[0] == Input("motor", "N m", gain=0.1, sd=3.0, wander=0.5)
    assert (read.inputs[1].gain, read.inputs[1].sd, read.inputs[1].wander) == (None, None, None)
    assert simulation_text(read) == read.layout
    assert parse_simulation(simulation_text(replace(read, layout=""))) == read


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("gain = 0.1", "gain = -0.1", "a number above 0 [1]; found gain = -0.1. Correct"),
        ("sd = 3.0", "sd = 0", "a number above 0 [N m]; found sd = 0. Correct"),
        ("wander = 0.5", "wander = 0", "a number above 0 [s]; found wander = 0"),
        ("sd = 3.0", "sd = nan", "a finite number; found nan"),
        ("sd = 3.0", 'sd = "3 N m"', "a finite number; found 3 N m. Write a number without quotes"),
        ("gain = 0.1\nsd = 3.0", "", "[inputs] motor: an input with wander must have gain or sd; it has neither"),
        ('[inputs.motor]\nunit = "N m"', "[inputs.phase]", "the phase of the stride must be exact; it has gain or sd"),
        ("wander", "wanders", "Did you mean 'wander'?"),
    ],
)
def test_a_fault_of_an_input_is_told_with_its_line(ankle_text, old, new, words):
    text = ankle_text.replace('[inputs.phase]\nunit = "1"\n', ERRING.replace(old, new))
    with pytest.raises(SchemaError) as refusal:
        parse_simulation(text, "ankle.toml")
    assert words in str(refusal.value)
    assert re.match(r"ankle.toml, line \d+, \[inputs\] (motor|phase): ", str(refusal.value))


LONG = """
[observations]
omega = "omega"
[observations.ankle_angle_r]
expression = "57.2958*theta"   # as the cameras see it
unit = "deg"
sd = 0.3
lowpass = 6.0
"""


def test_an_observation_in_the_long_form_is_read(ankle_text):
    read = parse_simulation(ankle_text + LONG)
    assert read.observations == (("omega", "omega"), ("ankle_angle_r", "57.2958*theta"))
    assert read.sensors == (Sensor("ankle_angle_r", "deg", 0.3, 6.0),)
    assert read.sensor("omega") == Sensor("omega")


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("sd = 0.3", "sd = 0", "ankle_angle_r: sd must be a number above 0 [deg]; found sd = 0. Correct"),
        ("lowpass = 6.0", "lowpass = -6", "lowpass must be a number above 0 [Hz]; found lowpass = -6"),
        ("lowpass = 6.0", "cutoff = 6", "only keys of the simulation file are allowed; found 'cutoff'"),
        ("sd = 0.3", 'sd = "small"', "sd must be a finite number; found small. Write a number without quotes"),
        ('unit = "deg"', 'unit = "kg"', "'theta' has a unit of another dimension, rad. Correct unit"),
        ('expression = "57.2958*theta" ', "", "an observation must have an expression; it has none"),
        ('theta"   #', 'thetta"   #', "Did you mean 'theta'?"),
    ],
)
def test_a_fault_of_an_observation_is_told_with_its_line(ankle_text, old, new, words):
    line = (ankle_text + LONG).split("\n").index("[observations.ankle_angle_r]") + 1
    with pytest.raises(GaitdiscError) as refusal:
        parse_simulation((ankle_text + LONG).replace(old, new), "ankle.toml")
    assert f"ankle.toml, line {line}, " in str(refusal.value) and words in str(refusal.value)
