import subprocess
import sys

from rich.console import Console

from gaitdisc.report.text import r2_text

OUTPUTS = ("hip_flexion_r", "ankle_angle_l")


def printed(run, width=140):
    console = Console(width=width, record=True, file=None, force_terminal=False)
    with console.capture() as capture:
        console.print(r2_text(run))
    return capture.get()


def test_one_participant(run_maker):
    run = run_maker(outputs=OUTPUTS)
    text = printed(run)
    assert f"{run.responses[0].r2_of('ankle_angle_l', 'augmented'):.2f}" in text
    assert "median" in text
    assert "n = 749 samples" in text


def test_several_participants_and_markup_in_names(run_maker):
    text = printed(run_maker(3, outputs=OUTPUTS))
    assert all(name in text for name in ("P01", "P02", "P03"))
    assert "n = 3 participants" in text


def test_nobody_says_why(run_maker, refusal):
    assert "strides need initial contacts" in printed(run_maker(0, refusals=(refusal,)))


def test_the_terminal_needs_no_matplotlib():
    code = "import sys, gaitdisc.report.text; sys.exit('matplotlib' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
