import shutil

from gaitdisc.batch.unit_key import response_key, unit_key, unit_keys
from gaitdisc.ingest.study import Filters, PlannedTrial


def test_the_key_follows_bytes_and_settings_not_names(study, tmp_path):
    planned = study.participants[0].trials[0]
    key = unit_key(study, planned)
    assert unit_key(study.model_copy(update={"title": "another"}), planned) == key
    assert unit_key(study.model_copy(update={"filters": Filters(kinematics_hz=8.0)}), planned) != key
    shutil.copy(study.path_of(planned.files[0]), tmp_path / "copy.mot")
    copied = PlannedTrial(condition="nominal", files=(str(tmp_path / "copy.mot"),))
    assert unit_key(study, copied) == key
    with (tmp_path / "copy.mot").open("a") as file:
        file.write(" ")
    assert unit_key(study, copied) != key


def test_a_response_rests_on_both_walks(study):
    keys = unit_keys(study, study.participants[0])
    assert list(keys) == ["nominal", "exo"]
    assert response_key(keys) != response_key({**keys, "exo": "another"})
