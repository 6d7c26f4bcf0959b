"""Where two walks disagree: the gap over the stride of every channel, and where it is more than chance."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from gaitdisc.channel import Channel
from gaitdisc.errors import SchemaError, ShapeError
from gaitdisc.recording import PERCENT, Finding
from gaitdisc.recording.arrays import Values, read_only
from gaitdisc.saved.kind import CSV, Kind, Saved
from gaitdisc.saved.provenance import Provenance
from gaitdisc.words import as_html

AGAIN = "Compare the walks again: `gaitdisc compare`."
CURVES = ("first", "second", "sd_first", "sd_second", "gap", "low", "high", "t")
REGION_COLUMNS = ("channel", "unit", "from_percent", "to_percent", "gap", "at_percent", "gap_sd", "mean_gap", "p")
CHANNEL_COLUMNS = (
    "channel", "unit", "differs", "largest_gap", "at_percent", "gap_sd", "rms_gap", "rms_sd", "p", "within", "visible",
    "shift_percent", "rms_shifted", "limit", "offset", "shape", "too_small",
)  # fmt: skip


@dataclass(frozen=True)
class Exchange:
    """What was exchanged in the permutation test, and how often."""

    unit: str
    first: int  # units of the first walk; 1 for one taken as a curve without spread of its own
    second: int  # units of the second, alike
    strides_first: int  # strides that the units of the first hold
    strides_second: int  # strides that the units of the second hold
    permutations: int
    exact: bool  # whether these are all that there are
    threshold: float  # |t| that only `alpha` of them exceed anywhere in the stride and in any channel
    alpha: float  # of the whole family of points and channels


@dataclass(frozen=True)
class Alignment:
    """Shift along the stride that the channels of two walks have in common."""

    percent: float = 0.0  # by how much later all of the first walk's curves together fit best [% stride]
    applied: bool = False  # whether they were moved by it before anything was tested
    agreeing: int = 0  # channels whose gap narrows by it
    channels: int = 0  # all channels
    # largest gap of each channel the other way [its unit]: without the shift where it was applied, else with it
    otherwise: Sequence[float] = ()


@dataclass(frozen=True)
class Smallest:
    """Smallest difference that is named: less matters to nobody, however sure it is.

    >>> Smallest().of("deg", 60.0), Smallest(body_weight_n=700.0).of("N", 800.0), Smallest().of("N", 800.0)
    (2.0, 35.0, 40.0)
    """

    angle_deg: float = 2.0  # of an angle [deg]
    moment_n_m_per_kg: float = 0.1  # of a moment per body mass [N m/kg]
    # of body weight for a force where the weight is known; else, and for every other unit, of the range of the second
    # walk's mean curve
    share: float = 0.05
    body_weight_n: float | None = None  # mass x 9.81 [N]

    def of(self, unit: str, reach: float) -> float:
        """Smallest difference named of one channel, in its unit, by the range of its mean curve."""
        if unit == "deg":
            return self.angle_deg
        if unit == "N m/kg":
            return self.moment_n_m_per_kg
        return self.share * (self.body_weight_n if unit == "N" and self.body_weight_n else reach)


@dataclass(frozen=True, eq=False)
class Mismatch(Saved, file="mismatch.json"):
    """Difference of two walks over the stride, second minus first.

    Parameters
    ----------
    first, second : str
        Names of the two walks. The second is the reference: gaps are related to the SD of its strides.
    channels : tuple of Channel
        Channels that both walks have.
    curves : mapping of str to ndarray (phase, channel) [channel's unit]
        `first`, `second`: mean curves. `sd_first`, `sd_second`: standard deviations over strides; NaN for a single
        stride. `gap`: second minus first, with the limits `low` and `high` of its 1 - alpha band for all points and
        channels together. `t`: the test statistic [1].
    regions : DataFrame
        One row per region of the stride with a significant gap, columns `REGION_COLUMNS`: largest gap, its place, its
        size in stride-to-stride standard deviations of the second walk; mean gap; corrected p of the cluster.
    summary : DataFrame
        One row per channel, columns `CHANNEL_COLUMNS`: whether it differs; largest gap and its place; rms over the
        stride of the gap and of the second walk's SD; p of the largest |t|, corrected; `within`, the largest gap that
        the band allows; `visible`, the gap that is detected with a power of 80 %; `shift_percent`, the best-fitting
        delay of the first walk's curve, and `rms_shifted`, the rms gap after this shift; `limit`, the smallest
        difference that is reported; `offset`, the mean gap over the stride, and `shape`, the largest gap without the
        offset; `too_small`, whether the gap is significant but smaller than `limit`.
    exchange : Exchange
        Exchanged units (such as strides) and permutations of the test.
    findings : tuple of Finding
        Findings in both walks, and channels that could not be compared.
    provenance : Provenance
        Settings, seed, files.
    alignment : Alignment
        Shift that all channels have in common; if it was applied, all other fields refer to the shifted curves.

    Raises
    ------
    ShapeError
        If a curve is missing or its shape is not (phase, channel).
    SchemaError
        If a table lacks a column.
    """

    first: str
    second: str
    channels: tuple[Channel, ...]
    curves: Mapping[str, Values]
    regions: pd.DataFrame
    summary: pd.DataFrame
    exchange: Exchange
    findings: tuple[Finding, ...]
    provenance: Provenance
    alignment: Alignment = Alignment()

    def __post_init__(self) -> None:
        """Check shapes and columns once."""
        wanted = (len(PERCENT), len(self.channels))
        for name in CURVES:
            shape = np.shape(self.curves[name]) if name in self.curves else "none"
            if shape != wanted:
                raise ShapeError(f"{name!r} of a mismatch must have shape {wanted}", f"found {shape}", AGAIN)
        for name, columns in (("regions", REGION_COLUMNS), ("summary", CHANNEL_COLUMNS)):
            if missing := [column for column in columns if column not in getattr(self, name)]:
                needed = f"a mismatch must have the columns {', '.join(columns)} in {name}"
                raise SchemaError(needed, f"{name} lacks {', '.join(missing)}", AGAIN)
        curves = {name: np.asarray(self.curves[name], float) for name in CURVES}
        if np.nansum(curves["gap"] * (curves["second"] - curves["first"])) < 0:  # saved as first minus second
            curves |= {"gap": -curves["gap"], "t": -curves["t"], "low": -curves["high"], "high": -curves["low"]}
            for name, table in (("regions", self.regions), ("summary", self.summary)):
                turned = [
                    column for column in ("gap", "largest_gap", "gap_sd", "mean_gap", "offset") if column in table
                ]
                object.__setattr__(self, name, table.assign(**{column: -table[column] for column in turned}))
        object.__setattr__(self, "curves", {name: read_only(values) for name, values in curves.items()})

    def to_frame(self) -> pd.DataFrame:
        """Curves and gap of every channel, one row per channel and percent of the stride."""
        tables = [self.curve_table(name).assign(channel=name) for name in self.names]
        return pd.concat(tables, ignore_index=True)

    def _repr_html_(self) -> str:
        rows = [("second minus first", f"{self.second} minus {self.first}"), ("channels", str(len(self.names)))]
        rows += [
            (f"RMS gap of {channel.name}", f"{self.rmse[channel.name]:.3g} {channel.unit}") for channel in self.channels
        ]
        return as_html("Mismatch", [*rows, ("regions beyond chance", str(len(self.regions)))])

    def __repr__(self) -> str:
        return f"Mismatch({self.second} minus {self.first}: {len(self.names)} channels, {len(self.regions)} regions)"

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the channels, in order."""
        return tuple(channel.name for channel in self.channels)

    @property
    def rmse(self) -> dict[str, float]:
        """Root mean square over the stride of the gap between the mean curves [each channel's unit]."""
        return {name: float(self.summary_of(name)["rms_gap"]) for name in self.names}

    def curve_table(self, name: str) -> pd.DataFrame:
        """All curves of one channel, one row per percent of the stride.

        Parameters
        ----------
        name : str
            Name of the channel.
        """
        column = self.names.index(name)
        table = pd.DataFrame({key: self.curves[key][:, column] for key in CURVES})
        table.insert(0, "percent", PERCENT)
        table["differs"] = False
        unit = self.channels[column].unit
        table.attrs["units"] = {key: "1" if key == "t" else unit for key in CURVES} | {"percent": "%"}
        for row in self.regions_of(name):
            table["differs"] |= table["percent"].between(row["from_percent"], row["to_percent"])
        return table

    def ordered(self) -> list[str]:
        """Names of the channels that differ, sorted by the gap as a multiple of the smallest reported difference."""
        differing = self.summary[self.summary["differs"].astype(bool)]
        reaches = dict(zip(self.names, np.ptp(self.curves["second"], axis=0), strict=True))
        size = {
            name: abs(row["largest_gap"]) / (row["limit"] or Smallest().of(row["unit"], reaches[name]) or 1.0)
            for row in _records(differing)
            for name in [str(row["channel"])]
        }
        return sorted(size, key=lambda name: -size[name])

    def regions_of(self, name: str) -> list[dict[str, Any]]:
        """Rows of `regions` for one channel, in order of the stride.

        Parameters
        ----------
        name : str
            Name of the channel.
        """
        return _records(self.regions[self.regions["channel"] == name])

    def summary_of(self, name: str) -> dict[str, Any]:
        """Row of `summary` for one channel.

        Parameters
        ----------
        name : str
            Name of the channel.
        """
        return _records(self.summary[self.summary["channel"] == name])[0]


def _records(table: pd.DataFrame) -> list[dict[str, Any]]:
    return [{str(key): value for key, value in row.items()} for row in table.to_dict("records")]


MISMATCH = Kind(
    Mismatch,
    "mismatch.json",
    ("first", "second", "channels", "exchange", "alignment", "findings", "provenance"),
    {"regions": CSV("regions.csv", REGION_COLUMNS, True), "summary": CSV("summary.csv", CHANNEL_COLUMNS, True)},
    {"curves": dict},
    lambda mismatch: dict(mismatch.curves),
    later=False,
    keyed=False,
    page="gaitdisc.comparison.page:write_mismatch_report",
)
