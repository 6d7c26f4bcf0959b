"""Recordings that wait on disk."""

from __future__ import annotations

import numpy as np
import pytest

from gaitdisc.channel import Channel
from gaitdisc.processing.pooled import shelf
from gaitdisc.recording import Recording, Source

EMG = Recording(
    np.arange(5000) / 1000,
    np.random.default_rng(0).normal(size=(5000, 2)),
    tuple(Channel(f"emg_{muscle}_r", "emg", "V", "r") for muscle in ("sol", "ta")),
    "P01",
    "walking",
    Source("a.c3d"),
    np.random.default_rng(1).random((5000, 2)) < 0.1,
)


def test_what_was_put_away_comes_back_to_the_last_bit_and_is_not_in_memory():
    with shelf() as shelved:
        first, second = shelved.put([EMG, EMG]), shelved.put([EMG])
        assert sum(one.values.nbytes for one in first.kept) < 100
        assert first.channels == EMG.channels * 2
        for (found,) in (list(first.recordings())[1:], second.recordings()):
            for name in ("time", "values", "suspect"):
                np.testing.assert_array_equal(getattr(found, name), getattr(EMG, name))
            assert (found.subject, found.condition, found.source) == ("P01", "walking", EMG.source)
        folder = shelved.folder
    assert not folder.exists()


def test_what_lies_in_the_folder_is_not_counted_at_each_new_one():
    with shelf() as shelved:
        first, second = shelved.put([EMG]), shelved.put([EMG.with_values(2 * EMG.values)])
        first.files[0].unlink()  # a count of the folder would give its place, and that of the second, away
        shelved.put([EMG])
        np.testing.assert_array_equal(next(second.recordings()).values, 2 * EMG.values)


def test_a_full_disk_leaves_them_in_memory(monkeypatch):
    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np, "savez", full)
    with shelf() as shelved:
        (found,) = shelved.put([EMG]).recordings()
    assert found is EMG


def test_the_shelf_is_cleared_after_an_error():
    with pytest.raises(ZeroDivisionError), shelf() as shelved:
        shelved.put([EMG])
        _ = 1 / 0
    assert not shelved.folder.exists()
