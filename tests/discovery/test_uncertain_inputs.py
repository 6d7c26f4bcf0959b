"""Inputs whose errors are stated: what these explain is not named, what is hidden beside them is, with its number."""

from dataclasses import replace

import numpy as np
import pytest
from hidden_in_a_mass import MASS, RATE, mass, record, with_load

from gaitdisc.discovery import uncertain_inputs
from gaitdisc.discovery.case import set_up_case
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.discover import discover, fit_given
from gaitdisc.discovery.input_errors import with_constant_errors, with_drawn_errors
from gaitdisc.discovery.uncertain_inputs import covariance_by_inputs, weigh_unstated_errors
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.simulation import Simulation
from gaitdisc.simulation.simulation_file import parse_simulation
from gaitdisc.simulation.writing import simulation_text

SEED = 3


def _driven(measured: Measured, inputs) -> Measured:
    return replace(measured, drive=replace(measured.drive, inputs=inputs))


def _wandering(measured: Measured, sd: float, seconds: float) -> Measured:
    """Inputs with an error of a known size and memory, drawn sample by sample."""
    kept, error = np.exp(-1 / (RATE * seconds)), np.random.default_rng(7).normal(size=measured.drive.inputs.shape)
    for sample in range(1, error.shape[1]):
        error[:, sample] = kept * error[:, sample - 1] + np.sqrt(1 - kept**2) * error[:, sample]
    return _driven(measured, measured.drive.inputs + sd * error)


def _stating(simulation: Simulation, **errors: float) -> Simulation:
    return replace(simulation, inputs=tuple(replace(one, **errors) for one in simulation.inputs))


@pytest.mark.slow
def test_what_a_stated_error_explains_as_well_is_not_named():
    measured = _wandering(record(mass(), SEED), 2.0, 0.3)
    found, augmented = discover(_stating(mass(), sd=2.0, wander=0.3), measured)
    assert (found.verdict, found.effects, augmented.effects) == ("no_gap", (), ())
    (said,) = (one.what for one in found.findings if one.kind == "stated errors")
    assert "stated errors of 'push' explain" in said and said in found.sentence


@pytest.mark.slow
def test_a_term_beside_a_stated_error_is_named_with_its_number_in_its_interval():
    measured = _wandering(record(with_load("-30*max(0, x - 0.25)"), SEED), 2.0, 0.3)
    found, _ = discover(_stating(mass(), sd=2.0, wander=0.3), measured)
    assert [(one.name, one.place) for one in found.effects] == [("one_sided_spring", "load")]
    numbers = found.effects[0].estimates
    assert numbers["stiffness"].low < 30 < numbers["stiffness"].high
    assert numbers["engagement"].low < 0.25 < numbers["engagement"].high
    assert not [one for one in found.findings if one.kind in ("stated errors", "exact inputs")]


@pytest.mark.slow
def test_a_gain_within_its_stated_error_is_corrected_and_not_named():
    measured = record(mass(), SEED)
    measured = _driven(measured, measured.drive.inputs / 1.12)
    assert [(one.name, one.place) for one in discover(mass(), measured)[0].effects] == [("input_gain", "push")]
    found, augmented = discover(_stating(mass(), gain=0.1), measured)
    assert (found.verdict, found.effects) == ("no_gap", ())
    (moved,) = found.corrections
    assert moved.parameter == "gain_of_push" and moved.found.low < 1.12 < moved.found.high
    again = parse_simulation(simulation_text(augmented))
    assert again.values()["gain_of_push"] == pytest.approx(1.12, rel=0.02)
    assert with_constant_errors(again) == again


def test_an_offset_is_a_number_with_bounds_of_two_standard_deviations():
    made = with_constant_errors(_stating(mass(), sd=1.5))
    (offset,) = made.parameters[-1:]
    assert (offset.name, offset.value, offset.unit, offset.low, offset.high) == ("offset_of_push", 0, "N", -3, 3)
    assert "push + offset_of_push" in dict(made.equations)["v"]


def test_drawn_errors_have_the_stated_size_and_memory():
    measured, stated = record(mass(), SEED), _stating(mass(), sd=2.0, gain=0.1, wander=0.4)
    inputs = measured.drive.inputs
    drawn = np.array([with_drawn_errors(measured, stated, seed).drive.inputs - inputs for seed in range(400)])
    assert drawn.var(axis=0) == pytest.approx(4 + (0.1 * inputs) ** 2, rel=0.4)
    later = (drawn[:, :, 20:] * drawn[:, :, :-20]).mean(axis=0)
    assert (later / (4 + 0.01 * inputs[:, 20:] * inputs[:, :-20])).mean() == pytest.approx(np.exp(-1), abs=0.02)


@pytest.mark.parametrize("seen", ["x", "push + 3*x"])
def test_the_covariance_is_that_of_runs_with_drawn_errors(seen):
    stated = _stating(mass().with_observation("x", seen), sd=2.0, wander=0.3)
    case = set_up_case(stated, record(mass().with_observation("x", seen), SEED))
    now = case.as_read()
    fit, shooting = now.fit, now.shooting
    covariance = covariance_by_inputs(case, now)[0]
    runs = []
    for seed in range(600):
        drawn = replace(shooting, measured=with_drawn_errors(case.measured, stated, seed))
        runs.append(drawn.run(now.machine, fit.starts[None], fit.values[None])[1][0, 0, :, 0])
    assert np.cov(np.array(runs).T) == pytest.approx(covariance, abs=0.2 * covariance.max())


@pytest.mark.parametrize(
    ("hidden", "wander", "gain", "named", "left"),
    [
        ("", 2.0, 1.0, "linear_stiffness@load", ()),  # a slow error of the push, and nothing else
        ("", 0.5, 1.25, "viscous_damping@load", ("input_gain@push",)),
        ("-30*max(0, x - 0.25)", 0.5, 1.0, "one_sided_spring@load", ("one_sided_spring@load",)),
        ("-1.5*v*abs(v)", 0.0, 1.0, "quadratic_drag@load", ("quadratic_drag@load",)),
    ],
)
def test_what_unstated_errors_or_a_gain_explain_as_well_is_not_named(hidden, wander, gain, named, left):
    measured = _wandering(record(with_load(hidden) if hidden else mass(), SEED), wander, 4.0)
    case = set_up_case(mass(), _driven(measured, measured.drive.inputs / gain))
    verdict = fit_given(case, case.as_read(), (named,))
    weighed, after = weigh_unstated_errors(case, verdict)
    assert after.found.labels == left
    said = [one.what for one in weighed.measured.findings if one.kind == "unstated errors"]
    assert len(said) == (left != (named,)) and all("unstated errors of 'push' explain" in one for one in said)
    assert (after.rivals[:1] == (verdict.found,)) == bool(said)


def test_gains_of_two_inputs_together_explain_what_neither_does_alone():
    measured, two = record(mass(), SEED), MASS.replace('v = "(push', 'v = "(push + pull')
    total = measured.drive.inputs
    pull = np.roll(total, 1, axis=0)
    measured = _driven(measured, np.concatenate([(total - pull) / 1.2, pull / 0.85], axis=2))
    case = set_up_case(
        parse_simulation(two.replace("[parameters.m]", '[inputs.pull]\nunit = "N"\n[parameters.m]')), measured
    )
    verdict = fit_given(case, case.as_read(), ("input_gain@push", "cubic_stiffness@load"))
    weighed, after = weigh_unstated_errors(case, verdict)
    assert (after.word, after.found.labels) == ("input_error", ("input_gain@push", "input_gain@pull"))
    assert [part.values["gain"] for part in after.found.parts] == pytest.approx([1.2, 0.85], rel=0.02)
    (said,) = (one.what for one in weighed.measured.findings if one.kind == "unstated errors")
    assert said == "unstated errors of 'push' and 'pull' explain cubic stiffness at load as well"


def test_what_takes_half_of_unseen_errors_is_no_error_that_wanders(monkeypatch):
    case = set_up_case(mass(), record(with_load("-8*x**3"), SEED))
    verdict = fit_given(case, case.as_read(), ("cubic_stiffness@load",))
    assert verdict.proof.closed > 0.5
    monkeypatch.setattr(uncertain_inputs, "beside_errors", lambda case, now, erring: (0.0, now))  # all are as likely
    assert weigh_unstated_errors(case, verdict) == (case, verdict)
    monkeypatch.setattr(uncertain_inputs, "CRITERIA", replace(CRITERIA, half=1.0))
    assert weigh_unstated_errors(case, verdict)[1].found.labels == ()


def test_an_error_that_is_stated_is_not_doubted():
    stated = _stating(mass(), sd=2.0, wander=0.3)
    case = set_up_case(stated, _wandering(record(mass(), SEED), 2.0, 4.0))
    verdict = fit_given(case, case.as_read(), ("linear_stiffness@load",))
    assert weigh_unstated_errors(case, verdict) == (case, verdict)
