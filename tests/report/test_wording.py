import pytest

from gaitdisc.report.wording import counted, label, listed, number, sideless, unit_text, upwards


def test_sides_of_known_and_unknown_channels():
    assert sideless("hip_flexion_r_moment") == "hip_flexion_moment"
    assert sideless("pelvis_list") == "pelvis_list"


def test_labels_read_like_words():
    assert label("hip_rotation_l") == "hip rotation, left"
    assert label("emg_gasmed_r") == "EMG gastrocnemius, right"
    assert label("my_signal") == "my signal"


def test_upwards_is_the_sign_word_without_its_footnote():
    assert upwards("ankle_angle_r") == "dorsiflexion"
    assert upwards("pelvis_tilt") == "pelvis rotates backwards"
    assert upwards("unknown") == ""


@pytest.mark.parametrize(
    ("value", "text"), [(0.955, "0.95"), (-0.3, "−0.30"), (-0.001, "0.00"), (float("nan"), "not computed")]
)
def test_numbers(value, text):
    assert number(value) == text


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [(0.99, 0, "1"), (0.97, 1, "1.0"), (-0.6, 0, "−1"), (0.9996, 3, ">0.999"), (0.9994, 3, "0.999"), (1.0, 2, "1.00")],
)
def test_a_share_short_of_all_is_not_all_and_an_amount_is_rounded(value, digits, text):
    assert number(value, digits) == text


def test_counts_lists_and_units():
    assert (counted(0, "stride"), counted(1, "stride")) == ("0 strides", "1 stride")
    assert (listed(["a"]), listed(["a", "b"])) == ("a", "a and b")
    assert unit_text("V/s2") == "V/s²"
