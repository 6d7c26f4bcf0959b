"""Section 5.3.3, Table 5.2: states of walkers from a few sensors, by models of the same person and of others.

    python studies/ch5_gait.py [individual|population] [FOLDER] [DATA] [--quick] [--kinds shred shred-text] [--seeds 1]

`individual` (above in the table, Fig. 5.4): the embedded cohort (12 people, 60 s, ten angles: it has no pelvis, so the
two "random" sensor sets are none of its), one person's twelve treadmill walks (18 states) and two runners (18 states).
The split is temporal with a gap; for one person of each kind, windows drawn at random stand beside it, which leak. Then
noise, and lost readings. `population` (below, Fig. 5.5): each of the cohort by models of ten others (the next in the
list is who the models are chosen by), then corrected by ten strides of which the states are known.

The text's own network is `shred-text`, with 100 readings in place of 25. A run that was stopped goes on.
"""

from __future__ import annotations

from pathlib import Path

from command_line import GAIT, KEPT, QUICK, argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("part", "individual or population", "individual", choices=("individual", "population")),
    argument("folder", KEPT, Path("ch5_gait")),
    GAIT,
    QUICK,
    argument("--kinds", "of model (default: the usual five)", nargs="+"),
    argument("--seeds", "of networks and random features: 0 to one less than this", 1),
)  # before the slow imports

from collections.abc import Mapping

import pandas as pd
from chapter5 import gait
from chapter5.gait import SAGITTAL, Wanted
from further import Result, result_text, write_page

from gaitdisc.reconstruction.reconstruct_study import SUBJECT
from gaitdisc.reconstruction.window_model import KINDS
from gaitdisc.reconstruction.windows import RANDOM, RULES
from gaitdisc.report.page import Block

LEFT_OUT = "one person left out"
ABOUT = "chapter 5, computed anew."


def individual(wanted: Wanted) -> Result:
    """Reconstruct everybody from own walks, with every sensor set, and write the page."""
    walks, blocks, summaries = gait.walkers(wanted), [], []
    for name, study in walks.items():
        condition = "nominal" if name == "cohort" else ""
        sets = [words for words in gait.SENSORS if name != "cohort" or words not in gait.PELVIS]
        cells = [wanted.cell(study, words, f"individual/{name}", condition=condition) for words in sets]
        summaries += [found["summary"].assign(data=name) for found in cells]
        errors = pd.concat([found["errors"] for found in cells])
        blocks.append(Block(name, study.title, (), (gait.sensor_sets_figure(errors, study.title, name, "temporal"),)))
    table = pd.concat(summaries, ignore_index=True)
    sets = gait.sensor_sets_table(table, gait.printed("individual"), "sets", "temporal")
    split, first = leaks(walks, wanted), Block("sets", "Table 5.2", (), tables=(sets,))
    of_noise = gait.disturbed(walks["cohort"], wanted.folder, wanted.quick)
    blocks = [first, *blocks, Block("splits", "The split", (), tables=(split,)), of_noise]
    return write_page(table, blocks, "Individual models, section 5.3.3", ABOUT, wanted.folder)


def leaks(walks: Mapping[str, gait.Study], wanted: Wanted) -> gait.Table:
    """The split that leaks beside the honest ones, for one person: of the treadmill, or the first of the cohort."""
    name = "treadmill_walk_ik" if "treadmill_walk_ik" in walks else "cohort"
    condition, one, found = "nominal" if name == "cohort" else "", gait.first_person(walks[name]), []
    for rule in RULES:
        place = f"individual/{name}{'' if rule == 'temporal' else f' {rule.split()[0]}'}"
        cell = wanted.cell(one, SAGITTAL, place, split=rule, condition=condition)
        found.append(cell["summary"].assign(data=f"{name}, {rule}"))
    own = pd.concat(found).query("participant == @one.participants[0].id")
    return gait.sensor_sets_table(own, gait.NOTHING_PRINTED, "splits", f"as named; {RANDOM}: {RULES[RANDOM]}")


def population(wanted: Wanted) -> Result:
    """Reconstruct everybody by models of the others, before and after ten strides, and write the page."""
    people, walk_s = (4, 30.0) if wanted.quick else (gait.PEOPLE, gait.WALK_S)
    study = gait.cohort(wanted.folder / "recordings", people, walk_s)
    sets = [words for words in gait.SENSORS if words not in gait.PELVIS]
    cells = [wanted.cell(study, words, "population/cohort", split=SUBJECT, condition="nominal") for words in sets]
    table = pd.concat([found["summary"].assign(data="cohort") for found in cells], ignore_index=True)
    errors = pd.concat([found["errors"] for found in cells])
    figure = gait.sensor_sets_figure(errors, study.title, "population", LEFT_OUT)
    numbers = gait.sensor_sets_table(table, gait.printed("population"), "population", LEFT_OUT)
    blocks = [Block("population", "Table 5.2", tuple(gait.calibration_sentences(table)), (figure,), (numbers,))]
    return write_page(table, blocks, "Population models, section 5.3.3", ABOUT, wanted.folder)


if __name__ == "__main__":
    kinds = tuple(GIVEN.kinds or KINDS)
    make = {"individual": individual, "population": population}[GIVEN.part]
    print(result_text(make(Wanted(GIVEN.quick, GIVEN.folder, GIVEN.data, kinds, GIVEN.seeds))))
