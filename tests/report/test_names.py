"""Names that a user gave, of every sign that means something to a page, a figure, a terminal or a spreadsheet."""

from dataclasses import replace
from html.parser import HTMLParser
from xml.etree import ElementTree

import pandas as pd
import pytest
from rich.console import Console

from gaitdisc.recording import Finding
from gaitdisc.report.response_page import write_report
from gaitdisc.report.sentences import r2_text
from gaitdisc.results.participant_response import RESPONSE
from gaitdisc.results.pooled_cycles import WALK
from gaitdisc.results.provenance import Refusal
from gaitdisc.spreadsheet import read_csv

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
    return run_maker(outputs=("hip_flexion_r",))


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
