"""Tables of joint moments against those that the files hold, the effect of the filters, and curves over each other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from plug_in_gait_angles import HELD_BACK

PARTS = ("ankle_angle", "knee_angle", "hip_flexion", "ankle_inversion", "knee_adduction", "hip_adduction")
PARTS += ("ankle_rotation", "knee_rotation", "hip_rotation")
NAMES = (*(f"{part}_{{}}_moment" for part in PARTS), *(f"{joint}_power_{{}}" for joint in ("ankle", "knee", "hip")))
SETS = ("6/20 Hz", "6/6 Hz", "6/20 Hz, distal frame")
Curves = dict[str, tuple[np.ndarray, np.ndarray]]  # channel -> ours, theirs over one step


class Walk(NamedTuple):
    """One walk, computed in one way."""

    person: str
    kind: str
    source: str
    settings: str
    balance: str
    steps: list[Curves]


def rms(ours: np.ndarray, theirs: np.ndarray) -> float:
    """Over the frames that both have; the file writes 0 where it has none."""
    both = np.isfinite(ours) & np.isfinite(theirs) & (theirs != 0)
    return float(np.sqrt(np.mean((ours - theirs)[both] ** 2))) if both.any() else np.nan


def against_plug_in_gait(found: list[Walk]) -> list[tuple[str, ...]]:
    """Rows of the table: channel by channel, people kept back apart."""
    rows = []
    sources = (("markers", SETS[0]), ("markers, Harrington's hip", SETS[0]), ("bones", SETS[0]), ("bones", SETS[2]))
    for source, settings in sources:
        for name in NAMES:
            cells = []
            for kind, only in (("straight", False), ("straight", True), ("turn", False), ("turn", True)):
                chosen = [w for w in found if w[1:4] == (kind, source, settings) and (w.person in HELD_BACK) >= only]
                errors = [rms(*curves[name]) for walk in chosen for curves in walk.steps]
                cells.append(f"{np.median(errors):.3f} ({max(errors):.3f}), {len(errors)}" if errors else "-")
            rows.append((source, settings, name.replace("_{}", ""), *cells))
    return rows


def balances(found: list[Walk]) -> list[tuple[str, ...]]:
    """Rows of the table: measured against needed force, each walk."""
    chosen = [w for w in found if (w.source, w.settings) == ("markers", SETS[0])]
    return [(w.person, w.kind, w.balance) for w in chosen]


def filter_effect(found: list[Walk]) -> str:
    """Peak knee extension moment of the first half of stance at 6/20 and at 6/6 Hz, a sentence."""
    peaks = []
    for name in SETS[:2]:
        curves = [c["knee_angle_{}_moment"][0] for w in found if w[2:4] == ("markers", name) for c in w.steps]
        peaks.append([-np.nanmin(curve[: len(curve) // 2]) for curve in curves])
    both, apart = np.median(peaks, axis=1), np.subtract(peaks[1], peaks[0])
    return (
        f"peak knee extension moment, {len(apart)} steps: median {both[0]:.3f} N m/kg at {SETS[0]}, {both[1]:.3f} at "
        f"{SETS[1]}; the change of a step has median {np.median(apart):+.3f}, "
        f"least {apart.min():+.3f}, most {apart.max():+.3f}"
    )


def over_each_other(steps: Mapping[str, Sequence[Curves]], file: str) -> None:
    """Draw ours and, dashed, theirs in the person's colour, a panel for each channel."""
    from matplotlib.figure import Figure

    names = list(next(iter(steps.values()))[0])
    drawing = Figure(figsize=(13, 11), layout="constrained")
    for place, name in enumerate(names):
        axis = drawing.add_subplot(4, 3, place + 1, title=name.replace("_{}", ""), xlabel="% of stance")
        axis.set_ylabel("W/kg" if "power" in name else "N m/kg")
        for number, (person, several) in enumerate(steps.items()):
            for one, curves in enumerate(several):
                ours, theirs = curves[name]
                phase = np.linspace(0, 100, len(ours))
                label = person if place == 0 and one == 0 else None
                axis.plot(phase, ours, color=f"C{number}", linewidth=1.1, label=label)
                axis.plot(phase, np.where(theirs != 0, theirs, np.nan), "--", color=f"C{number}", linewidth=0.8)
        if place == 0:
            axis.legend(fontsize=7, title="ours; theirs dashed", title_fontsize=7)
    drawing.savefig(file, dpi=100)
