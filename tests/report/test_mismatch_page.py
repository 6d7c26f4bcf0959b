from html.parser import HTMLParser

import numpy as np
import pytest
from driven_walker import DrivenWalker

from gaitdisc.comparison.compare import compare_walks
from gaitdisc.processing.walk_pair import walk_pair
from gaitdisc.report.figure import save_figure
from gaitdisc.report.mismatch_page import (
    channels_table,
    findings_of,
    mismatch_figures,
    mismatch_numbers,
    mismatch_text,
    regions_table,
    write_mismatch_report,
)


@pytest.fixture(scope="module")
def mismatch():
    walks = [
        DrivenWalker("A", seed=1, spring_per_s2=k).walked(25.0, name) for k, name in ((250.0, "exo"), (0.0, "free"))
    ]
    return compare_walks(*walk_pair(*walks), ("ankle_angle_r", "knee_angle_r"))


def test_the_numbers_drawn_are_those_found(mismatch):
    numbers = mismatch_numbers(mismatch, ["ankle_angle_r"])
    column = mismatch.names.index("ankle_angle_r")
    np.testing.assert_array_equal(numbers["gap"], mismatch.curves["gap"][:, column])
    shaded = numbers["percent"][numbers["differs"]]
    row = mismatch.regions_of("ankle_angle_r")[0]
    assert row["from_percent"] in shaded.to_numpy()


def test_curves_and_gap_are_drawn_alike_each_time(mismatch, tmp_path):
    figures = mismatch_figures(mismatch)
    assert [figure.name for figure in figures] == ["mismatch-curves", "mismatch-gap"]
    assert "right ankle angle" in figures[0].alt
    assert "permutation test" in figures[0].caption
    for figure, again in zip(figures, mismatch_figures(mismatch), strict=True):
        assert save_figure(figure, tmp_path / "a").data == save_figure(again, tmp_path / "b").data


@pytest.fixture(scope="module")
def mismatch_tables():
    walks = [
        DrivenWalker("A", seed=1, spring_per_s2=k).walked(25.0, name) for k, name in ((250.0, "exo"), (0.0, "free"))
    ]
    return compare_walks(*walk_pair(*walks))


def test_every_region_and_every_channel_has_a_row(mismatch_tables):
    assert len(regions_table(mismatch_tables).rows) == len(mismatch_tables.regions) > 0
    assert [row[0] for row in channels_table(mismatch_tables).rows].count("right ankle angle") == 1
    assert len(channels_table(mismatch_tables).rows) == len(mismatch_tables.names)
    assert len(findings_of(mismatch_tables).rows) == len(mismatch_tables.findings)


def test_the_sign_is_printed_and_the_text_lists_all_channels(mismatch_tables):
    row = next(row for row in regions_table(mismatch_tables).rows if row[0] == "right ankle angle")
    largest = mismatch_tables.summary_of("ankle_angle_r")["largest_gap"]
    assert row[2][0] == ("−" if largest < 0 else "+")
    column = mismatch_tables.names.index("ankle_angle_r")
    apart = np.subtract(*(mismatch_tables.curves[word][:, column] for word in ("second", "first")))
    assert largest == pytest.approx(apart[np.argmax(np.abs(apart))])
    assert "free minus A exo" in regions_table(mismatch_tables).caption
    assert mismatch_text(mismatch_tables).row_count >= len(mismatch_tables.names)


def test_the_page_answers_first_and_needs_nothing_but_itself(tmp_path):
    walks = [
        DrivenWalker("A", seed=1, spring_per_s2=k).walked(25.0, name) for k, name in ((250.0, "exo"), (0.0, "free"))
    ]
    found = compare_walks(*walk_pair(*walks), ("ankle_angle_r", "knee_angle_r"))
    page = write_mismatch_report(found, tmp_path)
    text = page.read_text(encoding="utf-8")
    HTMLParser().feed(text)
    assert text.index("In A free the right") < text.index("<figure>") < text.index("How the numbers were made")
    assert "http" not in text.split("</head>")[1]
    assert "<script" not in text
    assert (tmp_path / "channels" / "ankle_angle_r.csv").read_text().startswith("percent,first,second,")
    assert {file.name for file in (tmp_path / "tables").iterdir()} >= {"regions.csv", "channels.csv", "findings.csv"}
    first = page.read_bytes()
    assert write_mismatch_report(found, tmp_path).read_bytes() == first
