"""A page says how its own numbers were made."""

from dataclasses import replace
from html import unescape

import pytest
from manufactured_discovery import manufactured
from texts import says

from gaitdisc.report.discovery_method import method_of
from gaitdisc.report.discovery_page import write_discovery_report
from gaitdisc.results.discovery import DEVICE, ENGINE, SIMULATION, TRACKED
from gaitdisc.results.provenance import made_now


@pytest.mark.parametrize(
    ("section", "says", "no_word_of"),
    [
        (SIMULATION, "Trials were divided into short runs.", "Inverse dynamics"),
        (ENGINE, "The engine computed the accelerations along the smoothed record", "Inverse dynamics"),
        (TRACKED, "Each block of time was predicted", "short runs. The initial state"),
        (DEVICE, "A moment model of this person was calibrated", "short runs. The initial state"),
    ],
)
def test_a_page_says_how_its_own_answer_was_made(tmp_path, unpainted, section, says, no_word_of):
    found = replace(manufactured(), provenance=made_now({"title": "A leg"}, 0, {}, section))
    page = unescape(write_discovery_report(found, tmp_path).read_text())
    assert says in page and no_word_of not in page
    assert method_of(found).held_out in page and method_of(found).added_to in page


def test_an_answer_that_says_nothing_of_itself_is_of_a_simulation():
    found = replace(manufactured(), provenance=None)
    assert says(method_of(found).sentences[0], "into short runs")
