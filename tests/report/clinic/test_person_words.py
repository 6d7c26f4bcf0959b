from __future__ import annotations

from made_clinic import made_controls, made_person

from gaitdisc.clinic.contrast import contrast_of
from gaitdisc.clinic.reading import read_beside
from gaitdisc.recording import PERCENT
from gaitdisc.report.clinic.person_words import (
    MOST,
    contrast_sentences,
    noted_sentences,
    outstanding_sentences,
    quality_sentence,
    score_sentences,
)
from gaitdisc.results.clinical_reading import Limits, Noted

LIMITS = Limits(52.0, 66.0, 59.0, 3.6, 18)


def _noted(side, value, rule="knee", excess=2.0):
    return Noted(rule, "reduced knee flexion in swing", side, value, "deg", 0, LIMITS, 5, excess)


def test_a_sentence_has_number_limits_side_and_cycles():
    assert noted_sentences([_noted("l", 38.0)]) == [
        "Reduced knee flexion in swing: left 38 deg (5 cycles); limits 52 to 66 deg, reference 59 ± 3.6 deg, 18 people."
    ]


def test_both_sides_are_one_sentence_and_there_are_at_most_six():
    both = noted_sentences([_noted("r", 40.0), _noted("l", 38.0)])
    assert len(both) == 1 and "left 38 deg (5 cycles), right 40 deg (5 cycles)" in both[0]
    assert len(noted_sentences([_noted("l", 38.0, rule=str(k)) for k in range(9)])) == MOST == 6


def test_nothing_that_stands_out_and_why_nothing_can_be_said():
    few = outstanding_sentences(read_beside(made_person(), made_controls(6)))
    assert few[0].endswith("With 6 controls the limits are wide: smaller differences may be there.")
    assert "there is no reference" in outstanding_sentences(read_beside(made_person(), None))[0]


def test_quality_and_scores_are_said_with_counts():
    reading = read_beside(made_person(each=2), made_controls(6))
    assert quality_sentence(reading).startswith(
        "2 left and 2 right cycles of 2 trials over ground, 2 on a plate. amber:"
    )
    said = " ".join(score_sentences(reading))
    assert "Gait profile score: both" in said and "6 people" in said and "No gait deviation index: its 15" in said
    assert "No gait profile score: there is no reference" in score_sentences(read_beside(made_person(), None))[0]


def test_a_difference_is_said_with_place_p_and_counts():
    bump = 15.0 * ((PERCENT >= 65) & (PERCENT <= 80))
    before = read_beside(made_person(session="before", each=8, spread=0.0), None)
    after = read_beside(made_person(session="after", each=8, spread=0.0, seed=1, changed={"knee_angle_l": bump}), None)
    said, *_ = contrast_sentences(contrast_of(before, after))
    assert said.startswith("Knee flexion, left: 15 deg more (flexion) in after walk than in before walk, at 65 to 80 %")
    assert said.endswith("8 and 8 cycles.")
    few = contrast_sentences(contrast_of(*(read_beside(made_person(session=w, each=2), None) for w in ("a", "b"))))
    assert few[0].startswith("Left: not tested. a permutation test")
