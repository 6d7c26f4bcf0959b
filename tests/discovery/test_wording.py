from dataclasses import replace

import pytest
from hidden_in_a_mass import mass
from manufactured_discovery import CUBIC, SPRING, manufactured
from texts import says

from gaitdisc.discovery.candidate import Candidate
from gaitdisc.discovery.catalogue import read_shapes
from gaitdisc.discovery.result import Correction, Estimate, Explanation, FoundEffect, GapSize, Whereabouts
from gaitdisc.discovery.scored_model import Part
from gaitdisc.discovery.wording import write_sentence
from gaitdisc.simulation.simulation_file import bundled, parse_simulation

SHAPE = next(one for one in read_shapes() if one.name == "one_sided_spring")
WHERE = ("missing_physics", "port", "ankle_moment", "one_sided_spring", ("max(0, theta - _x0)",))
ENGAGED = Candidate(*WHERE, {"x0": "quantiles of x"}, "theta", SHAPE.means, names=SHAPE.names)
SHOWN = " With it, the held-out error falls from 3.09 to 0.60 deg (noise floor 0.50)."


def sentence(base=None, parts=(ENGAGED,), **changes):
    made = write_sentence(manufactured(**changes), base or bundled("ankle"), tuple(Part(one, {}) for one in parts))
    return made.sentence


def test_the_issues_own_sentence():
    said = sentence()
    assert says(said, "a one-sided spring", "ankle_moment", "286 N m/rad", "279 to 293", "2.0 deg of dorsiflexion")
    assert says(said, "12 and 55 %") and said.endswith(SHOWN)


def test_a_coupling_says_to_what():
    effect = FoundEffect("equation", "v", "linear_coupling", "", {"coupling": Estimate(0.2, 0.1, 0.3, "1/s^2")})
    part = Candidate("missing_physics", "equation", "v", "linear_coupling", ("x",), means="a linear coupling", role="x")
    said = sentence(mass(), (part,), effects=(effect,), where=())
    assert says(said, "coupling", "equation", "0.2 1/s^2 (95 % CI 0.1 to 0.3)")


@pytest.mark.parametrize(
    ("unit", "words"), [("cm^3/s", "a term proportional to \N{MINUS SIGN}h_2"), ("N", "a linear spring")]
)
def test_where_units_are_not_mechanical_an_effect_is_named_by_its_form(unit, words):
    tank = f'[states.h_2]\nunit = "cm"\n[ports.leak]\nunit = "{unit}"\n[equations]\nh_2 = "leak"\n'
    effect = FoundEffect("port", "leak", "linear_stiffness", "-0.9*(h_2)", {"stiffness": Estimate(0.9, 0.8, 1.0, "")})
    part = Candidate(
        "missing_physics", "port", "leak", "linear_stiffness", ("(h_2)",), means="a linear spring", role="h_2"
    )
    said = sentence(parse_simulation(tank), (part,), effects=(effect,), where=())
    assert says(said, f"lacks {words} at the leak port: 0.9 (95 % CI 0.8 to 1.0)")


@pytest.mark.parametrize(
    ("verdict", "before", "words"),
    [
        ("no_gap", 0.11, ("Simulation and data", "noise")),
        ("no_gap", 0.4, ("no missing effect", "white noise", "does not grow")),
        ("unexplained", 0.4, ("No effect is named", "simulation and data", "more")),
    ],
)
def test_where_nothing_is_named_it_says_what_is_left(verdict, before, words):
    size = GapSize(before, before, 0.1, 0.4, {"theta": (0.054, 0.054, 0.0087)}, 14)
    said = sentence(verdict=verdict, effects=(), parts=(), where=(), rivals=(), held_out=size)
    assert says(said, *words)
    assert says(said, "3.09 deg", "0.50")


def test_where_nothing_meets_the_criteria_the_listed_explanation_that_removes_most_is_said():
    sizes = {"theta": (0.054, 0.0105, 0.0087)}
    size, left = GapSize(0.5, 0.5, 0.1, 0.4, sizes, 14), GapSize(0.5, 0.2, 0.1, 0.004, sizes, 14)
    listed = (Explanation((SPRING,), replace(left, p=0.2)), Explanation((replace(SPRING, name="hysteresis"),), left))
    none = {"verdict": "unexplained", "effects": (), "parts": (), "where": (), "rivals": (), "held_out": size}
    said = sentence(**none, explanations=listed)
    assert says(said, "no tested explanation meets the criteria", "removes most", "hysteresis", "88 %", "New trials")
    assert "removes most" not in sentence(**none, explanations=listed[:1])
    none["held_out"] = GapSize(0.01, 0.01, 0.02, 1.0, {"theta": (0.01, 0.01, 0.02)}, 14)
    assert "agree within the noise" not in sentence(**none)


def test_what_stays_unexplained_is_said_where_it_is_more_than_a_few_percent():
    sizes = {"theta": (0.054, 0.0105, 0.0087)}
    left = sentence(held_out=GapSize(0.5, 0.25, 0.01, 0.001, sizes, 14))
    assert says(left, "25 %", "above", "unexplained")
    assert "unexplained" not in sentence(held_out=GapSize(0.5, 0.02, 0.01, 0.001, sizes, 14))


def not_named(p, pieces, bic=900.0):
    """Return what is said where held-out data do not bear out what was learned from."""
    rival = FoundEffect("equation", "omega", "coulomb_friction", "", {}, bic=bic)
    size = GapSize(1, 1, 1, p, {"theta": (0.054, 0.054, 0.0087)}, pieces)
    return sentence(verdict="no_gap", effects=(), parts=(), where=(), rivals=(rival,), held_out=size)


@pytest.mark.parametrize(("bic", "unproven"), [(1325.0, True), (9.0, False), (float("nan"), False)])
def test_what_was_learned_from_and_not_borne_out_is_not_called_agreement(bic, unproven):
    said = not_named(0.4, 14, bic)
    assert says(said, "No effect is named") == unproven
    assert (says(said, "equation", "omega", "not")) == unproven
    assert ("agree within the noise" in said) != unproven


def test_two_effects_are_both_told():
    friction = FoundEffect("port", "load", "coulomb_friction", "", {"friction": Estimate(3.0, 2.8, 3.2, "N m")})
    other = Candidate("missing_physics", "port", "load", "coulomb_friction", means="dry (Coulomb) friction")
    said = sentence(parts=(ENGAGED, other), effects=(SPRING, friction))
    assert says(said, "friction", "load port: 3.0 N m", "(95 % CI 2.8 to 3.2)")


@pytest.mark.parametrize(
    ("name", "number", "said"),
    [
        ("input_delay", (0.04, 0.03, 0.05, "s"), "x acts 0.04 s (95 % CI 0.03 to 0.05) later than recorded"),
        ("input_delay", (-0.04, -0.05, -0.03, "s"), "x acts 0.04 s (95 % CI 0.03 to 0.05) earlier than recorded"),
        ("input_gain", (1.2, 1.1, 1.3, "1"), "x acts 1.2 (95 % CI 1.1 to 1.3) times as strongly"),
        ("input_saturation", (0.7, 0.6, 0.8, "1"), "driving signal x saturates below 0.7 (95 % CI 0.6 to 0.8)"),
        ("sensor_gain", (1.2, 1.1, 1.3, "1"), "x reads 1.2 (95 % CI 1.1 to 1.3) times the true value"),
        ("sensor_gain", (0.0178, 0.0175, 0.0181, "1"), "true value, as if radians were read as"),
        ("sensor_gain", (-1.01, -1.03, -0.99, "1"), "times the true value, as if its sign were reversed"),
        ("sensor_offset", (-0.2, -0.3, -0.1, "m"), "x reads 0.2 m (95 % CI 0.1 to 0.3) too low"),
        ("sensor_drift", (0.2, 0.1, 0.3, "m/s"), "measured x drifts upwards by 0.2 m/s"),
        ("sensor_lag", (0.04, 0.03, 0.05, "s"), "measured x lags by 0.04 s"),
    ],
)
def test_signals(name, number, said):
    effect, kind = (
        FoundEffect("observation", "x", name, "", {"lower_limit": Estimate(*number)}),
        f"{name.split('_')[0]}_error",
    )
    made = sentence(mass(), (Candidate(kind, "observation", "x", name),), verdict=kind, effects=(effect,), where=())
    assert made.startswith("The ")
    assert said in made


def test_random_pushes():
    strength = Estimate(3.0, float("nan"), float("nan"), "N")
    push = FoundEffect("equation", "v", "process_noise", "", {"strength": strength})
    said = sentence(mass(), (), verdict="process_noise", effects=(push,), where=(Whereabouts("equation", "v", 1.0),))
    assert says(said, "3.00 N", "equation", "no deterministic effect")


def test_a_shape_without_a_name_says_over_which_states():
    shape = FoundEffect("port", "load", "unnamed", "2*exp(-x**2)*v", {})
    said = sentence(mass(), (), verdict="unnamed", effects=(shape,), where=())
    assert says(said, "load port", "no")
    assert says(said, "shape, a function")


def test_a_shape_that_was_read_says_what_it_reads_as_and_never_that_this_is_its_name():
    shape = FoundEffect("port", "load", "unnamed", "-8.0725*(x**2*v)", {}, reads_as="-8.07*(x**2*v)")
    said = sentence(mass(), (), verdict="unnamed", effects=(shape,), where=())
    assert says(said, "no", "-8.07*(x**2*v)")
    known = replace(shape, reads_as="-14*(x**3)", reads_as_effect="cubic_stiffness")
    said = sentence(mass(), (), verdict="unnamed", effects=(known,), where=())
    assert says(said, "load port", "-14*(x**3)")


def test_a_tie_is_told_with_what_would_tell_them_apart():
    said = sentence(rivals=(replace(CUBIC, tied=True),))
    assert says(said, "data cannot distinguish", "ankle_moment", "both")


def test_of_several_channels_the_one_with_the_clearest_gap_is_told():
    size = GapSize(1, 1, 1, 0.1, {"x": (1.0, 0.9, 0.9), "y": (0.5, 0.1, 0.1)})
    said = sentence(held_out=size, channels=("x", "y"), units=("m", "m"))
    assert says(said, "falls", "0.50", "0.10 m")


@pytest.mark.parametrize(
    ("size", "said"),
    [
        ((0.054, 0.0105, 0.0087), "falls from 3.09 to 0.60 deg (noise floor 0.50)."),
        ((0.0105, 0.054, 0.0087), "rises from 0.60 to 3.09 deg (noise floor 0.50)."),
        ((0.0105, 0.01051, 0.0087), "does not change: 0.60 deg (noise floor 0.50)."),
    ],
)
def test_an_error_falls_rises_or_does_not_change_as_its_numbers_do(size, said):
    sentence_now = sentence(held_out=GapSize(1, 1, 1, 0.01, {"theta": size}, 40))
    assert sentence_now.endswith(f"With it, the held-out error {said}")


def test_a_channel_whose_error_rises_is_not_passed_over():
    size = GapSize(1, 1, 1, 0.01, {"x": (1.0, 0.5, 0.1), "y": (0.2, 0.4, 0.1)}, 40)
    said = sentence(held_out=size, channels=("x", "y"), units=("m", "m"))
    assert says(said, "falls", "1.00", "0.50 m", "0.10", "rises", "0.20", "0.40 m")


def test_few_pieces_are_counted_in_the_sentence():
    size = GapSize(1, 1, 1, 0.0313, {"theta": (0.054, 0.0105, 0.0087)}, 5)
    assert says(sentence(held_out=size), "0.50", "p = 0.031", "5 independent samples")


def test_what_is_not_borne_out_says_by_which_test():
    assert says(not_named(0.34, 9), "not", "(p = 0.34", "9 independent samples")


@pytest.mark.parametrize(
    ("bounds", "said"),
    [
        ((), "The parameter k is 31.2 N/m (95 % CI 30.8 to 31.6), but 24 N/m in the file"),
        ((20.0, 28.0), "is 31.2 N/m (95 % CI 30.8 to 31.6), but 24 N/m in the file, outside its bounds, 20 to 28 N/m."),
        ((-float("inf"), 28.0), "but 24 N/m in the file, above its bound, 28 N/m."),
        ((35.0, float("inf")), "but 24 N/m in the file, below its bound, 35 N/m."),
        ((20.0, 40.0), "but 24 N/m in the file. With it"),
    ],
)
def test_a_wrong_parameter_is_told_beside_the_files_number_and_outside_its_bounds(bounds, said):
    found = {"value": Estimate(31.2, 30.8, 31.6, "N/m")}
    effect = FoundEffect("parameter", "k", "wrong_parameter", "", found, bounds=bounds)
    part = Candidate("wrong_parameter", "parameter", "k", "wrong_parameter", value=24.0)
    assert said in sentence(mass(), (part,), verdict="wrong_parameter", effects=(effect,), where=())


def test_what_clearly_moved_within_its_bounds_is_said():
    clear = Correction("inertia", 0.110, Estimate(0.1126, 0.1118, 0.1134, "kg m^2"))
    lost = Correction("b", 1.0, Estimate(1.01, 0.9, 1.1, "N m s/rad"))
    assert says(sentence(corrections=(clear, lost)), "inertia", "0.11 kg m^2", "0.1126 kg m^2")
    assert "moved" not in sentence(corrections=(lost,))


def test_where_names_explain_too_little_it_is_not_said_that_the_data_do_not_bear_them_out():
    said = not_named(0.001, 14)
    assert says(said, "No effect", "equation", "omega", "less than half")
    assert "bear it out" not in said
