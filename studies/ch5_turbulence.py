"""Section 5.3.1: a turbulent flow from one sensor that stays or walks: Fig. 5.2, on a stand-in for the database's flow.

    python studies/ch5_turbulence.py [FOLDER] [--quick] [--models 8] [--nodes 48] [--cut 40]

The database's flow (1024 nodes, Re_lambda above 400) does not come with the package. A forced isotropic flow is
computed instead, with 48 nodes and Re_lambda near 29: a stand-in, on which no printed number can be reproduced. A run
that was stopped goes on. The text's 125,000 values are those of --nodes 64 --cut 50.
"""

from __future__ import annotations

from pathlib import Path

from command_line import KEPT, QUICK, argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("folder", KEPT, Path("ch5_turbulence")),
    QUICK,
    argument("--models", "of each kind of sensor", 8),
    argument("--nodes", "of the box, along one side", 48),
    argument("--cut", "side of the part that is kept, in nodes (default: five sixths of the box)", type=int),
)  # before the slow imports

from dataclasses import replace

from ch5_fields import ABOUT, middle_of, route_cells
from chapter5.pages import boxes_figure, flow_figure, histograms_figure, maps_figure, medians_table
from chapter5.reconstruct_field import CEILING, FieldTask, prepare, targets_of
from chapter5.routes import Route, fixed, fixed_at_random, random_walk
from chapter5.turbulence import FlowSettings, record_turbulence
from further import Result, result_text, write_page

from gaitdisc.reconstruction.windows import RANDOM, Lags
from gaitdisc.report.page import Block

SPLITS = (RANDOM, "temporal")
MODELS = 8  # of each kind of sensor; the dissertation trains 100
KINDS = ("linear", "delay ridge", "fourier ridge", "shred")
# reaches as far back as the 100 snapshots of the dissertation: 1.2 turnovers
TASK = FieldTask("stand-in turbulence", Lags(13, 8))
STAND_IN = (
    "This flow is a stand-in, not the database's, whose Reynolds number of Taylor's microscale is above 400; its cut "
    "holds most of the box, where the dissertation's holds a hundred-thirtieth. The dissertation prints no error in "
    "numbers but standard deviations, 0.0998 for fixed and 0.0617 for walking sensors, of windows drawn at random."
)


def run(
    quick: bool = False, folder: Path = Path("ch5_turbulence"), models: int = MODELS, nodes: int = 48, cut: int = 0
) -> Result:
    """Compute the flow, reconstruct it from fixed and from walking sensors under both splits, and draw Fig. 5.2."""
    settings = FlowSettings(nodes=24, cut=16, spin_up=300) if quick else FlowSettings(nodes, cut or 5 * nodes // 6)
    kinds, models = (KINDS[:2], min(models, 3)) if quick else (KINDS, models)
    flow, numbers = record_turbulence(settings, folder / "flow")
    cells, shown = [], {}
    for rule in SPLITS:
        task = replace(TASK, rule=rule)
        targets = targets_of(flow, task)
        for run_number in range(models):
            walk = random_walk(flow, run_number)
            stays = Route("1 fixed", fixed_at_random(flow, 1, run_number).points)
            for route in (stays, Route("1 walking", walk.points)):
                path = folder / "cells" / f"{rule.split()[0]}-{route.name.split()[-1]}-{run_number}.json"
                cells += route_cells(flow, route, replace(task, seed=run_number), kinds, targets, path)
                print(f"{rule}, {route.name} {run_number + 1} of {models}: R2 {cells[-1].r2:.3f}", flush=True)
        ready = prepare(flow, fixed(flow, [0]), task, targets)
        middle, snapshot = middle_of(ready.test)
        shown[f"flow, snapshot {snapshot + 1}, {rule}"] = flow.values[snapshot, :, 0]
        shown[f"its POD ceiling, {rule}"] = targets.fields(middle.y, middle)[0, :, 0]
    best = [cell for cell in cells if cell.model == kinds[-1]]
    ceilings = {cell.split: cell.relative_l2 for cell in cells if cell.model == CEILING}
    drawn = (
        flow_figure(numbers, settings.power),
        maps_figure(flow, shown, "maps", "As Fig. 5.2, top"),
        boxes_figure(best, "boxes", f"As Fig. 5.2, centre: {kinds[-1]}", ceilings),
        histograms_figure(best, "errors", "As Fig. 5.2, bottom"),
    )
    block = Block("flow", "One sensor in a turbulent flow", (STAND_IN,), drawn, (medians_table(cells, "models"),))
    return write_page(cells, [block], "Turbulence, section 5.3.1", ABOUT, folder)


if __name__ == "__main__":
    print(result_text(run(**vars(GIVEN))))
