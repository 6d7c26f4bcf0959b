"""Words of the pages in another language, from a table that somebody filled in."""

import csv
from dataclasses import replace

import pytest
from made_clinic import PROVENANCE, made_controls, made_person, made_run
from texts import says

from gaitdisc.clinic.clinical_reference import Limits, Noted, PersonSession
from gaitdisc.clinic.page_words import PageWords, english_words, read_words, write_words
from gaitdisc.clinic.person_page import index_rows, write_index, write_person_page
from gaitdisc.clinic.reading import contrast, read_beside
from gaitdisc.clinic.sentences import (
    MOST,
    contrast_sentences,
    outstanding_sentences,
    quality_sentence,
    score_sentences,
    write_noted,
)
from gaitdisc.errors import SchemaError
from gaitdisc.recording import PERCENT

ENGLISH = english_words()


def doubled(word):
    """A language in which each word differs from its English."""
    return f"§{word}§"


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """English, and in a language that has every word."""
    folder = tmp_path_factory.mktemp("pages")
    reference = made_controls(6)
    person = made_person(changed={"knee_angle_l": -60.0})
    session = PersonSession("P01", (read_beside(person, reference),))
    found = {}
    for name, say in (("en", PageWords()), ("other", PageWords({word: doubled(word) for word in ENGLISH}))):
        page = write_person_page(session, "P01", reference, PROVENANCE, folder / name, say)[0]
        index = write_index(made_run(person), index_rows(session, "P01", say), reference, folder / name, say)
        found[name] = page.read_text(encoding="utf-8"), index.read_text(encoding="utf-8")
    return folder, found


@pytest.mark.parametrize(
    "word",
    ["en", "What stands out", "Kinematics", "knee flexion", "dorsiflexion", "step length", "asymmetry", "limits",
     "reduced knee flexion in swing", "left", "gait profile score", "Reading the curves"],
)  # fmt: skip
def test_headings_sign_words_and_what_stands_out_are_in_the_other_language(pages, word):
    _, found = pages
    (english, _), (other, _) = found["en"], found["other"]
    assert word in english.replace("Reduced", "reduced") and doubled(word) in other.replace("§Reduced", "§reduced")


def test_the_index_has_them_too_and_the_numbers_beside_stay(pages):
    folder, found = pages
    _, index = found["other"]
    assert doubled("state") in index and doubled("green") in index and "■ §" in index.lower()
    for path in (folder / "en").rglob("*.csv"):
        if path.name != "people.csv":  # the words that are read
            assert path.read_bytes() == (folder / "other" / path.relative_to(folder / "en")).read_bytes()


def test_every_word_of_rules_is_in_the_table_and_a_filled_one_comes_back(tmp_path):
    path = write_words(tmp_path / "de.csv")
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))
    assert rows[0] == ["English", "other"] and [word for word, _ in rows[1:]] == ENGLISH and "short steps" in ENGLISH
    path.write_text("English;other\nknee flexion;Kniebeugung, <b>\nstep length;\n", encoding="utf-8-sig")
    words = read_words(path)
    assert words("knee flexion [deg]") == "Kniebeugung, <b> [deg]" and words("step length") == "step length"
    assert read_words(write_words(path, words)) == words


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("knee,Knie\n", "de.csv begins with knee, Knie"),
        ("English,other\n\nelbow,Ellbogen\n", "de.csv, line 3: 'elbow' does not"),
        (
            "English,other\nNone of {} values lies outside 2 standard deviations of the reference.,Nichts.\n",
            "as often as in",
        ),
    ],
)
def test_another_table_is_refused_with_its_line(tmp_path, text, said):
    (tmp_path / "de.csv").write_text(text, encoding="utf-8")
    with pytest.raises(SchemaError, match=said):
        read_words(tmp_path / "de.csv")


def test_a_table_that_is_no_text_is_refused(tmp_path):
    (tmp_path / "de.csv").write_bytes(b"\xff\xfe\x00E")
    with pytest.raises(SchemaError, match=r"CSV.*UTF-8"):
        read_words(tmp_path / "de.csv")


LIMITS = Limits(46.0, 72.0, 59.0, 3.6, 18)
SWING = "reduced knee flexion in swing"


def _noted(side, value, rule="knee", tier=2, words=SWING):
    return Noted(rule, words, side, value, "deg", 0, LIMITS, 5, 2.0, tier, f"{rule} less")


@pytest.mark.parametrize(
    ("noted", "tier", "parts"),
    [
        ([_noted("l", 38.0)], 2, [("left 38 deg (5 cycles)", "limits 46 to 72 deg", "59 ± 3.6 deg", "18 people")]),
        ([_noted("l", 48.0, tier=1)], 1, [("left 48 deg (5 cycles)", "2 sd: 52 to 66 deg", "59 ± 3.6 deg")]),
        ([_noted("l", 48.0, tier=1)], 2, []),
        ([_noted("r", 40.0), _noted("l", 48.0, tier=1)], 2, [("left 48 deg (5 cycles, □), right 40 deg (5 cycles);",)]),
        ([_noted("r", 40.0), _noted("l", 48.0, tier=1)], 1, []),
        ([_noted("l", 38.0), _noted("l", 2.0, words="more extended at contact")], 2,
         [("swing: left 38", "; more extended at contact: left 2 deg (5 cycles).")]),
        ([_noted("l", 38.0, rule=str(k)) for k in range(9)], 2, [("left",)] * MOST),
    ],
)  # fmt: skip
def test_what_says_one_thing_is_one_sentence_of_its_highest_tier(noted, tier, parts):
    found = write_noted(noted, tier)
    assert len(found) == len(parts)
    for said, own in zip(found, parts, strict=True):
        assert said.startswith("Reduced knee flexion in swing: ") and all(part in said for part in own)


def test_nothing_that_stands_out_and_why_nothing_can_be_said():
    few = outstanding_sentences(read_beside(made_person(each=2, changed={"knee_angle_l": -60.0}), made_controls(6)))
    assert list(few) == [""] and says(" ".join(few[""]), "3 cycles", "2 left, 2 right", "few controls (6)", "missed")
    assert "there is no reference" in outstanding_sentences(read_beside(made_person(), None))[""][0]


@pytest.mark.parametrize(
    ("nearest", "which"),
    [("", "(6)"), ("age", "(6, those nearest in age)"), ("speed", "(6, those nearest in walking speed)"),
     ("age and speed", "(6, those nearest in age and walking speed)")],
)  # fmt: skip
def test_few_controls_are_said_with_which_of_them_they_are(nearest, which):
    reading = read_beside(made_person(), made_controls(6))
    said = outstanding_sentences(replace(reading, nearest=nearest))[""][-1]
    assert said == f"With few controls {which} the 95 % limits are wide: differences may be missed."


def test_quality_and_scores_are_said_with_counts():
    reading = read_beside(made_person(each=2), made_controls(6))
    assert says(quality_sentence(reading), "2 left", "2 right cycles", "2 trials", "2")
    said = " ".join(score_sentences(reading))
    assert "Gait profile score: both" in said and "6 people" in said and says(said, "gait deviation index", "15")
    assert says(score_sentences(read_beside(made_person(), None))[0], "gait profile score", "no")


def test_a_difference_is_said_with_place_p_and_counts():
    bump = 15.0 * ((PERCENT >= 65) & (PERCENT <= 80))
    before = read_beside(made_person(session="before", each=8, spread=0.0), None)
    after = read_beside(made_person(session="after", each=8, spread=0.0, seed=1, changed={"knee_angle_l": bump}), None)
    said, *_ = contrast_sentences(contrast(before, after))
    assert says(said, "left: 15 deg more", "after", "before", "65", "80 %")
    assert "in ‘after’ than in ‘before’" in said and said.endswith("8 and 8 cycles.")
    both = {"knee_angle_l": bump / 5, "hip_flexion_l": bump / 5}  # less than matters
    slightly = read_beside(made_person(session="after", each=8, spread=0.0, seed=1, changed=both), None)
    assert says(contrast_sentences(contrast(before, slightly))[-1], "2 parts", "less than 5 deg")
    few = contrast_sentences(contrast(*(read_beside(made_person(session=w, each=2), None) for w in ("a", "b"))))
    assert says(few[0], "not tested; a test", "6 cycles", "there")
