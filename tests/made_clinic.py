"""Made people of a clinic: curves of the shape of walking, each with an offset of its own: answers are known."""

import numpy as np
import pandas as pd

from gaitdisc.channel import Channel
from gaitdisc.clinic.reference import make_reference
from gaitdisc.processing.leg_curves import PROFILE
from gaitdisc.processing.pooled_cycles import CYCLE_COLUMNS, PooledCycles
from gaitdisc.recording import PERCENT
from gaitdisc.response.participant_response import ResponseRun
from gaitdisc.saved.provenance import Provenance

SOURCE = "# Made, after the form of Schwartz 2008: 83 children of 4 to 17 years; licence: none, made here"
T = 2 * np.pi * PERCENT / 100
KNEE = 5 + 12 * np.exp(-(((PERCENT - 14) / 8) ** 2)) + 55 * np.exp(-(((PERCENT - 72) / 11) ** 2))
ANKLE = 10 * np.sin(np.pi * PERCENT / 55) * (PERCENT < 55) - 18 * np.exp(-(((PERCENT - 63) / 6) ** 2))
SHAPES = {
    "hip_flexion": 12 + 22 * np.cos(T), "hip_adduction": 6 * np.sin(T), "hip_rotation": 3 * np.cos(2 * T),
    "knee_angle": KNEE, "ankle_angle": ANKLE, "foot_progression_angle": -8 + 2 * np.cos(T),
}  # fmt: skip
PELVIS = {"pelvis_tilt": -10 + np.cos(2 * T), "pelvis_list": 4 * np.sin(T), "pelvis_rotation": 5 * np.cos(T)}
MUSCLE = 1e-4 * (1.2 + np.cos(T))
CHANNELS = (
    *(Channel(name, "angle", "deg") for name in PELVIS),
    *(Channel(f"{name}_{side}", "angle", "deg", side) for side in "lr" for name in SHAPES),
    *(Channel(f"ankle_power_{side}", "power", "W/kg", side) for side in "lr"),
    *(Channel(f"emg_ta_{side}", "emg", "V", side) for side in "lr"),
)
NAMES = [channel.name for channel in CHANNELS]
PROVENANCE = Provenance({"filters": {"kinematics_hz": 6.0}}, 0, {}, {"gaitdisc": "0"}, "", "2026-01-01T00:00:00+00:00")


def made_person(subject="P01", condition="walk", session="", *, changed=None, each=4, seed=0, spread=2.0, **fields):
    """Cycles of one person: offsets of the person (sd `spread`) and of each cycle (0.3 deg); `changed` is added."""
    rng = np.random.default_rng([seed, sum(map(ord, subject))])
    own = {name: rng.normal(0.0, spread) for name in NAMES}
    rows, curves = [], []
    for side in "lr":
        for k in range(each):
            start = float(k)
            rows.append((
                1, side, start, start + 0.6, start + 0.1, start + 0.5, start + 1.0, "events", "events", "events",
                k == 0, True, "", 1.0, 0.5, 120.0, 60.0, 40.0, 40.0, 20.0, 1.2, 0.6, 0.1, 1.2 + 0.01 * k,
            ))  # fmt: skip
            curve = np.full((len(PERCENT), len(CHANNELS)), np.nan)
            for column, channel in enumerate(CHANNELS):
                if channel.side not in (side, ""):
                    continue
                curve[:, column] = _shape(channel, side) + (changed or {}).get(channel.name, 0.0)
                if channel.quantity == "angle":
                    curve[:, column] += own[channel.name] + rng.normal(0.0, 0.3)
            curves.append(curve)
    given = {
        "subject": subject, "group": "", "session": session, "condition": condition, "trials": 2,
        "detectors": {"events": 2}, "contact_offset_s": None, "foot_off_offset_s": None, "offset_steps": 0,
        "over_ground": True, "channels": CHANNELS, "curves": np.array(curves),
        "cycles": pd.DataFrame(rows, columns=pd.Index(CYCLE_COLUMNS)), "findings": (), "refusals": (),
        "files": {f"{subject} {condition}, file 1": 64 * "a"},
    }  # fmt: skip
    return PooledCycles(**{**given, **fields})


def _shape(channel, side):
    if channel.quantity == "emg":
        return MUSCLE
    if channel.quantity == "power":
        return 3.0 * np.exp(-(((PERCENT - 52) / 5) ** 2))
    if channel.name in PELVIS:
        # the other foot's cycle begins half a cycle later
        return PELVIS[channel.name] if side == "r" else np.roll(PELVIS[channel.name][:-1], 50)[np.r_[:100, 0]]
    return SHAPES[channel.name[:-2]]


def made_controls(count=20):
    """A reference of so many people."""
    return make_reference([made_person(f"C{k:02d}", seed=5) for k in range(count)], "controls", PROVENANCE)


def made_run(*cycles, refusals=()):
    """Run of cycles and refusals."""
    own = tuple(refusal for one in cycles for refusal in one.refusals)
    return ResponseRun("A week", "walk", "", (*refusals, *own), PROVENANCE, {"cycles.json": cycles})


def published_table(change=lambda row: row):
    """Means and spreads of two groups of speed, in the form of a published reference."""
    rows = [SOURCE, "group,speed_low,speed_high,people,variable,percent,mean,sd"]
    for group, low, high, people, shift in (("slow", 0.2, 0.36, 40, -5.0), ("free", 0.36, 0.5, 83, 0.0)):
        for name in PROFILE:
            rows += [
                change(f"{group},{low},{high},{people},{name},{at},{0.1 * at + shift},2.5") for at in range(0, 101, 2)
            ]
    return "\n".join(row for row in rows if row) + "\n"


def written_table(folder, text):
    """A table of a published reference as a file."""
    path = folder / "children.csv"
    path.write_text(text, encoding="utf-8")
    return path
