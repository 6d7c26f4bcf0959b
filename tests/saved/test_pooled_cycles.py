"""Cycles of a person, summaries of a walk, and the clinical variables of a leg's curves."""

from dataclasses import replace

import numpy as np
import pytest
from made_clinic import KNEE, PELVIS, made_person
from made_cycles import made_cycles

from gaitdisc.channel import vocabulary
from gaitdisc.clinic.laboratory import clinical_axes
from gaitdisc.errors import ShapeError
from gaitdisc.processing.leg_curves import BY_NAME, NORMAL, PROFILE, VARIABLES, make_legs
from gaitdisc.recording import PERCENT


def test_kept_and_left_out_are_distinguished_and_counted_by_foot():
    one = made_cycles(each=4, out=1)
    assert (one.counted("l"), one.counted("r"), len(one.left_out)) == (4, 4, 2)
    assert len(one.kept) == len(one.curves) == 8
    assert one.name == "P01 walk" and made_cycles(session="after").where == "after walk"


def test_means_go_by_the_cycles_of_the_own_foot_with_their_spread_and_number():
    means = made_cycles(each=4).mean_curves().set_index(["channel", "side"]).sort_index()
    knee = means.loc[("knee_angle_r", "r")]
    assert knee["mean"].to_numpy() == pytest.approx(10 * np.sin(2 * np.pi * PERCENT / 100) + 1.5)
    assert knee["sd"].to_numpy() == pytest.approx(np.std([0, 1, 2, 3], ddof=1))
    assert set(knee["n"]) == {4}
    assert set(means.index.get_level_values("channel")) >= {"pelvis_tilt"}
    assert len(means.loc[("pelvis_tilt", "l")]) == len(means.loc[("pelvis_tilt", "r")]) == 101
    assert ("knee_angle_r", "l") not in means.index


def test_a_single_cycle_has_a_mean_and_no_spread():
    moment = made_cycles().mean_curves()
    moment = moment[moment["channel"] == "ankle_angle_l_moment"]
    assert set(moment["n"]) == {1} and moment["sd"].isna().all() and moment["mean"].notna().all()


def test_curves_need_a_row_for_each_kept_cycle():
    with pytest.raises(ShapeError, match=r"\(8, 101, 6\).*\(3, 101, 6\).*P01"):
        made_cycles(curves=np.zeros((3, 101, 6)))


def test_light_and_counts(walk):
    assert walk.worst == "warning"
    assert replace(walk, findings=()).worst == "clean"
    assert walk.counted() == {"l": 1, "r": 1}
    assert walk.counted(kept=False) == {"r": 1}


def test_curves_have_101_points(walk):
    with pytest.raises(ShapeError, match=r"101, 2\).*\(4, 100, 2\).*P01"):
        replace(walk, curves=np.zeros((4, 100, 2)))


def test_pelvic_curves_are_named_for_the_legs_own_side():
    legs = make_legs(made_person(spread=0.0, each=40))
    np.testing.assert_allclose(legs["r"].mean("pelvis_tilt"), -PELVIS["pelvis_tilt"], atol=0.3)  # forwards
    np.testing.assert_allclose(legs["r"].mean("pelvis_obliquity"), -PELVIS["pelvis_list"], atol=0.3)  # right side up
    np.testing.assert_allclose(legs["r"].mean("pelvis_rotation"), PELVIS["pelvis_rotation"], atol=0.3)
    for name in ("pelvis_obliquity", "pelvis_rotation"):  # half a cycle later the left side does what the right did
        np.testing.assert_allclose(legs["l"].mean(name), legs["r"].mean(name), atol=0.6)
    np.testing.assert_allclose(legs["l"].mean("knee_flexion"), KNEE, atol=0.3)
    assert (legs["l"].count, legs["l"].stance_percent) == (40, 60.0)


def test_angles_about_the_line_of_walking_are_left_out_of_a_turn():
    turning = made_person(changed={"pelvis_rotation": 0.45 * PERCENT})
    legs = make_legs(turning)
    assert "pelvis_rotation" not in legs["l"].cycles and "foot_progression" not in legs["r"].cycles
    assert 40 < legs["r"].turned_deg < 50
    assert "pelvis_rotation" in make_legs(made_person())["l"].cycles


def test_a_cycle_with_a_gap_is_no_curve_and_another_unit_no_variable():
    person = made_person()
    curves = np.array(person.curves)
    curves[0, 10, person.channels.index(next(c for c in person.channels if c.name == "knee_angle_l"))] = np.nan
    assert len(make_legs(made_person(curves=curves))["l"].cycles["knee_flexion"]) == 3
    from dataclasses import replace

    watts = tuple(replace(c, unit="W") if c.quantity == "power" else c for c in person.channels)
    assert "ankle_power" not in make_legs(made_person(channels=watts))["l"].cycles


def test_forces_of_belts_are_weighed_by_what_both_feet_carry_over_strides():
    """Left 420 N and right 280 N on the mean over strides: 700 N are the weight."""
    from gaitdisc.channel import Channel

    person = made_person()
    added = tuple(Channel(f"ground_force_{side}_vy", "vertical_force", "N", side) for side in "lr")
    forces = np.full((len(person.curves), 101, 2), np.nan)
    forces[:4, :, 0], forces[4:, :, 1] = 420.0, 280.0
    curves = np.concatenate([person.curves, forces], axis=2)
    legs = make_legs(made_person(channels=(*person.channels, *added), curves=curves))
    np.testing.assert_allclose(legs["l"].mean("vertical_force"), 60.0)
    np.testing.assert_allclose(legs["r"].mean("vertical_force"), 40.0)
    assert "vertical_force" not in make_legs(person)["l"].cycles


def test_a_moment_whose_end_is_not_known_is_kept_and_one_with_an_earlier_gap_is_not():
    person = made_person()
    column = [channel.name for channel in person.channels].index("ankle_power_l")
    curves = np.array(person.curves)
    curves[0, 95:, column] = np.nan  # the first left cycle
    curves[1, 50, column] = np.nan
    leg = make_legs(made_person(curves=curves))["l"]
    assert len(leg.cycles["ankle_power"]) == 3
    assert np.isfinite(leg.mean("ankle_power")).all()  # of the two others there
    curves[:4, 95:, column] = np.nan
    alone = make_legs(made_person(curves=curves))["l"].mean("ankle_power")
    assert np.isfinite(alone[:95]).all() and np.isnan(alone[95:]).all()


def test_every_variable_is_a_channel_of_the_vocabulary_and_has_an_axis():
    for variable in VARIABLES:
        for side in "lr":
            channel = vocabulary().named(variable.channel(side))
            assert channel is not None, variable.name
            assert variable.unit.removesuffix("/kg") == channel.unit or (variable.unit, channel.unit) == ("%", "N")
    assert clinical_axes().keys() == BY_NAME.keys()
    assert all(low < high for low, high in clinical_axes().values())


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
