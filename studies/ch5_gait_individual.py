"""Section 5.3.3, individual models: 18 states from a few sensors of the same person, Table 5.2 above and Fig. 5.4.

    python studies/ch5_gait_individual.py [FOLDER] [DATA] [--quick]

The embedded cohort (12 people, 60 s, ten angles: it has no pelvis, so the two "random" sensor sets are none of its),
one person's twelve treadmill walks (18 states) and two runners (18 states). The split is temporal with a gap; for one
person of each kind, windows drawn at random stand beside it, which leak. Then noise, and lost readings.
"""

from __future__ import annotations

from pathlib import Path

from command_line import GAIT, KEPT, QUICK, argument, command_line

OUT = argument("folder", KEPT, Path("ch5_individual"))
GIVEN = command_line(__name__, __doc__, OUT, GAIT, QUICK)  # before the slow imports

from collections.abc import Mapping

import pandas as pd
from chapter5 import gait

from gaitdisc.ingest.study import Study
from gaitdisc.reconstruction.reconstruct_study import ReconstructionSettings
from gaitdisc.reconstruction.sensed_walks import read_walks
from gaitdisc.reconstruction.window_model import KINDS, MASKED, sensing
from gaitdisc.reconstruction.windows import RANDOM, RULES
from gaitdisc.report.page import Block, write_blocks
from gaitdisc.report.table import save_table

SAGITTAL = "3 sagittal"
QUICK_KINDS = ("linear", "delay ridge", "fourier ridge")


def run(quick: bool = False, folder: Path = Path("ch5_individual"), data: Path = gait.DATA) -> gait.Result:
    """Reconstruct everybody from own walks, with every sensor set, and write the page."""
    kinds = QUICK_KINDS if quick else tuple(KINDS)
    walks = studies(quick, folder, data)
    blocks, summaries = [], []
    for name, study in walks.items():
        settings = ReconstructionSettings(kinds=kinds, condition="nominal" if name == "cohort" else "")
        sets = [words for words in gait.SENSORS if name != "cohort" or words not in gait.PELVIS]
        cells = [gait.cell(study, words, settings, folder / name / words.replace(" ", "_")) for words in sets]
        summaries += [found["summary"].assign(data=name) for found in cells]
        errors = pd.concat([found["errors"] for found in cells])
        blocks.append(Block(name, study.title, (), (gait.sensor_sets_figure(errors, study.title, name, "temporal"),)))
    table = pd.concat(summaries, ignore_index=True)
    sets = gait.sensor_sets_table(table, gait.printed("individual"), "sets", "temporal")
    first = Block("sets", "Table 5.2", (), tables=(sets,))
    blocks = [first, *blocks, leaks(walks, kinds, folder), disturbed(walks["cohort"], kinds, folder)]
    page = write_blocks("Individual models, section 5.3.3", "Ebers 2023, chapter 5, computed anew.", blocks, folder)
    return gait.Result(table, page)


def studies(quick: bool, folder: Path, data: Path) -> Mapping[str, Study]:
    """Who walked, by name."""
    if quick:
        return {"cohort": gait.cohort(folder / "recordings", 1, 30.0)}
    found = {"cohort": gait.cohort(folder / "recordings")}
    if data.is_dir():
        found["treadmill_walk_ik"] = gait.treadmill(data, folder / "treadmill")
        found["exotendon_run"] = gait.exotendon(data)
    return found


def leaks(walks: Mapping[str, Study], kinds: tuple[str, ...], folder: Path) -> Block:
    """The split that leaks beside the honest ones, for one person: of the treadmill, or the first of the cohort."""
    name = "treadmill_walk_ik" if "treadmill_walk_ik" in walks else "cohort"
    study, condition = walks[name], "nominal" if name == "cohort" else ""
    one = gait.first_person(study)
    found = []
    for rule in RULES:
        settings = ReconstructionSettings(split=rule, kinds=kinds, condition=condition)
        place = folder / name / f"{SAGITTAL}{'' if rule == 'temporal' else f' {rule.split()[0]}'}".replace(" ", "_")
        found.append(gait.cell(one, SAGITTAL, settings, place)["summary"].assign(data=f"{name}, {rule}"))
    rule = f"as named; {RANDOM}: {RULES[RANDOM]}"
    own = pd.concat(found).query("participant == @one.participants[0].id")
    return Block("splits", "The split", (), tables=(gait.sensor_sets_table(own, gait.NOTHING_PRINTED, "splits", rule),))


def disturbed(study: Study, kinds: tuple[str, ...], folder: Path) -> Block:
    """Noise and missing readings, for the first person of the cohort."""
    file = folder / "disturbed.csv"
    person = study.participants[0].id
    if not file.exists():
        walks = read_walks(study, gait.SENSORS[SAGITTAL], "nominal")
        names = tuple(channel.name for channel in walks.channels)
        what = sensing(names, gait.SENSORS[SAGITTAL], ReconstructionSettings().lags(walks.rate_hz), walks.rate_hz)
        channels = [channel for channel in walks.channels if channel.name in what.states]
        own = [(walk.recording, walk.phi) for walk in walks.people[person]]
        masked = (MASKED,) if "shred" in kinds else ()
        missing = gait.against_missing(own, what, channels, (*kinds, *masked))
        save_table(pd.concat([gait.against_noise(own, what, channels, kinds), missing]), file)
    figure = gait.disturbance_figure(pd.read_csv(file), f"{person}, {SAGITTAL} sensors")
    return Block("disturbed", "Noise and missing readings", (), (figure,))


if __name__ == "__main__":
    result = run(GIVEN.quick, GIVEN.folder, GIVEN.data)
    print(result.table.groupby(["data", "sensors", "model"], sort=False)[["rmse_deg", "relative_l2_whole"]].mean())
    print(result.page)
