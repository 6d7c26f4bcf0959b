from __future__ import annotations

import numpy as np
from made_clinic import KNEE, PELVIS, made_person

from gaitdisc.recording import PERCENT
from gaitdisc.results.leg_curves import legs_of


def test_pelvic_curves_are_named_for_the_legs_own_side():
    legs = legs_of(made_person(spread=0.0, each=40))
    np.testing.assert_allclose(legs["r"].mean("pelvis_tilt"), -PELVIS["pelvis_tilt"], atol=0.3)  # forwards
    np.testing.assert_allclose(legs["r"].mean("pelvis_obliquity"), -PELVIS["pelvis_list"], atol=0.3)  # right side up
    np.testing.assert_allclose(legs["r"].mean("pelvis_rotation"), PELVIS["pelvis_rotation"], atol=0.3)
    for name in ("pelvis_obliquity", "pelvis_rotation"):  # half a cycle later the left side does what the right did
        np.testing.assert_allclose(legs["l"].mean(name), legs["r"].mean(name), atol=0.6)
    np.testing.assert_allclose(legs["l"].mean("knee_flexion"), KNEE, atol=0.3)
    assert (legs["l"].count, legs["l"].stance_percent) == (40, 60.0)


def test_angles_about_the_line_of_walking_are_left_out_of_a_turn():
    turning = made_person(changed={"pelvis_rotation": 0.45 * PERCENT})
    legs = legs_of(turning)
    assert "pelvis_rotation" not in legs["l"].cycles and "foot_progression" not in legs["r"].cycles
    assert 40 < legs["r"].turned_deg < 50
    assert "pelvis_rotation" in legs_of(made_person())["l"].cycles


def test_a_cycle_with_a_gap_is_no_curve_and_another_unit_no_variable():
    person = made_person()
    curves = np.array(person.curves)
    curves[0, 10, person.channels.index(next(c for c in person.channels if c.name == "knee_angle_l"))] = np.nan
    assert len(legs_of(made_person(curves=curves))["l"].cycles["knee_flexion"]) == 3
    from dataclasses import replace

    watts = tuple(replace(c, unit="W") if c.quantity == "power" else c for c in person.channels)
    assert "ankle_power" not in legs_of(made_person(channels=watts))["l"].cycles


def test_forces_of_belts_are_weighed_by_what_both_feet_carry_over_strides():
    """Left 420 N and right 280 N on the mean over strides: 700 N are the weight."""
    from gaitdisc.channel import Channel

    person = made_person()
    added = tuple(Channel(f"ground_force_{side}_vy", "vertical_force", "N", side) for side in "lr")
    forces = np.full((len(person.curves), 101, 2), np.nan)
    forces[:4, :, 0], forces[4:, :, 1] = 420.0, 280.0
    curves = np.concatenate([person.curves, forces], axis=2)
    legs = legs_of(made_person(channels=(*person.channels, *added), curves=curves))
    np.testing.assert_allclose(legs["l"].mean("vertical_force"), 60.0)
    np.testing.assert_allclose(legs["r"].mean("vertical_force"), 40.0)
    assert "vertical_force" not in legs_of(person)["l"].cycles


def test_a_moment_whose_end_is_not_known_is_kept_and_one_with_an_earlier_gap_is_not():
    person = made_person()
    column = [channel.name for channel in person.channels].index("ankle_power_l")
    curves = np.array(person.curves)
    curves[0, 95:, column] = np.nan  # the first left cycle
    curves[1, 50, column] = np.nan
    leg = legs_of(made_person(curves=curves))["l"]
    assert len(leg.cycles["ankle_power"]) == 3
    assert np.isfinite(leg.mean("ankle_power")).all()  # of the two others there
    curves[:4, 95:, column] = np.nan
    alone = legs_of(made_person(curves=curves))["l"].mean("ankle_power")
    assert np.isfinite(alone[:95]).all() and np.isnan(alone[95:]).all()
