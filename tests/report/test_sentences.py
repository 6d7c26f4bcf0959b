"""Sentences of a study, and names of every sign that means something to a page, a terminal or a spreadsheet."""

from dataclasses import replace
from html.parser import HTMLParser
from xml.etree import ElementTree

import numpy as np
import pandas as pd
import pytest
from fresh_process import modules_loaded_by
from rich.console import Console
from texts import says

from gaitdisc.processing.pooled_cycles import WALK
from gaitdisc.recording import Finding
from gaitdisc.response.page import write_report
from gaitdisc.response.participant_response import RESPONSE
from gaitdisc.response.sentences import participant_sentences, r2_text, study_sentences
from gaitdisc.saved.provenance import Refusal
from gaitdisc.spreadsheet import read_csv

OUTPUTS = ("hip_flexion_r", "knee_angle_r", "ankle_angle_r")


def set_r2(response, model, kind, values, walk="exo"):
    rows = (response.r2["model"] == model) & (response.r2["kind"] == kind) & (response.r2["walk"] == walk)
    response.r2.loc[rows, "r2"] = values
    return response


@pytest.fixture
def response(response_maker):
    """Nominal 0.87, Augmented 0.94, Exo 0.97; ridge 0.10 below each; null 0.51."""
    made = response_maker("P01", outputs=OUTPUTS)
    for model, value in (("nominal", 0.87), ("augmented", 0.94), ("exo", 0.97)):
        set_r2(made, model, "network", value)
        set_r2(made, model, "ridge", value - 0.10)
    return set_r2(made, "nominal", "network", 0.96, walk="nominal")


def test_the_device_model_helps(response):
    headline, without, verdict, ridge, null = participant_sentences(response)
    assert says(headline, "P01", "0.87", "(R²", "3 variables", "7.5 s, n = 749", "samples", "0.94", "0.97")
    assert "the Nominal model reaches R² = 0.96" in without
    assert "helps: R² rises by 0.07" in verdict
    assert says(verdict, "better", "3 of 3 variables), 70", "%")
    assert says(ridge, "0.77", "0.84", "0.87", "0.10")
    assert says(null, "Band-limited noise alone", "0.51")


@pytest.mark.parametrize(
    ("values", "sentence", "words"),
    [
        ({"nominal": -0.3}, 0, ("worse", "nothing (R² −0.30)")),
        (
            {"augmented": [0.87, 0.874, 0.866]},
            2,
            ("not", "no better", "changes by 0.000", "better", "1 of 3 variables"),
        ),
        ({"augmented": 0.80}, 2, ("worse: R² falls", "0.07")),
        ({"nominal": 0.49}, 4, ("the Nominal model", "not exceed")),
        ({"nominal": 0.49, "exo": 0.4}, 4, ("Nominal and Exo", "not exceed")),
        ({"augmented": [0.94, 0.94, 0.5]}, 4, ("0.51", "1 of 3 variables", "no better", "right")),
    ],
)
def test_a_model_that_is_no_better_or_worse_than_another_the_mean_or_noise_is_named(response, values, sentence, words):
    for model, r2 in values.items():
        set_r2(response, model, "network", r2)
    assert says(participant_sentences(response)[sentence], *words)


def test_ridge_wins(response):
    set_r2(response, "augmented", "ridge", 0.96)
    assert says(participant_sentences(response)[3], "ridge exceeds", "(0.96", "0.94", "no advantage")
    set_r2(response, "augmented", "ridge", 0.94)
    assert participant_sentences(response)[3].endswith("the networks are no better.")


def test_what_was_not_computed_is_said(response):
    response.r2.loc[response.r2["variable"] == "knee_angle_r", "r2"] = np.nan
    assert says(participant_sentences(response)[0], "2 of 3 variables", "not")
    response.r2["r2"] = np.nan
    headline, verdict = participant_sentences(response)
    assert says(headline, "explains a share", "not")
    assert says(verdict, "not computed whether the Discrepancy")


def test_the_study_over_participants(run_maker, refusal):
    run = run_maker(3, outputs=OUTPUTS, refusals=(refusal,))
    for response, gain in zip(run.responses, (0.02, 0.04, -0.01), strict=True):
        set_r2(response, "nominal", "network", 0.8)
        set_r2(response, "augmented", "network", 0.8 + gain)
        set_r2(response, "augmented", "ridge", 0.83)
    who, models, verdict, ridge, null = study_sentences(run)
    assert says(who, "3 participants", "left", "P13")
    assert says(models, "Nominal 0.80 [0.80, 0.80]", "Augmented 0.82 [0.81, 0.83]")
    assert says(verdict, "helps: R² rises", "0.02", "better", "2 of 3 participants")
    assert says(ridge, "0.83 [0.83, 0.83]", "exceeds the network", "2 of 3 participants")
    assert "0.51" in null


def test_a_study_where_it_does_not_help(run_maker):
    assert says(study_sentences(run_maker(2, outputs=OUTPUTS, gain=0.0))[2], "no better", "the Nominal model")


def test_one_participant_carries_no_test(run_maker):
    assert "One participant is not enough for a test" in study_sentences(run_maker(1, outputs=OUTPUTS))[0]


def test_nobody(run_maker, refusal):
    (refused,), (none,) = study_sentences(run_maker(0, refusals=(refusal,))), study_sentences(run_maker(0))
    assert says(refused, "No participant", "P13", "no result")
    assert says(none, "No participant", "none", "no result")


OUTPUTS_PRINTED = ("hip_flexion_r", "ankle_angle_l")


def printed(run, width=80):
    console = Console(width=width, force_terminal=False)
    with console.capture() as capture:
        console.print(r2_text(run))
    return capture.get()


def test_one_participant_fits_a_terminal_of_80_columns(run_maker):
    run = run_maker(outputs=(*OUTPUTS_PRINTED, "emg_gasmed_r"))
    text = printed(run)
    [line] = [line for line in text.splitlines() if line.startswith("ankle_angle_l")]
    [response] = run.responses
    wanted = [("nominal", "network", "nominal"), *((m, "network", "exo") for m in ("nominal", "augmented", "exo"))]
    wanted += [*((m, "ridge", "exo") for m in ("nominal", "augmented", "exo")), ("nominal", "null", "exo")]
    assert line.split()[1:] == [f"{response.r2_of('ankle_angle_l', *which):.2f}" for which in wanted]
    assert "…" not in text
    assert "n = 749 samples" in text
    assert says(" ".join(text.split()), "7.5 s of each walk")


def test_several_participants_and_markup_in_names(run_maker):
    run = run_maker(3, outputs=OUTPUTS_PRINTED)
    run = run.with_units(RESPONSE, (*run.responses[:2], replace(run.responses[2], participant="[red]P03")))
    text = printed(run)
    assert all(name in text for name in ("P01", "P02", "[red]P03", "median", "n = 3 participants"))


def test_what_was_not_computed_is_a_dash(run_maker):
    run = run_maker(outputs=OUTPUTS_PRINTED)
    run.responses[0].r2["r2"] = np.nan
    assert "nan" not in printed(run).lower()
    assert "–" in printed(run)


def test_nobody_says_why(run_maker, refusal):
    assert "strides need initial contacts" in printed(run_maker(0, refusals=(refusal,)), width=200)


def test_the_terminal_needs_no_matplotlib():
    assert "matplotlib" not in modules_loaded_by("gaitdisc.response.sentences")


NAMES = (
    "xo[/b]",
    "[exo]",
    "[red]$a_b$",
    "<script>alert(1)</script>",
    "&amp; 100 % {} {{x}} {% x %}",
    "light:foo:bar",
    "$\\frac{1}{2$ ^_",
    "=1+1 :smile:",
    "_hidden",
    "@sum",
)
# the same signs, the first one still first, in fewer names: each draws a whole page
JOINED = (
    "[exo] xo[/b] :smile: light:foo:bar",
    "=1+1 [red]$a_b$ &amp; 100 % {} {{x}} {% x %}",
    "_hidden $\\frac{1}{2$ ^_",
    "@sum <script>alert(1)</script>",
)


class Words(HTMLParser):
    """Text of a page, tags apart."""

    def __init__(self, page):
        super().__init__()
        self.words, self.tags = [], set()
        self.feed(page)
        self.text = " ".join(" ".join(self.words).split())

    def handle_data(self, data):
        self.words.append(data)

    def handle_starttag(self, tag, attrs):
        self.tags.add(tag)


def named(run, name):
    """A run in which everything that a user names has this name."""
    walks = tuple(
        replace(walk, condition=name, curves=walk.curves, findings=(Finding("warning", "gap", name, name, name, name),))
        if walk.condition == run.exo
        else walk
        for walk in run.walks
    )
    made = replace(run.provenance, settings={name: name}, files={name: "ab" * 32})
    run = run.with_units(WALK, walks)
    return replace(run, title=name, exo=name, refusals=(Refusal("P09", name, name),), provenance=made)


@pytest.fixture(scope="module")
def plain(run_maker):
    return run_maker(outputs=("hip_flexion_r",), seconds=20.0)


@pytest.fixture(scope="module")
def tags(plain, tmp_path_factory):
    """Tags of a page without strange names."""
    return Words(write_report(plain, tmp_path_factory.mktemp("plain")).read_text(encoding="utf-8")).tags


@pytest.mark.parametrize("name", [*JOINED, *(pytest.param(name, marks=pytest.mark.slow) for name in NAMES)])
def test_a_page_its_tables_and_its_figures_show_a_name_as_it_is(plain, tags, tmp_path, name):
    page = Words(write_report(named(plain, name), tmp_path / "named").read_text(encoding="utf-8"))
    assert page.text.count(" ".join(name.split())) >= 8
    assert page.tags <= tags | {"section", "td"}
    for drawn in (tmp_path / "named" / "figures").glob("*.svg"):
        ElementTree.parse(drawn)
    findings = read_csv(tmp_path / "named" / "tables" / "findings.csv")
    assert name in findings["condition"].tolist() and name in findings["channel"].tolist()
    first_signs = {cell[:1] for cell in pd.read_csv(tmp_path / "named" / "tables" / "refusals.csv")["reason"]}
    assert not first_signs & set("=+-@")


@pytest.mark.parametrize("name", NAMES)
def test_a_terminal_shows_a_name_as_it_is(plain, name):
    responses = tuple(replace(r, participant=name, held_out=r.held_out) for r in plain.responses)
    refused = replace(plain, units={}, refusals=(Refusal(name, name, name),))
    for shown in (plain.with_units(RESPONSE, responses), refused):
        console = Console(width=300, force_terminal=False)
        with console.capture() as capture:
            console.print(r2_text(shown))
        assert name in capture.get()
