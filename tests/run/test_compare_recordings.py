import pytest
from driven_walker import DrivenWalker

from gaitdisc.comparison.compare_recordings import compare_files, compare_study
from gaitdisc.errors import ComparisonError, SchemaError
from gaitdisc.ingest.storage import write_storage
from gaitdisc.ingest.study import Conditions, Participant, PlannedTrial, Study


@pytest.fixture(scope="module")
def lab(tmp_path_factory):
    folder = tmp_path_factory.mktemp("lab")
    for word, spring in (("walk_exo_ik", 250.0), ("walk_free_ik", 0.0)):
        trial = DrivenWalker("A", seed=3, spring_per_s2=spring).walked(30.0, word)
        write_storage(trial.stream("kinematics"), folder / f"{word}.mot")
    return folder


def test_the_spring_is_found_at_the_ankle_under_short_names(lab):
    found = compare_files(lab / "walk_exo_ik.mot", lab / "walk_free_ik.mot")
    assert (found.first, found.second) == ("exo", "free")
    assert {name[:5] for name in found.ordered()[:2]} == {"ankle"}
    assert found.provenance.settings["detector"] == "angles"
    assert set(found.provenance.files) == {"exo", "free"}


def test_one_channel_alone(lab):
    found = compare_files(lab / "walk_exo_ik.mot", lab / "walk_free_ik.mot", ("ankle_angle_l",))
    assert found.names == ("ankle_angle_l",)


def test_a_file_against_itself_is_refused_in_words(lab):
    with pytest.raises(SchemaError, match=r"two different recordings; walk_exo_ik\.mot.*walk_exo_ik\.mot"):
        compare_files(lab / "walk_exo_ik.mot", lab / "walk_exo_ik.mot")


def test_a_participant_of_a_study_and_too_few_participants(lab):
    trials = tuple(
        PlannedTrial(condition=word, files=(f"walk_{word}_ik.mot",), speed_m_per_s=1.2) for word in ("exo", "free")
    )
    (lab / "other_ik.mot").write_bytes((lab / "walk_exo_ik.mot").read_bytes() + b"\n")
    other = PlannedTrial(condition="exo", files=("other_ik.mot",), speed_m_per_s=1.2)
    people = (Participant(id="P01", trials=trials), Participant(id="P02", trials=(other,)))
    study = Study(conditions=Conditions(nominal="free", device="exo"), participants=people).placed(lab)
    found = compare_study(study, "P01")
    assert (found.first, found.second) == ("P01 free", "P01 exo")  # second minus first
    assert found.ordered()[0].startswith("ankle")
    with pytest.raises(SchemaError, match=r"P02.*none.*'free', 1.*'exo'"):
        compare_study(study, "P02")
    with pytest.raises(ComparisonError, match="number of these participants is 1"):
        compare_study(study)


def test_short_trials_are_compared_by_their_pooled_cycles(lab):
    trials = tuple(
        PlannedTrial(condition=word, files=(f"walk_{word}_ik.mot",), speed_m_per_s=1.2, crop_s=(start, start + 9.5))
        for word in ("exo", "free")
        for start in (0.0, 10.0, 20.0)
    )
    people = (Participant(id="P01", trials=trials),)
    study = Study(conditions=Conditions(nominal="free", device="exo"), participants=people).placed(lab)
    found = compare_study(study, "P01")
    assert (found.first, found.second) == ("P01 free", "P01 exo")
    assert found.ordered()[0].startswith("ankle")
