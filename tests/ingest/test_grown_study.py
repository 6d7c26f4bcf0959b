"""What came since is added to a study; what stands in it stays."""

from __future__ import annotations

import pytest

from gaitdisc.errors import SchemaError
from gaitdisc.ingest.study import Conditions, Participant, PlannedTrial, Study
from gaitdisc.ingest.study_file import grown_study


def study_of(people, sessions=(), others=(), **more):
    participants = tuple(
        Participant(id=name, trials=tuple(trials), **more.get(name, {})) for name, trials in people.items()
    )
    return Study(sessions=sessions, conditions=Conditions(nominal="straight", others=others), participants=participants)


def walk(*files, condition="straight", session=None):
    return PlannedTrial(condition=condition, session=session, files=files)


@pytest.fixture
def study(tmp_path):
    """As somebody edited it: Zoe is P01, and one of her trials is not used."""
    return study_of({"P01": [walk("zoe/1.c3d"), walk("zoe/2.c3d", condition="unknown")]}).placed(tmp_path)


def test_a_person_keeps_the_pseudonym_and_edits_and_a_new_one_gets_another(study, tmp_path):
    draft = study_of(
        {
            "P01": [walk("anna/1.c3d")],
            "P02": [walk("zoe/1.c3d"), walk("zoe/2.c3d"), walk("zoe/3.c3d", condition="turn")],
        },
        others=("turn",), P01={"height_m": 1.6}, P02={"age_years": 30},
    ).placed(tmp_path)  # fmt: skip
    grown = grown_study(study, draft)
    assert [one.id for one in grown.participants] == ["P01", "P02"]
    zoe, anna = grown.participants
    assert [trial.files for trial in zoe.trials] == [("zoe/1.c3d",), ("zoe/2.c3d",), ("zoe/3.c3d",)]
    assert [trial.condition for trial in zoe.trials] == ["straight", "unknown", "turn"]
    assert (anna.trials[0].files, anna.height_m, zoe.age_years) == (("anna/1.c3d",), 1.6, 30)
    assert grown.conditions.others == ("turn",) and grown.folder == tmp_path


def test_nothing_new_is_the_same_study_and_files_of_a_trial_join_it(study, tmp_path):
    assert grown_study(study, study) == study
    draft = study_of({"P07": [walk("zoe/1.c3d", "zoe/1_ik.mot")]}).placed(tmp_path)
    (zoe,) = grown_study(study, draft).participants
    assert [trial.files for trial in zoe.trials] == [("zoe/1.c3d", "zoe/1_ik.mot"), ("zoe/2.c3d",)]


def test_sessions_of_the_draft_come_behind_and_what_does_not_fit_is_refused(study, tmp_path):
    own = study_of({"P01": [walk("zoe/1.c3d", session="pre")]}, ("pre",)).placed(tmp_path)
    draft = study_of({"P01": [walk("zoe/9.c3d", session="post")]}, ("pre", "post")).placed(tmp_path)
    assert grown_study(own, draft).sessions == ("pre", "post")
    stray = (Participant(id="P01", trials=(walk("zoe/9.c3d", session="later"),)),)
    with pytest.raises(SchemaError, match="later"):
        grown_study(own, draft.model_copy(update={"participants": stray}).placed(tmp_path))
