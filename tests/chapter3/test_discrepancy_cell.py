import numpy as np
import pytest
from chapter3.cell import DiscrepancyCell, PartAccuracy, cells_table

TIME = np.arange(101) / 10
TRUTH = np.column_stack([np.sin(TIME), np.cos(TIME)])


def part(augmented, diverged=None):
    return PartAccuracy(TIME, TRUTH, TRUTH + 0.2, augmented, diverged)


def test_accuracy_is_the_share_of_the_error_that_went():
    assert part(TRUTH + 0.05).accuracy() == pytest.approx([75.0, 75.0])
    assert part(TRUTH - 0.8).accuracy() == pytest.approx([-300.0, -300.0])
    assert part(TRUTH - 0.8).accuracy(clipped=True) == pytest.approx([-100.0, -100.0])


def test_the_horizon_and_the_valid_time():
    late = TRUTH + np.where(TIME > 5, 1.0, 0.0)[:, None]
    found = part(late)
    assert found.change([4.0]) == pytest.approx([100.0])
    assert found.change([10.0])[0] < 0
    assert found.valid_s("augmented") == pytest.approx(5.1)
    assert found.first_jump_s(channel=1) == pytest.approx(1.6)


def test_what_diverged_has_no_number():
    values = np.where(TIME[:, None] > 3, np.nan, TRUTH)
    cell = DiscrepancyCell("s", "gp", "state", "right", 0.0, 0, ("x", "y"), {"forecast": part(values, 3.0)}, 1.0, 1.0)
    table = cells_table([cell])
    assert table["accuracy"].isna().all()
    assert table["diverged_s"].tolist() == [3.0, 3.0]


def test_what_was_refused_keeps_its_row():
    cell = DiscrepancyCell("s", "gp", "state", "right", 0.0, 0, ("x",), {}, 1.0, 0.0, refused="too short")
    assert cells_table([cell])["refused"].tolist() == ["too short"]


def test_the_step_between_samples_is_said():
    cell = DiscrepancyCell("s", "gp", "state", "right", 0.0, 0, ("x", "y"), {"reconstruction": part(TRUTH)}, 1.0, 1.0)
    assert cell.dt_s == pytest.approx(TIME[1])
    assert np.isnan(DiscrepancyCell("s", "gp", "state", "right", 0.0, 0, ("x",), {}, 1.0, 0.0).dt_s)
