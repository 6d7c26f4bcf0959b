"""Models of MuJoCo and OpenSim with something hidden in them or nothing: does `gaitdisc discover` name it.

    python studies/engines.py [--models leg knee_muscles double_pendulum] [--hidden NAME ...] [--seed N] [--noise DEG]

The record is made by the engine itself with the hidden effect in its own form, four trials of 4 s at 100 Hz under sums
of sines at each control; angles in degrees with noise, low-passed at 6 Hz, as a laboratory hands them over. `discover`
is given the model without the effect, the mapping that `gaitdisc new` writes, and the table.
"""

from __future__ import annotations

from command_line import QUICK, argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("--models", "files of studies/systems, by their name", ["leg", "knee_muscles", "double_pendulum"]),
    argument("--hidden", "some of the hidden effects", ["all"]),
    argument("--seed", "of controls, starts, noise and hidden numbers", 1),
    argument("--noise", "of the angles, standard deviation [deg]", 0.3),
    QUICK,
)  # before the slow imports

import re
from pathlib import Path
from typing import NamedTuple

import engine_cases as cases
import numpy as np
import pandas as pd
from engine_cases import RATE_HZ, SECONDS, TRIALS, Case, Model, measured, ran, read_model, sines, written

SYSTEMS = Path(__file__).parent / "systems"
MODELS = {
    "leg": Model("leg.xml", "knee", "shank", (0.25, 0.15)),
    "arm": Model("arm.xml", "elbow", "forearm", (0.3, 0.3, 0.2), strength=0.25),
    "knee_muscles": Model("knee_muscles.xml", "knee", "shank", (0.12, 0.12), 0.2),
    "double_pendulum": Model("double_pendulum.osim", "knee", "shank", (0.25, 0.15)),
}


class Hidden(NamedTuple):
    """What is hidden: its name in the answer, the place, the estimate, and its range at strength 1."""

    name: str
    place: str
    estimate: str
    low: float
    high: float


HIDDEN = {
    "spring": Hidden("linear_stiffness", "{joint}_moment", "stiffness", 5.0, 12.0),
    "one-sided": Hidden("one_sided_spring", "{joint}_moment", "stiffness", 15.0, 40.0),
    "viscous": Hidden("viscous_damping", "{joint}_moment", "damping", 0.5, 1.5),
    "Coulomb": Hidden("coulomb_friction", "{joint}_moment", "friction", 0.6, 1.5),
    "mass": Hidden("wrong_parameter", "{body}_mass", "value", 1.12, 1.25),
    "gravity": Hidden("wrong_parameter", "gravity", "value", 0.85, 0.92),
    "offset": Hidden("sensor_offset", "{joint}", "offset", 2.0, 4.0),
    "none": Hidden("", "", "", 0.0, 0.0),
    "saturated": Hidden("input_saturation", "{joint}_motor", "limit", 0.1, 0.2),  # only when it is named
}


def hidden_in(model: Model, kind: str, rng: np.random.Generator) -> Case:
    """Hide an effect in the text of a model, in the engine's own words."""
    text, one = (SYSTEMS / model.file).read_text(encoding="utf-8"), HIDDEN[kind]
    drawn = float(rng.uniform(one.low, one.high))
    named = (one.name, one.place.format(joint=model.joint, body=model.body), one.estimate)
    if kind == "saturated":  # of leg and arm, which have such a motor
        text = text.replace(f'"{named[1]}"', f'"{named[1]}" ctrlrange="-{drawn!r} {drawn!r}"')
    if kind in ("none", "offset", "saturated"):
        return Case(model, kind, text, drawn, named)
    if kind in ("mass", "gravity"):
        return with_share(model, kind, text, drawn, named[1])
    drawn *= model.strength
    if model.file.endswith(".osim"):
        return Case(model, kind, _in_opensim(model, kind, text, drawn), drawn, named)
    truth, more = _in_mujoco(model, kind, text, drawn)
    if kind == "viscous":  # of a joint that has a damper, it is that damper's number
        return Case(model, kind, truth, more, ("wrong_parameter", f"{model.joint}_damping", "value"))
    return Case(model, kind, truth, drawn, named)


def with_share(model: Model, kind: str, text: str, share: float, name: str) -> Case:
    """Hide another value of a parameter, as a share of the model's own."""
    engine = read_model(SYSTEMS / model.file)
    value = share * next(one.value for one in engine.parameters if one.name == name)
    changed = engine.text_with_value(text, name, value)
    assert changed is not None
    return Case(model, kind, changed, value, ("wrong_parameter", name, "value"))


def _in_mujoco(model: Model, kind: str, text: str, number: float) -> tuple[str, float]:
    """Attributes of the joint, or a tendon that is slack below 0.1 rad; and the attribute's number."""
    if kind == "one-sided":
        tendon = f'<fixed name="hidden" stiffness="{number!r}" springlength="-1000 0.1">'
        tendon = f'<tendon>{tendon}<joint joint="{model.joint}" coef="1"/></fixed></tendon>'
        return text.replace("</mujoco>", f"{tendon}</mujoco>"), number
    own = {one.name: one.value for one in read_model(SYSTEMS / model.file).parameters}
    word = {"spring": "stiffness", "viscous": "damping", "Coulomb": "frictionloss"}[kind]
    more = own[f"{model.joint}_{word}"] + number
    found = re.search(rf'<joint name="{model.joint}"[^>]*?/?>', text)
    assert found is not None
    tag = re.sub(rf'\s{word}="[^"]*"', "", found[0]).replace("/>", f' {word}="{more!r}"/>')
    return text[: found.start()] + tag + text[found.end() :], more


def _in_opensim(model: Model, kind: str, text: str, number: float) -> str:
    """A force of an expression, put in by hand."""
    shape = {"spring": "q", "one-sided": "max(0,q-0.1)", "viscous": "qdot", "Coulomb": "tanh(qdot/0.02)"}[kind]
    force = f"<coordinate>{model.joint}</coordinate><expression>-{number!r}*{shape}</expression>"
    force = f'<ExpressionBasedCoordinateForce name="hidden">{force}</ExpressionBasedCoordinateForce>'
    at = text.rindex("</objects>", 0, text.index("</ForceSet>"))
    return text[:at] + force + text[at:]


def recorded(case: Case, noise_deg: float, rng: np.random.Generator, folder: Path) -> Path:
    """Write the table that a laboratory would hand over."""
    truth = folder / f"truth{Path(case.model.file).suffix}"
    truth.write_text(case.truth, encoding="utf-8")
    engine, tables = read_model(truth), []
    count, t = len(engine.coordinates), np.arange(int(RATE_HZ * SECONDS)) / RATE_HZ
    for _ in range(TRIALS):
        u = np.column_stack([case.model.offset + sines(rng, t, size) for size in case.model.sizes])
        u = np.maximum(u, 0.0) if case.model.offset else u
        start = rng.uniform(-0.2, 0.2, (1, count))
        tables.append(measured(engine, u, ran(engine, start, u), noise_deg, rng))
        if case.kind == "offset":
            tables[-1][case.model.joint] += case.number
    return written(tables, folder)


def study(models: list[str], kinds: list[str], seed: int, noise_deg: float) -> pd.DataFrame:
    """Every case, as rows."""

    def made(name: str, kind: str, folder: Path) -> tuple[Case, Path, Path]:
        rng = np.random.default_rng([seed, sorted(MODELS).index(name), list(HIDDEN).index(kind)])
        case = hidden_in(MODELS[name], kind, rng)
        return case, SYSTEMS / case.model.file, recorded(case, noise_deg, rng, folder)

    return cases.study(models, kinds, made)


if __name__ == "__main__":
    chosen = (GIVEN.models, [*HIDDEN][:-1] if GIVEN.hidden == ["all"] else GIVEN.hidden)
    cases.print_sums(study(*((["leg"], ["viscous"]) if GIVEN.quick else chosen), GIVEN.seed, GIVEN.noise))
