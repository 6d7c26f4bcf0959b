from __future__ import annotations

import io
import json

import numpy as np
import pytest
from texts import says

from gaitdisc.ingest.reader_worker import READERS, answer, points_in_rows, serve


def _request(path, **changes):
    limits = {"cap_bytes": 2**40, "limit_s": 600.0, "clock_s": 600.0}
    return {"path": str(path), "reader": "ezc3d", "wanted": [50, 3, 4, 500]} | limits | changes


def test_coordinates_come_with_time_first_and_gaps_are_nan():
    points = np.arange(24.0).reshape(3, 2, 4)
    rows = points_in_rows(points, np.array([[0, 0, -1, 0], [0.0, 0, 0, 0]]))
    assert rows.shape == (4, 6)
    np.testing.assert_array_equal(rows[0], [0, 8, 16, 4, 12, 20])
    assert np.isnan(rows[2, :3]).all()
    assert np.isfinite(rows[2, 3:]).all()


@pytest.mark.parametrize("reader", list(READERS))
def test_both_readers_hand_back_what_was_written(tmp_path, write_c3d, some_points, some_analog, reader):
    path = write_c3d(tmp_path / "a.c3d", some_points, some_analog)
    head, (points, analog, _) = answer(_request(path, reader=reader))
    assert head["reader"].startswith(reader)
    np.testing.assert_allclose(points, some_points.transpose(2, 1, 0).reshape(50, 9), rtol=1e-6)
    np.testing.assert_allclose(analog.T, some_analog, rtol=1e-6)


def test_other_counts_than_expected_are_said(tmp_path, write_c3d, some_points, some_analog):
    path = write_c3d(tmp_path / "a.c3d", some_points, some_analog)
    head, arrays = answer(_request(path, wanted=[51, 3, 4, 500]))
    assert list(head) == ["said"] and says(head["said"], "50 frames", "3 points", "500 samples", "4 analog")
    assert not arrays


def test_what_a_reader_raises_is_its_opinion(tmp_path):
    assert answer(_request(tmp_path / "none", reader="c3d"))[0]["said"].startswith("it stopped with FileNotFoundError")


def test_serving_ends_with_the_requests(tmp_path, write_c3d, some_points, some_analog, monkeypatch):
    monkeypatch.setattr("gaitdisc.ingest.reader_worker._limit", lambda *_: None)  # would cap this very process
    path = write_c3d(tmp_path / "a.c3d", some_points, some_analog)
    answers = io.BytesIO()
    serve(io.BytesIO(json.dumps(_request(path)).encode() + b"\n"), answers)
    head, _, numbers = answers.getvalue().partition(b"\n")
    assert json.loads(head)["reader"].startswith("ezc3d")
    values = np.frombuffer(numbers)
    np.testing.assert_allclose(values[:450].reshape(50, 9)[:, 0], some_points[0, 0], rtol=1e-6)
    np.testing.assert_allclose(values[450:].reshape(500, 4), some_analog.T, rtol=1e-6)
