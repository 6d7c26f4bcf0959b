import re
from dataclasses import replace

import numpy as np
import pandas as pd

from gaitdisc.channel import Channel
from gaitdisc.discovery.compare import compare_walks
from gaitdisc.recording import PERCENT
from gaitdisc.report.mismatch_sentences import method_sentences, mismatch_sentences
from gaitdisc.results import WalkSummary
from gaitdisc.results.walk_summary import STRIDE_COLUMNS

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
    assert re.match(r"In model the right ankle is up to [78]\.\d deg", first)
    assert "deg more plantarflexed than in measured between 12 and 55 % of the stride (" in first
    assert first.endswith(" stride-to-stride sd, p < .001).")
    assert rest[-1].startswith(
        "No gap is seen in right hip flexion and pelvis tilt: with 95 % confidence they agree to"
    )


def test_no_gap_is_said_with_what_could_have_been_seen():
    first, second = mismatch_sentences(compare_walks(walk("model", 2), walk("measured", 3)))
    assert first.startswith("No gap: model and measured cannot be told apart in 3 channels (20 and 20 strides, p = ")
    assert second.startswith("That is no proof of none: a gap would have been seen, in four such comparisons of five, ")
    assert "deg" in second


def test_a_late_curve_is_called_timing():
    said = mismatch_sentences(compare_walks(walk("model", 4, shift=-6), walk("measured", 5)))
    assert any("Much of the largest gap is timing: moved 6 % of the stride earlier" in text for text in said)


def test_the_method_says_what_p_speaks_of():
    one = replace(walk("sim", 6, strides=1), condition="sim")
    said = " ".join(method_sentences(compare_walks(one, walk("measured", 7))))
    assert "sim has 1 stride and was taken as a curve without spread; 20 strides of measured" in said
    assert "p speaks of these two recordings alone" in said
