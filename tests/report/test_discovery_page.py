import math
import re
from dataclasses import replace
from html import unescape

import numpy as np
import pandas as pd
import pytest
from manufactured_discovery import CUBIC, SPRING, manufactured
from scipy.special import logit
from texts import says

from gaitdisc.discovery.method import methods_used
from gaitdisc.discovery.page import (
    corrections_table,
    estimates_table,
    explanations_table,
    gap_table,
    models_table,
    share_closed,
    trials_table,
    where_table,
    write_discovery_report,
)
from gaitdisc.discovery.result import (
    CHANCE,
    DEVICE,
    ENGINE,
    SIMULATION,
    TRACKED,
    Correction,
    Estimate,
    Explanation,
    FoundEffect,
    GapSize,
)
from gaitdisc.report.table import tabulate_findings
from gaitdisc.saved.provenance import provenance_now


def test_an_angle_is_given_in_degrees_too():
    rows = estimates_table(manufactured()).rows
    assert rows[0][2:] == ("stiffness", "286 N m/rad", "279 N m/rad", "293 N m/rad", "")
    assert rows[1][-1] == "2.0 deg (95 % CI 1.9 to 2.1)"


def test_where_no_number_is_an_angle_no_column_is_in_degrees():
    found = manufactured()
    (effect,) = found.effects
    table = estimates_table(
        replace(found, effects=(replace(effect, estimates={"stiffness": effect.estimates["stiffness"]}),))
    )
    assert table.columns[-1] == "high"
    assert table.rows[0][2:] == ("stiffness", "286 N m/rad", "279 N m/rad", "293 N m/rad")


def test_the_gap_is_given_for_both_parts_of_the_data():
    table = gap_table(manufactured())
    assert [row[0] for row in table.rows] == ["held out", "fitted"]
    assert table.rows[0][2:] == ("3.09 deg", "0.60 deg", "0.50 deg", "99 %", "0.010")
    assert table.numbers["before"].iloc[0] == 0.054


@pytest.mark.parametrize(("sizes", "closed"), [((2.0, 1.0, 1.0), 1.0), ((2.0, 2.0, 1.0), 0.0), ((2.0, 0.8, 1.0), 1.0)])
def test_closed_is_of_the_squared_gap_above_the_noise(sizes, closed):
    assert share_closed(*sizes) == closed


def test_where_nothing_stands_above_the_noise_nothing_is_closed():
    assert math.isnan(share_closed(1.0, 1.0, 1.0))


SEARCHED = replace(manufactured().provenance, section=SIMULATION)


def test_a_name_is_the_likelier_to_be_right_the_more_of_the_gap_goes(tmp_path):
    found = manufactured(provenance=SEARCHED)
    sizes = [GapSize(1.0, after, 0.0) for after in (1.0, math.sqrt(0.5), 0.0)]
    chances = np.array([replace(found, held_out=size).probability for size in sizes])
    np.testing.assert_allclose(logit(chances), [CHANCE[0], CHANCE[0] + CHANCE[1] / 2, sum(CHANCE)])
    assert f"this answer is correct: {100 * found.probability:.0f} % (from tests" in found.chance
    tied = replace(found, rivals=(replace(CUBIC, tied=True),))
    assert (
        says(tied.chance, "or one that these data cannot distinguish from it") and tied.to_json()["probability"] > 0.5
    )
    assert tied.chance in unescape(write_discovery_report(tied, tmp_path).read_text(encoding="utf-8"))


ENGINES = replace(SEARCHED, section=ENGINE)
OTHERS = ({"provenance": ENGINES}, {"provenance": None}, {"given": "proven"}, {"verdict": "unnamed"})


@pytest.mark.parametrize("other", OTHERS, ids=str)
def test_what_was_not_searched_in_tests_with_known_effects_has_no_probability(other):
    found = replace(manufactured(provenance=SEARCHED), **other)
    assert math.isnan(found.probability) and found.chance == "" and found.to_json()["probability"] is None


def test_where_has_share_stride_and_region():
    found = manufactured()
    assert where_table(found).rows == (("at the ankle_moment port", "97 %", "12 to 55 %", "theta > 0.035"),)
    machine = where_table(replace(found, where=(replace(found.where[0], phase=()),)))
    assert machine.columns == ("place", "share of the gap", "region") and machine.rows[0][2] == "theta > 0.035"


def test_a_rival_is_listed_with_what_would_distinguish_it():
    table = explanations_table(manufactured(rivals=(replace(CUBIC, tied=True),)))
    assert table.rows[0][1] == "cubic_stiffness@ankle_moment"
    assert table.rows[0][4:6] == ("640", "yes") and says(table.rows[0][6], "wider range", "both")


def test_accounts_are_listed_with_what_each_closes_of_the_held_out_gap():
    named, other = (GapSize(0.3, after, 0.05, 0.01) for after in (0.06, 0.2))
    found = manufactured(explanations=(Explanation((SPRING,), named), Explanation((CUBIC, SPRING), other)))
    table = explanations_table(found)
    assert [row[5] for row in table.rows] == ["named", "no"]
    assert table.rows[1][1] == "cubic_stiffness@ankle_moment, one_sided_spring@ankle_moment"
    assert table.numbers["closed"].tolist() == pytest.approx([864 / 875, 500 / 875])


def test_findings_are_listed():
    assert tabulate_findings(manufactured().findings, "").rows[0][0] == "warning"


def test_what_moved_within_its_bounds_has_a_table_of_its_own():
    moved = Correction("inertia", 0.110, Estimate(0.1126, 0.1118, 0.1134, "kg m^2"))
    table = corrections_table(manufactured(corrections=(moved,)))
    assert table.rows == (("inertia", "0.11 kg m^2", "0.1126 kg m^2", "0.1118 kg m^2", "0.1134 kg m^2"),)
    assert "not effects" in table.caption
    assert corrections_table(manufactured()).rows == ()


def test_a_rival_outside_its_bounds_is_said_to_lie_there():
    found = {"value": Estimate(1.817, 1.7, 1.9, "N m/rad")}
    rival = FoundEffect("parameter", "strength", "wrong_parameter", "", found, bounds=(0.3, 1.7))
    (row,) = explanations_table(manufactured(rivals=(rival,))).rows
    assert says(row[2], "0.3", "1.7 N m/rad")


def test_the_test_says_on_how_many_pieces_and_of_what_where_nothing_is_named():
    size = GapSize(1, 1, 1, 0.34, {"theta": (0.054, 0.054, 0.0087)}, 9)
    table = gap_table(manufactured(verdict="no_gap", effects=(), held_out=size))
    assert says(table.caption, "9 independent samples")
    assert says(table.caption, "No effect is named", "cubic stiffness", "ankle_moment")
    assert "No effect is named" not in gap_table(manufactured()).caption


def test_every_held_out_trial_has_its_errors():
    found = manufactured()
    table = trials_table(found)
    assert set(table.numbers["trial"]) == {found.runs.names[one] if found.runs.names else str(one + 1)
                                           for one in found.runs.trial}  # fmt: skip
    first = found.runs.trial == found.runs.trial[0]
    before = np.sqrt(np.mean((found.runs.measured[first] - found.runs.simulated[first])[..., 0] ** 2))
    assert table.numbers["before"].iloc[0] == pytest.approx(before)


def test_a_small_rival_is_said_to_be_small():
    small = FoundEffect("port", "load", "constant_load", "0.1", small=True)
    table = explanations_table(manufactured(rivals=(small,)))
    assert table.rows[0][5] == "small"


def test_the_models_of_chapter_4_stand_beside_the_named_effect_in_the_channels_unit():
    table = models_table(replace(manufactured(), beside={"Nominal": 21.4, "Nominal + named effect": 3.2}))
    assert [row[0] for row in table.rows] == ["Nominal", "Nominal + named effect"]
    assert table.rows[0][1].startswith("21.4 ")
    assert models_table(manufactured()).rows == ()


def test_the_answer_comes_first_and_the_page_needs_nothing_else(tmp_path):
    text = write_discovery_report(manufactured(), tmp_path).read_text(encoding="utf-8")
    body = text[text.index("<main>") :]
    assert body.index("lacks a one-sided spring") < body.index("Verdict: missing physics") < body.index("279 N m/rad")
    assert not re.search(r'(src|href)="(?!data:|#)', text)
    assert "<script" not in text


@pytest.mark.usefixtures("unpainted")
def test_every_table_lies_beside_the_page(tmp_path):
    write_discovery_report(manufactured(), tmp_path)
    names = {path.stem for path in (tmp_path / "tables").iterdir()}
    assert {"estimates", "gap", "where", "rivals", "findings", "files"} <= names
    assert pd.read_csv(tmp_path / "tables" / "estimates.csv")["high"].tolist() == [292.8, 0.037]
    assert (tmp_path / "figures" / "over_stride.csv").is_file()


@pytest.mark.usefixtures("unpainted")
def test_no_gap_is_a_page_too(tmp_path):
    empty = manufactured(verdict="no_gap", where=(), effects=(), rivals=(), findings=(), provenance=None)
    text = write_discovery_report(empty, tmp_path).read_text(encoding="utf-8")
    assert says(text, "no", "nothing", "to the simulation")
    assert "Other explanations" not in text


@pytest.mark.usefixtures("unpainted")
def test_what_a_file_says_is_text_and_never_markup(tmp_path):
    text = write_discovery_report(manufactured(sentence="<b>lacks</b>"), tmp_path).read_text(encoding="utf-8")
    assert "&lt;b&gt;lacks" in text


@pytest.mark.parametrize(
    ("section", "says", "no_word_of"),
    [
        (SIMULATION, "Trials were divided into short runs.", "Inverse dynamics"),
        (ENGINE, "The engine then computed the accelerations along the smoothed record", "Inverse dynamics"),
        (TRACKED, "Each block of time was predicted", "short runs. The initial state"),
        (DEVICE, "A moment model of this person was calibrated", "short runs. The initial state"),
    ],
)
def test_a_page_says_how_its_own_answer_was_made(tmp_path, unpainted, section, says, no_word_of):
    found = replace(manufactured(), provenance=provenance_now({"title": "A leg"}, 0, {}, section))
    page = unescape(write_discovery_report(found, tmp_path).read_text())
    assert says in page and no_word_of not in page
    assert methods_used(found).held_out in page and methods_used(found).added_to in page


def test_an_answer_that_says_nothing_of_itself_is_of_a_simulation():
    found = replace(manufactured(), provenance=None)
    assert says(methods_used(found).sentences[0], "into short runs")
