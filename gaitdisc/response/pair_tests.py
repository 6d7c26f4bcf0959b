"""The paired tests over participants: what differs, by how much, how sure, and Fig. 4.2 with a bar where two differ."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from gaitdisc.report.figure import Figure
from gaitdisc.report.panels import MODELS, Room, draw_box, in_style, legend, legend_lines, panels, sheets
from gaitdisc.report.table import Table
from gaitdisc.response.participant_response import ResponseRun
from gaitdisc.response.participants_result import FAMILIES, PAIRS, PairTests
from gaitdisc.response.r2_tables import lowest_drawn, models_key, r2_numbers, tail_words, variables
from gaitdisc.words import MODEL_WORDS, NONE, counted, label, listing, number

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MOST_NAMED = 6  # variables in one sentence
SMALLEST_SHOWN = 1e-4
_WORDS = {**MODEL_WORDS, "perfect": "R² = 1"}
_FAMILY_WORDS = {  # of `FAMILIES`, in their order
    "pair": "the variables of one pair",
    "all": "all tests of all pairs",
    "variable": "the pairs of one variable",
}
_GROUPS = (("", 1), ("R²", 2), ("exact signed rank", 4), ("Holm-Sidak", 3), ("difference", 3))
MOST = 10  # variables in one figure
HEIGHT = 3.1  # of the panel [inch]
PLACES = {"nominal": -0.27, "augmented": 0.0, "exo": 0.27}
BARS = (("nominal", "augmented"), ("augmented", "exo"), ("nominal", "exo"))  # the longest lies highest


def comparison_tables(run: ResponseRun) -> list[Table]:
    """One table for each pair of models, and one of the other families; empty where nothing was tested."""
    if run.tests is None or run.tests.too_few:
        return []
    return [*(_pair_table(run.tests, *pair) for pair in PAIRS), _families_table(run.tests)]


def comparison_sentences(run: ResponseRun) -> list[str]:
    """What the paired tests say, and what they cannot; empty where the run has none, or one participant only."""
    tests = run.tests
    if tests is None or len(run.responses) < 2:
        return []
    if tests.too_few:
        return [f"{tests.too_few}. The numbers describe these participants only."]
    counts = tests.families.groupby("family")["different"].sum()
    total = int((tests.families["family"] == "pair").sum())
    differing = [f"{int(counts.get(family, 0))} over {_FAMILY_WORDS[family]}" for family in FAMILIES]
    every = counted(total, "test")
    return [
        *(_verdict(tests, first, second) for first, second in PAIRS[:3]),
        "A non-significant difference does not show equality: the interval of the shift gives its possible size.",
        _floor(tests),
        _say_unexplained(tests),
        f"Significant differences in {every} of 3 pairs, by family: {listing(differing)}. The first family is used.",
    ]


def p_text(p: float) -> str:
    """Write a p to three figures, or that it is smaller than 0.0001.

    >>> p_text(2 / 2**11), p_text(0.0420), p_text(1e-7), p_text(float("nan"))
    ('0.000977', '0.042', '<0.0001', 'not tested')
    """
    if not math.isfinite(p):
        return "not tested"
    return f"<{SMALLEST_SHOWN:.4f}" if p < SMALLEST_SHOWN else f"{p:.3g}"


def _pair_table(tests: PairTests, first: str, second: str) -> Table:
    numbers = tests.of_pair(first, second)
    columns = _columns(first, second)
    rows = []
    for _, row in numbers.iterrows():
        tested = math.isfinite(row["p"])
        untested = (NONE, NONE, str(int(row["n"])), *("not tested",) * (len(columns) - 3))
        rows.append((label(row["variable"]), *([write(row) for write in columns.values()] if tested else untested)))
    count = int(numbers["p"].notna().sum())
    missing = [f"{label(str(row.variable))}: {row.left_out}" for row in numbers.itertuples() if row.left_out]
    explained = (
        "n: pairs with a non-zero difference; W: smaller sum of ranks; p: exact, two-sided; Holm-Sidak level: limit "
        f"for p in its step; median: of the differences; shift: Hodges-Lehmann with its {100 * tests.level:.0f} % "
        "interval, not corrected for the number of tests; rank-biserial: −1 all lower, 1 all higher"
        if (first, second) == PAIRS[0]
        else f"columns as for {_WORDS[PAIRS[0][0]]} and {_WORDS[PAIRS[0][1]]}"
    )
    one_sign = " R² is never above 1, so all differences have one sign." if second == "perfect" else ""
    caption = (
        f"{_WORDS[second]} minus {_WORDS[first]}, R² [1] on the held-out device walk, "
        f"n = {counted(tests.participants, 'participant')}, Holm-Sidak over {counted(count, 'test')}, alpha = "
        f"{tests.alpha:g}; {explained}.{one_sign}{' Left out: ' + '; '.join(missing) + '.' if missing else ''}"
    )
    return Table(f"tests-{first}-{second}", caption, ("variable", *columns), tuple(rows), numbers, _GROUPS)


def _columns(first: str, second: str) -> dict[str, Callable[[pd.Series], str]]:
    """Headings after that of the variable, and how each writes a row that was tested."""
    return {
        _WORDS[first]: lambda row: number(row["median_first"], 3),
        _WORDS[second]: lambda row: number(row["median_second"], 3),
        "n": lambda row: str(int(row["n"])),
        "zeros": lambda row: str(int(row["zeros"])),
        "W": lambda row: f"{row['w']:g}",
        "p": lambda row: p_text(row["p"]),
        "Holm-Sidak level": lambda row: f"{row['step_level']:.4f}",
        "adjusted p": lambda row: p_text(row["p_adjusted"]),
        f"{_WORDS[second]} is": direction_found,
        "median": lambda row: number(row["median_difference"], 4),
        "shift [95 %]": lambda row: (
            f"{number(row['shift'], 4)}\n[{number(row['low'], 4, '−∞')}, {number(row['high'], 4, '∞')}]"
        ),
        "rank-biserial": lambda row: number(row["rank_biserial"], none=NONE),
    }


def direction_found(row: pd.Series) -> str:
    """In which direction a test says that the second differs from the first.

    >>> direction_found(pd.Series({"different": True, "rank_biserial": -1.0}))
    'lower'
    """
    return ("higher" if row["rank_biserial"] > 0 else "lower") if row["different"] else "not significant"


def _families_table(tests: PairTests) -> Table:
    rows = []
    for family in FAMILIES:
        for first, second in PAIRS[:3]:
            tested = tests.families
            tested = tested[(tested["family"] == family) & (tested["first"] == first) & (tested["second"] == second)]
            named = [label(str(variable)) for variable in tested.loc[tested["different"], "variable"]]
            rows.append((
                _FAMILY_WORDS[family],
                f"{_WORDS[first]}, {_WORDS[second]}",
                _range(tested["tests"], "d"),
                _range(tested["critical"], ".4f"),
                f"{len(named)} of {len(tested)}",
                ", ".join(named) if named else "none",
            ))  # fmt: skip
    caption = (
        f"The paired tests with other families, n = {counted(tests.participants, 'participant')}, alpha = "
        f"{tests.alpha:g} in each. Stopping level: the level at which the step-down procedure stopped, printed in the "
        "dissertation as “Sidak α = 0.013”. With eight variables per pair and four rejected it is 0.0127; with three "
        "pairs per variable no level has this value."
    )
    columns = ("family", "pair", "tests in it", "stopping level", "different", "which")
    return Table("tests-families", caption, columns, tuple(rows), tests.families)


def _verdict(tests: PairTests, first: str, second: str) -> str:
    rows = tests.of_pair(first, second)
    tested = rows[rows["p"].notna()]
    counts = []
    for word, sign in (("more", 1), ("less", -1)):
        chosen = tested[tested["different"] & (np.sign(tested["rank_biserial"]) == sign)]
        if len(chosen):
            named = [label(str(variable)) for variable in chosen["variable"]]
            which = f" ({'; '.join(named)})" if len(named) <= MOST_NAMED and len(named) < len(tested) else ""
            counts.append(f"{word} in {len(named)} of {counted(len(tested), 'variable')}{which}")
    start = f"{_WORDS[second]} against {_WORDS[first]}"
    if not len(tested):
        return f"{start}: no variable has enough participants for a test."
    if not counts:
        return f"{start}: there is no significant difference in any of {counted(len(tested), 'variable')}."
    largest = tested["shift"].abs().max()
    return f"{start}: {_WORDS[second]} explains {listing(counts)}; largest shift of R²: {number(float(largest), 3)}."


def _floor(tests: PairTests) -> str:
    rows = tests.tests[tests.tests["p"].notna()]
    if not len(rows):
        return "No test was made."
    n, count = int(rows["n"].max()), int(rows["tests"].max())
    smallest = 2.0 ** (1 - n)
    return (
        f"With n = {n} the smallest possible p is {p_text(smallest)}, and {p_text(1 - (1 - smallest) ** count)} after "
        f"adjustment for {counted(count, 'test')}. If many tests have this p, they show only that all participants "
        "agree."
    )


def _say_unexplained(tests: PairTests) -> str:
    rows = tests.of_pair("exo", "perfect")
    unexplained = 1 - rows["median_first"].dropna()
    if not len(unexplained):
        return "The unexplained variance of the Exo model was not computed."
    return (
        f"The Exo model, the upper limit for these inputs, leaves {number(float(unexplained.min()))} to "
        f"{number(float(unexplained.max()))} of the variance unexplained (medians of the variables). Every model has "
        "R² below 1, so the p-value of this comparison carries no information."
    )


def _range(values: pd.Series, form: str) -> str:
    if not len(values):
        return NONE
    low, high = f"{values.min():{form}}", f"{values.max():{form}}"
    return low if low == high else f"{low} to {high}"


@in_style
def comparison_figures(run: ResponseRun) -> list[Figure]:
    """Boxes of R2 over participants, three a variable, a bar above every pair that differs; none without tests."""
    if run.tests is None or run.tests.too_few:
        return []
    numbers = r2_numbers(run)
    numbers = numbers[numbers["kind"] == "network"].drop(columns="kind").reset_index(drop=True)
    pages = sheets(variables(run), MOST, "comparison")
    return [_figure(run, run.tests, numbers[numbers["variable"].isin(part)], name) for name, part in pages.items()]


def _figure(run: ResponseRun, tests: PairTests, numbers: pd.DataFrame, name: str) -> Figure:
    names = list(dict.fromkeys(numbers["variable"]))
    drawn, [[axes]] = panels(1, 1, HEIGHT, Room(left=0.6, bottom=0.75))
    low = lowest_drawn(numbers)
    step = 0.05 * (1 - low)
    different = {}
    for pair in BARS:
        rows = tests.of_pair(*pair)
        different[pair] = set(rows.loc[rows["different"].astype(bool), "variable"]) & set(names)
    for place, variable in enumerate(names):
        _draw_boxes(axes, numbers[numbers["variable"] == variable], place)
        for height, pair in enumerate(BARS):
            if variable in different[pair]:
                left, right = (place + PLACES[model] for model in pair)
                y = 1 + (height + 0.7) * step
                across, up = [left, left, right, right], [y - 0.2 * step, y, y, y - 0.2 * step]
                axes.plot(across, up, color="#111111", linewidth=0.9, clip_on=False)
    axes.set_xticks(
        range(len(names)), [textwrap.fill(label(variable), 14, break_long_words=False) for variable in names]
    )
    axes.tick_params(axis="x", length=0)
    axes.set_xlim(-0.5, len(names) - 0.5)
    axes.set_ylim(low, 1 + 3.2 * step)
    axes.set_yticks([tick for tick in axes.get_yticks() if low - 1e-9 <= tick <= 1 + 1e-9])
    axes.spines["left"].set_bounds(low, 1)
    axes.set_ylabel("R² on the held-out device walk [1]")
    for edge in np.arange(len(names) - 1) + 0.5:
        axes.axvline(edge, color="#e4e4e4", linewidth=0.6, zorder=0)
    bar = legend_lines({"different": {"color": "#111111", "linewidth": 0.9}})
    legend(drawn, [*models_key(linestyle="-", ms=4, mew=0), *bar])
    hidden = int((numbers["r2"] < low).sum())
    below = f" {counted(hidden, 'value')} below {number(low)} {'is' if hidden == 1 else 'are'} cut off."
    caption = (
        f"R² [1] of the second derivative of each variable on the held-out device walk ({run.exo}) over participants, "
        f"n = {counted(tests.participants, 'participant')}; split: last {tail_words(run)} s of the walk held out. "
        "Boxes: quartiles, thick line: median, whiskers: range, marks: participants; networks only. A bar joins two "
        "models that differ: exact two-sided Wilcoxon signed-rank test, Holm-Sidak over the variables of the pair, "
        f"alpha = {tests.alpha:g}.{below if hidden else ''} After Fig. 4.2 of the dissertation."
    )
    counts = [f"{MODEL_WORDS[a]} and {MODEL_WORDS[b]} differ in {len(which)}" for (a, b), which in different.items()]
    alt = f"Boxes of R² of three models for {counted(len(names), 'variable')}: {', '.join(counts)}."
    return Figure(name, caption, alt, numbers, drawn)


def _draw_boxes(axes: Axes, rows: pd.DataFrame, place: int) -> None:
    for model, offset in PLACES.items():
        look, x = MODELS[model], place + offset
        values = rows.loc[rows["model"] == model, "r2"].dropna().to_numpy()
        if not len(values):
            continue
        draw_box(axes, values, x, look.colour)
        axes.plot(np.full(len(values), x), values, look.mark, color=look.colour, ms=2.0, mew=0, zorder=3)
