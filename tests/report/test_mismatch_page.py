"""The page of a mismatch and its sentences."""

import re
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pandas as pd
import pytest
from driven_walker import DrivenWalker
from texts import says

from gaitdisc.channel import Channel
from gaitdisc.comparison.compare import compare_walks
from gaitdisc.comparison.mismatch import Alignment, Smallest
from gaitdisc.comparison.page import (
    channels_table,
    mismatch_figures,
    mismatch_numbers,
    mismatch_text,
    regions_table,
    write_mismatch_report,
)
from gaitdisc.comparison.sentences import method_sentences, mismatch_sentences
from gaitdisc.processing.pooled_cycles import STRIDE_COLUMNS, WalkSummary
from gaitdisc.processing.walk_pair import walk_pair
from gaitdisc.recording import PERCENT
from gaitdisc.report.figure import save_figure


@pytest.fixture(scope="module")
def walks():
    springs = {"exo": 250.0, "free": 0.0}
    return walk_pair(*(DrivenWalker("A", seed=1, spring_per_s2=k).walked(25.0, word) for word, k in springs.items()))


@pytest.fixture(scope="module")
def mismatch(walks):
    return compare_walks(*walks, ("ankle_angle_r", "knee_angle_r"))


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
def mismatch_tables(walks):
    return compare_walks(*walks)


def test_every_region_and_every_channel_has_a_row(mismatch_tables):
    assert len(regions_table(mismatch_tables).rows) == len(mismatch_tables.regions) > 0
    assert [row[0] for row in channels_table(mismatch_tables).rows].count("right ankle angle") == 1
    assert len(channels_table(mismatch_tables).rows) == len(mismatch_tables.names)


def test_the_sign_is_printed_and_the_text_lists_all_channels(mismatch_tables):
    row = next(row for row in regions_table(mismatch_tables).rows if row[0] == "right ankle angle")
    largest = mismatch_tables.summary_of("ankle_angle_r")["largest_gap"]
    assert row[2][0] == ("−" if largest < 0 else "+")
    column = mismatch_tables.names.index("ankle_angle_r")
    apart = np.subtract(*(mismatch_tables.curves[word][:, column] for word in ("second", "first")))
    assert largest == pytest.approx(apart[np.argmax(np.abs(apart))])
    assert "free minus A exo" in regions_table(mismatch_tables).caption
    assert mismatch_text(mismatch_tables).row_count >= len(mismatch_tables.names)


def test_the_page_answers_first_and_needs_nothing_but_itself(mismatch, tmp_path):
    page = write_mismatch_report(mismatch, tmp_path)
    text = page.read_text(encoding="utf-8")
    HTMLParser().feed(text)
    assert text.index("In A free the right") < text.index("<figure>") < text.index("How the numbers were computed")
    assert "http" not in text.split("</head>")[1]
    assert "<script" not in text
    assert f"both walks, n = {len(mismatch.findings)}." in text
    assert (tmp_path / "channels" / "ankle_angle_r.csv").read_text().startswith("percent,first,second,")
    assert {file.name for file in (tmp_path / "tables").iterdir()} >= {"regions.csv", "channels.csv", "findings.csv"}
    first = page.read_bytes()
    assert write_mismatch_report(mismatch, tmp_path).read_bytes() == first


NAMES = ("hip_flexion_r", "ankle_angle_r", "pelvis_tilt")


def walk(name, seed, strides=20, gap=0.0, channel=1, shift=0):
    channels = tuple(Channel(n, "angle", "deg", "r" if n.endswith("_r") else "") for n in NAMES)
    wave = 10 * np.sin(2 * np.pi * (PERCENT + shift) / 100)
    offsets = np.random.default_rng(seed).normal(0, 1.0, (strides, 1, len(NAMES)))
    curves = np.repeat(wave[None, :, None], strides, axis=0) + offsets
    curves[:, 12:56, channel] += gap
    table = pd.DataFrame(columns=pd.Index(STRIDE_COLUMNS))
    return WalkSummary("", name, 9.0, 100.0, "angles", channels, curves, table, (), {})


def test_the_first_sentence_is_the_answer():
    first, *rest = mismatch_sentences(compare_walks(walk("model", 0, gap=-8.0), walk("measured", 1)))
    assert re.match(r"In measured.*right ankle.* [78]\.\d deg", first)
    assert says(first, "more", "model", "12", "55 %")
    assert says(first, "stride-to-stride SD", "p < 0.001); 3.")
    assert says(first, "the entire curve")
    assert says(rest[-1], "right", "95 %")


def test_no_gap_is_said_with_what_could_have_been_seen():
    first, second = mismatch_sentences(compare_walks(walk("model", 2), walk("measured", 3)))
    assert says(first, "model", "measured", "3 channels (20", "20 strides, p =")
    assert says(second, "not", "four of five such comparisons")
    assert "deg" in second


def test_a_late_curve_is_called_timing():
    late = walk("model", 4)
    curves = np.array(late.curves)
    curves[:, :, 1] = walk("model", 4, shift=-6).curves[:, :, 1]
    said = mismatch_sentences(compare_walks(replace(late, curves=curves), walk("measured", 5)))
    assert any(says(text, "6 %", "earlier") for text in said)


def test_marks_that_lie_apart_are_said_and_make_no_finding():
    found = compare_walks(walk("model", 4, shift=7), walk("measured", 5))
    assert found.ordered() == []
    said = mismatch_sentences(found)
    assert says(said[1], "model", "7.0 %", "later", "3 of 3 channels", "right")
    unmoved = np.abs(found.curves["second"] - walk("model", 4, shift=7).curves.mean(axis=0))[:, 0].max()
    assert said[1].endswith(f" instead of {unmoved:.1f} deg.")
    assert says(" ".join(method_sentences(found)), "A shift along", "most channels")


def test_an_offset_is_distinguished_from_a_change_of_shape():
    higher = walk("model", 0, strides=40)
    higher = replace(higher, curves=higher.curves + np.array([0.0, 6.0, 0.0]))
    first = mismatch_sentences(compare_walks(higher, walk("measured", 1, strides=40)))[0]
    assert says(first, "more", "model throughout the stride")
    assert re.search(r"\): an offset, .*\d deg\.$", first)


def test_what_is_smaller_than_a_clinician_would_call_one_is_not_named():
    rng = np.random.default_rng(0)
    one, other = walk("model", 0), walk("measured", 1)
    one = replace(one, curves=one.curves[:1] + [0.0, 1.5, 0.0] + 0.1 * rng.normal(size=one.curves.shape))
    other = replace(other, curves=one.curves[::-1] - [0.0, 1.5, 0.0] + 0.1 * rng.normal(size=one.curves.shape))
    found = compare_walks(one, other)
    assert found.ordered() == []
    assert not len(found.regions)
    said = mismatch_sentences(found)
    assert says(said[0], "model", "measured", "significantly", "right")
    assert "by less than 2.0 deg" in said[0]
    assert compare_walks(one, other, smallest=Smallest(angle_deg=1.0)).ordered() == ["ankle_angle_r"]


def test_the_method_says_what_p_speaks_of():
    one = replace(walk("sim", 6, strides=1), condition="sim")
    said = " ".join(method_sentences(compare_walks(one, walk("measured", 7))))
    assert says(said, "sim", "1 stride", "20 strides", "measured")
    assert says(said, "these two recordings")


def test_the_smallest_p_that_so_few_strides_can_give_is_said():
    """Nine strides against one curve: 2^8 patterns of signs."""
    found = compare_walks(walk("sim", 6, strides=1, gap=-8.0), walk("measured", 7, strides=9))
    assert found.exchange.permutations == 256 and len(found.regions)
    have = int((found.regions["p"] == 1 / 256).sum())
    for sentences in (mismatch_sentences(found), method_sentences(found)):
        assert says(" ".join(sentences), "p = 0.0039", "9 strides", f"{have} of ")
    many = compare_walks(walk("sim", 6, gap=-8.0), walk("measured", 7))
    assert says(" ".join(method_sentences(many)), "p = 0.0005", "2000 permutations")


def test_a_shift_that_was_not_applied_is_said_with_both_numbers():
    found = compare_walks(walk("model", 4, gap=-8.0), walk("measured", 5))
    found = replace(found, alignment=Alignment(4.0, False, 2, 3, [1.0, 5.5, 2.0]))
    largest = abs(found.summary_of("ankle_angle_r")["largest_gap"])
    assert says(
        mismatch_sentences(found)[1],
        "model",
        "not",
        "4.0 %",
        "later",
        "2 of 3 channels",
        "right",
        "5.5",
        f"{largest:.1f} deg",
    )
    assert "2.0" in [row[-1] for row in channels_table(found).rows]
