from __future__ import annotations

from gaitdisc.channel import vocabulary
from gaitdisc.results.emg_timing import NORMAL


def test_bars_are_parts_of_the_cycle_and_most_of_muscles_in_the_vocabulary():
    for bars in NORMAL.values():
        assert all(0 <= first < last <= 100 for first, last in bars)
    known = [muscle for muscle in NORMAL if vocabulary().named(f"emg_{muscle}_r")]
    assert len(known) >= 14


def test_calf_is_active_in_stance_and_shin_in_swing():
    inside = {m: [first <= at <= last for at in (30, 80) for first, last in NORMAL[m]] for m in ("gas", "ta")}
    assert inside["gas"] == [True, False]
    assert inside["ta"] == [False, False, False, True]
