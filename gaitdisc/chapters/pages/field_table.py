"""Table of a field study: a row a route, the error of every model under every split."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from gaitdisc.chapters.fields.field_cell import FieldCell, field_cells_table
from gaitdisc.report.table import Table


def field_table(cells: Sequence[FieldCell], name: str, printed: Mapping[tuple[str, str], float] | None = None) -> Table:
    """Relative L2 error of every route, model and split; the least of each row and split is marked by a star.

    Parameters
    ----------
    printed : mapping of (str, str) to float, optional
        (route, split) -> what the dissertation prints for its SHRED on its field; shown in a column of its own.
    """
    splits = list(dict.fromkeys(cell.split for cell in cells))
    models = list(dict.fromkeys(cell.model for cell in cells if not _is_bound(cell.model)))
    routes = list(dict.fromkeys(cell.route for cell in cells))
    found = {(cell.route, cell.split, cell.model): cell for cell in cells}
    extra = ("printed",) if printed else ()
    rows = []
    for route in routes:
        row = [route]
        for split in splits:
            here = {model: found.get((route, split, model)) for model in models}
            least = min((c.relative_l2 for c in here.values() if c is not None), default=0.0)
            row += [_cell(cell, least) for cell in here.values()]
            if printed:
                row.append(f"{printed[route, split]:.4f}" if (route, split) in printed else "")
        rows.append(tuple(row))
    first = cells[0]
    caption = (
        f"{first.field}, {first.quantity}: relative L2 error, the norm of the error over the norm of the field about "
        f"zero; in brackets RMSE [{first.unit}] and R2 about the training part's mean; star: least of the models. "
        f"Test snapshots: {', '.join(f'{split} {_judged(cells, split)}' for split in splits)}."
        f"{_bounds(cells)}"
    )
    columns = ("route", *[word for _ in splits for word in (*models, *extra)])
    groups = (("", 1), *[(split, len(models) + len(extra)) for split in splits])
    return Table(name, caption, columns, tuple(rows), field_cells_table(cells), groups)


def _is_bound(model: str) -> bool:
    return model.endswith("(no sensor)") or model.startswith("POD")


def _bounds(cells: Sequence[FieldCell]) -> str:
    """What needs no sensor, and what no model can beat: the same for every route."""
    found = {(cell.split, cell.model): cell for cell in reversed(cells) if _is_bound(cell.model)}
    words = [f"{split}, {model}: {_cell(cell)}" for (split, model), cell in reversed(found.items())]
    return f" Bounds: {'; '.join(words)}." if words else ""


def _cell(cell: FieldCell | None, least: float = 0.0) -> str:
    if cell is None:
        return ""
    star = "*" if cell.relative_l2 == least else ""
    return f"{cell.relative_l2:.3f}{star} ({cell.rmse:.3g}; {cell.r2:.2f})"


def _judged(cells: Sequence[FieldCell], split: str) -> str:
    counts = sorted({cell.judged for cell in cells if cell.split == split})
    return str(counts[0]) if len(counts) == 1 else f"{counts[0]} to {counts[-1]}"


def medians_table(cells: Sequence[FieldCell], name: str) -> Table:
    """Median and range over runs of every route, split and model."""
    groups: dict[tuple[str, str, str], list[FieldCell]] = {}
    for cell in cells:
        route = "" if _is_bound(cell.model) else cell.route
        groups.setdefault((cell.split, cell.model, route), []).append(cell)
    rows = []
    for (split, model, route), found in groups.items():
        some = found if route else found[:1]
        errors, r2 = [cell.relative_l2 for cell in some], [cell.r2 for cell in some]
        rows.append((
            split, model, route, str(len(some)), f"{np.median(errors):.3f}", f"{min(errors):.3f} to {max(errors):.3f}",
            f"{np.median(r2):.3f}", f"{np.median([c.bias for c in some]):+.4f}",
            f"{np.median([c.sd for c in some]):.4f}", f"{np.median([c.seconds for c in some]):.1f}",
        ))  # fmt: skip
    first = cells[0]
    caption = (
        f"{first.field}, {first.quantity} [{first.unit}]: medians over runs; relative L2 error about zero with its "
        "range, R2 about the training part's mean, mean and standard deviation of reconstructed minus measured, "
        "processor time of a fit."
    )
    columns = ("split", "model", "sensor", "n", "relative L2", "range", "R2", "bias", "sd", "fit [s]")
    return Table(name, caption, columns, tuple(rows), field_cells_table(cells))
