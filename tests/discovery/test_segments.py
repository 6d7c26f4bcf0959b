import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gaitdisc.discovery.segments import Segments, cut_segments
from gaitdisc.errors import SamplingError


@given(st.lists(st.integers(4, 300), min_size=1, max_size=5), st.integers(1, 400))
def test_segments_lie_inside_the_trials_and_never_overlap(samples, length):
    segments = cut_segments(np.array(samples), tuple(range(len(samples))), length)
    places = list(zip(np.repeat(segments.trial, segments.length), segments.samples.ravel(), strict=True))
    assert len(set(places)) == len(places)
    assert all(sample < samples[trial] for trial, sample in places)
    assert set(segments.trial) == set(range(len(samples)))


@given(st.lists(st.integers(4, 2000), min_size=1, max_size=5), st.integers(1, 3000))
def test_cutting_again_to_the_length_that_came_of_it_changes_nothing(samples, length):
    trials = tuple(range(len(samples)))
    once = cut_segments(np.array(samples), trials, length)
    again = cut_segments(np.array(samples), trials, once.length)
    assert again.length == once.length
    assert (again.begin.tolist(), again.trial.tolist()) == (once.begin.tolist(), once.trial.tolist())


@given(st.integers(4, 2000), st.integers(1, 3000))
def test_the_segments_of_the_shortest_trial_leave_less_than_one_over(shortest, length):
    segments = cut_segments(np.array([shortest]), (0,), length)
    assert len(segments) * segments.length > shortest - segments.length
    assert 1 <= segments.length <= shortest


def test_the_length_divides_the_shortest_trial_nearly_evenly():
    segments = cut_segments(np.array([100, 70]), (0, 1), 30)
    assert segments.length == 35
    assert segments.begin.tolist() == [0, 35, 0, 35]


def test_only_the_trials_that_are_asked_for():
    assert set(cut_segments(np.array([40, 40, 40]), (2,), 20).trial) == {2}


def test_a_trial_of_three_samples_is_refused():
    with pytest.raises(SamplingError, match=r"least 4 samples.*3."):
        cut_segments(np.array([50, 3]), (0, 1), 20)


def test_records_are_cut_where_the_segments_lie():
    records = np.arange(20.0).reshape(2, 10, 1)
    cut = Segments(np.array([0, 1]), np.array([3, 0]), 2).of(records)
    assert cut[..., 0].tolist() == [[3.0, 4.0], [10.0, 11.0]]


def test_every_step_is_a_segment_of_its_own():
    steps = Segments(np.array([0, 1]), np.array([5, 0]), 3).steps
    assert (steps.trial.tolist(), steps.begin.tolist(), steps.length) == ([0, 0, 1, 1], [5, 6, 0, 1], 2)


def test_rows_are_tiled_version_by_version():
    segments = Segments(np.array([0, 1]), np.array([5, 7]), 3)
    starts = np.arange(12.0).reshape(3, 2, 2)
    rows = segments.rows(starts, np.array([[1.0], [2.0], [3.0]]))
    assert rows.trial.tolist() == [0, 1] * 3
    assert rows.begin.tolist() == [5, 7] * 3
    assert rows.starts.tolist() == starts.reshape(6, 2).tolist()
    assert np.ravel(rows.values).tolist() == [1.0, 1.0, 2.0, 2.0, 3.0, 3.0]


def test_margins_are_run_and_not_compared():
    segments = cut_segments(np.array([100, 70]), (0, 1), 18, 10, 3)
    assert (segments.margin, segments.every, segments.span, segments.length) == (10, 3, 16, 36)
    assert segments.begin.tolist() == [0, 16, 32, 48, 64, 0, 16, 32]
    inner = segments.of(np.stack([np.arange(100), np.arange(100)]))[:, segments.compared]
    assert inner[:2].tolist() == [[10, 13, 16, 19, 22, 25], [26, 29, 32, 35, 38, 41]]
    with pytest.raises(SamplingError, match=r"least 24 samples.*23"):
        cut_segments(np.array([23]), (0,), 18, 10)


def test_where_runs_overlap_what_is_compared_is_put():
    segments = cut_segments(np.array([40]), (0,), 10, 10)
    runs = np.arange(len(segments))[:, None] + np.zeros((1, segments.length))
    put = segments.put(np.full((1, 40), -1.0), runs)
    assert put[0].tolist() == [0.0] * 20 + [1.0] * 20


def test_some_of_the_segments():
    segments = cut_segments(np.array([100, 70]), (0, 1), 18, 10, 3)
    few = segments.among(np.array([1, 5]))
    assert (few.trial.tolist(), few.begin.tolist(), few.every) == ([0, 1], [16, 0], 3)


def test_segments_are_thinned_within_each_trial():
    whole = cut_segments(np.array([400, 100, 400]), (0, 1, 2), 50)
    fewer = whole.spread(400)
    assert fewer.trial.tolist() == [0, 0, 0, 1, 2, 2, 2]
    assert fewer.begin.tolist() == [0, 150, 300, 0, 0, 150, 300]
    assert whole.spread(900) is whole
    assert set(whole.spread(1).trial) == {0, 1, 2}
