"""Tables of chapter 3: every cell of the grid, and what the dissertation states beside what was found."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from gaitdisc.chapters.discrepancy.discrepancy_cell import PARTS, DiscrepancyCell, PartAccuracy, cells_table
from gaitdisc.chapters.pages.discrepancy_figure import METHOD_WORDS
from gaitdisc.report.table import Table, words_table

MOST_TERMS = 110  # characters
COEFFICIENT = r"(?<![*\w.])-?[0-9.]+(e[-+]?[0-9]+)?\*"  # of a term, but no power
WORST_SAID = -1000.0  # %: how much worse a run is whose error is eleven times the known model's, rounding decides
MOST_CHANNELS = 4  # that are listed one by one


def grid_table(cells: Sequence[DiscrepancyCell], name: str) -> Table:
    """Accuracy of every cell, a row a method, approach and noise; the median of the seeds."""
    groups: dict[tuple, list[DiscrepancyCell]] = {}
    for cell in cells:
        groups.setdefault((cell.variant, cell.approach, cell.method, cell.noise), []).append(cell)
    rows = []
    for (variant, approach, method, noise), found in groups.items():
        parts = [[c.parts[part] for c in found if c.parts] for part in PARTS]
        rows.append((
            variant, approach, METHOD_WORDS[method], f"{noise:g}", f"{len(found)}",
            *(_cell(each, len(found)) for each in parts),
            *(_median([p.valid_s("augmented") for p in each], "{:.1f}") for each in parts[1:]),
            _median([p.valid_s("known") for p in parts[2]], "{:.1f}"),
            f"{np.median([c.fit_s for c in found]):.1f}", f"{np.median([c.run_s for c in found]):.1f}",
            _found(found),
        ))  # fmt: skip
    columns = (
        "variant", "approach", "method", "noise", "n", "reconstruction, true start [%]",
        "forecast, true start (oracle) [%]", "forecast, estimated start [%]", "oracle valid [s]", "valid [s]",
        "known valid [s]", "fit [s]", "run [s]", "found",
    )  # fmt: skip
    caption = (
        "100 (1 − RMSE augmented / RMSE known) by channel, unclipped, against the noise-free truth: median and "
        "[least, greatest] of n seeds; without noise there is one. "
        "True start: the noise-free state, which no user has; estimated start: from the noisy measurement. "
        "How far below −1000 it lies depends on the machine, and is not said. "
        "Valid: until the error passes 0.4 standard deviations, median. Seconds of processor time. "
        "Found: terms of the first seed."
    )
    return Table(name, caption, columns, tuple(rows), cells_table(cells))


def _cell(parts: list[PartAccuracy], asked: int) -> str:
    """Say median and range over the seeds, by channel; when it diverged, and in how many seeds, instead of a number."""
    if not parts:
        return "not fitted"
    diverged = [part.diverged_s for part in parts if part.diverged_s is not None]
    if diverged:
        return f"diverged at t = {min(diverged):.2f} s" + (f" ({len(diverged)} of {asked} seeds)" * (asked > 1))
    accuracy = np.array([part.accuracy() for part in parts])
    many = accuracy.shape[1] > MOST_CHANNELS
    columns = [np.median(accuracy, axis=1)] if many else list(accuracy.T)
    said = "; ".join(spread_words(column) for column in columns)
    said += f" (median of {accuracy.shape[1]})" if many else ""
    return said if len(parts) == asked else f"{said} ({len(parts)} of {asked} seeds)"


def spread_words(values: NDArray[np.float64]) -> str:
    """Median, and least and greatest where there are several.

    Parameters
    ----------
    values : ndarray (seed,)
        [%].

    Examples
    --------
    >>> spread_words(np.array([99.5])), spread_words(np.array([-3.0, 4.0, 1.0]))
    ('99.5', '1.0 [-3.0, 4.0]')
    >>> spread_words(np.array([98.8, -6628419.0, 99.2]))
    '98.8 [below -1000, 99.2]'
    """
    if not np.isfinite(values).all():
        return "nothing to mend"
    middle = _percent(float(np.median(values)))
    return middle if len(values) == 1 else f"{middle} [{_percent(values.min())}, {_percent(values.max())}]"


def _percent(value: float) -> str:
    return f"{value:.1f}" if value >= WORST_SAID else f"below {WORST_SAID:.0f}"


def _median(values: list[float], form: str) -> str:
    return form.format(float(np.median(values))) if values else ""


def _found(cells: list[DiscrepancyCell]) -> str:
    refused = [cell.refused for cell in cells if cell.refused]
    if refused:
        return refused[0] + (f" ({len(refused)} of {len(cells)} seeds)" * (len(cells) > 1))
    kinds = [re.sub(COEFFICIENT, "", cell.terms) for cell in cells]
    same = f" (the same terms in {kinds.count(kinds[0])} of {len(cells)} seeds)" * (len(cells) > 1)
    return _short(cells[0].terms) + same if cells[0].terms else ""


def _short(text: str) -> str:
    return text if len(text) <= MOST_TERMS else f"{text[:MOST_TERMS]}… ({text.count('*')} products)"


def statements_table(statements: Sequence[tuple[str, str, str]], name: str) -> Table:
    """What the dissertation states, and what was found."""
    columns = ("where", "dissertation", "ours")
    caption = "The dissertation's statements beside what was found here."
    return words_table(name, caption, columns, statements)
