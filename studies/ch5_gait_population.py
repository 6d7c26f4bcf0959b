"""Section 5.3.3, population models: the states of a person whom no model saw, Table 5.2 below and Fig. 5.5.

    python studies/ch5_gait_population.py [FOLDER] [DATA] [--quick] [--without-networks]

The embedded cohort, each of its twelve people reconstructed by models of ten others (the next in the list is who the
models are chosen by), and then corrected by ten strides of which the states are known.
"""

from __future__ import annotations

from pathlib import Path

from command_line import GAIT, KEPT, QUICK, argument, command_line

OUT = argument("folder", KEPT, Path("ch5_population"))
WITHOUT_NETWORKS = argument("--without-networks", "ridge regressions alone", False)
GIVEN = command_line(__name__, __doc__, OUT, GAIT, QUICK, WITHOUT_NETWORKS)  # before the slow imports

import pandas as pd
from chapter5 import gait

from gaitdisc.reconstruction.reconstruct_study import CONDITION, SUBJECT, ReconstructionSettings
from gaitdisc.reconstruction.reconstruction import CALIBRATED
from gaitdisc.reconstruction.window_model import KINDS
from gaitdisc.report.page import Block, write_blocks

WITHOUT = ("linear", "delay ridge", "fourier ridge")
RULE = "one person left out"


def run(quick: bool, folder: Path, data: Path = gait.DATA, kinds: tuple[str, ...] = tuple(KINDS)) -> gait.Result:
    """Reconstruct everybody by models of the others, before and after ten strides, and write the page."""
    kinds = WITHOUT if quick else kinds
    study = gait.cohort(folder / "recordings", 4, 30.0) if quick else gait.cohort(folder / "recordings")
    settings = ReconstructionSettings(split=SUBJECT, condition="nominal", kinds=kinds)
    sets = [words for words in gait.SENSORS if words not in gait.PELVIS]
    cells = [gait.cell(study, words, settings, folder / "cohort" / words.replace(" ", "_")) for words in sets]
    table = pd.concat([found["summary"].assign(data="cohort") for found in cells], ignore_index=True)
    errors = pd.concat([found["errors"] for found in cells])
    figure = gait.sensor_sets_figure(errors, study.title, "population", RULE)
    numbers = gait.sensor_sets_table(table, gait.printed("population"), "population", RULE)
    blocks = [
        Block("population", "Table 5.2", tuple(calibration_sentences(table)), (figure,), (numbers,)),
        *([across(data, kinds, folder)] if data.is_dir() and not quick else []),
    ]
    page = write_blocks("Population models, section 5.3.3", "Ebers 2023, chapter 5, computed anew.", blocks, folder)
    return gait.Result(table, page)


def calibration_sentences(table: pd.DataFrame) -> list[str]:
    """What ten strides of a new person take off the error, by model and sensor set."""
    said = []
    for sensors, own in table.groupby("sensors", sort=False):
        rmse = own.groupby("model")["rmse_deg"].mean()
        pairs = [(model, rmse[model], rmse.get(CALIBRATED.format(model))) for model in KINDS if model in rmse]
        words = [f"{n} {a:.2f} to {b:.2f} deg ({100 * (b / a - 1):+.0f} %)" for n, a, b in pairs if b is not None]
        said.append(f"{sensors}, by ten strides: {', '.join(words)}.")
    return said


def across(data: Path, kinds: tuple[str, ...], folder: Path) -> Block:
    """One runner, without and with the device, each reconstructed by models of the other condition."""
    one = gait.first_person(gait.exotendon(data))
    found = []
    for word in ("natural", "exotendon"):
        settings = ReconstructionSettings(split=CONDITION, condition=word, kinds=kinds)
        for sensors in gait.SENSORS:
            place = folder / "exotendon_run" / word / sensors.replace(" ", "_")
            summary = gait.cell(one, sensors, settings, place)["summary"]
            found.append(summary.assign(data=f"exotendon_run, {word} tested"))
    rule = "fitted to the other condition"
    table = gait.sensor_sets_table(pd.concat(found), gait.NOTHING_PRINTED, "conditions", rule)
    return Block("conditions", "Another condition", (), tables=(table,))


if __name__ == "__main__":
    kinds = WITHOUT if GIVEN.without_networks else tuple(KINDS)
    result = run(GIVEN.quick, GIVEN.folder, GIVEN.data, kinds)
    print(result.table.groupby(["data", "sensors", "model"], sort=False)[["rmse_deg", "relative_l2_whole"]].mean())
    print(result.page)
