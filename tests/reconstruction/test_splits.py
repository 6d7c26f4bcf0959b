import numpy as np
import pytest

from gaitdisc.errors import SamplingError, SchemaError
from gaitdisc.reconstruction.windows import RANDOM, SEAM_S, split_by_subject, split_by_trial, split_within
from gaitdisc.recording import Samples

REACH_S = 0.5


def walk(seconds=60.0, first=0.0):
    time = first + np.arange(round(seconds * 100)) / 100
    return Samples(time[:, None], time[:, None], ("a",), ("b",), time, time % 1)


@pytest.mark.parametrize("rule", ["temporal", "blocked"])
def test_no_two_windows_of_different_parts_share_a_reading_or_the_filters_reach(rule):
    parts = split_within([walk()], rule, REACH_S)
    times = [part.time for part in (parts.fitted(), parts.checked(), parts.tested())]
    for k, one in enumerate(times):
        for other in times[k + 1 :]:
            assert np.abs(one[:, None] - other[None]).min() > REACH_S + SEAM_S - 1e-9
    assert sum(map(len, times)) > 0.85 * 6000 if rule == "temporal" else True


def test_the_temporal_split_judges_the_last_part_of_every_trial():
    parts = split_within([walk(), walk(30.0, 100.0)], "temporal", REACH_S)
    assert [each.time[0] for each in parts.test] == pytest.approx([48.8, 124.8], abs=0.02)
    assert parts.training[1].time[-1] == pytest.approx(120.99, abs=0.02)


def test_the_random_rule_leaks_and_says_so():
    parts = split_within([walk()], RANDOM, REACH_S)
    nearest = np.abs(parts.tested().time[:, None] - parts.fitted().time[None]).min(axis=1)
    assert np.mean(nearest < 0.011) > 0.9
    assert "leaks" in parts.rule


def test_a_person_left_out_is_nowhere_else():
    people = [[walk(10.0, 1000.0 * k)] for k in range(4)]
    parts = split_by_subject(people, 3)
    assert (parts.tested().time // 1000 == 3).all()
    assert (parts.checked().time // 1000 == 0).all()
    assert set(parts.fitted().time // 1000) == {1, 2}


def test_trials_left_out():
    parts = split_by_trial([walk(20.0), walk(20.0, 100.0)], [1], REACH_S)
    assert parts.tested().time[0] == 100.0
    assert parts.checked().time[0] - parts.fitted().time[-1] > REACH_S + SEAM_S - 0.001
    assert parts.checked().time[-1] < 20.0


def test_refusals():
    with pytest.raises(SchemaError, match="'shuffled'"):
        split_within([walk()], "shuffled", REACH_S)
    with pytest.raises(SamplingError, match=r"leave windows in.*none"):
        split_within([walk(5.0)], "temporal", REACH_S)
    with pytest.raises(SamplingError, match="at least three people"):
        split_by_subject([[walk()], [walk()]], 0)
