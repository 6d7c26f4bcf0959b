import numpy as np
import pytest

from gaitdisc.errors import ShapeError
from gaitdisc.ingest.reading import read_trial
from gaitdisc.recording import Surface

TILTED = np.array([[0.0, 0, 0], [0.4, 0, 0.3], [0.4, 0.6, 0.3], [0, 0.6, 0]])  # 0.5 m long, 0.6 m wide


def test_distances_are_measured_in_the_surface():
    plate = Surface("ramp", TILTED)
    along, across = np.array([0.8, 0.0, 0.6]), np.array([0.0, 1.0, 0.0])
    points = [
        plate.centre,
        plate.centre + 0.35 * along,
        plate.centre - 0.35 * across,
        plate.centre + 0.7 * plate.normal,
    ]
    assert plate.outside(np.array(points)) == pytest.approx([-0.25, 0.1, 0.05, -0.25])
    assert abs(plate.normal @ [0.6, 0, -0.8]) == pytest.approx(1)


def test_the_order_of_the_corners_does_not_matter():
    around = Surface("ramp", TILTED[::-1])
    assert around.outside(np.array([[0.5, 0.3, 0.3]])) == pytest.approx(Surface("a", TILTED).outside(np.array([[0.5, 0.3, 0.3]])))  # fmt: skip  # noqa: E501


def test_a_marker_that_is_missing_is_nowhere():
    assert np.isnan(Surface("ramp", TILTED).outside(np.full((1, 3), np.nan))).all()


@pytest.mark.parametrize("corners", [TILTED[:3], np.zeros((4, 3)), TILTED * np.nan])
def test_corners_that_span_nothing_are_refused(corners):
    with pytest.raises(ShapeError, match=r"corners \(4, 3\).*plate_3"):
        Surface("plate_3", corners)


def test_a_c3d_file_says_where_its_plates_lie(gait_data):
    trial = read_trial(gait_data / "young_straight_and_turn" / "HC030A" / "straight" / "HC030A05.c3d")
    assert [surface.name for surface in trial.surfaces] == ["plate_1", "plate_2"]
    # FORCE_PLATFORM:CORNERS: 463.8 by 508 mm, the second plate beside the first
    assert trial.surfaces[0].centre == pytest.approx([0.232, 0.254, 0.0], abs=1e-4)
    assert trial.surfaces[1].centre == pytest.approx([0.232, -0.324, 0.0], abs=1e-4)
