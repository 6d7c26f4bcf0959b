"""Joint moments and powers against Plug-in Gait's own in the same C3D files, and against OpenSim's inverse dynamics.

    python studies/moments.py [DATA] [--picture moments.png] [--quick]

DATA holds gait/young_straight_and_turn, gait/young_static and opensim_gait10dof. Errors are rms over a clean step on a
plate, median and largest over the steps [N m/kg, W/kg]. `markers`: segments from the markers by the package; `bones`:
Plug-in Gait's own segments, to test kinetics alone. Two people are kept back.
"""

from __future__ import annotations

from command_line import QUICK, RECORDINGS, argument, command_line

PICTURE = argument("--picture", "file for the curves over each other", type=str)
GIVEN = command_line(__name__, __doc__, RECORDINGS, PICTURE, QUICK)  # before the slow imports

from pathlib import Path

from gait10dof_segments import against_opensim
from markdown_table import markdown_table
from moments_tables import NAMES, SETS, Curves, Walk, against_plug_in_gait, balances, filter_effect, over_each_other
from plug_in_gait_bones import TRUNK, WALKERS, bones, feet, static_file

import gaitdisc as gd
from gaitdisc.ingest.c3d_parameters import read_body_measures
from gaitdisc.kinematics.calibration import calibrate_body
from gaitdisc.kinematics.marker_set import marker_set
from gaitdisc.kinematics.motion import motion
from gaitdisc.kinetics.body_inertia import Person
from gaitdisc.kinetics.joint_moments import KineticsSettings
from gaitdisc.kinetics.trial_kinetics import TrialKinetics, trial_kinetics

SET = marker_set("plug_in_gait")
CHOSEN = (KineticsSettings(), KineticsSettings(force_cutoff_hz=6.0), KineticsSettings(frame="distal"))
SETTINGS = dict(zip(SETS, CHOSEN, strict=True))


def walks(data: Path, quick: bool = False) -> list[Walk]:
    """Every clean step of every walk, by the source of the segments and the settings."""
    found: list[Walk] = []
    with gd.C3DReader() as reader:
        for person in WALKERS[:1] if quick else WALKERS:
            file = static_file(data / "gait", person)
            static = reader.read(file).stream("markers")
            measures = read_body_measures(file)
            sets = {"markers": SET, "markers, Harrington's hip": SET.with_hip("harrington")}
            bodies = {source: calibrate_body(static, one, measures) for source, one in sets.items()}
            for kind in ("straight", "turn"):
                path = next((data / "gait" / "young_straight_and_turn" / person / kind).glob("*.c3d"))
                trial, who = reader.read(path), Person(measures.mass_kg)
                segments = {one: motion(trial.stream("markers"), body).poses for one, body in bodies.items()}
                for source, poses in {**segments, "bones": bones(trial)}.items():
                    for name, settings in SETTINGS.items():
                        made = trial_kinetics(trial, poses, feet(trial), who, settings, TRUNK)
                        balance = made.balance.line().removeprefix("force balance ")
                        found.append(Walk(person, kind, source, name, balance, steps(trial, made)))
    return found


def steps(trial: gd.Trial, made: TrialKinetics) -> list[Curves]:
    """Ours and the file's curves over each clean step."""
    theirs, found = trial.stream("moments"), []
    for step in (one for one in made.steps if one.clean):
        rows = (made.moments.time >= step.start) & (made.moments.time <= step.end)
        names = {name: name.format(step.side) for name in NAMES}
        found.append({name: (made.moments[full][rows], theirs[full][rows]) for name, full in names.items()})
    return found


HEADS = (
    "segments from|settings|channel|straight: median (largest), steps|straight, kept back|turn, all|turn, kept back",
    "person|walk|force balance, trunk from its markers",
    "OpenSim's gait10dof|segments from|rms, right and left [N m]|largest [N m]|rms [N m/kg]",
)


if __name__ == "__main__":
    found = walks(GIVEN.data, GIVEN.quick)
    opensim = against_opensim(GIVEN.data / "opensim_gait10dof")
    for head, rows in zip(HEADS, (against_plug_in_gait(found), balances(found), opensim), strict=True):
        print(markdown_table(head, rows), end="\n\n")
    print(filter_effect(found))
    if GIVEN.picture:
        over_each_other({w.person: w.steps for w in found if w[1:4] == ("straight", "markers", SETS[0])}, GIVEN.picture)
