import pickle

import numpy as np
import pytest

from gaitdisc.errors import SchemaError
from gaitdisc.results import on_disk
from gaitdisc.results.on_disk import lies_on_disk
from gaitdisc.results.participant_response import RESPONSE


@pytest.fixture
def stored(response, tmp_path):
    RESPONSE.save(response, tmp_path, "key")
    return RESPONSE.load(tmp_path)


def test_arrays_are_read_when_they_are_looked_at(response, stored, monkeypatch):
    assert lies_on_disk(stored, "held_out") and lies_on_disk(stored, "residuals")
    assert not lies_on_disk(response, "held_out")
    np.testing.assert_array_equal(stored.held_out.measured, response.held_out.measured)
    assert stored.residuals.keys() == response.residuals.keys()
    read = []
    monkeypatch.setattr(on_disk.np, "load", lambda *_, **__: read.append(1))
    assert stored.held_out.time is stored.held_out.time  # what was just read is not read again
    assert read == []


def test_a_response_that_goes_to_another_process_takes_no_arrays_along(response, stored):
    assert len(pickle.dumps(stored)) < len(pickle.dumps(response))
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(stored)).held_out.phi, response.held_out.phi)


def test_arrays_that_changed_or_went_since_the_run_was_loaded_are_reported(response, tmp_path):
    RESPONSE.save(response, tmp_path, "key")
    changed, gone = RESPONSE.load(tmp_path), RESPONSE.load(tmp_path)
    on_disk._arrays.cache_clear()
    (tmp_path / "arrays.npz").write_bytes(b"other")
    with pytest.raises(SchemaError, match=r"arrays.npz.*changed since it was"):
        _ = changed.held_out
    (tmp_path / "arrays.npz").unlink()
    with pytest.raises(SchemaError, match=r"arrays.npz is missing"):
        _ = gone.residuals
