import pytest

from gaitdisc.report.gap_wording import direction_words


@pytest.mark.parametrize(
    ("name", "gap", "unit", "words"),
    [
        ("knee_angle_l", 3.0, "deg", "the left knee is up to 3.0 deg more flexed"),
        ("hip_rotation_r", -2.0, "deg", "the right hip is up to 2.0 deg more externally rotated"),
        ("emg_sol_r", 0.00012, "V", "right EMG soleus is up to 0.00012 V higher"),
        ("ankle_angle_r_moment", -12.0, "N m", "right ankle angle moment is up to 12.0 N m lower"),
    ],
)
def test_directions(name, gap, unit, words):
    assert direction_words(name, gap, unit) == words
