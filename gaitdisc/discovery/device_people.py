"""What a device does over people: effect by effect, who shows it, and how much, with an interval over people."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd

from gaitdisc.discovery.result import Discovery

COLUMNS = ("effect", "place", "number", "unit", "people", "of", "mean", "low", "high", "who")
NOTHING = "nothing named"


def over_people(found: Mapping[str, Discovery]) -> pd.DataFrame:
    """A row a number of each effect: in how many people it was named, mean, Student's 95 % interval (n > 1), who."""
    own: dict[tuple[str, str, str, str], dict[str, float]] = {}
    for person, one in found.items():
        for effect in one.effects:
            for number, each in effect.estimates.items():
                own.setdefault((effect.name, effect.place, number, each.unit), {})[person] = each.value
    rows: list[tuple[object, ...]] = []
    for key, each in own.items():
        largest = sorted(each.items(), key=lambda one: -abs(one[1]))
        who = ", ".join(f"{person} {value:.3g}" for person, value in largest)
        rows.append((*key, len(each), len(found), *_mean(list(each.values())), who))
    without = [person for person, one in found.items() if not one.effects]
    if without:
        rows.append((NOTHING, "", "", "", len(without), len(found), *[float("nan")] * 3, ", ".join(without)))
    table = pd.DataFrame(rows, columns=pd.Index(COLUMNS))
    return table.sort_values("people", ascending=False, kind="stable", ignore_index=True)


def lines(table: pd.DataFrame) -> list[str]:
    """Each row of `over_people` as a line of text."""
    said = []
    for row in table.to_dict("records"):
        what = f"{row['effect']} at {row['place']}, {row['number']}" if row["place"] else row["effect"]
        mean = f", mean {row['mean']:.3g}" if row["place"] else ""
        if np.isfinite(row["low"]):
            mean += f" (95 % {row['low']:.3g} to {row['high']:.3g})"
        said.append(f"{what}: {row['people']} of {row['of']}{mean} {row['unit']}".rstrip() + f": {row['who']}")
    return said


def _mean(values: list[float]) -> tuple[float, float, float]:
    from scipy.stats import t

    mean = float(np.mean(values))
    if len(values) < 2:
        return mean, float("nan"), float("nan")
    half = float(t.ppf(0.975, len(values) - 1) * np.std(values, ddof=1) / np.sqrt(len(values)))
    return mean, mean - half, mean + half
