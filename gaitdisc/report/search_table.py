"""How many sensors are enough, and which: the best set of every size, with what the search cost."""

from __future__ import annotations

import pandas as pd

from gaitdisc.report.table import Table
from gaitdisc.report.wording import counted, label, listed, number
from gaitdisc.results.reconstruction import WORTH, enough_sensors


def search_table(found: pd.DataFrame) -> Table:
    """Best set of every size.

    found: `search` of a reconstruction
    """
    chosen = enough_sensors(found)
    rows = tuple(
        (
            f"{row['sensors']}{' *' if k == chosen else ''}",
            listed([label(name) for name in str(row["names"]).split(", ")]),
            number(float(row["loss"]) ** 0.5, 3),
            number(float(row["rmse_deg"]), 2),
            str(row["fits"]),
            f"{row['seconds']:.1f}",
        )
        for k, row in found.reset_index(drop=True).iterrows()
    )
    caption = (
        "Best set of sensors of every size, by ridge regression on their history, all participants together: all sets "
        "of up to three, then the sensor that helps most. Chosen by the RMSE of all angles on the checked windows, "
        "sensors counted as exact; beside it that of the angles that no sensor measures, on the test windows. * the "
        f"smallest set that one more sensor improves by less than {100 * WORTH:.0f} %; without one, the largest."
    )
    columns = ("sensors", "which", "all angles [deg]", "not measured [deg]", "regressions", "processor time [s]")
    return Table("search", caption, columns, rows, found)


def search_sentences(found: pd.DataFrame) -> list[str]:
    """How many sensors are enough, and what one more would bring.

    found: `search` of a reconstruction
    """
    chosen = enough_sensors(found)
    row = found.iloc[chosen]
    names = listed([label(name) for name in str(row["names"]).split(", ")])
    size = int(row["sensors"])
    if chosen + 1 < len(found):
        less = 1 - (float(found["loss"].iloc[chosen + 1]) / float(row["loss"])) ** 0.5
        said = f"{counted(size, 'sensor').capitalize()} {'is' if size == 1 else 'are'} enough: {names}; one more "
        said += f"takes {100 * less:.0f} % off the error of all angles"
    else:
        said = (
            f"The best set of {counted(size, 'sensor')} is {names}; whether it is enough is not known, no larger one "
        )
        said += "was tried"
    cost = f"{counted(int(found['fits'].sum()), 'regression')}, {found['seconds'].sum():.1f} s"
    return [f"{said} (search: {cost})."]
