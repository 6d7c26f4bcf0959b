"""Long walks of markers and a static trial: models are fitted to the angles that the markers show."""

from dataclasses import replace

import numpy as np
import pytest
from changed_trials import with_stream
from driven_walker import DrivenWalker
from manufactured_body import RAJAGOPAL, known_angles, markers_of, static_of, without
from texts import says

from gaitdisc.errors import ChannelError
from gaitdisc.ingest.study import Conditions, Kinematics, Models, Participant, PlannedTrial, Study
from gaitdisc.processing.process import StudyWalks, processed
from gaitdisc.recording import Trial

ANGLES = ("hip_flexion_r", "knee_angle_r", "ankle_angle_r", "hip_flexion_l", "knee_angle_l")
WALK = PlannedTrial(condition="natural", files=("walk.trc",))
STATIC = PlannedTrial(condition="static", files=("static.trc",))


@pytest.fixture(scope="module")
def known():
    """A walk of known angles, 15 s."""
    return DrivenWalker("P01", seed=1).walked(15.0, "natural")


@pytest.fixture(scope="module")
def trials(known):
    own = known.stream("kinematics")
    angles = {name: own[name] if name in own.names else np.zeros(len(own.time)) for name in known_angles(2)}
    walk = markers_of(angles, RAJAGOPAL, speed=0.0)
    standing = {"markers": static_of(RAJAGOPAL)}
    return {
        "walk": Trial("P01 natural", {"markers": walk}, subject="P01", condition="natural"),
        "static": Trial("P01 static", standing, subject="P01", condition="static"),
    }


FREE, ASKED = Kinematics(joints="free"), Kinematics(angles="markers", joints="free")


def walks(trials, kinematics: Kinematics | None = FREE, planned=(WALK, STATIC), **person):
    study = Study(
        conditions=Conditions(nominal="natural", device="spring"),
        models=Models(angles=ANGLES, outputs=("knee_angle_r",)),
        kinematics=kinematics,
        participants=(Participant(id="P01", trials=planned, **person),),
    )
    return StudyWalks(study, study.participants[0], lambda one: trials["walk" if one is WALK else "static"])


def test_models_see_the_angles_that_the_markers_show(known, trials):
    own = walks(trials)
    found = own.read_walk(WALK).processed(own.study)
    given = processed(Trial("P01 natural", {"kinematics": known.stream("kinematics")}), own.study)
    np.testing.assert_allclose(found.state.values, given.state.selected(ANGLES).values, atol=1e-6)
    assert found.strides["r"].detector == "markers"
    kinds = [finding.kind for finding in found.findings]
    assert {"marker set", "residual"} <= set(kinds)
    assert (found.trial.subject, found.state.condition) == ("P01", "natural")


def test_angles_of_the_file_stay_unless_the_study_asks_for_markers(known, trials):
    both = with_stream(trials["walk"], "kinematics", known.stream("kinematics"))
    for source, computed in ((None, False), (Kinematics(angles="file"), False), (ASKED, True)):
        found = walks({**trials, "walk": both}, source).read_walk(WALK)
        assert ("pelvis_tilt" in found.trial.stream("kinematics").names) == computed


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("nobody stands", "P01 natural has markers.* condition = "),
        ("no knee", "P01 natural has markers.*RLFC"),
        ("file asked for", "no angles: the study selects the angles of the file"),
    ],
)
def test_markers_without_a_static_trial_are_refused_in_words(trials, change, words):
    own, planned = dict(trials), (WALK,) if change == "nobody stands" else (WALK, STATIC)
    if change == "no knee":
        static = without(trials["static"].stream("markers"), "RLFC", "RMFC")
        own["static"] = replace(trials["static"], streams={"markers": static})
    kinematics = Kinematics(marker_set="rajagopal", angles="file" if change == "file asked for" else None)
    read = walks(own, kinematics, planned)
    with pytest.raises(ChannelError, match=words):
        read.read_walk(WALK).processed(read.study)


def test_hips_come_from_a_trial_of_circled_legs_unless_the_study_names_others(trials):
    turn = 2 * np.pi * np.arange(600) / 500
    angles = {name: np.zeros(600) for name in known_angles(2)}
    for side in "rl":
        angles |= {f"hip_flexion_{side}": 25 * np.sin(turn), f"hip_adduction_{side}": 20 * np.sin(1.5 * turn + 0.4)}
    circled = {"markers": markers_of(angles, RAJAGOPAL, speed=0.0, file="circles.trc")}
    own = {**trials, "functional": Trial("P01 functional", circled)}
    planned = (WALK, STATIC, PlannedTrial(condition="functional", files=("circles.trc",)))
    for kinematics, by_function in ((FREE, True), (Kinematics(joints="free", hip="harrington"), False)):
        read = walks(trials, kinematics, planned)
        read.read = lambda one: own["walk" if one is WALK else one.condition]
        said = [finding for finding in read.read_walk(WALK).trial.findings if finding.kind == "functional hip"]
        assert len(said) == 2 * by_function
        assert all("hip_" in one.what and says(one.what, "0.0 mm from that of") for one in said)


def test_the_weight_comes_from_the_study(trials):
    assert walks(trials).read_walk(WALK).body_weight_n is None
    assert walks(trials, mass_kg=30.0).read_walk(WALK).body_weight_n == pytest.approx(294.2, abs=0.1)
