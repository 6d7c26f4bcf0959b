import pytest
from rich.console import Console
from rich.table import Table

from gaitdisc.words import (
    counted,
    direction_words,
    label,
    listing,
    number,
    p_words,
    plain,
    sideless,
    unit_text,
    upwards,
)


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


def test_a_p_of_one_in_a_thousand_is_printed():
    assert [p_words(p) for p in (0.00099, 0.001, 0.00105)] == ["p < 0.001", "p = 0.001", "p = 0.001"]


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
    assert (listing(["a"]), listing(["a", "b"])) == ("a", "a and b")
    assert unit_text("V/s2") == "V/s²"


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


def test_words_are_printed_letter_by_letter():
    console = Console(width=80, force_terminal=False)
    table = Table(caption=plain("[/c]"))
    table.add_column(plain("[b]h"))
    table.add_row(plain("xo[/b] :smile:"))
    with console.capture() as capture:
        console.print(table)
        console.print(plain("[exo]"))
    assert all(words in capture.get() for words in ("[b]h", "[/c]", "xo[/b] :smile:", "[exo]"))
