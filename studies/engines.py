"""Models of MuJoCo and OpenSim with something hidden in them or nothing: does `gaitdisc discover` name it.

    python studies/engines.py [--models leg knee_muscles double_pendulum] [--hidden NAME ...] [--seed N] [--noise DEG]

The record is made by the engine itself with the hidden effect in its own form, four trials of 4 s at 100 Hz under sums
of sines at each control; angles in degrees with noise, low-passed at 6 Hz, as a laboratory hands them over. `discover`
is given the model without the effect, the mapping that `gaitdisc new` writes, and the table. Printed are, case by case,
what was named, whether name and place are right, whether the interval holds the hidden number, by how much runs of the
engine itself err before and after, how the effect went into the model's own file, and the processor time.
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
import resource
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt

import gaitdisc as gd
from gaitdisc.batch.discover_engine import EngineAnswer, discover_model_file
from gaitdisc.engines.engine import Motion
from gaitdisc.engines.mapping import drafted
from gaitdisc.engines.model_file import read_model

SYSTEMS = Path(__file__).parent / "systems"
RATE_HZ, SECONDS, TRIALS, CUTOFF_HZ = 100.0, 4.0, 4, 6.0


class Model(NamedTuple):
    """A model that something is hidden in: at which joint, in which body, how strongly it is driven."""

    file: str
    joint: str
    body: str
    sizes: tuple[float, ...]
    offset: float = 0.0  # of the controls: excitations of muscles are not negative
    strength: float = 1.0  # of what is hidden at the joint


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
}


class Case(NamedTuple):
    """A model with something hidden in it: text of the truth, and what the answer is to name with which number."""

    model: Model
    kind: str
    truth: str
    number: float
    named: tuple[str, str, str]  # effect, place, estimate


def hidden_in(model: Model, kind: str, rng: np.random.Generator) -> Case:
    """Hide an effect in the text of a model, in the engine's own words."""
    text, one = (SYSTEMS / model.file).read_text(encoding="utf-8"), HIDDEN[kind]
    drawn = float(rng.uniform(one.low, one.high))
    named = (one.name, one.place.format(joint=model.joint, body=model.body), one.estimate)
    if kind in ("none", "offset"):
        return Case(model, kind, text, drawn, named)
    if kind in ("mass", "gravity"):
        return _heavier(model, kind, text, drawn)
    drawn *= model.strength
    if model.file.endswith(".osim"):
        return Case(model, kind, _in_opensim(model, kind, text, drawn), drawn, named)
    truth, more = _in_mujoco(model, kind, text, drawn)
    if kind == "viscous":  # of a joint that has a damper, it is that damper's number
        return Case(model, kind, truth, more, ("wrong_parameter", f"{model.joint}_damping", "value"))
    return Case(model, kind, truth, drawn, named)


def _heavier(model: Model, kind: str, text: str, share: float) -> Case:
    engine = read_model(SYSTEMS / model.file)
    name = HIDDEN[kind].place.format(body=model.body)
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
    engine = read_model(SYSTEMS / model.file)
    own = {one.name: one.value for one in engine.parameters}
    word = {"spring": "stiffness", "viscous": "damping", "Coulomb": "frictionloss"}[kind]
    more = own[f"{model.joint}_{word}"] + number
    found = re.search(rf'<joint name="{model.joint}"[^>]*?/?>', text)
    assert found is not None
    tag = re.sub(rf'\s{word}="[^"]*"', "", found[0]).replace("/>", f' {word}="{more!r}"/>')
    return text[: found.start()] + tag + text[found.end() :], more


def _in_opensim(model: Model, kind: str, text: str, number: float) -> str:
    """A force of an expression, put in by hand."""
    expression = {
        "spring": f"-{number!r}*q",
        "one-sided": f"-{number!r}*max(0,q-0.1)",
        "viscous": f"-{number!r}*qdot",
        "Coulomb": f"-{number!r}*tanh(qdot/0.02)",
    }[kind]
    force = (
        f'<ExpressionBasedCoordinateForce name="hidden"><coordinate>{model.joint}</coordinate>'
        f"<expression>{expression}</expression></ExpressionBasedCoordinateForce>"
    )
    end = text.index("</ForceSet>")
    at = text.rindex("</objects>", 0, end)
    return text[:at] + force + text[at:]


def recorded(case: Case, noise_deg: float, rng: np.random.Generator, folder: Path) -> Path:
    """Write the table that a laboratory would hand over."""
    truth = folder / f"truth{Path(case.model.file).suffix}"
    truth.write_text(case.truth, encoding="utf-8")
    engine = read_model(truth)
    names, count = [one.name for one in engine.coordinates], len(engine.coordinates)
    t = np.arange(int(RATE_HZ * SECONDS)) / RATE_HZ
    low_pass = butter(2, CUTOFF_HZ, fs=RATE_HZ, output="sos")
    passed = sosfiltfilt(low_pass, np.random.default_rng(0).normal(size=20_000)).std()
    tables = []
    for trial in range(1, TRIALS + 1):
        u = np.column_stack([case.model.offset + _sines(rng, t, size) for size in case.model.sizes])
        u = np.maximum(u, 0.0) if case.model.offset else u
        start = rng.uniform(-0.2, 0.2, (1, count))
        begun = Motion(start, np.zeros_like(start), u[:1])
        angles = np.rad2deg(engine.run(begun, u[None], RATE_HZ)[0, :, :count])
        seen = sosfiltfilt(low_pass, angles + noise_deg / passed * rng.normal(size=angles.shape), axis=0)
        if case.kind == "offset":
            seen[:, names.index(case.model.joint)] += case.number
        columns = dict(zip([one.name for one in engine.controls], u.T, strict=True)) | dict(
            zip(names, seen.T, strict=True)
        )
        tables.append(pd.DataFrame({"trial": trial, "time": t, **columns}))
    pd.concat(tables).to_csv(folder / "trial.csv", index=False, float_format="%.7g")
    return folder / "trial.csv"


def _sines(rng: np.random.Generator, t: NDArray[np.float64], size: float) -> NDArray[np.float64]:
    frequencies, phases = rng.uniform(0.4, 1.6, 4), rng.uniform(0, 2 * np.pi, 4)
    return size * (rng.uniform(0.3, 1.0, 4) * np.sin(2 * np.pi * np.outer(t, frequencies) + phases)).sum(axis=1)


def judged(case: Case, answer: EngineAnswer) -> dict[str, object]:
    """One line of the table."""
    found = answer.found
    named = ", ".join(f"{one.name} at {one.place}" for one in found.effects) or found.verdict
    row: dict[str, object] = {"hidden": case.kind, "named": named}
    if case.kind == "none":
        row["right"] = not found.effects
    else:
        name, place, number = case.named
        ours = [one for one in found.effects if (one.name, one.place) == (name, place)]
        row["right"] = len(ours) == 1 and len(found.effects) == 1
        estimate = ours[0].estimates.get(number) if ours else None
        if estimate is not None:
            row |= {
                "true": case.number,
                "found": f"{estimate.value:.4g} ({estimate.low:.4g} to {estimate.high:.4g})",
                "inside": estimate.low <= case.number <= estimate.high,
            }
    row["tied"] = sum(one.tied for one in found.rivals)
    row["native"] = sum("is written into" in note for note in answer.written.notes)
    return row


def cpu_s() -> float:
    """Processor time of this process and of those that have ended."""
    return sum(
        used.ru_utime + used.ru_stime
        for used in map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    )


def study(
    models: list[str], kinds: list[str], seed: int, noise_deg: float, told: Callable[[str], None]
) -> pd.DataFrame:
    """Every case, as rows."""
    rows = []
    for name in models:
        for kind in kinds:
            rng = np.random.default_rng([seed, sorted(MODELS).index(name), list(HIDDEN).index(kind)])
            case = hidden_in(MODELS[name], kind, rng)
            with tempfile.TemporaryDirectory() as folder:
                table = recorded(case, noise_deg, rng, Path(folder))
                model = Path(folder) / case.model.file
                model.write_text((SYSTEMS / case.model.file).read_text(encoding="utf-8"), encoding="utf-8")
                gd.write_simulation(drafted(read_model(model), degrees=True), model.with_suffix(".toml"))
                before = cpu_s()
                answer = discover_model_file(model, table)
                row = {"model": name, **judged(case, answer), "cpu s": round(cpu_s() - before, 1)}
            told("; ".join(f"{key} {value}" for key, value in row.items()))
            rows.append(row)
    return pd.DataFrame(rows)


def main() -> None:
    """Print the cases and their sums."""
    kinds = list(HIDDEN) if GIVEN.hidden == ["all"] else GIVEN.hidden
    models = GIVEN.models
    if GIVEN.quick:
        models, kinds = ["leg"], ["viscous"]
    table = study(models, kinds, GIVEN.seed, GIVEN.noise, lambda line: print(line, flush=True))
    for name, rows in table.groupby("model"):
        hidden = rows[rows["hidden"] != "none"]
        inside = hidden["inside"].dropna() if "inside" in hidden else []
        invented = rows[(rows["hidden"] == "none") & ~rows["right"].astype(bool)]
        print(
            f"{name}: name and place right in {int(hidden['right'].sum())} of {len(hidden)}, interval holds the number "
            f"in {int(sum(inside))} of {len(inside)}, invented {len(invented)}, "
            f"processor time {rows['cpu s'].median():.0f} s a case (median)"
        )


if __name__ == "__main__":
    main()
