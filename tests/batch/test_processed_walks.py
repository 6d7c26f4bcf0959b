from __future__ import annotations

import numpy as np
import pytest
from manufactured_body import RAJAGOPAL, known_angles, markers_of, static_of

from gaitdisc.batch.processed_walks import processed_walks, walks_and_errors
from gaitdisc.batch.unit_key import unit_keys
from gaitdisc.errors import ReadError
from gaitdisc.ingest.c3d_writing import write_c3d
from gaitdisc.ingest.reading import read_trial
from gaitdisc.ingest.study import Kinematics, Participant, PlannedTrial


def test_both_walks_say_what_the_models_leave_away(study):
    walks, refusals = processed_walks(study, study.participants[0])
    assert (list(walks), refusals) == (["nominal", "exo"], ())
    assert all(walk.findings[-1].severity == "note" for walk in walks.values())


def test_one_walk_that_cannot_be_read_leaves_the_other(study):
    person = study.participants[0]
    lost = person.trials[1].model_copy(update={"files": ("gone.mot",)})
    person = person.model_copy(update={"trials": (person.trials[0], lost)})
    walks, errors = walks_and_errors(study, person)
    assert (list(walks), list(errors)) == (["nominal"], ["exo"])
    assert isinstance(errors["exo"], ReadError)
    assert processed_walks(study, person)[1][0].reason == str(errors["exo"])


@pytest.fixture(scope="module")
def of_markers(study, tmp_path_factory):
    """The first person's walks as markers in C3D files, with a static trial and no angles."""
    folder = tmp_path_factory.mktemp("markers")
    for word in ("nominal", "exo"):
        own = read_trial(study.path_of(f"P01_{word}.mot")).stream("kinematics")
        angles = {name: own[name] if name in own.names else np.zeros(len(own.time)) for name in known_angles(2)}
        write_c3d([markers_of(angles, RAJAGOPAL, speed=0.0)], folder / f"{word}.c3d")
    write_c3d([static_of(RAJAGOPAL)], folder / "static.c3d")
    words = ("nominal", "exo", "static")
    trials = tuple(PlannedTrial(condition=word, files=(f"{word}.c3d",)) for word in words)
    update = {"participants": (Participant(id="P01", trials=trials),), "kinematics": Kinematics(joints="free")}
    return study.model_copy(update=update).placed(folder)


def test_walks_of_markers_are_the_walks_of_their_angles(study, of_markers):
    found, refusals = processed_walks(of_markers, of_markers.participants[0])
    given, _ = processed_walks(study, study.participants[0])
    assert not refusals
    for word, walk in found.items():
        np.testing.assert_allclose(walk.state.values, given[word].state.values, atol=1e-3)  # C3D holds 32 bits
        assert any(finding.kind == "marker set" for finding in walk.findings)


def test_the_key_of_a_walk_rests_on_its_static_trial_and_its_person(of_markers):
    person = of_markers.participants[0]
    keys = unit_keys(of_markers, person)
    heavy = person.model_copy(update={"mass_kg": 30.0})
    alone = person.model_copy(update={"trials": person.trials[:2]})
    assert len({tuple(unit_keys(of_markers, one).values()) for one in (person, heavy, alone)}) == 3
    assert unit_keys(of_markers, person) == keys
