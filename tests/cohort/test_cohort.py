"""The twelve: who they are, that they are found out, and what the package's own models make of them."""

from __future__ import annotations

import json

import numpy as np
import pytest

from gaitdisc.cohort.cohort import CALIBRATION_SEED, CHANGES, HIDDEN, REPORTED_SEED, the_twelve, walked_cohort, walks_of
from gaitdisc.cohort.measurement import measured
from gaitdisc.cohort.person import Spring
from gaitdisc.cohort.walk import walked
from gaitdisc.errors import SchemaError
from gaitdisc.ingest.study import Conditions, Models, Participant, Quality, Study
from gaitdisc.processing.process import processed
from gaitdisc.response.fit_response import ResponseSettings, fit_linear, held_out_part
from gaitdisc.response.samples import gait_samples
from gaitdisc.statistics.r2 import r2

OUTPUTS = ("hip_flexion_r", "knee_angle_r", "ankle_angle_r")
MUSCLES = ("ham", "rf", "vas", "gas", "sol", "ta", "gmed")
EMG = tuple(f"emg_{muscle}_{side}" for side in "rl" for muscle in MUSCLES)
EMG_OUTPUTS = tuple(f"emg_{muscle}_r" for muscle in MUSCLES[:5])


def study(outputs, emg, late_change="report"):
    return Study(
        conditions=Conditions(nominal="nominal", device="exo"),
        participants=(Participant(id="P01"),),
        models=Models(emg=emg, outputs=outputs),
        quality=Quality(late_change=late_change),
    )


def parts(walk, outputs, emg=()):
    trajectory = processed(measured(walk, "walk", "nominal"), study(outputs, emg)).trajectory
    settings = ResponseSettings(outputs, held_out_s=0.125 * len(walk.slow_s) / 100)
    return [gait_samples(part, outputs)[0] for part in held_out_part(trajectory, settings)]


def nominal_on_both(person, walker, device, duration_s, seed, outputs=OUTPUTS, emg=()):
    """R2 of the Nominal ridge on its own held-out part, and on that of the other walk."""
    train, held = parts(walked(person, None, duration_s, seed), outputs, emg)
    _, other = parts(walked(walker, device, duration_s, seed + 1), outputs, emg)
    model = fit_linear(train).model
    return r2(held.y, model(held.x)), r2(other.y, model(other.x))


def test_six_women_and_six_men_other_than_those_of_the_calibration():
    reported, calibration = the_twelve(), the_twelve(calibration=True)
    assert sorted(p.sex for p in reported) == ["f"] * 6 + ["m"] * 6
    assert {p.height_m for p in reported}.isdisjoint({p.height_m for p in calibration})
    assert len({p.name for p in reported + calibration}) == 24
    assert abs(REPORTED_SEED - CALIBRATION_SEED) > 1000
    assert [np.isfinite(p.change_s) for p in reported].count(True) == 1


def test_walks_of_a_person_are_two_trials_and_a_truth_that_is_plain():
    walks = walks_of(the_twelve()[0], 12.0)
    assert [trial.condition for trial in walks.trials.values()] == ["nominal", "exo"]
    assert {trial.subject for trial in walks.trials.values()} == {"W01"}
    truth = json.loads(json.dumps(walks.truth))
    assert truth["spring_nm_per_deg"] == 5.0
    assert truth["change_s"] is None
    assert len(truth["contacts_r_s"]["exo"]) > 8
    first = {key: s.values for key, s in walks.trials["nominal"].streams.items()}
    assert not np.array_equal(first["kinematics"], walks.trials["exo"].stream("kinematics").values)


@pytest.mark.parametrize("hidden", HIDDEN)
def test_effects_can_be_hidden(hidden):
    truth = walks_of(the_twelve()[0], 6.0, hidden).truth
    assert truth["hidden"] == hidden
    assert truth["spring_nm_per_deg"] == {"spring": 5.0, "scaled moment": 3.0}.get(hidden, 0.0)


def test_an_unknown_effect_is_refused():
    with pytest.raises(SchemaError, match="spring, weak plantarflexor"):
        walks_of(the_twelve()[0], 6.0, "gremlin")


def test_the_cohort_comes_one_person_at_a_time():
    names = [walks.person.name for walks, _ in zip(walked_cohort(4.0), range(2), strict=False)]
    assert names == ["W01", "W02"]


@pytest.mark.slow
def test_who_changes_late_is_found_by_the_quality_checks_alone():
    kinds = {}
    for number in (CHANGES, CHANGES + 1):
        trial = walks_of(the_twelve()[number], 120.0).trials["exo"]
        walk = processed(trial, study(OUTPUTS, ()))
        kinds[number] = [f.severity for f in walk.findings if f.kind == "late change"]
    assert kinds == {CHANGES: ["warning"], CHANGES + 1: []}


@pytest.mark.slow
def test_no_spring_and_no_adaptation_is_no_discrepancy(person):
    own, other = nominal_on_both(person.unadapted(), person.unadapted(), Spring(0.0), 240.0, 31)
    assert other == pytest.approx(own, abs=0.015)  # one person; the mean of twelve is held to 0.01 below


def test_a_spring_is_a_discrepancy_at_the_ankle(person):
    learner = person.adapted_to(Spring())
    own, other = nominal_on_both(person, learner, Spring(), 120.0, 31)
    assert other[2] < own[2] - 0.02


@pytest.mark.slow
def test_no_spring_and_no_adaptation_is_no_discrepancy_in_the_mean_of_twelve():
    outputs = OUTPUTS + EMG_OUTPUTS
    apart = []
    for number, someone in enumerate(the_twelve(calibration=True)):
        own, other = nominal_on_both(
            someone.unadapted(), someone.unadapted(), Spring(0.0), 240.0, 100 + 2 * number, outputs, EMG
        )
        apart.append(other - own)
    mean, error = np.mean(apart, axis=0), np.std(apart, axis=0, ddof=1) / np.sqrt(len(apart))
    assert np.all(np.abs(mean[:3]) < 0.01)
    assert np.all(np.abs(mean[3:]) < 0.01 + 2 * error[3:])
    assert np.all(error[:3] < 0.005)
