"""Numbers and times out of the cells of a text table; whatever is no number is named with its line and column."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ReadError, SamplingError
from gaitdisc.recording import Finding
from gaitdisc.recording.arrays import Values, mean_rate, mean_step

MISSING = ("", "nan", "NaN", "NAN", "-nan", "-nan(ind)", "nan(ind)", "1.#QNAN", "-1.#IND", "1.#IND")
_NUMBER = re.compile(r"[-+]?\d*(?:[.,](\d*))?(?:[eEdD]([-+]?\d+))?")
COARSE = 0.35  # of a step; a printed digit above this hides a missing sample
ALREADY_EVEN = 1e-6  # of a step


@dataclass(frozen=True)
class Form:
    """How the cells of a table are written."""

    file: str
    separator: str = "\t"  # what stands between cells; a blank means any run of blanks and tabs
    decimal: str = "."
    unread: frozenset[str] = frozenset()  # labels of columns that the study ignores, which may hold text

    def split(self, line: str, most: int = -1) -> list[str]:
        """Split a line into cells, the last of them the rest of the line where `most` splits are made."""
        return line.split(None if self.separator == " " else self.separator, most)


@dataclass(frozen=True)
class Cells:
    """Numbers of a table and the lines they stand in."""

    values: Values  # (row, column), numbers; NaN for blank cells
    lines: NDArray[np.intp]  # (row,), line of the file that each row stands in, counted from 1
    rows: list[str]  # as printed
    form: Form

    def printed_digit(self, column: int) -> float:
        """Size of the last digit that a column uses."""
        return printed_digit(self.form.split(row, column + 1)[column] for row in self.rows)


def parse_cells(lines: Sequence[str], labels: Sequence[str], first_line: int, form: Form) -> Cells:
    """Numbers of a table's body, which starts in line `first_line` of the file, counted from 1."""
    numbers = np.array([first_line + i for i, line in enumerate(lines) if line.strip()], dtype=np.intp)
    rows = [line for line in lines if line.strip()]
    if not rows:
        raise ReadError(
            f"{form.file} must contain rows of numbers", f"none follow line {first_line - 1}", "Export all rows."
        )
    rows = _even_rows(rows, labels, numbers, form)
    values = _numbers(rows, form)
    if values is None or np.isinf(values).any():
        values = _numbers_cell_by_cell(rows, labels, numbers, form)
    return Cells(values, numbers, rows, form)


def _even_rows(rows: list[str], labels: Sequence[str], numbers: NDArray[np.intp], form: Form) -> list[str]:
    width = len(labels)
    counts = [len(row.split()) if form.separator == " " else row.count(form.separator) + 1 for row in rows]
    if min(counts) < width:
        row = counts.index(min(counts)) if counts[-1] >= width else len(counts) - 1
        cut = " (the last line)" if row == len(rows) - 1 else ""
        raise ReadError(
            f"{form.file}: every row must have {width} cells, one per column",
            f"line {numbers[row]}{cut} has {counts[row]}",
            "The file was cut or edited. Copy or export it again.",
        )
    if max(counts) == width:
        return rows
    even = []
    for row, number in zip(rows, numbers, strict=True):
        cells = form.split(row)
        if any(cell.strip() for cell in cells[width:]):
            raise ReadError(
                f"{form.file}: every row must have {width} cells, one per column",
                f"line {number} has {len(cells)}",
                "Name every column in the header line, or export the file again.",
            )
        even.append(form.separator.join(cells[:width]))
    return even


def _numbers(rows: list[str], form: Form) -> Values | None:
    """Numbers by numpy's parser, the blank cells filled in if there are any; None where that does not do."""
    if form.decimal != ".":
        rows = [row.replace(form.decimal, ".") for row in rows]
    separator = None if form.separator == " " else form.separator
    blank = re.compile(rf"(?:^|(?<={re.escape(form.separator)})) *(?={re.escape(form.separator)}|$)")
    for filled in (False, True):
        try:
            values = np.loadtxt(
                [blank.sub("nan", row) for row in rows] if filled else rows, delimiter=separator, comments=None, ndmin=2
            )
        except ValueError:
            continue
        return values if len(values) == len(rows) else None
    return None


def _numbers_cell_by_cell(rows: list[str], labels: Sequence[str], numbers: NDArray[np.intp], form: Form) -> Values:
    values = np.full((len(rows), len(labels)), np.nan)
    for i, row in enumerate(rows):
        for j, (label, cell) in enumerate(zip(labels, form.split(row), strict=False)):
            text = cell.strip()
            if text in MISSING or label in form.unread:
                continue
            try:
                values[i, j] = float(text.replace(form.decimal, "."))
            except ValueError:
                values[i, j] = np.inf
            if not np.isfinite(values[i, j]) or "_" in text:
                raise ReadError(
                    f"{form.file}: line {numbers[i]}, column {label!r} must contain a number",
                    f"found {text[:40]!r}",
                    "Correct the cell. Leave it blank or write nan if nothing was measured.",
                )
    return values


def check_counts(
    cells: Cells, lines: Sequence[str], file: str, *counts: tuple[str, Sequence[int], int]
) -> list[Finding]:
    """Refuse fewer rows than claimed, report other wrong counts; each: what, header's counts, how many; rows first.

    A file that ends with a line end is read, as OpenSim does: who cuts a trial by hand leaves the header as it was.
    """
    kind, claimed, there = counts[0]
    if claimed and there < max(claimed) and lines[-1].strip():
        raise ReadError(
            f"{file} must have {max(claimed)} {kind}{' of numbers' * (kind == 'rows')}, as its header says",
            f"it ends after {there} {kind}, at line {cells.lines[-1]}",
            "The file is incomplete. Copy or export it again.",
        )
    findings = []
    for kind, claimed, there in counts:
        wrong = sorted({count for count in claimed if count != there})
        if wrong:
            what = f"the header states {' and '.join(map(str, wrong))} {kind}, but the file has {there}"
            spoils = "nothing in gaitdisc; other programs may refuse the file"
            if there < max(wrong):
                spoils = "the end of the recording, if this copy is incomplete"
            findings.append(Finding("warning", "wrong count", file, what, spoils))
    return findings


def printed_digit(texts: Iterable[str]) -> float:
    """Size of the last digit in use, the finest of a column; zeros that only fill up a number are none.

    >>> printed_digit(["0", "0.017", "0.033"]), printed_digit(["0.000000", "0.017000"]), printed_digit(["5.25e-04"])
    (0.001, 0.001, 1e-06)
    """
    finest = 0
    for text in texts:
        match = _NUMBER.fullmatch(text.strip())
        if match:
            finest = max(finest, len((match[1] or "").rstrip("0")) - int(match[2] or 0))
    return float(10.0 ** -min(finest, 300))


def even_time(time: Values, digit_s: float, file: str, lines: NDArray[np.intp] | None = None) -> Values:
    """Even time base that a column of printed times rounds.

    A column is taken as even when no step differs from the mean one by more than one printed digit, and no time from
    the even base by more than that. Where the digit is coarser than 35 % of a step a missing sample would look like
    rounding, so all steps must be the same there.

    time (time,) [s]: as read
    digit_s: size of the last printed digit [s]; 0 for binary files
    lines (time,): line of each sample in the file, for the message; the row counted from 1 without it
    returns (time,) [s]: the same array where it is even already

    >>> even_time(np.array([0.0, 0.017, 0.033, 0.05]), 1e-3, "walk.mot")
    array([0.        , 0.01666667, 0.03333333, 0.05      ])
    """
    time = np.asarray(time, float)

    def place(row: int) -> str:
        return f"line {lines[row]}" if lines is not None else f"row {row + 1}"

    if len(time) < 2:
        raise SamplingError(
            f"{file}: a recording must have at least two samples", f"it has {len(time)}", "Export the entire trial."
        )
    if not np.isfinite(time).all():
        row = int(np.argmax(~np.isfinite(time)))
        raise SamplingError(
            f"{file}: every sample must have a time", f"{place(row)} has {time[row]}", "Export the file again."
        )
    steps = np.diff(time)
    if steps.min() <= 0:
        row = int(np.argmin(steps))
        raise SamplingError(
            f"{file}: time must increase",
            f"{place(row + 1)} has t = {time[row + 1]:.10g} s after {time[row]:.10g} s",
            "Remove the duplicate or misplaced rows, or export the trial again.",
        )
    step = mean_step(time)
    even = time[0] + step * np.arange(len(time))
    drift, off = np.abs(time - even).max(), np.abs(steps - step).max()
    if drift <= ALREADY_EVEN * step:
        return time
    if max(off, drift) > max(1.01 * digit_s if digit_s <= COARSE * step else 0.0, 1e-3 * step):
        row, usual = int(np.argmax(np.abs(steps - np.median(steps)))), np.median(steps)
        raise SamplingError(
            f"{file}: a recording must have a constant rate",
            f"between {place(row)} and {place(row + 1)} the step is {steps[row]:.6g} s (t = {time[row]:.6g} s), the "
            f"usual step is {usual:.6g} s, and times have a resolution of {digit_s:.0e} s",
            "Samples are missing, or times have too few digits. Export the file at one rate and with more digits.",
        )
    # a whole number of samples a second where the digits allow one, else from first to last time
    rate = round(mean_rate(time))
    rounded = time[0] + np.arange(len(time)) / rate if rate > 0 else even
    return rounded if np.abs(time - rounded).max() <= 1.01 * digit_s else even
