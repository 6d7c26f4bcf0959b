"""A measured or a simulated recording: channels on one even time base; and what is wrong with one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gaitdisc.channel import Channel, nearest_word
from gaitdisc.errors import ChannelError, SamplingError, ShapeError
from gaitdisc.recording.arrays import Span, Values, mean_rate, mean_step, read_only
from gaitdisc.words import as_html

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

SHOWN = 12  # channels of a notebook's table
SEVERITIES = ("note", "warning", "refused")
STEP_TOLERANCE = 1e-3  # of the mean step; ingest evens out what a file's printed digits round


@dataclass(frozen=True)
class Finding:
    """One observation about a file or a channel.

    Parameters
    ----------
    severity : str
        `note` (nothing is affected), `warning` (some samples or channels are affected), `refused` (the trial is not
        used).
    kind : str
        Kind of the observation in one or two words: `gap`, `dead`, `clipped`, `late change`, ...
    file : str
        Name of the file, or of the trial if there is no file.
    what : str
        The observation, with number and unit.
    spoils : str
        Affected samples, channels or results, and the remedy.
    channel : str
        Name of the channel; empty for the entire file.
    spans : tuple of Span
        Start and end of each affected part [s].

    Examples
    --------
    >>> Finding("warning", "gap", "walk.mot", "0.12 s missing", "accelerations within 0.15 s", "knee_angle_r").line()
    'warning: walk.mot, knee_angle_r: gap: 0.12 s missing; affects accelerations within 0.15 s'
    """

    severity: str
    kind: str
    file: str
    what: str
    spoils: str
    channel: str = ""
    spans: tuple[Span, ...] = ()

    def __post_init__(self) -> None:
        if self.severity not in SEVERITIES:
            raise ValueError(f"severity must be one of {SEVERITIES}, not {self.severity!r}")

    @property
    def rank(self) -> int:
        """Rank of the severity: 0 for `refused`, the most severe."""
        return len(SEVERITIES) - 1 - SEVERITIES.index(self.severity)

    def line(self) -> str:
        """Return the finding as one line of text."""
        where = ", ".join(part for part in (self.file, self.channel) if part)
        spoils = f"; affects {self.spoils}" if self.spoils else ""
        return f"{self.severity}: {where}: {self.kind}: {self.what}{spoils}"


@dataclass(frozen=True)
class Source:
    """Where a recording comes from."""

    file: str = ""  # name of the file without its folder; empty for what the package made itself
    sha256: str = ""  # hash of the file's bytes, 64 hexadecimal digits, or empty
    reader: str = ""  # what read it: `ezc3d 1.7.2`, `mot`, `simulation`


@dataclass(frozen=True, eq=False)
class Recording:
    """Channels that share evenly spaced times. The arrays are read-only, and time is their first axis.

    Parameters
    ----------
    time : ndarray (time,) [s]
        Times, evenly spaced and increasing.
    values : ndarray (time, channel) [each channel's unit]
        Values of the channels; NaN, never 0, where nothing was measured.
    channels : sequence of Channel
        One channel per column, with different names.
    subject, condition : str
        Pseudonym of the person, and the condition, such as `nominal` or `exo`.
    source : Source
        File, hash and reader.
    suspect : ndarray of bool (time, channel), optional
        True for unreliable values (a filled gap, a filter's edge, a plateau).

    Raises
    ------
    ShapeError
        If times, values, channels and marks do not match.
    SamplingError
        If time is not evenly spaced (a step differs from the mean by more than 0.1 %).
    ChannelError
        If two channels have the same name.

    Examples
    --------
    >>> knee = Channel("knee_angle_r", "angle", "deg", "r")
    >>> walk = Recording(np.arange(5) / 100, np.zeros((5, 1)), (knee,))
    >>> walk.rate_hz, walk.names
    (100.0, ('knee_angle_r',))
    """

    time: Values
    values: Values
    channels: tuple[Channel, ...]
    subject: str = ""
    condition: str = ""
    source: Source = field(default_factory=Source)
    suspect: NDArray[np.bool_] = None  # pyright: ignore[reportAssignmentType]  # never none once it is made

    def __post_init__(self) -> None:
        time, values = read_only(self.time), read_only(self.values)
        channels = tuple(self.channels)
        strange = next((channel for channel in channels if not isinstance(channel, Channel)), None)
        if strange is not None:
            raise ChannelError(
                "each channel of a recording must be a gaitdisc.Channel with name, quantity and unit",
                f"found {strange!r}",
                'Write Channel("knee_angle_r", "angle", "deg", "r"), or read a DataFrame with gaitdisc.read.',
            )
        if time.ndim != 1 or values.shape != (len(time), len(channels)):
            raise ShapeError(
                "a recording must have values of shape (time, channel)",
                f"the values have shape {values.shape}, for {len(time)} times and {len(channels)} channels",
                "Put time first, with one column per channel.",
            )
        suspect = np.zeros(values.shape, bool) if self.suspect is None else self.suspect
        if np.shape(suspect) != values.shape:
            raise ShapeError(
                "the marks of suspect samples must have the shape of the values",
                f"the marks have shape {np.shape(suspect)}, the values {values.shape}",
                "Give one mark per sample and channel.",
            )
        names = [channel.name for channel in channels]
        doubled = len({*names}) < len(names) and sorted({name for name in names if names.count(name) > 1})
        if doubled:
            raise ChannelError(
                "each channel must have its own name",
                f"{self.source.file or 'the recording'} contains {doubled[0]!r} {names.count(doubled[0])} times",
                "Give the columns different names in the study's [channels].",
            )
        if len(time) > 1:
            steps, mean = np.diff(time), mean_step(time)
            worst = int(np.argmax(np.abs(steps - mean)))
            if not (mean > 0 and abs(steps[worst] - mean) <= STEP_TOLERANCE * mean):  # also where a time is NaN
                file = self.source.file or "the recording"
                raise SamplingError(
                    "a recording must have a constant sampling rate",
                    f"{file} has a step of {steps[worst]:.6g} s after sample {worst} (t = {time[worst]:.6g} s); the "
                    f"mean step is {mean:.6g} s",
                    "Export it at one rate, or resample it before reading.",
                )
        checked = {"time": time, "values": values, "channels": channels, "suspect": read_only(suspect, bool)}
        for name, value in checked.items():
            object.__setattr__(self, name, value)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the channels, in order."""
        return tuple([channel.name for channel in self.channels])  # faster than of a generator

    @property
    def rate_hz(self) -> float:
        """Sampling rate [Hz]; NaN for fewer than two samples."""
        return float(round(mean_rate(self.time), 6)) if len(self.time) > 1 else float("nan")

    @property
    def duration_s(self) -> float:
        """Duration [s], including the step after the last sample."""
        return len(self.time) / self.rate_hz if len(self.time) > 1 else 0.0

    def index(self, name: str) -> int:
        """Return the column of a channel.

        Parameters
        ----------
        name : str
            Name of the channel.

        Raises
        ------
        ChannelError
            If no channel has this name; the message gives the nearest name.
        """
        if not isinstance(name, str):
            raise ChannelError(
                "a channel must be selected by its name",
                f"found {type(name).__name__} {str(name)[:60]}",
                "Use the channel's name. For several channels use recording.selected([...]); for a period of time "
                "use recording.between(...).",
            )
        if name not in (names := self.names):
            axes = [label for label in names if label.rpartition(".")[0] == name]
            nearest = None if axes else nearest_word(name, names)
            there = f"{', '.join(names[:SHOWN])}{', ...' * (len(names) > SHOWN)}" or "none"
            hint = f"the marker is {', '.join(axes)}" if axes else f"the nearest is {nearest!r}" if nearest else there
            raise ChannelError(
                f"channel {name!r} is required",
                f"{self.source.file or 'the recording'} has {len(names)} channels: {hint}",
                "Use one of these, or map the column in the study's [channels] or in read(..., channels=...).",
            )
        return names.index(name)

    def __getitem__(self, name: str) -> Values:
        return self.values[:, self.index(name)]

    def __contains__(self, name: object) -> bool:
        return name in self.names

    def selected(self, names: Sequence[str]) -> Recording:
        """Recording of some channels, in the order requested.

        Parameters
        ----------
        names : sequence of str, or str
            Names of the channels, or one name.
        """
        columns = [self.index(name) for name in several(names)]
        return replace(
            self,
            values=self.values[:, columns],
            channels=tuple(self.channels[column] for column in columns),
            suspect=self.suspect[:, columns],
        )

    def selected_by(self, wanted: Callable[[Channel], bool]) -> Recording:
        """Recording of the channels for which a condition holds.

        Parameters
        ----------
        wanted : callable
            Function of a Channel that returns True or False.
        """
        return self.selected([channel.name for channel in self.channels if wanted(channel)])

    def between(self, start_s: float, end_s: float) -> Recording:
        """Recording of the samples with start_s <= time < end_s.

        Parameters
        ----------
        start_s, end_s : float
            Start and end on the recording's own clock [s].
        """
        first, last = np.searchsorted(self.time, [start_s - 1e-9, end_s - 1e-9])
        rows = slice(int(first), int(last))
        return replace(self, time=self.time[rows], values=self.values[rows], suspect=self.suspect[rows])

    def with_values(self, values: Values, suspect: NDArray[np.bool_] | None = None) -> Recording:
        """Recording with other values on the same time base and channels.

        Parameters
        ----------
        values : ndarray (time, channel)
            New values.
        suspect : ndarray of bool (time, channel), optional
            Marks that are added to the existing ones.
        """
        marks = self.suspect if suspect is None else self.suspect | suspect
        return replace(self, values=values, suspect=marks)

    def __repr__(self) -> str:
        names = ", ".join(self.names[:4]) + (", ..." if len(self.names) > 4 else "")
        span = f"{len(self.time)} samples" + (f" at {self.rate_hz:g} Hz" if len(self.time) > 1 else "")
        return f"Recording({len(self.names)} channels ({names}), {span})"

    def _repr_html_(self) -> str:
        rows = [("subject, condition", ", ".join(word for word in (self.subject, self.condition) if word))]
        if len(self.time) > 1:
            span = f"{self.time[0]:.3f} to {self.time[-1]:.3f} s, {len(self.time)} samples at {self.rate_hz:g} Hz"
            rows.append(("time", span))
        rows.append(("file", self.source.file))
        for column, channel in enumerate(self.channels[:SHOWN]):
            known = self.values[np.isfinite(self.values[:, column]), column]
            text = f"{known.min():.4g} to {known.max():.4g}" if len(known) else "no value"
            rows.append((channel.name, f"{text} [{channel.unit}]"))
        if len(self.channels) > SHOWN:
            rows.append((f"and {len(self.channels) - SHOWN} more", ""))
        return as_html("Recording", [row for row in rows if row[1] or row[0].startswith("and ")])

    def to_pandas(self, units: bool = False) -> pd.DataFrame:
        """Table with one column per channel, indexed by time [s]; `attrs["units"]` has the units.

        Parameters
        ----------
        units : bool
            Whether columns are called `name [unit]`; `gaitdisc.read` can read such a table or its CSV file.
        """
        import pandas as pd

        names = [f"{channel.name} [{channel.unit}]" if units else channel.name for channel in self.channels]
        table = pd.DataFrame(self.values, pd.Index(self.time, name="time"), names, copy=True)  # a user edits it
        table.attrs["units"] = {name: c.unit for name, c in zip(names, self.channels, strict=True)} | {"time": "s"}
        return table

    def to_xarray(self) -> xr.DataArray:
        """Labelled array (time, channel) with the units as a coordinate; requires xarray."""
        import xarray as xr

        units = ("channel", [channel.unit for channel in self.channels])
        coordinates: dict[str, Any] = {"time": self.time, "channel": list(self.names)}
        return xr.DataArray(
            np.array(self.values),
            coords={**coordinates, "unit": units},
            dims=("time", "channel"),
            attrs={"subject": self.subject, "condition": self.condition},
        )


def join_recordings(first: Recording, *others: Recording) -> Recording:
    """Channels of recordings that share one time base; subject, condition and source are the first one's."""
    recordings = (first, *others)
    return replace(
        first,
        values=np.hstack([recording.values for recording in recordings]),
        channels=tuple(channel for recording in recordings for channel in recording.channels),
        suspect=np.hstack([recording.suspect for recording in recordings]),
    )


def several(names: str | Sequence[str]) -> tuple[str, ...]:
    """Names of which one may be given by itself: a string is one name, and no sequence of letters."""
    return (names,) if isinstance(names, str) else tuple(names)
