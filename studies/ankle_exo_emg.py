"""EMG of eight people under nine settings of an ankle exoskeleton: paired tests by muscle and part of the stride.

    python studies/ankle_exo_emg.py [DATA]

The source does not say what the settings C1 to C9 are, in which order they were walked, or what the EMG is scaled by.
C1 cost the least energy and C6 the most, so C6 against C1 is tested first;
"""

from __future__ import annotations

from command_line import GAIT, command_line

GIVEN = command_line(__name__, __doc__, GAIT)  # before the slow imports

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pandas as pd
from ankle_exo_walks import (
    MUSCLES,
    PARTS,
    PEOPLE,
    SETTINGS,
    Walks,
    electrodes_of,
    faulty_electrodes,
    part_of_stride,
    read_walks,
)
from markdown_table import markdown_table

import gaitdisc as gd

EASIEST, HARDEST = "C1", "C6"


def log_ratios(walks: Walks, setting: str, part: str, faulty: Mapping[tuple[str, str], str]) -> pd.DataFrame:
    """Logarithm of EMG in a setting over EMG in the easiest, (person, muscle), mean over the electrodes that work.

    A ratio does not depend on the unknown reference, as long as it is the same in all settings of a person.
    """
    table = pd.DataFrame(np.nan, index=list(PEOPLE), columns=list(MUSCLES))
    for person in PEOPLE:
        for muscle, heads in MUSCLES.items():
            electrodes = [name for name in electrodes_of(heads) if (person, name) not in faulty]
            both = [walks.curves[person, word] for word in (EASIEST, setting)]
            levels = [
                [one.loc[part_of_stride(one[f"Fz_{name[-1]}"].to_numpy()) == part, name].mean() for one in both]
                for name in electrodes
            ]
            if levels:
                table.loc[person, muscle] = float(np.mean([np.log(other / easiest) for easiest, other in levels]))
    return table


def contrast(walks: Walks, setting: str, faulty: Mapping[tuple[str, str], str]) -> pd.DataFrame:
    """Tests of one setting against the easiest, a row a part of the stride and muscle; shift, low and high in %."""
    tables = []
    for part in PARTS:
        ratios = log_ratios(walks, setting, part, faulty)
        tables.append(gd.paired_tests(ratios * 0, ratios).assign(part=part, setting=setting))
    table = pd.concat(tables, ignore_index=True)
    table[["shift", "low", "high"]] = 100 * np.expm1(table[["shift", "low", "high"]])
    return table


def run(data: Path) -> tuple[Walks, dict[tuple[str, str], str], pd.DataFrame]:
    """Recordings, faulty electrodes, and the tests of every setting against the easiest."""
    walks = read_walks(data / "ankle_exo_emg_grf")
    faulty = faulty_electrodes(walks)
    others = [setting for setting in SETTINGS if setting != EASIEST]
    return walks, faulty, pd.concat([contrast(walks, setting, faulty) for setting in others], ignore_index=True)


def _hardest_table(tests: pd.DataFrame) -> str:
    rows = []
    for row in tests[tests["setting"] == HARDEST].itertuples():
        mark = "**" if row.different else ""
        test = (row.n, f"{row.w:g}", f"{row.p:.4f}", f"{row.step_level:.4f}", f"{mark}{row.p_adjusted:.3f}{mark}")
        size = (f"{row.shift:+.0f}", f"{row.low:+.0f} to {row.high:+.0f}", f"{row.rank_biserial:+.2f}")
        rows.append((row.part, row.variable, *test, *size))
    return markdown_table("part | muscle | n | W | p | level | adjusted p | change [%] | 95 % | rank-biserial", rows)


if __name__ == "__main__":
    walks, faulty, tests = run(GIVEN.data)
    least = gd.signed_rank(np.zeros(len(PEOPLE)), np.arange(1.0, len(PEOPLE) + 1)).p
    largest = max(count for count in range(1, 100) if gd.holm_sidak([least] + [1.0] * (count - 1)).rejected[0])
    print(f"{walks.strides} strides; energy [W]: {walks.energy_w.mean().round(0).astype(int).to_dict()}")
    print(f"n = {len(PEOPLE)}: smallest p {least:.4f}, largest family {largest} tests")
    print(f"left out, {len(faulty)} of {len(PEOPLE) * len(electrodes_of())} electrodes:")
    print("; ".join(f"{person} {name}: {reason}" for (person, name), reason in faulty.items()))
    print(f"\n{HARDEST} against {EASIEST}:\n\n" + _hardest_table(tests))
    found = []
    for (part, muscle), rows in tests.groupby(["part", "variable"], sort=False):
        cells = [f"**{r.shift:+.0f}**" if r.different else f"{r.shift:+.0f}" for r in rows.itertuples()]
        found.append((part, muscle, *cells))
    heads = " | ".join(["part", "muscle", *dict.fromkeys(tests["setting"])])
    print(f"\nChange against {EASIEST} [%]:\n\n" + markdown_table(heads, found))
    different = f"{int(tests['different'].sum())} of {len(tests)} tests"
    print(f"\n{different}, each family the six muscles of one part and setting")
