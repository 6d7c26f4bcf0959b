"""Models of OpenSim with muscles and something hidden in them: does `gaitdisc discover` name it.

    python studies/engines_with_muscles.py --folder FOLDER [--models arm26 leg6dof9musc] [--hidden NAME ...] [--seed N]

arm26.osim and leg6dof9musc.osim are those of OpenSim (github.com/opensim-org/opensim-models, Models/Arm26 and
Models/Leg6Dof9Musc, CC BY); put both into FOLDER. The leg hangs at a locked pelvis. The record is made by OpenSim with
the hidden effect in its own form, four trials of 4 s at 100 Hz under random smooth excitations, trials that leave the
given range of angles drawn anew; a weak muscle is excited the more. Noise, low-pass, mapping and judgement are those of
studies/engines.py.
"""

from __future__ import annotations

from command_line import argument, command_line

KINDS = ["spring", "one-sided", "viscous", "Coulomb", "weak muscle", "late excitation", "mass", "none"]
GIVEN = command_line(
    __name__,
    __doc__,
    argument("--folder", "where arm26.osim and leg6dof9musc.osim lie", required=True),
    argument("--models", "some of the models", ["arm26", "leg6dof9musc"]),
    argument("--hidden", "some of the hidden effects", [*KINDS]),
    argument("--seed", "of excitations, starts, noise and hidden numbers", 1),
)  # before the slow imports

import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
from engine_cases import (
    RATE_HZ,
    SECONDS,
    TRIALS,
    Case,
    Model,
    measured,
    print_sums,
    ran,
    read_model,
    sines,
    study,
    written,
)
from engines import hidden_in as hidden_at
from engines import with_share


class Muscled(NamedTuple):
    """A model, where something is hidden in it, and how it is moved: angles in degrees."""

    joint: str
    body: str
    muscle: str  # whose excitation is late
    weak: str
    rest: tuple[float, ...]  # posture that trials begin near
    levels: tuple[float, ...]  # mean excitation of each muscle
    ranges: tuple[tuple[float, float], ...]
    corner: float  # [rad], from which a one-sided spring acts
    strength: float
    locked: tuple[str, ...] = ()


MODELS = {
    "arm26": Muscled(  # its triceps' path jumps at -16.5 and 41 degrees of the shoulder, its biceps' at 30
        "r_shoulder_elev", "r_ulna_radius_hand", "BIClong", "TRIlat", (-4, 35), (0.01, 0.05, 0.05, 0.085, 0.03, 0.03),
        ((-15.8, 28), (2, 120)), 0.0, 0.5,
    ),
    "leg6dof9musc": Muscled(
        "knee_angle_r", "tibia_r", "bifemsh_r", "bifemsh_r", (15, -50, -5),
        (0.128, 0.176, 0.03, 0.218, 0.032, 0.03, 0.043, 0.03, 0.194), ((-30, 80), (-110, 0), (-45, 30)), -0.8, 1.0,
        ("pelvis_tilt", "pelvis_tx", "pelvis_ty"),
    ),
}  # fmt: skip
SWING = 0.55  # of a muscle's mean excitation
LATE_S, WEAK, NOISE_DEG = (0.03, 0.06), (0.5, 0.7), 0.3
EARLY = 20  # samples before the record
MOST_DRAWN = 200  # trials


def hidden_in(name: str, kind: str, model: Path, rng: np.random.Generator) -> Case:
    """Hide an effect in the text of a model; a late excitation is hidden in the record alone."""
    one, text = MODELS[name], model.read_text(encoding="utf-8")
    place = Model(str(model), one.joint, one.body, (), strength=one.strength)
    if kind == "late excitation":
        return Case(place, kind, text, rng.uniform(*LATE_S), ("input_delay", one.muscle, "delay"))
    if kind == "weak muscle":
        return with_share(place, kind, text, rng.uniform(*WEAK), f"{one.weak}_max_isometric_force")
    case = hidden_at(place, kind, rng)
    return case._replace(truth=case.truth.replace("max(0,q-0.1)", f"max(0,q-({one.corner}))"))


def recorded(case: Case, name: str, rng: np.random.Generator, truth: Path) -> Path:
    """Write the table that a laboratory would hand over."""
    truth.write_text(case.truth, encoding="utf-8")
    one, engine, found = MODELS[name], read_model(truth), []
    t = np.arange(-EARLY, round(RATE_HZ * SECONDS)) / RATE_HZ
    controls = [each.name for each in engine.controls]
    levels, late = list(one.levels), controls.index(one.muscle)
    if case.kind == "weak muscle":
        own = {each.name: each.value for each in read_model(truth.parent / f"{name}.osim").parameters}
        levels[controls.index(one.weak)] *= own[case.named[1]] / case.number
    for _ in range(MOST_DRAWN):
        u = np.column_stack([level + sines(rng, t, SWING * level) for level in levels]).clip(0.01, 1.0)
        acting = u.copy()
        if case.kind == "late excitation":
            acting[:, late] = np.interp(t - case.number, t, u[:, late])
        start = np.deg2rad([one.rest]) + rng.uniform(-0.05, 0.05, (1, len(one.rest)))
        angles = ran(engine, start, acting[EARLY:])
        if all(low < each.min() and each.max() < high for (low, high), each in zip(one.ranges, angles.T, strict=True)):
            found.append(measured(engine, u[EARLY:], angles, NOISE_DEG, rng))
        if len(found) == TRIALS:
            return written(found, truth.parent)
    raise SystemExit(f"{name} with {case.kind} stays within its angles in {len(found)} trials of {MOST_DRAWN} drawn")


def made(name: str, kind: str, work: Path) -> tuple[Case, Path, Path]:
    """A case with its model, the pelvis locked, and its record."""
    rng = np.random.default_rng([GIVEN.seed, sorted(MODELS).index(name), KINDS.index(kind)])
    text = (Path(GIVEN.folder) / f"{name}.osim").read_text(encoding="utf-8")
    for one in MODELS[name].locked:
        text = re.sub(rf'(<Coordinate name="{one}">.*?<locked>)false', r"\1true", text, count=1, flags=re.DOTALL)
    (work / f"{name}.osim").write_text(text, encoding="utf-8")
    case = hidden_in(name, kind, work / f"{name}.osim", rng)
    return case, work / f"{name}.osim", recorded(case, name, rng, work / "truth.osim")


if __name__ == "__main__":
    print_sums(study(GIVEN.models, GIVEN.hidden, made))
