import numpy as np
import pytest
from plug_in_gait_bones import feet as named_feet
from texts import says

from gaitdisc.errors import ShapeError
from gaitdisc.ingest.c3d import read_c3d
from gaitdisc.ingest.reading import read_trial
from gaitdisc.kinetics.plate_steps import FootPath, PlateStep, empty_findings, foot_paths, plate_steps
from gaitdisc.kinetics.platform import Platform, Wrench, platforms
from gaitdisc.recording import Surface

FRAMES, SAMPLES = np.arange(200) / 100, np.arange(2000) / 1000
CORNERS = np.array([[0.0, 0, 0], [0.4, 0, 0], [0.4, 0.6, 0], [0, 0.6, 0]])
UP = np.array([0.0, 0.0, 1.0])


def plate(place=(0.2, 0.3), start=0.5, end=1.2, peak=700.0):
    load = peak * np.clip(np.sin(np.pi * (SAMPLES - start) / (end - start)), 0, None)
    load *= (start < SAMPLES) & (end > SAMPLES)
    force = load[:, None] * UP
    wrench = Wrench.at(np.array([*place, 0.0]), force)
    return Platform("plate_1", SAMPLES, wrench, UP, CORNERS.mean(0), Surface("plate_1", CORNERS))


def foot(side, x=0.2, heel_y=0.25, start=0.5, end=1.2):
    """Stands from start to end at heel_y, flies in and out with 3 m/s; 18 cm from heel to toes."""
    y = heel_y + 3.0 * (np.minimum(FRAMES - start, 0) + np.maximum(FRAMES - end, 0))
    heel = np.stack([np.full_like(y, x), y, np.full_like(y, 0.04)], 1)
    return FootPath(side, FRAMES, heel, np.add(heel, [0.0, 0.18, 0.0]))


def test_a_foot_swings_while_it_is_faster_forwards_than_one_that_bears_load_whenever_the_record_begins():
    standing = foot("r")
    late = FootPath("r", FRAMES + 10.0, standing.heel, standing.toe)
    (first, second), shifted = standing.swings(), late.swings()
    assert (*first, *second) == pytest.approx((0.0, 0.48, 1.2, 1.99), abs=0.025)
    assert np.array(shifted) == pytest.approx(np.array([first, second]) + 10.0)
    assert foot("r", start=0.0, end=2.0).swings() == []


def test_a_belt_carries_the_foot_backwards_while_it_stands():
    stands, y = (FRAMES > 0.5) & (FRAMES < 1.2), np.cumsum(np.where((FRAMES > 0.5) & (FRAMES < 1.2), -1.2, 3.0)) / 100
    rolls = np.where(stands, 0.1 * np.sin(np.pi * (FRAMES - 0.5) / 0.7) ** 2, 0.0)  # the toes beside the heel
    heel, toe = (np.stack([np.zeros(200), y + part, np.zeros(200)], 1) for part in (0.0, 0.18 + rolls))
    spans = FootPath("r", FRAMES, heel, toe).swings()
    assert np.ravel(spans) == pytest.approx([0.0, 0.5, 1.2, 1.99], abs=0.04)


AWAY = foot("l", x=0.2, heel_y=-0.6, start=-1.0, end=0.6)


def step(platform=None, **feet):
    (found,) = plate_steps([platform or plate()], feet or {"r": foot("r"), "l": AWAY})
    return found


def test_one_foot_alone_is_told_from_the_one_that_flies_over():
    found = step()
    assert (found.side, found.reason, found.clean, found.finding("a.c3d")) == ("r", "", True, None)
    assert (found.start, found.end) == pytest.approx((0.516, 1.193), abs=0.003)
    assert step(r=AWAY, l=foot("l")).side == "l"


def test_the_foot_is_the_one_under_which_the_force_is():
    both = {"r": foot("r", x=0.1, heel_y=1.0), "l": foot("l")}
    assert step(**both).side == "l"


def test_two_feet_on_one_plate():
    found = step(r=foot("r", x=0.3, start=0.3), l=foot("l", x=0.1))
    assert found.side == ""
    assert says(
        found.finding("a.c3d").line(), "a.c3d", "plate_1", "0.52", "1.19 s", "excluded", "both", "0.68 s", "0.68 s"
    )


def test_a_step_that_the_edge_cuts():
    over = step(plate((0.2, 0.08)), r=foot("r", heel_y=-0.03), l=AWAY)
    assert over.side == "r" and says(over.reason, "heel", "3 cm beyond")
    beyond = step(plate((0.2, 0.55)), r=foot("r", heel_y=0.5), l=AWAY)
    assert beyond.side == "r" and says(beyond.reason, "toes", "8 cm beyond")


def test_toes_that_reach_over_the_edge_show_in_the_centre_of_pressure():
    reached = step(plate((0.2, 0.585)), r=foot("r", heel_y=0.4), l=AWAY)
    assert reached.side == "r" and says(reached.reason, "centre of pressure", "1.5 cm")


def test_a_force_that_no_foot_makes():
    found = step(plate((0.2, 0.58)), r=foot("r", heel_y=0.05), l=AWAY)
    assert found.side == "" and says(found.reason, "centre of pressure", "30 cm", "(r)")


def test_feet_without_markers_then():
    blind = FootPath("r", FRAMES, np.full((200, 3), np.nan), np.full((200, 3), np.nan))
    assert says(step(r=blind).reason, "both feet are missing")


def test_a_step_that_the_recording_cuts_has_right_forces_and_is_no_whole_stance():
    found = step(plate(start=1.5, end=2.6), r=foot("r", start=1.5, end=2.6), l=AWAY)
    assert (found.side, found.clean, found.whole) == ("r", True, False)
    assert step().whole


def test_a_platform_that_names_its_foot_needs_no_markers():
    force = plate()
    named = Platform("ground_force_l", force.time, force.wrench, UP, force.point, None, "l")
    (found,) = plate_steps([named], {})
    assert (found.side, found.clean) == ("l", True)


def test_a_platform_that_names_the_wrong_foot_is_found_out():
    force = plate()
    named = Platform("ground_force_l", force.time, force.wrench, UP, force.point, None, "l")
    (exchanged,) = plate_steps([named], {"r": foot("r"), "l": foot("l", heel_y=0.85)})
    assert exchanged.side == "l" and says(exchanged.reason, "side l", "centre of pressure", "(r), 55 cm away")
    (apart,) = plate_steps([named], {"l": foot("l", x=0.5)})
    assert says(apart.reason, "centre of pressure", "30 cm")
    (own,) = plate_steps([named], {"l": foot("l"), "r": AWAY})
    assert own.clean


def test_a_plate_that_nobody_stepped_on_is_said():
    empty = plate(peak=12.0)
    assert plate_steps([empty], {"r": foot("r"), "l": AWAY}) == []
    assert says(empty_findings([empty, plate()], "a.c3d")[0].line(), "a.c3d", "plate_1", "never", "12 N", "nothing; no")


def test_a_path_of_unlike_shapes_is_refused():
    with pytest.raises(ShapeError, match=r"\(3, 3\).*\(4, 3\).*3 times"):
        FootPath("r", np.arange(3.0), np.zeros((3, 3)), np.zeros((4, 3)))


# The side is the one that the events of the file have at the same instant; reasons as seen on pictures of the steps
REAL = {
    "HC002D/straight/HC002D06": [("r", ""), ("l", "")],
    "HC002D/turn/HC002D25": [("l", ""), ("r", "the heel is 2 cm beyond the plate's edge")],
    "HC030A/turn/HC030A22": [("r", ""), ("l", "")],
    "HC031A/turn/HC031A23": [("r", ""), ("", "both feet are on the plate, l for 0.53 s, r for 0.47 s")],
    "HC032A/turn/HC032A18": [("r", ""), ("l", "the toes are 8 cm beyond the plate's edge")],
    "HC033A/turn/HC033A22": [("r", ""), ("l", "the centre of pressure comes within 1.9 cm of the edge")],
    "HC036A/straight/HC036A10": [("r", ""), ("l", "")],
    "HC036A/turn/HC036A23": [("r", "")],
}


@pytest.mark.parametrize("walk", REAL)
def test_steps_of_real_walks(gait_data, walk):
    trial = read_c3d(gait_data / "young_straight_and_turn" / f"{walk}.c3d")
    steps: list[PlateStep] = plate_steps(platforms(trial), named_feet(trial))
    said = [(one.side, set(one.reason.split(", "))) for one in steps]
    assert said == [(side, set(reason.split(", "))) for side, reason in REAL[walk]]
    for one in steps:
        landed = [e.side for e in trial.events if e.label == "initial contact" and abs(e.time - one.start) < 0.04]
        assert not one.clean or not trial.events or landed == [one.side]


def test_sides_exchanged_in_an_opensim_file_are_found_out(gait_data):
    walk = gait_data.parent / "opensim_gait10dof" / "ExperimentalData"
    trial = read_trial([walk / "subject01_walk.trc", walk / "subject01_walk_grf.mot"])
    heels, toes = {"r": "R.Heel", "l": "L.Heel"}, {"r": "R.Toe.Tip", "l": "L.Toe.Tip"}
    feet = foot_paths(trial.stream("markers"), heels, toes)
    whole = [one for one in plate_steps(platforms(trial), feet) if one.end - one.start > 0.3]
    assert len(whole) >= 4 and all(one.clean for one in whole)
    exchanged = {"r": feet["l"], "l": feet["r"]}
    found = [one for one in plate_steps(platforms(trial), exchanged) if one.end - one.start > 0.3]
    assert all("follows the other foot" in one.reason for one in found)
