import pandas as pd
import pytest

from gaitdisc.report.search_table import search_sentences, search_table


@pytest.fixture
def found():
    names = ["knee_angle_l", "hip_flexion_r, knee_angle_l", "ankle_angle_r, hip_flexion_r, knee_angle_l"]
    return pd.DataFrame(
        {"sensors": [1, 2, 3], "names": names, "loss": [1.0, 0.25, 0.2304], "rmse_deg": [4.0, 2.0, 1.9],
         "fits": [18, 153, 816], "seconds": 0.5}
    )  # fmt: skip


def test_the_smallest_set_that_does_is_marked(found):
    rows = search_table(found).rows
    assert [row[0] for row in rows] == ["1", "2 *", "3"]
    assert rows[1][1:5] == ("hip flexion, right and knee angle, left", "0.500", "2.00", "153")


def test_the_sentence_says_how_many_which_what_one_more_brings_and_the_cost(found):
    [said] = search_sentences(found)
    assert said.startswith("2 sensors are enough: hip flexion, right and knee angle, left; one more takes 4 % off")
    assert said.endswith("(search: 987 regressions, 1.5 s).")


def test_a_search_that_was_too_short_says_so(found):
    [said] = search_sentences(found.iloc[:2])
    assert said.startswith(
        "The best set of 2 sensors is hip flexion, right and knee angle, left; whether it is enough is "
    )
    assert "no larger one was tried" in said and "are enough" not in said
