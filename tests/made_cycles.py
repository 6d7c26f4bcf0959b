"""Pooled cycles of known shape: one angle and one moment a side, every cycle a constant on top of a sine."""

import numpy as np
import pandas as pd

from gaitdisc.channel import Channel
from gaitdisc.processing.pooled_cycles import CYCLE_COLUMNS, PooledCycles
from gaitdisc.recording import PERCENT, Finding
from gaitdisc.saved.provenance import Refusal

CHANNELS = (
    *(Channel(f"knee_angle_{side}", "angle", "deg", side) for side in "lr"),
    *(Channel(f"ankle_angle_{side}_moment", "moment", "N m/kg", side) for side in "lr"),
    Channel("emg_ta_l", "emg", "V", "l"),
    Channel("pelvis_tilt", "angle", "deg", ""),
)


def made_cycles(subject="P01", condition="walk", session="", *, each=4, out=1, **fields):
    """As many kept cycles of each foot, a few left out; the k-th cycle is k higher than the first."""
    rows, curves = [], []
    for side in "lr":
        for k in range(each + out):
            kept, start = k < each, 1.0 * k + (0.5 if side == "l" else 0.0)
            reason = "" if kept else "no contact of the other foot within the cycle: a contact was missed or is false"
            rows.append((
                1 + k % 2, side, start, start + 0.6, start + 0.1, start + 0.5, start + 1.0, "events", "force",
                "events", k == 0, kept, reason, 1.0, 0.5, 120.0, 60.0, 40.0, 40.0, 20.0, 1.2 + 0.1 * k, 0.6, 0.1, 1.2,
            ))  # fmt: skip
            if kept:
                curve = np.full((len(PERCENT), len(CHANNELS)), np.nan)
                own = [c.side in (side, "") for c in CHANNELS]
                curve[:, own] = (10.0 * np.sin(2 * np.pi * PERCENT / 100) + k)[:, None]
                curve[:, [c.quantity == "moment" and k > 0 for c in CHANNELS]] = np.nan
                curves.append(curve)
    given = {
        "subject": subject, "group": "", "session": session, "condition": condition, "trials": 2,
        "detectors": {"events": 2}, "contact_offset_s": None, "foot_off_offset_s": -0.012, "offset_steps": 0,
        "over_ground": True, "channels": CHANNELS,
        "curves": np.array(curves).reshape(-1, len(PERCENT), len(CHANNELS)),
        "cycles": pd.DataFrame(rows, columns=pd.Index(CYCLE_COLUMNS)),
        "findings": (Finding("note", "unit", f"{subject} {condition}, file 1", "mm taken as m", ""),),
        "refusals": (Refusal(subject, f"{condition} 3", "a cycle needs two contacts; found one. Add trials."),),
        "files": {f"{subject} {condition}, file 1": 64 * "a"},
    }  # fmt: skip
    return PooledCycles(**{**given, **fields})
