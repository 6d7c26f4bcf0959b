"""EMG of eight people under nine settings of an ankle exoskeleton: paired tests by muscle and part of the stride.

    python studies/ankle_exo_emg.py [DATA]

DATA holds the folder ankle_exo_emg_grf; by default ../shared/data/gait, or GAITDISC_DATA/gait. The source does not say
what the settings C1 to C9 are, in which order they were walked, or what the EMG is scaled by. C1 cost the least energy
and C6 the most, so C6 against C1 is tested first; but that choice was made on the same eight people. With n = 8 the
smallest p is 2/256 = 0.0078, so that no family of more than six tests can show anything: gastrocnemius and soleus, with
two electrodes a leg, count as one muscle each, and the family is the six muscles in one part of the stride.
"""

from __future__ import annotations

from command_line import SHARED, argument, command_line

GIVEN = command_line(
    __name__, __doc__, argument("data", "folder that holds ankle_exo_emg_grf", SHARED / "gait")
)  # before the slow imports

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

import gaitdisc as gd

PEOPLE = tuple(f"S{number:02d}" for number in range(1, 9))
SETTINGS = tuple(f"C{number}" for number in range(1, 10))
EASIEST, HARDEST = "C1", "C6"
MUSCLES = {
    "gastrocnemius": ("MGAS", "LGAS"),
    "soleus": ("MSOL", "LSOL"),
    "tibialis anterior": ("TA",),
    "vastus medialis": ("VASM",),
    "rectus femoris": ("RF",),
    "biceps femoris": ("BF",),
}
PARTS = ("early stance", "late stance", "swing")
LOADED = 0.05  # of the largest vertical force: a foot is on the ground
LARGEST_CHANGE = 2.5  # of an electrode's mean over the stride against its median over the settings: beyond it, a fault
LEAST_BURST = 1.5  # largest over smallest value of the curve: below it, nothing but noise


@dataclass(frozen=True, eq=False)
class Walks:
    """Median stride of every person and setting.

    Parameters
    ----------
    curves : mapping of (str, str) to DataFrame (phase bin, signal) [N; EMG of its unknown reference]
        30 bins from right initial contact on.
    energy_w : DataFrame (person, setting) [W]
        Metabolic power as the source has it.
    """

    curves: Mapping[tuple[str, str], pd.DataFrame]
    energy_w: pd.DataFrame
    strides: int


def read_walks(folder: Path) -> Walks:
    """Read the recordings; the median over strides is not moved by the spikes that some strides have."""
    with np.load(folder / "assisted.npz") as stored:
        names = [str(name) for name in stored["signals"]]
        strides = {(p, s): np.asarray(stored[f"x_{p}{s}"], float) for p in PEOPLE for s in SETTINGS}
        power = {s: [float(stored[f"y_{p}{s}"][0].mean()) for p in PEOPLE] for s in SETTINGS}
    curves = {key: pd.DataFrame(np.median(values, axis=0).T, columns=names) for key, values in strides.items()}
    return Walks(curves, pd.DataFrame(power, index=list(PEOPLE)), sum(len(values) for values in strides.values()))


def part_of_stride(force: NDArray[np.float64]) -> NDArray[np.str_]:
    """Part of the stride that each phase bin belongs to, from the leg's own vertical force.

    Parameters
    ----------
    force : ndarray (phase bin,) [N]
        Of one leg over one stride, in a circle; the sign does not matter.
    """
    on_ground = np.abs(force) > LOADED * np.abs(force).max()
    contacts = np.flatnonzero(on_ground & ~np.roll(on_ground, 1))
    lengths = [int(np.argmin(np.roll(on_ground, -start))) or len(force) for start in contacts]
    start, length = max(zip(contacts, lengths, strict=True), key=lambda stance: stance[1])
    parts = np.full(len(force), PARTS[2], dtype="<U12")
    stance = (start + np.arange(length)) % len(force)
    parts[stance[: length // 2]], parts[stance[length // 2 :]] = PARTS[0], PARTS[1]
    return parts


def faulty_electrodes(walks: Walks) -> dict[tuple[str, str], str]:
    """Electrodes (person, signal) that are left out in all settings, with the reason."""
    found = {}
    for person in PEOPLE:
        for name in _electrodes():
            curves = np.column_stack([walks.curves[person, setting][name] for setting in SETTINGS])
            change = curves.mean(axis=0) / np.median(curves.mean(axis=0))
            burst = curves.max(axis=0) / np.abs(curves).min(axis=0)
            worst = int(np.argmax(np.abs(np.log(change))))
            if not 1 / LARGEST_CHANGE < change[worst] < LARGEST_CHANGE:
                found[person, name] = f"{change[worst]:.2g} times its median in {SETTINGS[worst]}"
            elif burst.min() < LEAST_BURST:
                found[person, name] = f"no burst in {SETTINGS[int(np.argmin(burst))]}"
    return found


def log_ratios(walks: Walks, setting: str, part: str, faulty: Mapping[tuple[str, str], str]) -> pd.DataFrame:
    """Logarithm of EMG in a setting over EMG in the easiest, (person, muscle), mean over the electrodes that work.

    A ratio does not depend on the unknown reference, as long as it is the same in all settings of a person.
    """
    table = pd.DataFrame(np.nan, index=list(PEOPLE), columns=list(MUSCLES))
    for person in PEOPLE:
        for muscle, heads in MUSCLES.items():
            electrodes = [name for name in _electrodes(heads) if (person, name) not in faulty]
            levels = [
                [_level(walks.curves[person, word], name, part) for word in (EASIEST, setting)] for name in electrodes
            ]
            if levels:
                table.loc[person, muscle] = float(np.mean([np.log(other / easiest) for easiest, other in levels]))
    return table


def contrast(walks: Walks, setting: str, faulty: Mapping[tuple[str, str], str]) -> pd.DataFrame:
    """Tests of one setting against the easiest, one row a part of the stride and muscle.

    Returns
    -------
    DataFrame
        As `gd.paired_tests` gives it, with part and setting; shift, low and high as change in %.
    """
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


def _electrodes(heads: tuple[str, ...] = tuple(head for muscle in MUSCLES.values() for head in muscle)) -> list[str]:
    return [f"{head}_{side}" for head in heads for side in "RL"]


def _level(curves: pd.DataFrame, name: str, part: str) -> float:
    parts = part_of_stride(curves[f"Fz_{name[-1]}"].to_numpy())
    return float(curves.loc[parts == part, name].mean())


def _hardest_table(tests: pd.DataFrame) -> list[str]:
    lines = [
        "| part | muscle | n | W | p | level | adjusted p | change [%] | 95 % | rank-biserial |",
        "|" + "---|" * 10,
    ]
    for row in tests[tests["setting"] == HARDEST].itertuples():
        mark = "**" if row.different else ""
        lines.append(
            f"| {row.part} | {row.variable} | {row.n} | {row.w:g} | {row.p:.4f} | {row.step_level:.4f} | "
            f"{mark}{row.p_adjusted:.3f}{mark} | {row.shift:+.0f} | {row.low:+.0f} to {row.high:+.0f} | "
            f"{row.rank_biserial:+.2f} |"
        )
    return lines


def _every_table(tests: pd.DataFrame) -> list[str]:
    others = list(dict.fromkeys(tests["setting"]))
    lines = [f"| part | muscle | {' | '.join(others)} |", "|" + "---|" * (2 + len(others))]
    for (part, muscle), rows in tests.groupby(["part", "variable"], sort=False):
        cells = [f"**{r.shift:+.0f}**" if r.different else f"{r.shift:+.0f}" for r in rows.itertuples()]
        lines.append(f"| {part} | {muscle} | {' | '.join(cells)} |")
    return lines


def main() -> None:
    """Print the tables."""
    walks, faulty, tests = run(GIVEN.data)
    least = gd.signed_rank(np.zeros(len(PEOPLE)), np.arange(1.0, len(PEOPLE) + 1)).p
    largest = max(count for count in range(1, 100) if gd.holm_sidak([least] + [1.0] * (count - 1)).rejected[0])
    print(f"{walks.strides} strides; energy [W]: {walks.energy_w.mean().round(0).astype(int).to_dict()}")
    print(f"n = {len(PEOPLE)}: smallest p {least:.4f}, largest family {largest} tests")
    print(f"left out, {len(faulty)} of {len(PEOPLE) * len(_electrodes())} electrodes:")
    print("; ".join(f"{person} {name}: {reason}" for (person, name), reason in faulty.items()))
    print(f"\n{HARDEST} against {EASIEST}:\n\n" + "\n".join(_hardest_table(tests)))
    print(f"\nChange against {EASIEST} [%]:\n\n" + "\n".join(_every_table(tests)))
    print(
        f"\n{int(tests['different'].sum())} of {len(tests)} tests, each family the six muscles of one part and setting"
    )


if __name__ == "__main__":
    main()
