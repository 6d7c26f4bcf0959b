"""Numbers fitted by the engine's own runs: those of the truth, wherever the expansion's lay."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from saved_folders import PENDULUM

from gaitdisc.discovery.candidate import Candidate
from gaitdisc.discovery.discover_engine import _NOTHING, keep_borne_out, keep_some
from gaitdisc.discovery.fit_by_engine import NO_FILTER, EngineFit, at_other_cutoffs, base_runs
from gaitdisc.discovery.kept_work import kept_work
from gaitdisc.discovery.record_filter import RecordFilter
from gaitdisc.discovery.result import Explanation, FoundEffect
from gaitdisc.discovery.scored_model import Part
from gaitdisc.engines.mapping import draft
from gaitdisc.engines.motion import Motion
from gaitdisc.engines.own_runs import residual_by
from gaitdisc.simulation.compiled_simulation import Drive
from gaitdisc.simulation.measured import Measured

MISSING = ("missing_physics", "port", "pivot_moment")
SPRING = Candidate(*MISSING, "linear_stiffness", ("pivot",), names={"factor": "stiffness"})
DAMPED = Candidate("wrong_parameter", "parameter", "pivot_damping", "wrong_parameter", value=0.3)
WEAK = Candidate("input_error", "input", "drive", "input_gain")
LATE = Candidate(*MISSING, "delayed_feedback", ("delay(pivot, _d)",), {"d": "delays"})
KNEE = Path(__file__).parents[2] / "studies/systems/knee_muscles.xml"
CLIPPED = Candidate("input_error", "input", "drive", "input_saturation", ("min({s}, {limit})",), {"limit": ""})


def driven(folder, change, low_pass):
    """Return a model, what three driven trials of one with a change show, and their states."""
    pytest.importorskip("mujoco", reason="MuJoCo is not installed: gaitdisc[mujoco]")
    from gaitdisc.engines.engine import read_model

    (folder / "plain.xml").write_text(PENDULUM)
    (folder / "truth.xml").write_text(PENDULUM.replace(*change))
    plain, t, rng = read_model(folder / "plain.xml"), np.arange(300) / 100, np.random.default_rng(2)
    controls = [0.5 * np.sin(2 * np.pi * f * t)[:, None] + 0.2 * np.cos(5 * f * t)[:, None] for f in (0.6, 1.0, 1.3)]
    start = Motion(np.full((3, 1), 0.2), np.zeros((3, 1)), np.zeros((3, 1)))
    whole = read_model(folder / "truth.xml").run(start, np.stack(controls), 100.0)
    seen = low_pass.filtered(whole[:, :, :1] + 0.003 * rng.normal(size=(3, 300, 1)), 1)
    measured = Measured(Drive.of(controls, 100.0), seen, tuple("123"), ("pivot",))
    return plain, measured, whole


def fitted(plain, measured, states, part, low_pass):
    """Return what was found with numbers of the engine's own runs."""
    fit = EngineFit(draft(plain), plain, measured, states, (part,), low_pass)
    effect = FoundEffect(part.candidate.kind, part.candidate.place, part.candidate.name, "")
    return fit.fitted(replace(_NOTHING, effects=(effect,)), fit.mapping, base_runs(plain, fit))


@pytest.mark.parametrize(
    ("change", "part", "number", "truth", "low_pass"),
    [
        (("damping=", 'stiffness="6" damping='), Part(SPRING, {"factor": -6.6}), "stiffness", 6.0, NO_FILTER),
        (('gear="5"', 'gear="4"'), Part(WEAK, {"gain": 0.88}), "gain", 0.8, NO_FILTER),
        (("gear=", 'ctrlrange="-9 0.4" gear='), Part(CLIPPED, {"limit": 0.45}), "limit", 0.4, NO_FILTER),
        (('damping="0.3"', 'damping="0.6"'), Part(DAMPED, {"value": 0.5}), "value", 0.6, RecordFilter((4.0,), 100.0)),
    ],
)
def test_the_engines_own_runs_bring_a_number_to_the_truth(tmp_path, change, part, number, truth, low_pass):
    """A low-pass takes a little of each swing, as a damper would: the runs go through it as well."""
    one = fitted(*driven(tmp_path, change, low_pass), part, low_pass).effects[0].estimates[number]
    assert one.low < truth < one.high and one.high - one.low < 0.05 * truth


@pytest.mark.parametrize(("truth", "missing"), [("damping=", False), ('stiffness="0.6" damping=', True)])
def test_a_cut_off_that_its_record_hides_is_found_beside_the_engines_own_runs(tmp_path, truth, missing):
    """Where an effect is missing, no cut-off leaves mere noise."""
    plain, measured, states = driven(tmp_path, ("damping=", truth), RecordFilter((4.0,), 100.0))
    for assumed in (None, 4.8):
        fit = EngineFit(draft(plain), plain, measured, states, low_pass=RecordFilter((assumed,), 100.0))
        found = at_other_cutoffs(plain, fit, base_runs(plain, fit), measured, 1.0)
        assert missing if found is None else found[1].low_pass.cutoffs_hz == pytest.approx([4.0], rel=0.15)


def test_a_cutoff_at_which_runs_leave_more_hides_nothing(tmp_path, monkeypatch):
    """At 1.2 Hz the gap of a wrong damping would be noise; the runs leave more than at the true 4 Hz."""
    low = RecordFilter((1.2,), 100.0)
    monkeypatch.setattr("gaitdisc.discovery.fit_by_engine.find_record_filter", lambda *_, **__: (low, ()))
    plain, measured, states = driven(tmp_path, ('damping="0.3"', 'damping="0.33"'), RecordFilter((4.0,), 100.0))
    fit = EngineFit(draft(plain), plain, measured, states, low_pass=RecordFilter((4.0,), 100.0))
    assert at_other_cutoffs(plain, fit, base_runs(plain, fit), measured, 1.0) is None


@pytest.mark.parametrize("done", [2, 4])
def test_a_fit_that_was_stopped_goes_on_to_the_same_numbers(tmp_path, monkeypatch, done):
    """Its runs are kept, two of three trials of the base or more, though a low-pass leaves samples without a value."""
    low_pass = RecordFilter((4.0,), 100.0)
    record = driven(tmp_path, ('damping="0.3"', 'damping="0.6"'), low_pass)
    part, made, stop_at = Part(DAMPED, {"value": 0.5}), [], 0

    def counted(*given):
        made.append(given)
        if len(made) == stop_at:
            raise KeyboardInterrupt
        return residual_by(*given)

    monkeypatch.setattr("gaitdisc.discovery.fit_by_engine.residual_by", counted)
    at_once = fitted(*record, part, low_pass)
    every, stop_at = len(made), len(made) + done + 1
    with pytest.raises(KeyboardInterrupt), kept_work(tmp_path, lambda _: None):
        fitted(*record, part, low_pass)
    made.clear()
    with kept_work(tmp_path, lambda _: None):
        again = fitted(*record, part, low_pass)
    assert again.effects == at_once.effects and len(made) == every - done


@pytest.mark.parametrize("gain", [-2.0, 0.0])
def test_a_late_feedback_is_borne_out_by_the_engine_where_it_acts_and_not_where_it_is_invented(tmp_path, gain):
    """MuJoCo runs it along the measured motion: a name of the expansion alone was said without a proof."""
    plain, measured, whole = driven(tmp_path, ("damping=", "damping="), NO_FILTER)
    part = Part(LATE, {"factor": -2.0, "d": 0.1})
    fit = EngineFit(draft(plain), plain, measured, whole, (part,))
    controls, start = measured.drive.inputs, Motion(whole[:, 0, :1], whole[:, 0, 1:], np.zeros((3, 1)))
    for _ in range(9 if gain else 0):  # a run under the forces of the run before, until it is its own
        forces = [gain * np.interp(measured.time(0) - 0.1, measured.time(0), one[:, 0]) for one in whole]
        whole = plain.run(start, controls, 100.0, np.array(forces)[:, :, None])
    rng = np.random.default_rng(5)
    fit.measured = replace(measured, observed=whole[:, :, :1] + 0.003 * rng.normal(size=(3, 300, 1)))
    fit.states = whole
    runs = base_runs(plain, fit)
    found = replace(_NOTHING, effects=(FoundEffect("port", "pivot_moment", "delayed_feedback", part.term),))
    runs = replace(runs, after=fit.left(found, fit.parts, runs))
    assert fit.written(found, fit.parts)[1].absent == () and runs.leave_mere_noise == (gain == 0.0)
    kept = keep_borne_out(fit, found, runs, runs.at.trial == 2)
    assert kept == ((part,) if gain else ())


def test_an_answer_of_which_one_part_stays_is_of_that_parts_kind():
    """Own runs bear out the late input beside the spring, not the mass that was named first."""
    mass = Part(Candidate("wrong_parameter", "parameter", "rod_mass", "wrong_parameter", value=2.0), {"value": 2.1})
    late = Part(Candidate("input_error", "input", "drive", "input_delay"), {"seconds": 0.05})
    effects = tuple(
        FoundEffect(part.candidate.kind, part.candidate.place, part.candidate.name, "") for part in (mass, late)
    )
    both, alone, more = effects, effects[1:], FoundEffect("port", "pivot_moment", "viscous_damping", "", tied=True)
    others = tuple(map(Explanation, (both, alone, (effects[1], more))))
    found = replace(_NOTHING, verdict="wrong_parameter", effects=both, rivals=(more,), explanations=others)
    kept = keep_some(found, (mass, late), (late,))
    assert (kept.verdict, kept.effects) == ("input_error", alone) and len(kept.explanations) == 2
    assert [(rival.place, rival.small, rival.tied) for rival in kept.rivals] == [
        ("rod_mass", True, False),
        ("pivot_moment", False, False),
    ]


@pytest.mark.parametrize("weak", ["force", "excitation"])
def test_own_runs_distinguish_a_muscles_force_from_its_excitation(weak):
    """Activation rises faster the less there is of it: a scaled excitation makes no scaled activation."""
    pytest.importorskip("mujoco", reason="MuJoCo is not installed: gaitdisc[mujoco]")
    from gaitdisc.discovery.discover_engine import with_forces_of_muscles
    from gaitdisc.engines.engine import read_model

    model, t, rng = read_model(KNEE), np.arange(300) / 100, np.random.default_rng(4)
    controls = [0.25 + 0.2 * np.sin(2 * np.pi * f * t[:, None] + [0.0, 2.5]) for f in (0.6, 1.1, 1.7)]
    truth = model.with_values({"flexor_force": 0.8 * 700.0}) if weak == "force" else model
    driven = np.stack(controls) * ([1.0, 0.8] if weak == "excitation" else [1.0, 1.0])
    start = Motion(np.full((3, 1), 0.1), np.zeros((3, 1)), driven[:, 0])
    whole = truth.run(start, driven, 100.0)
    seen = whole[:, :, :1] + 0.001 * rng.normal(size=(3, 300, 1))
    measured = Measured(Drive.of(controls, 100.0), seen, tuple("123"), ("knee",))
    part = Part(Candidate("input_error", "input", "flexor", "input_gain"), {"gain": 0.81})
    fit = EngineFit(draft(model), model, measured, whole, (part,))
    found = replace(_NOTHING, verdict="input_error", effects=(FoundEffect("input", "flexor", "input_gain", ""),))
    runs = base_runs(model, fit)
    (one,) = with_forces_of_muscles(fit, fit.fitted(found, fit.mapping, runs), fit.mapping, runs).effects
    number, true = (one.estimates["value"], 560.0) if weak == "force" else (one.estimates["gain"], 0.8)
    assert one.place == ("flexor_force" if weak == "force" else "flexor")
    assert number.low < true < number.high
