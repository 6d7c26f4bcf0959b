"""A path never seen in training: reconstructed from readings and places, by a model fitted on many other paths."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from gaitdisc.errors import ChannelError
from gaitdisc.recording import Field
from gaitdisc.sensing.reconstructor import fit_reconstructor
from gaitdisc.sensing.windows import stacked

from .field_cell import FieldCell
from .field_task import FieldTask
from .reconstruct_field import field_cells, prepare, targets_of
from .routes import Route

OWN, OTHER = "the fitted path", "another path, never fitted"
ALONE, MANY, MANY_PLACED = "fitted on one path", "fitted on {} paths", "fitted on {} paths, places given"


def unseen_path(
    field: Field, routes: Sequence[Route], unseen: Route, task: FieldTask, kinds: Sequence[str]
) -> list[FieldCell]:
    """Error on a path never fitted, beside that on the fitted one.

    The dissertation says of its network that it "cannot extrapolate to unseen sensor location trajectories". Here that
    error is stated: for a model fitted on one path, on many, and on many with each sensor's place fed in beside its
    reading. The test times are those of the split, and were not fitted on any path.
    """
    if len(routes) < 2 or {route.sensors for route in routes} != {unseen.sensors}:
        counts = ", ".join(str(route.sensors) for route in routes) or "none"
        raise ChannelError(
            f"a path never seen needs two other paths or more, each with {unseen.sensors} sensors",
            f"found {len(routes)} paths, with {counts} sensors",
            "Give more paths, alike in their sensors.",
        )
    cells, targets = [], targets_of(field, task)
    many = len(routes)
    for fitted, placed in ((ALONE, False), (MANY.format(many), False), (MANY_PLACED.format(many), True)):
        placed_task = replace(task, positions=placed)
        ready = [prepare(field, route, placed_task, targets) for route in (routes[:1] if fitted == ALONE else routes)]
        training, check = stacked([each.training for each in ready]), stacked([each.check for each in ready])
        tested = {OTHER: replace(prepare(field, unseen, placed_task, targets), training=training)}
        if fitted == ALONE:
            tested = {OWN: ready[0]} | tested
        for kind in kinds:
            done = fit_reconstructor(kind, ready[0].what, training, check, task.seed)
            for where, each in tested.items():
                label = task.label(f"{where}; {fitted}", task.named(kind))
                cells += field_cells(field, each, label, each.reconstructed(done), done.seconds)
    return cells
