import base64
import os
import re
import signal
from dataclasses import replace
from functools import partial

import numpy as np
import pandas as pd
import pytest
from texts import says

from gaitdisc.errors import GaitdiscError
from gaitdisc.processing.pooled_cycles import WALK
from gaitdisc.recording import Finding
from gaitdisc.response import page as response_page
from gaitdisc.response.page import method_sentences, write_report
from gaitdisc.response.participant_response import RESPONSE
from gaitdisc.saved.provenance import Refusal

OUTPUTS = ("hip_flexion_r", "ankle_angle_l")


@pytest.fixture(scope="session")
def page(run, tmp_path_factory):
    return write_report(run, tmp_path_factory.mktemp("report"))


def test_the_answer_comes_first(page):
    text = page.read_text(encoding="utf-8")
    order = ["Research use, not a", "<h1>", "Left out: 1", "In P01, the Nominal model", "<img"]
    places = [text.index(words) for words in order]
    assert places == sorted(places)
    assert says(text, "need initial contacts", "both")
    assert "amber: warnings" in text


def test_the_page_needs_nothing_but_itself(page):
    text = page.read_text(encoding="utf-8")
    assert not re.search(r"(https?:)?//[a-z]", text)
    assert "<script" not in text
    assert "default-src 'none'" in text
    assert set(re.findall(r'(?:src|href)="([^"#]{1,10})', text)) == {"data:image"}
    for encoded in re.findall(r"data:image/svg\+xml;base64,([^\"]+)", text):
        svg = base64.b64decode(encoded).decode()
        outside = re.findall(r'(?:href|src)="([^#][^"]{0,12})|url\((?!#)', svg)
        assert set(outside) <= {"data:image/p"}


def test_every_figure_has_caption_alt_and_files(page):
    text = page.read_text(encoding="utf-8")
    shown = re.findall(r'<figure>\s*<img src="[^"]+" alt="([^"]*)"[^>]*>\s*<figcaption>(.*?)</figcaption>', text, re.S)
    assert len(shown) == len(list((page.parent / "figures").glob("*.svg"))) == 5
    for alt, caption in shown:
        assert len(alt) > 40
        assert re.search(r"n = \d", caption)
        assert "split" in caption
        name = re.search(r"figures/([\w-]+)\.csv", caption).group(1)
        for ending in ("svg", "png", "csv"):
            assert (page.parent / "figures" / f"{name}.{ending}").stat().st_size > 0
        assert len(pd.read_csv(page.parent / "figures" / f"{name}.csv"))
    for name in re.findall(r"tables/([\w-]+)\.csv", text):
        assert (page.parent / "tables" / f"{name}.csv").is_file()


def test_the_whole_r2_table_lies_beside_the_page(page, run):
    written = pd.read_csv(page.parent / "tables" / "r2.csv", keep_default_na=False, na_values=[""])
    pd.testing.assert_frame_equal(written, run.r2_table(), check_dtype=False, rtol=1e-7)


def test_writing_again_gives_the_same_bytes(page, run, tmp_path):
    write_report(run, tmp_path)
    files = sorted(path.relative_to(tmp_path) for path in tmp_path.rglob("*") if path.is_file())
    assert len(files) > 20
    for file in files:
        assert (tmp_path / file).read_bytes() == (page.parent / file).read_bytes(), file


@pytest.mark.usefixtures("unpainted")
def test_hostile_words_are_only_words(run_maker, tmp_path):
    evil = '<script>alert(1)</script> $\\frac{x}$ "quoted" {{7*7}}'
    run = run_maker(outputs=("hip_flexion_r",), title=evil, refusals=(Refusal(evil, evil, evil),))
    walks = tuple(replace(walk, subject=evil) for walk in run.walks)
    run = replace(run, nominal="natural").with_units(WALK, walks)
    run = run.with_units(RESPONSE, (replace(run.responses[0], participant=evil),))
    text = write_report(run, tmp_path).read_text(encoding="utf-8")
    assert "<script" not in text
    assert "&lt;script&gt;alert(1)" in text
    assert "{{7*7}}" in text
    assert all(path.parent == tmp_path / "figures" for path in (tmp_path / "figures").iterdir())


@pytest.mark.usefixtures("unpainted")
def test_everybody_refused(run_maker, refusal, tmp_path):
    text = write_report(run_maker(0, refusals=(refusal,)), tmp_path).read_text(encoding="utf-8")
    assert "No participant could be analysed" in text
    assert says(text, "need initial contacts", "both")
    assert "<img" not in text


@pytest.mark.usefixtures("unpainted")
def test_walks_without_a_response_are_still_shown(run_maker, refusal, tmp_path):
    run = run_maker(outputs=("hip_flexion_r",), refusals=(refusal,)).with_units(RESPONSE, ())
    text = write_report(run, tmp_path).read_text(encoding="utf-8")
    assert says(text, "model was fitted")
    assert text.count("<img") == 2


@pytest.mark.usefixtures("unpainted")
def test_several_participants_are_folded_and_none_is_lost(run_maker, tmp_path, monkeypatch):
    monkeypatch.setattr("gaitdisc.report.page.MOST_PROCESSES", 1)
    text = write_report(run_maker(3, outputs=("hip_flexion_r",), seconds=20.0), tmp_path).read_text(encoding="utf-8")
    assert text.count("<summary>Tables and figures of P0") == 3
    assert "3 participants were analysed" in text
    assert all(f"In P0{i}, the Nominal model" in text for i in (1, 2, 3))
    assert (tmp_path / "tables" / "r2-study.csv").is_file()


@pytest.mark.usefixtures("unpainted")
def test_numbers_that_were_not_computed(run_maker, tmp_path):
    run = run_maker(outputs=OUTPUTS)
    run.responses[0].r2["r2"] = np.nan
    text = write_report(run, tmp_path).read_text(encoding="utf-8")
    assert "not computed" in text
    assert ">nan<" not in text.lower()


@pytest.mark.usefixtures("unpainted")
def test_a_place_that_cannot_be_written_is_said(run, tmp_path):
    (tmp_path / "report").write_text("a file, no folder")
    with pytest.raises(GaitdiscError, match="cannot be written"):
        write_report(run, tmp_path / "report")


def test_the_paired_tests_have_their_section_and_the_same_bytes(tested_maker, tmp_path, monkeypatch):
    """Without the figures of each participant, which are drawn and compared above."""
    none = {subject: [] for subject in ("held_out", "residual", "curves", "strides")}
    brief = partial(dict, sentences=[], r2=None, reasons=[], dropped=None, figures=none)
    monkeypatch.setattr("gaitdisc.report.page.MOST_PROCESSES", 1)
    monkeypatch.setattr(
        response_page, "_section", lambda _, person, name, *__: brief(participant=person, anchor=f"participant-{name}")
    )
    run = tested_maker(6, ("hip_flexion_r",))
    text = write_report(run, tmp_path / "a").read_text(encoding="utf-8")
    assert text.index("Explained variance") < text.index("Which model explains more") < text.index(">P01</h2>")
    assert "tables/tests-augmented-exo.csv" in text
    assert "figures/comparison.csv" in text
    write_report(run, tmp_path / "b")
    for file in ("report.html", "figures/comparison.svg", "tables/tests-nominal-exo.csv", "tables/tests-families.csv"):
        assert (tmp_path / "a" / file).read_bytes() == (tmp_path / "b" / file).read_bytes()


@pytest.mark.usefixtures("unpainted")
def test_too_few_for_a_test_is_said(tested_maker, tmp_path):
    text = write_report(tested_maker(2, ("hip_flexion_r",)), tmp_path).read_text(encoding="utf-8")
    assert says(text, "2 participants", "0.5")
    assert "figures/comparison.csv" not in text


@pytest.mark.usefixtures("unpainted")
def test_a_run_of_before_there_were_tests_has_no_such_section(run_maker, tmp_path):
    text = write_report(run_maker(2, outputs=("hip_flexion_r",)), tmp_path).read_text(encoding="utf-8")
    assert "Which model explains more" not in text


@pytest.mark.slow
def test_participants_drawn_side_by_side_are_those_drawn_alone(run_maker, tmp_path):
    run = run_maker(3, outputs=("hip_flexion_r",))
    write_report(run, tmp_path / "all")
    first = run.with_units(WALK, run.walks[:2]).with_units(RESPONSE, run.responses[:1])
    write_report(first, tmp_path / "one")
    alone = sorted(path for path in (tmp_path / "one" / "figures").iterdir() if "P01" in path.name)
    assert len(alone) >= 4 * 3
    for path in alone:
        assert path.read_bytes() == (tmp_path / "all" / "figures" / path.name).read_bytes()


@pytest.mark.slow  # tests/report/test_page.py breaks a process that draws no page
@pytest.mark.usefixtures("unpainted")
def test_a_process_that_is_killed_while_it_draws_costs_its_time_alone(run_maker, tmp_path, monkeypatch):
    run = run_maker(3, outputs=("hip_flexion_r",))
    monkeypatch.setattr("gaitdisc.report.page.os.cpu_count", lambda: 2)
    here, drawn = os.getpid(), response_page._section

    def killed_elsewhere(*given):
        if os.getpid() != here:
            os.kill(os.getpid(), signal.SIGKILL)
        return drawn(*given)

    monkeypatch.setattr(response_page, "_section", killed_elsewhere)
    text = response_page.write_report(run, tmp_path).read_text(encoding="utf-8")
    assert text.count('class="participant"') == 3


def test_walks_whose_angles_are_of_markers_are_counted(run):
    first, *others = run.walks
    said = Finding("note", "marker set", "P01 natural, file 1", "plug_in_gait: ...", "")
    some = run.with_units(WALK, (replace(first, findings=(*first.findings, said)), *others))
    sentences = method_sentences(some)
    assert len(sentences) == 6
    assert sentences[0].startswith(f"Joint angles of 1 of {len(run.walks)} walks are computed from markers")


def test_the_filter_is_said_in_words(run, run_maker):
    # 5.39 Hz: where two passes of order 4 at 6 Hz and 100 samples/s have lost half of the power
    last = method_sentences(run)[-1]
    assert says(last, "4", "6 Hz", "−3 dB")
    assert says(last, "both", "5.39 Hz", "100 samples/s")
    assert "EMG" not in last
    with_emg = run_maker(outputs=("emg_sol_r",))
    assert says(method_sentences(with_emg)[-1], "EMG", "40 Hz", "10 Hz")


def test_other_settings_are_said_as_they_are(run):
    other = replace(run, provenance=replace(run.provenance, settings={"low_pass_hz": 6, "seed": 1}))
    assert says(method_sentences(other)[-1], "low_pass_hz = 6")
    none = replace(run, provenance=replace(run.provenance, settings={}))
    assert says(method_sentences(none)[-1], "The settings of", "no")
