"""A trial: everything recorded of one person during one walk, each stream on its own time base."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from gaitdisc.errors import ChannelError, SamplingError, ShapeError, UnitError
from gaitdisc.recording.arrays import Values, freeze, frozen
from gaitdisc.recording.recording import Finding, Recording, join_recordings
from gaitdisc.recording.strides import interpolate
from gaitdisc.recording.wrapping import unwrap, wrap_recording
from gaitdisc.words import as_html


class Limits(NamedTuple):
    """Least and largest value that something can have."""

    least: float
    most: float
    unit: str

    def hold(self, value: float) -> bool:
        """Whether a value is possible; NaN is not."""
        return self.least <= value <= self.most

    def check(self, name: str, value: float | None) -> None:
        """Refuse a value that no person has."""
        if value is not None and not self.hold(value):
            raise UnitError(
                f"a person's {name} must be between {self.least:g} and {self.most:g} {self.unit}",
                f"found {value:g} {self.unit}",
                f"Give it in {self.unit}.",
            )


LENGTHS_M = {
    "height_m": Limits(0.4, 2.5, "m"),
    "inter_asis_m": Limits(0.08, 0.45, "m"),
    "marker_diameter_m": Limits(0.002, 0.04, "m"),
    "leg_length_m": Limits(0.2, 1.4, "m"),
    "knee_width_m": Limits(0.03, 0.25, "m"),
    "ankle_width_m": Limits(0.02, 0.15, "m"),
}
MASS_KG, AGE_YEARS = Limits(5.0, 300.0, "kg"), Limits(1, 120, "years")
LEG_OF_STATURE = 0.530  # greater trochanter over ground, Winter (2009), figure 4.1


@dataclass(frozen=True)
class BodyMeasures:
    """Mass and lengths of a person; None or absent where nobody measured.

    >>> BodyMeasures(mass_kg=60.3, knee_width_m={"l": 0.124, "r": 0.121}).knee_width_m["l"]
    0.124
    """

    mass_kg: float | None = None  # body mass [kg]
    height_m: float | None = None  # stature [m]
    inter_asis_m: float | None = None  # distance between the anterior superior iliac spines [m]
    marker_diameter_m: float | None = None  # of the markers that were used [m]
    # side (`l`, `r`) to leg length from spine to medial malleolus, width of the knee between its condyles, width of the
    # ankle between its malleoli [m]
    leg_length_m: Mapping[str, float] = field(default_factory=dict)
    knee_width_m: Mapping[str, float] = field(default_factory=dict)
    ankle_width_m: Mapping[str, float] = field(default_factory=dict)

    @property
    def leg_m(self) -> float | None:
        """Mean leg length [m], by stature where nobody measured a leg; None without either.

        >>> round(BodyMeasures(height_m=1.7).leg_m, 3), BodyMeasures().leg_m
        (0.901, None)
        """
        lengths = list(self.leg_length_m.values())
        if lengths:
            return sum(lengths) / len(lengths)
        return None if self.height_m is None else LEG_OF_STATURE * self.height_m

    def __post_init__(self) -> None:
        for name, limits in {"mass_kg": MASS_KG, **LENGTHS_M}.items():
            value = getattr(self, name)
            if isinstance(value, Mapping):
                for side, length in value.items():
                    limits.check(f"{name} of side {side!r}", length)
                object.__setattr__(self, name, frozen(value))
            else:
                limits.check(name, value)


SHOWN = 6  # findings of a notebook's table
STREAMS = ("kinematics", "markers", "segments", "emg", "forces", "moments", "signals")


@dataclass(frozen=True, eq=False)
class Surface:
    """A force plate or a belt, a rectangle that a foot can step on, in the laboratory's frame.

    >>> plate = Surface("plate_1", np.array([[0.0, 0, 0], [0.4, 0, 0], [0.4, 0.6, 0], [0, 0.6, 0]]))
    >>> plate.outside(np.array([[0.1, 0.1, 0.05], [0.5, 0.3, 0.0]])).round(9).tolist()
    [-0.1, 0.1]
    """

    name: str  # first part of its channels' names: `plate_1`
    corners: Values  # (4, 3) [m], in order around it

    def __post_init__(self) -> None:
        freeze(self, "corners")
        corners = self.corners
        sound = corners.shape == (4, 3) and np.isfinite(corners).all()
        if not sound or np.linalg.norm(np.cross(corners[2] - corners[0], corners[3] - corners[1])) < 1e-6:
            raise ShapeError(
                "the four corners (4, 3) of a force plate must span an area",
                f"{self.name} has {np.array2string(corners, precision=3)}",
                "Correct FORCE_PLATFORM:CORNERS.",
            )

    @property
    def centre(self) -> Values:
        """Its middle, (3,) [m]."""
        return self.corners.mean(axis=0)

    @property
    def normal(self) -> Values:
        """Unit vector at right angles to it, (3,), to one side or the other."""
        across = np.cross(self.corners[2] - self.corners[0], self.corners[3] - self.corners[1])
        return across / np.linalg.norm(across)

    def outside(self, points: Values) -> Values:
        """How far points lie beyond the nearest edge, seen along the normal, (point,) [m]; negative inside.

        points (point, 3) [m]: in the laboratory's frame
        """
        towards = np.roll(self.corners, -1, axis=0) - self.corners
        outwards = np.cross(towards, self.normal)
        outwards /= np.linalg.norm(outwards, axis=1, keepdims=True)
        outwards *= np.sign(np.einsum("ex,ex->e", outwards, self.corners - self.centre))[:, None]
        return np.einsum("pex,ex->pe", points[:, None] - self.corners, outwards).max(axis=1)


@dataclass(frozen=True)
class Event:
    """A gait event that the trial's file contains.

    Parameters
    ----------
    label : str
        `initial contact` or `foot off`; other events keep their own label.
    side : str
        `r`, `l` or empty.
    time : float
        Time on the trial's clock, as in the recordings [s].
    """

    label: str
    side: str
    time: float


@dataclass(frozen=True, eq=False)
class Trial:
    """The streams of one walk, on one clock.

    Parameters
    ----------
    name : str
        Name of the file without its ending, or the trial's name in the study.
    streams : mapping of str to Recording
        Keys among `STREAMS`: `kinematics` (joint angles, pelvis translations), `markers`, `segments` (poses from a
        markerless system), `emg`, `forces` (ground reactions), `moments` (joint moments and powers), `signals` (all
        other digitised channels).
    events : tuple of Event
        Events of the file, in chronological order.
    findings : tuple of Finding
        Findings of the reader.
    subject, condition : str
        Pseudonym and condition.
    surfaces : tuple of Surface
        Positions of the force plates or belts of `forces`, if the file contains them.

    Raises
    ------
    ChannelError
        If a stream has a key that is not among `STREAMS`.

    Examples
    --------
    >>> Trial("walk", {}).name
    'walk'
    """

    name: str
    streams: Mapping[str, Recording]
    events: tuple[Event, ...] = ()
    findings: tuple[Finding, ...] = ()
    subject: str = ""
    condition: str = ""
    surfaces: tuple[Surface, ...] = ()

    def __post_init__(self) -> None:
        unknown = set(self.streams) - set(STREAMS)
        if unknown:
            raise ChannelError(
                f"the streams of a trial must be among {', '.join(STREAMS)}",
                f"{self.name} has {sorted(unknown)[0]!r}",
                "Put the channels into one of these streams.",
            )
        object.__setattr__(self, "streams", frozen(self.streams))

    def __repr__(self) -> str:
        words = ", ".join(f"{key} {len(stream.names)} at {stream.rate_hz:g} Hz" for key, stream in self.streams.items())
        return f"Trial({self.name!r}: {words or 'no stream'}; {len(self.events)} events, {len(self.findings)} findings)"

    def _repr_html_(self) -> str:
        rows = [
            (key, f"{len(stream.names)} channels, {stream.rate_hz:g} Hz, {stream.duration_s:.2f} s")
            for key, stream in self.streams.items()
        ]
        rows += [("events", str(len(self.events)))] if self.events else []
        return as_html(f"Trial {self.name}", [*rows, *((f.kind, f.what) for f in self.findings[:SHOWN])])

    def stream(self, key: str) -> Recording:
        """Return one stream.

        Parameters
        ----------
        key : str
            One of `STREAMS`.

        Raises
        ------
        ChannelError
            If the trial lacks this stream.
        """
        if key not in self.streams:
            raise ChannelError(
                f"trial {self.name} must have {key}",
                f"it has {', '.join(self.streams) or 'no streams'}",
                "Use one of these, or read the missing file together with the others.",
            )
        return self.streams[key]

    def on_one_base(self, rate_hz: float, keys: tuple[str, ...] | None = None) -> Recording:
        """Resample streams to one time base, the period that all of them cover.

        Streams are interpolated linearly. Slower streams gain no information. Faster streams must first be low-passed,
        to avoid aliasing (EMG envelopes at 10 Hz, kinematics at 6 Hz).

        Parameters
        ----------
        rate_hz : float
            Sampling rate of the result [Hz].
        keys : tuple of str, optional
            Streams to bring together, in this order; all of them by default.

        Returns
        -------
        Recording
            Channels of all streams; samples interpolated from a suspect sample are suspect.

        Raises
        ------
        SamplingError
            If the streams have no time in common.
        """
        streams = [self.stream(key) for key in (keys or tuple(self.streams))]
        start = max(recording.time[0] for recording in streams)
        end = min(recording.time[-1] for recording in streams)
        count = int(np.floor((end - start) * rate_hz + 1e-6)) + 1
        if count < 2:
            raise SamplingError(
                f"trial {self.name}: streams on one time base must overlap in time",
                f"the last stream begins at {start:.3f} s, and the first one ends at {end:.3f} s",
                "Check that the files belong to the same trial and clock.",
            )
        time = start + np.arange(count) / rate_hz
        joined = join_recordings(*(resample(recording, time) for recording in streams))
        return replace(joined, subject=self.subject, condition=self.condition)


def resample(recording: Recording, time: Values) -> Recording:
    """Recording interpolated at other times; what rests on a suspect sample is suspect."""
    values = interpolate(recording.time, unwrap(recording).values, time)  # a heading comes round on the short way
    marks = interpolate(recording.time, np.asarray(recording.suspect, float), time) > 0
    return wrap_recording(replace(recording, time=time, values=values, suspect=marks), recording)
