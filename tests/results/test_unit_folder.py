import json
from dataclasses import asdict

import pandas as pd
import pytest
from resealed import resealed

from gaitdisc.errors import SchemaError
from gaitdisc.recording import Finding
from gaitdisc.results.participant_response import RESPONSE, load_run
from gaitdisc.results.unit_folder import load_unit, save_unit, stored_finding


@pytest.mark.parametrize("file", ["r2.csv", "arrays.npz"])
def test_a_flipped_byte_is_reported(response, tmp_path, file):
    RESPONSE.save(response, tmp_path, "key")
    content = bytearray((tmp_path / file).read_bytes())
    content[len(content) // 2] ^= 1
    (tmp_path / file).write_bytes(bytes(content))
    with pytest.raises(SchemaError, match=rf"{file}.*changed"):
        RESPONSE.load_keyed(tmp_path)


def test_a_missing_file_and_another_format(response, tmp_path):
    with pytest.raises(SchemaError, match=r"run.json is missing"):
        load_run(tmp_path)
    RESPONSE.save(response, tmp_path, "key")
    resealed(tmp_path / "response.json", lambda data: data.update(format=99))
    with pytest.raises(SchemaError, match="of format 99, not 1"):
        RESPONSE.load_keyed(tmp_path)
    (tmp_path / "response.json").write_text("{")
    with pytest.raises(SchemaError, match="not readable as JSON"):
        RESPONSE.load_keyed(tmp_path)


def test_a_field_that_does_not_fit_the_schema_is_named(response, tmp_path):
    RESPONSE.save(response, tmp_path, "key")
    resealed(tmp_path / "response.json", lambda data: data.update(held_out_s=-1))
    with pytest.raises(SchemaError, match=r"at \$.held_out_s: -1"):
        RESPONSE.load_keyed(tmp_path)


def test_a_finding_comes_back_as_it_was():
    gap = Finding("warning", "gap", "a.mot", "0.1 s missing", "the windows", "knee_angle_r", ((1.0, 1.1), (2.0, 2.3)))
    assert stored_finding(json.loads(json.dumps(asdict(gap)))) == gap


def test_a_table_saved_under_an_earlier_name_of_a_column_has_the_name_of_today(tmp_path):
    fields = {"participants": 0, "alpha": 0.05, "level": 0.95, "too_few": ""}
    save_unit(tmp_path, "tests.json", fields, {"curves.csv": pd.DataFrame({"state": ["knee"], "told": [1.5]})}, {})
    _, tables, _ = load_unit(tmp_path, "tests.json", {"curves.csv": ("state", "reconstructed")})
    assert tables["curves.csv"]["reconstructed"].tolist() == [1.5]
