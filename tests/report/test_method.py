from dataclasses import replace

from gaitdisc.recording import Finding
from gaitdisc.report.method import method_sentences


def test_five_sentences_name_the_equations(run):
    sentences = method_sentences(run)
    assert len(sentences) == 5
    text = " ".join(sentences)
    assert all(f"Eq. 4.{i}" in text for i in (1, 2, 3, 4, 5))
    assert "last 7.5 s of each walk" in text
    assert "natural" in text
    assert "spring" in text


def test_walks_whose_angles_are_of_markers_are_counted(run):
    first, *others = run.walks
    said = Finding("note", "marker set", "P01 natural, file 1", "plug_in_gait: ...", "")
    some = replace(run, walks=(replace(first, findings=(*first.findings, said)), *others))
    sentences = method_sentences(some)
    assert len(sentences) == 6
    assert sentences[0].startswith(f"Joint angles of 1 of {len(run.walks)} walks are computed from markers")


def test_the_filter_is_said_in_words(run, run_maker):
    # 5.39 Hz: where two passes of order 4 at 6 Hz and 100 samples/s have lost half of the power
    last = method_sentences(run)[-1]
    assert "order 4 a pass, forwards and backwards, so without lag, 6 Hz at −3 dB of one pass" in last
    assert "both passes: 5.39 Hz at 100 samples/s" in last
    assert "EMG" not in last
    with_emg = run_maker(outputs=("emg_sol_r",))
    assert "EMG was high-passed at 40 Hz, rectified, and low-passed at 10 Hz" in method_sentences(with_emg)[-1]


def test_other_settings_are_said_as_they_are(run):
    other = replace(run, provenance=replace(run.provenance, settings={"low_pass_hz": 6, "seed": 1}))
    assert method_sentences(other)[-1].startswith("Filters as the settings state them: low_pass_hz = 6. ")
    none = replace(run, provenance=replace(run.provenance, settings={}))
    assert method_sentences(none)[-1].startswith("The settings of the run name no filter. ")
