"""Numbers out of the cells of a text table; whatever is no number is named with its line and column."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ReadError

MISSING = ("", "nan", "NaN", "NAN", "-nan", "-nan(ind)", "nan(ind)", "1.#QNAN", "-1.#IND", "1.#IND")


@dataclass(frozen=True)
class Cells:
    """Numbers of a table and the lines they stand in."""

    values: NDArray[np.float64]  # (row, column), numbers; NaN for blank cells
    lines: NDArray[np.intp]  # (row,), line of the file that each row stands in, counted from 1
    first_column: list[str]  # first cell of each row as printed


@dataclass(frozen=True)
class Form:
    """How the cells of a table are written."""

    file: str
    separator: str = "\t"  # what stands between cells; a blank means any run of blanks and tabs
    decimal: str = "."

    def split(self, line: str) -> list[str]:
        """Split a line into cells."""
        return line.split() if self.separator == " " else line.split(self.separator)


def parsed_cells(lines: Sequence[str], labels: Sequence[str], first_line: int, form: Form) -> Cells:
    r"""Numbers of a table's body.

    first_line: line of the file in which the body starts, counted from 1

    >>> parsed_cells(["0\t1.5", "0.1\t"], ["time", "a"], 3, Form("walk.mot")).values
    array([[0. , 1.5],
           [0.1, nan]])
    """
    numbers = np.array([first_line + i for i, line in enumerate(lines) if not line.isspace() and line], dtype=np.intp)
    rows = [line for line in lines if line and not line.isspace()]
    if not rows:
        raise ReadError(
            f"{form.file} needs rows of numbers", f"none follow line {first_line - 1}", "Export the whole trial."
        )
    rows = _even_rows(rows, labels, numbers, form)
    values = _numbers(rows, form)
    if values is None or np.isinf(values).any():
        values = _numbers_cell_by_cell(rows, labels, numbers, form)
    separator = None if form.separator == " " else form.separator
    return Cells(values, numbers, [row.split(separator, 1)[0].strip() for row in rows])


def _even_rows(rows: list[str], labels: Sequence[str], numbers: NDArray[np.intp], form: Form) -> list[str]:
    width = len(labels)
    if form.separator == " ":
        counts = [len(row.split()) for row in rows]
    else:
        counts = [row.count(form.separator) + 1 for row in rows]
    if min(counts) < width:
        row = counts.index(min(counts)) if counts[-1] >= width else len(counts) - 1
        cut = ", the last line" if row == len(rows) - 1 else ""
        raise ReadError(
            f"{form.file}: every row needs {width} cells, one a column",
            f"line {numbers[row]}{cut} has {counts[row]}",
            "The file was cut or edited: copy or export it again.",
        )
    if max(counts) == width:
        return rows
    even = []
    for row, number in zip(rows, numbers, strict=True):
        cells = form.split(row)
        if any(cell.strip() for cell in cells[width:]):
            raise ReadError(
                f"{form.file}: every row needs {width} cells, one a column",
                f"line {number} has {len(cells)}",
                "Name every column in the line of labels, or export the file again.",
            )
        even.append((" " if form.separator == " " else form.separator).join(cells[:width]))
    return even


def _numbers(rows: list[str], form: Form) -> NDArray[np.float64] | None:
    """Numbers by numpy's parser, the blank cells filled in if there are any; None where that does not do."""
    if form.decimal != ".":
        rows = [row.replace(form.decimal, ".") for row in rows]
    separator = None if form.separator == " " else form.separator
    blank = re.compile(rf"(?:^|(?<={re.escape(form.separator)})) *(?={re.escape(form.separator)}|$)")
    for filled in (False, True):
        try:
            values = np.loadtxt(
                [blank.sub("nan", row) for row in rows] if filled else rows,
                delimiter=separator,
                comments=None,
                ndmin=2,
            )
        except ValueError:
            continue
        return values if len(values) == len(rows) else None
    return None


def _numbers_cell_by_cell(
    rows: list[str], labels: Sequence[str], numbers: NDArray[np.intp], form: Form
) -> NDArray[np.float64]:
    values = np.full((len(rows), len(labels)), np.nan)
    for i, row in enumerate(rows):
        for j, (label, cell) in enumerate(zip(labels, form.split(row), strict=False)):
            text = cell.strip()
            if text in MISSING:
                continue
            try:
                values[i, j] = float(text.replace(form.decimal, "."))
            except ValueError:
                values[i, j] = np.inf
            if not np.isfinite(values[i, j]) or "_" in text:
                raise ReadError(
                    f"{form.file}: a number is needed in line {numbers[i]}, column {label!r}",
                    f"found {text[:40]!r}",
                    "Correct the cell; leave it blank or write nan where nothing was measured.",
                )
    return values
