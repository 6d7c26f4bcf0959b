import subprocess
import sys
from dataclasses import replace

import numpy as np
from rich.console import Console

from gaitdisc.report.text import r2_text

OUTPUTS = ("hip_flexion_r", "ankle_angle_l")


def printed(run, width=80):
    console = Console(width=width, force_terminal=False)
    with console.capture() as capture:
        console.print(r2_text(run))
    return capture.get()


def test_one_participant_fits_a_terminal_of_80_columns(run_maker):
    run = run_maker(outputs=(*OUTPUTS, "emg_gasmed_r"))
    text = printed(run)
    [line] = [line for line in text.splitlines() if line.startswith("ankle_angle_l")]
    [response] = run.responses
    wanted = [("nominal", "network", "nominal"), *((m, "network", "exo") for m in ("nominal", "augmented", "exo"))]
    wanted += [*((m, "ridge", "exo") for m in ("nominal", "augmented", "exo")), ("nominal", "null", "exo")]
    assert line.split()[1:] == [f"{response.r2_of('ankle_angle_l', *which):.2f}" for which in wanted]
    assert "…" not in text
    assert "n = 749 samples" in text
    assert "last 7.5 s of each walk" in " ".join(text.split())


def test_several_participants_and_markup_in_names(run_maker):
    run = run_maker(3, outputs=OUTPUTS)
    run = replace(run, responses=(*run.responses[:2], replace(run.responses[2], participant="[red]P03")))
    text = printed(run)
    assert all(name in text for name in ("P01", "P02", "[red]P03", "median", "n = 3 participants"))


def test_what_was_not_computed_is_a_dash(run_maker):
    run = run_maker(outputs=OUTPUTS)
    run.responses[0].r2["r2"] = np.nan
    assert "nan" not in printed(run).lower()
    assert "–" in printed(run)


def test_nobody_says_why(run_maker, refusal):
    assert "strides need initial contacts" in printed(run_maker(0, refusals=(refusal,)), width=200)


def test_the_terminal_needs_no_matplotlib():
    code = "import sys, gaitdisc.report.text; sys.exit('matplotlib' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
