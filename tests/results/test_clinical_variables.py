from __future__ import annotations

from gaitdisc.channel import vocabulary
from gaitdisc.results.leg_curves import BY_NAME, NORMAL, PROFILE, VARIABLES


def test_every_variable_is_a_channel_of_the_vocabulary_and_has_a_place_of_its_own():
    for variable in VARIABLES:
        for side in "lr":
            channel = vocabulary().named(variable.channel(side))
            assert channel is not None, variable.name
            assert variable.unit.removesuffix("/kg") == channel.unit or (variable.unit, channel.unit) == ("%", "N")
    places = [(one.kind != "kinematics", one.row, one.column) for one in VARIABLES]
    assert len(set(places)) == len(places)


def test_the_profile_is_the_nine_curves_of_the_paper():
    assert len(PROFILE) == 9 and set(PROFILE) <= set(BY_NAME)


def test_bars_are_parts_of_the_cycle_and_most_of_muscles_in_the_vocabulary():
    for bars in NORMAL.values():
        assert all(0 <= first < last <= 100 for first, last in bars)
    known = [muscle for muscle in NORMAL if vocabulary().named(f"emg_{muscle}_r")]
    assert len(known) >= 14


def test_calf_is_active_in_stance_and_shin_in_swing():
    inside = {m: [first <= at <= last for at in (30, 80) for first, last in NORMAL[m]] for m in ("gas", "ta")}
    assert inside["gas"] == [True, False]
    assert inside["ta"] == [False, False, False, True]
