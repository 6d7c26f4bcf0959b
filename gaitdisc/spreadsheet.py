"""Tables as CSV that a spreadsheet shows as they are: text that it would take for a formula begins with an apostrophe.

A channel named `=HYPERLINK(...)` would be computed by the program that opens the table (OWASP: CSV injection). Numbers
stay numbers: -0.5 is no formula.
"""

from __future__ import annotations

import csv
import itertools
import math
import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from gaitdisc.whole_file import whole_file

if TYPE_CHECKING:
    import pandas as pd

# apostrophes in front are counted, so that one can be taken off again
_FORMULA = re.compile(r"'*[=+\-@\t\r\n＝＋－＠]")
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
_NUMBERS = "biufcmM"  # kinds of a numpy column that hold no text
_OTHER_SEPARATORS = re.compile(r"[;\t\r]")  # of cells in another language, of rows on another system


def quote(text: str) -> str:
    """Text of a cell or heading, with an apostrophe in front where a spreadsheet would take it for a formula.

    >>> quote("=1+1"), quote("knee_angle_r"), quote("-0.5"), quote("-x")
    ("'=1+1", 'knee_angle_r', '-0.5', "'-x")
    """
    return f"'{text}" if _FORMULA.match(text) and not _NUMBER.fullmatch(text) else text


def unquote(text: str) -> str:
    """Text as it was before `quote`.

    >>> unquote("'=1+1"), unquote("it's"), unquote(quote("'=1"))
    ('=1+1', "it's", "'=1")
    """
    return text[1:] if text.startswith("'") and _FORMULA.match(text[1:]) else text


def write_csv(
    table: pd.DataFrame, path: Path, float_format: str | None = None, rest: Iterable[pd.DataFrame] = ()
) -> None:
    """Write a table without its index as CSV, whole or not at all.

    float_format: of every number; by default as many digits as it takes to read the same number again
    rest: further rows, tables of the same columns, of which one at a time is held
    """
    heads = [quote(str(name)) for name in table.columns]
    with whole_file(path) as part, part.open("w", encoding="utf-8", newline="") as file:
        for number, rows in enumerate(itertools.chain([table], rest)):
            words = set(heads)
            cells = [_cells(column, float_format, words) for _, column in rows.items()]
            other = any(map(_OTHER_SEPARATORS.search, words))
            writer = csv.writer(file, quoting=csv.QUOTE_NONNUMERIC if other else csv.QUOTE_MINIMAL, lineterminator="\n")
            writer.writerows([heads][number:])
            writer.writerows(zip(*cells, strict=True))


def _cells(column: pd.Series, float_format: str | None, words: set[str]) -> Sequence[object]:
    """Cells of a column, of which none is a formula, as they are written; its words are added to those of the table."""
    import pandas as pd

    if column.dtype.kind == "f":  # a fifth of the time that pandas takes
        return ["" if math.isnan(cell) else float_format % cell if float_format else cell for cell in column.to_numpy()]
    if column.dtype.kind in _NUMBERS:
        return column.tolist()
    codes, known = pd.factorize(column)  # a million cells hold some hundred words
    if all(isinstance(cell, str) for cell in known):
        cells = [*map(quote, known), ""]
        words.update(cells)
        return [cells[code] for code in codes]
    cells = [quote(cell) if isinstance(cell, str) else "" if pd.isna(cell) else cell for cell in column]
    words.update(cell for cell in cells if isinstance(cell, str))
    return cells


def read_csv(path: Path, words: Sequence[str] = (), skiprows: int = 0) -> pd.DataFrame:
    """Read a table that `write_csv` wrote; an empty cell is a missing number.

    words: columns whose cells are words, also where they look like numbers: a participant called 007
    skiprows: lines before the header
    """
    import pandas as pd

    read = {"engine": "python", "keep_default_na": False, "na_values": [""], "skiprows": skiprows}
    table = texts = pd.read_csv(path, dtype=dict.fromkeys(words, str), **read)
    if tuple(map(int, pd.__version__.split(".")[:2])) < (3, 1):  # which reads 0.3 as 0.30000000000000004
        texts = pd.read_csv(path, dtype=str, **read)
    for place in range(len(table.columns)):
        if table.dtypes.iloc[place].kind not in _NUMBERS:
            plain = table.iloc[:, place].map(lambda cell: unquote(cell) if isinstance(cell, str) else cell)
            table.isetitem(place, plain.to_numpy())
        elif texts is not table and table.dtypes.iloc[place].kind == "f":
            table.isetitem(place, texts.iloc[:, place].to_numpy(object).astype(float))
    return table.rename(columns=unquote)
