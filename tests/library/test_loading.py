"""Any saved result, read back."""

import json

import numpy as np
import pandas as pd
import pytest
from manufactured_discovery import manufactured

import gaitdisc as gd
from gaitdisc.errors import SchemaError


def test_a_discovery_comes_back_and_is_saved_with_the_same_bytes(tmp_path):
    found = manufactured()
    assert found.save(tmp_path / "one") == tmp_path / "one"
    again = gd.load(tmp_path / "one")
    assert isinstance(again, gd.Discovery)
    again.save(tmp_path / "two")
    assert [(tmp_path / "one" / name).read_bytes() for name in ("discovery.json", "held_out.csv")] == [
        (tmp_path / "two" / name).read_bytes() for name in ("discovery.json", "held_out.csv")
    ]
    assert (again.effects, again.train, again.where, again.findings) == (
        found.effects, found.train, found.where, found.findings)  # fmt: skip
    columns = ["run", "time", "theta_measured", "theta_augmented"]
    pd.testing.assert_frame_equal(again.to_frame()[columns], found.to_frame()[columns], rtol=1e-7)


def test_a_mismatch_comes_back(tmp_path):
    walks = gd.example_walks(12.0)
    found = gd.compare(walks["exo"], walks["nominal"], ["ankle_angle_r"])
    again = gd.load(found.save(tmp_path / "compare"))
    assert isinstance(again, gd.Mismatch) and repr(again) == repr(found)
    np.testing.assert_array_equal(again.curves["gap"], found.curves["gap"])


def test_a_folder_without_a_result_is_refused(tmp_path):
    (tmp_path / "notes.txt").write_text("")
    with pytest.raises(SchemaError, match=r"folder with one.*run.json.*notes.txt"):
        gd.load(tmp_path)
    with pytest.raises(SchemaError, match="nothere is no folder"):
        gd.load(tmp_path / "nothere")


def test_a_discovery_that_was_edited_or_is_of_another_format_is_refused(tmp_path):
    from gaitdisc.results.sealed_json import read_sealed, sealed_text

    file = manufactured().save(tmp_path) / "discovery.json"
    data = read_sealed(file)
    file.write_text(sealed_text(data | {"format": 2}))
    with pytest.raises(SchemaError, match="of format 2, not 1"):
        gd.load(tmp_path)
    file.write_text(sealed_text({key: value for key, value in data.items() if key != "gap"}))
    with pytest.raises(SchemaError, match=r"not.*.KeyError: 'gap'"):
        gd.load(tmp_path)
    manufactured().save(tmp_path, overwrite=True)
    text = json.loads(file.read_text()) | {"verdict": "no_gap"}
    file.write_text(json.dumps(text))
    with pytest.raises(SchemaError, match="changed since it was saved"):
        gd.load(tmp_path)
