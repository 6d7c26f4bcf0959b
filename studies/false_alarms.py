"""What is said of people without faults: those at hand with all their trials, and made ones, half of them patients.

Made people walk over two plates; a static trial stands on both. Patterns are hallmarks of the clinic, planted into the
habit (gaitdisc/cohort/person.py; equinus and Trendelenburg here). `faults_on_pages.py` runs this.
"""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from as_a_user import Answer, answer_of, told
from markdown_table import markdown_table

import gaitdisc as gd
from gaitdisc.cohort.person import PATTERNS, Pattern, Person, draw_one, somebody, walking_with

Files = dict[str, list[Path]]  # static, walk, turn
COLUMNS = ("person", "kind", "trials", "cycles", "alarms", "sentences", "said")
ALWAYS, WALKED_STRIDES, TRIALS, CONTROLS = 10.0, 6.5, 3, 20
# sentence that has to be there; patterns that the package does not have
OWN = {
    "equinus": Pattern((("ankle_angle", 0.0, ALWAYS, -16.0),)),
    "Trendelenburg": Pattern((("hip_adduction", 0.30, 0.35, 9.0),), (), (1,)),
}
SPOKEN = {
    "stiff knee": "reduced knee flexion in swing",
    "drop foot": "reduced dorsiflexion in swing",
    "crouch": "reduced knee extension in stance",
    "asymmetric": "l reduced knee flexion in swing",
    "slow": "reduced walking speed",
    "equinus": "reduced dorsiflexion in stance",
    "Trendelenburg": "l increased hip adduction in stance",
}


class Made(NamedTuple):
    """One made person: even numbers are healthy."""

    number: int
    seed: int
    out: Path

    @property
    def kind(self) -> str:
        """Empty for the healthy."""
        return list(SPOKEN)[self.number // 2 % len(SPOKEN)] if self.number % 2 else ""


def person_of(made: Made) -> Person:
    """Somebody drawn, who walks as their kind."""
    seed, sex = made.seed + made.number, "fm"[made.number // 2 % 2]
    if made.kind == "slow":
        return replace(somebody("slow", seed, sex), name=f"M{made.number:03d}")
    person = draw_one(f"M{made.number:03d}", seed, sex)
    PATTERNS.update(OWN)
    return walking_with(person, made.kind) if made.kind else person


def write_person(made: Made, folder: Path) -> None:
    """A static trial on both plates and some walks over them, as C3D files of a laboratory."""
    from gaitdisc.cohort.demonstration import write_marker_trial
    from gaitdisc.cohort.marker_trial import marker_trial, overground, standing
    from gaitdisc.cohort.walk import walked

    person, who = person_of(made), f"rec/M{made.number:03d}"
    write_marker_trial(on_plates(standing(person), person.mass_kg, made.seed), folder, f"{who}/static/static")
    walk = walked(person, None, float(np.ceil(WALKED_STRIDES * person.stride_s)), seed=made.seed + 13 * made.number)
    belts = newtonian(marker_trial(walk, "walk", "walking"), person.mass_kg)
    last = float(belts.stream("markers").time[-1]) - 4.0 * person.stride_s
    for number, start in enumerate(np.linspace(0.0, last, TRIALS), 1):
        trial = overground(belts, float(start), person.stride_s, person.speed_m_per_s, f"w{number}")
        write_marker_trial(trial, folder, f"{who}/walk/w{number}")
    table = f"participant_id,weight,height\nM{made.number:03d},{person.mass_kg:.1f},{person.height_m:.3f}\n"
    (folder / "rec" / "participants.csv").write_text(table, encoding="utf-8")


def newtonian(belts: gd.Trial, mass_kg: float) -> gd.Trial:
    """Walk whose belts carry what weight and rise of the pelvis need; single stances had 0.77 to 1.16 of it."""
    from gaitdisc.signals.butterworth import low_pass

    markers, forces = low_pass(belts.stream("markers"), 6.0, 4), belts.stream("forces")
    height = np.mean([markers[f"{name}.z"] for name in ("RASI", "LASI", "RPSI", "LPSI")], axis=0)
    rise = np.gradient(np.gradient(height, markers.time), markers.time)
    needed = np.interp(forces.time, markers.time, mass_kg * (9.81 + rise))
    load = forces["plate_1_fz"] + forces["plate_2_fz"]
    share = np.where(load > 0.3 * mass_kg * 9.81, needed / load, 1.0)
    return replace(belts, streams={**belts.streams, "forces": forces.with_values(forces.values * share[:, None])})


def on_plates(static: gd.Trial, mass_kg: float, seed: int) -> gd.Trial:
    """Static trial with half of the body weight under the middle of each foot."""
    from gaitdisc.cohort.marker_trial import FORCE_N, MOMENT_NM, belts
    from gaitdisc.recording import Source

    markers, plates = static.stream("markers"), belts()
    time = np.arange(round(1000 * float(markers.time[-1]))) / 1000
    rng, columns, channels = np.random.default_rng([seed, 47]), [], []
    for plate, side in zip(plates, "RL", strict=True):
        under = [np.mean([markers[f"{side}{name}.{axis}"].mean() for name in ("CAL", "TOE")]) for axis in "xy"]
        x, y = np.array(under) - plate.corners.mean(axis=0)[:2]
        weight = 0.5 * mass_kg * 9.81
        loads = (0.0, 0.0, weight, y * weight, -x * weight, 0.0)
        for name, load in zip((*(f"f{a}" for a in "xyz"), *(f"m{a}" for a in "xyz")), loads, strict=True):
            noise = FORCE_N if name[0] == "f" else MOMENT_NM
            columns.append(load + rng.normal(0.0, noise, len(time)))
            quantity, unit = ("force", "N") if name[0] == "f" else ("moment", "N m")
            channels.append(gd.Channel(f"{plate.name}_{name}", quantity, unit))
    forces = gd.Recording(time, np.column_stack(columns), tuple(channels), static.subject, "", Source(reader="cohort"))
    return replace(static, streams={**static.streams, "forces": forces}, surfaces=plates)


def made_reference(out: Path, seed: int) -> Path:
    """Healthy made people of another seed, walked once; `out`/made_ref."""
    if not (out / "made_ref" / "reference.json").exists():
        folder = out / "made_controls"
        shutil.rmtree(folder, ignore_errors=True)
        for number in range(CONTROLS):
            write_person(Made(2 * number, seed + 500_000, out), folder)
        (folder / "rec" / "participants.csv").unlink()
        told("new", folder / "study", "--from", folder / "rec")
        told("reference", folder / "study", "--out", out / "made_ref")
    return out / "made_ref"


def of_made(made: Made) -> list[dict[str, Any]]:
    """Row of one made person."""
    folder = made.out / "made" / f"M{made.number:03d}"
    if not (folder / "rec").exists():
        write_person(made, folder)
    shutil.rmtree(folder / "study", ignore_errors=True)
    answer = answer_of(folder, made.out / "made_ref", pages=False)
    return [row_of(f"M{made.number:03d}", made.kind, TRIALS + 1, answer)]


def laid_out(folder: Path, who: str, files: Files, kinds: Sequence[str] = ("static", "walk")) -> Path:
    """A folder with a person's recordings, new."""
    shutil.rmtree(folder, ignore_errors=True)
    for kind in kinds:
        for path in files.get(kind, []):
            target = folder / "rec" / who / kind / path.name
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, target)
    return folder


def of_person(job: Any) -> list[dict[str, Any]]:
    """Rows of a real person without faults, with all trials, by the file's angles and by the markers'."""
    rows = []
    for angles in ("file", "markers"):
        folder = laid_out(job.out / "healthy" / f"{job.who} {angles}", job.who, job.files, tuple(job.files))
        answer = answer_of(folder, job.out / "ref", angles, job.pages)
        rows.append(row_of(job.who, angles, sum(map(len, job.files.values())), answer))
    return rows


def row_of(person: str, kind: str, trials: int, answer: Answer) -> dict[str, Any]:
    """What is kept of an answer: warnings and refusals, sentences, and whether the planted one is there."""
    alarms = sorted({line for line in answer.lines if not line.startswith(("note", "printed"))})
    spoken = answer.spoken()
    said = any(SPOKEN[kind] in sentence for sentence in spoken) if kind in SPOKEN else ""
    values = (person, kind, trials, answer.cycles, " || ".join(alarms), "; ".join(spoken), said)
    return dict(zip(COLUMNS, values, strict=True))


def table(rows: Sequence[dict[str, str]]) -> str:
    """Trials, people with an alarm, sentences; then every alarm."""
    lines = []
    for kind in dict.fromkeys(row["kind"] for row in rows):
        own = [row for row in rows if row["kind"] == kind]
        alarmed = sum(bool(row["alarms"]) for row in own)
        said = sum(row["said"] == "True" for row in own) if kind in SPOKEN else "-"
        spoken = sum(bool(row["sentences"]) for row in own)
        trials = sum(int(row["trials"]) for row in own)
        lines.append((kind or "healthy", len(own), trials, alarmed, spoken, said))
    text = [markdown_table("kind | people | trials | with a warning | with a sentence | planted one said", lines)]
    alarms = [(row, line) for row in rows for line in row["alarms"].split(" || ") if line]
    text += [f"alarm: {row['person']} {row['kind']}: {line[:240]}" for row, line in alarms]
    return "\n".join(text)
