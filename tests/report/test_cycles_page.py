from base64 import b64decode
from collections import Counter
from dataclasses import replace
from xml.etree import ElementTree

import pandas as pd
import pytest
from made_cycles import made_cycles
from texts import says

from gaitdisc.processing.page import (
    cycles_figures,
    cycles_sentences,
    person_block,
    save_cycle_blocks,
    write_cycles_page,
)
from gaitdisc.recording import Finding
from gaitdisc.report.curve_panels import LEFT, MARGIN, WIDTH
from gaitdisc.report.figure import inline_drawing
from gaitdisc.response.page import write_report
from gaitdisc.response.participant_response import ResponseRun
from gaitdisc.saved.provenance import Refusal, provenance_now

SVG = "{http://www.w3.org/2000/svg}"
pytestmark = pytest.mark.usefixtures("unpainted")


def _run(*cycles, exo="", unfitted=()):
    refusals = tuple(refusal for one in cycles for refusal in one.refusals)
    made = provenance_now({}, 0, {}, "4.2")
    return ResponseRun("walks", "walk", exo, refusals, made, {"cycles.json": cycles}, unfitted)


def test_a_run_of_cycles_has_its_own_page_and_tidy_tables(tmp_path):
    run = _run(made_cycles(), made_cycles("P02", condition="turn"))
    page = write_report(run, tmp_path).read_text()
    assert "Gait cycles pooled over trials" in page and "Response to a device" not in page
    assert says(page, "2 participants: 8 left cycles", "8 right cycles", "4 trials", "4 left")
    assert says(page, "needs two contacts")
    cycles = pd.read_csv(tmp_path / "tables" / "cycles.csv")
    assert len(cycles) == 20
    assert len(pd.read_csv(tmp_path / "tables" / "means.csv")) > 100
    assert set(pd.read_csv(tmp_path / "tables" / "spatiotemporal.csv")["value"]) >= {"stance_percent", "speed_m_per_s"}


def test_a_page_of_computed_angles_says_how_and_others_do_not(tmp_path):
    plain, computed = made_cycles(), made_cycles("P02")
    residual = Finding("note", "residual", "P02 walk, file 1", "markers lie 2.0 mm off", "")
    said = "computed from markers"
    assert said not in write_report(_run(plain), tmp_path / "a").read_text()
    computed = replace(computed, findings=(*computed.findings, residual))
    page = write_report(_run(plain, computed), tmp_path / "b").read_text()
    assert said in page and "markers lie 2.0 mm" in page


def test_the_offset_and_few_cycles_are_said():
    moved = made_cycles(detectors={"markers": 1}, contact_offset_s=0.06, offset_steps=1, each=2)
    said = " ".join(cycles_sentences(_run(moved)))
    assert says(said, "markers", "P01", "+60 ms (1")
    assert says(said, "fewer", "3 cycles", "P01")
    assert "fewer" not in " ".join(cycles_sentences(_run(made_cycles(each=4))))
    (none,) = cycles_sentences(_run(made_cycles(each=0)))
    assert says(none, "No cycle")


def test_why_no_models_are_fitted_is_said(tmp_path):
    why = Refusal("P01", "", "P01 has 2 of 'walk'.")
    first = save_cycle_blocks(_run(made_cycles(), exo="exo", unfitted=(why,)), tmp_path)[0]
    assert any(says(sentence, "models are fitted", "P01") for sentence in first.sentences)
    assert "does not compare a device" in save_cycle_blocks(_run(made_cycles()), tmp_path)[0].sentences[0]


def test_one_part_a_person_with_a_figure_for_each_session_and_condition(tmp_path):
    run = _run(made_cycles(session="before"), made_cycles(session="after"), made_cycles("P02"))
    blocks = save_cycle_blocks(run, tmp_path)
    assert [block.heading for block in blocks] == ["Cycles", "P01", "P02"]
    assert [figure.name for figure in blocks[1].figures] == ["cycles-P01-before_walk", "cycles-P01-after_walk"]
    (said,) = person_block(run.cycles[2:], "P02").sentences
    assert says(said, "walk: 4 left", "4 right cycles", "2 trials")
    assert save_cycle_blocks(_run(), tmp_path) == []
    assert write_cycles_page(run, tmp_path).is_file()


def test_both_feet_lie_over_each_other_with_every_cycle_and_foot_off():
    (figure,) = cycles_figures(made_cycles(each=4), "P01-walk")
    drawing = ElementTree.fromstring(figure.drawn)
    titles, panels = drawing.findall(f"{SVG}text"), drawing.findall(f"{SVG}svg")
    assert "".join(titles[0].itertext()) == "knee angle [deg]" and titles[-1][0].text.startswith("EMG")
    knee = [(path.get("class"), path.get("data-side"), path.get("d")) for path in panels[0].iter(f"{SVG}path")]
    kinds = Counter(kind for kind, _, _ in knee)
    assert (kinds["mean"], kinds["single"], kinds["spread"]) == (2, 8, 2)
    assert Counter(side for kind, side, _ in knee if kind == "single") == {"l": 4, "r": 4}
    off = next(line for kind, _, line in knee if kind == "off")
    assert float(off[1:].split()[0]) == pytest.approx(LEFT + 0.6 * (WIDTH - LEFT - MARGIN), abs=0.06)
    assert b'class="single"' not in b64decode(inline_drawing(figure.drawn, 100).partition(",")[2])
    assert says(figure.caption, "4 cycles left", "4 cycles right", "2 trials")
    assert "one plate" not in figure.caption and says(figure.caption, "1 left, 1 right")
    assert figure.alt.startswith("Mean cycles of P01, walk: ")


def test_without_a_kept_cycle_nothing_is_drawn():
    assert cycles_figures(made_cycles(each=0), "x") == []
