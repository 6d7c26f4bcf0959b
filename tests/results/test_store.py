import json

import numpy as np
import pandas as pd
import pytest

from gaitdisc.errors import SchemaError
from gaitdisc.results.store import (
    load_response,
    load_run,
    load_walk,
    save_response,
    save_run,
    save_walk,
    unit_name,
)


def test_a_walk_comes_back_as_it_was(walk, tmp_path):
    save_walk(walk, tmp_path, "key")
    loaded, key = load_walk(tmp_path)
    assert key == "key"
    np.testing.assert_array_equal(loaded.curves, walk.curves)
    pd.testing.assert_frame_equal(loaded.strides, walk.strides, check_dtype=False)
    for name in ("subject", "condition", "duration_s", "rate_hz", "detector", "channels", "findings", "files"):
        assert getattr(loaded, name) == getattr(walk, name)


def test_a_response_comes_back_as_it_was(response, tmp_path):
    save_response(response, tmp_path, "key")
    loaded, _ = load_response(tmp_path)
    pd.testing.assert_frame_equal(loaded.r2, response.r2)
    pd.testing.assert_frame_equal(loaded.fits, response.fits)
    np.testing.assert_array_equal(loaded.held_out.predicted["nominal"], response.held_out.predicted["nominal"])
    np.testing.assert_array_equal(loaded.residuals["nominal"], response.residuals["nominal"])
    assert (loaded.inputs, loaded.outputs, loaded.units) == (response.inputs, response.outputs, response.units)


def test_a_run_comes_back_as_it_was(run, tmp_path):
    save_walk(run.walks[0], tmp_path / "walks" / unit_name("P01", "exo"), "key")
    save_response(run.responses[0], tmp_path / "responses" / "P01", "key")
    save_run(run, tmp_path)
    loaded = load_run(tmp_path)
    assert (loaded.title, loaded.refusals, loaded.provenance) == (run.title, run.refusals, run.provenance)
    pd.testing.assert_frame_equal(loaded.r2_table(), run.r2_table())


def test_saving_twice_gives_the_same_bytes(response, tmp_path):
    for folder in ("a", "b"):
        save_response(response, tmp_path / folder, "key")
    for file in ("response.json", "r2.csv", "fits.csv", "arrays.npz"):
        assert (tmp_path / "a" / file).read_bytes() == (tmp_path / "b" / file).read_bytes()


@pytest.mark.parametrize("file", ["r2.csv", "arrays.npz"])
def test_a_flipped_byte_is_told(response, tmp_path, file):
    save_response(response, tmp_path, "key")
    content = bytearray((tmp_path / file).read_bytes())
    content[len(content) // 2] ^= 1
    (tmp_path / file).write_bytes(bytes(content))
    with pytest.raises(SchemaError, match=rf"{file} is changed since it was saved.*gaitdisc run"):
        load_response(tmp_path)


def test_a_missing_file_and_another_format(response, tmp_path):
    with pytest.raises(SchemaError, match=r"run.json is missing"):
        load_run(tmp_path)
    save_response(response, tmp_path, "key")
    data = json.loads((tmp_path / "response.json").read_text())
    (tmp_path / "response.json").write_text(json.dumps({**data, "format": 99}))
    with pytest.raises(SchemaError, match="of format 99, not 1"):
        load_response(tmp_path)
    (tmp_path / "response.json").write_text("{")
    with pytest.raises(SchemaError, match="not readable as JSON"):
        load_response(tmp_path)


def test_a_field_that_does_not_fit_the_schema_is_named(response, tmp_path):
    save_response(response, tmp_path, "key")
    data = json.loads((tmp_path / "response.json").read_text())
    (tmp_path / "response.json").write_text(json.dumps({**data, "held_out_s": -1}))
    with pytest.raises(SchemaError, match=r"at \$.held_out_s: -1"):
        load_response(tmp_path)
