"""Force platforms: wrenches about a point and where they act; which plates a file has, and their forces."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.channel import Channel
from gaitdisc.errors import ChannelError, ReadError, ShapeError, UnitError
from gaitdisc.ingest.c3d_points import AXES
from gaitdisc.ingest.force_plates import CLEAR_LOAD_N, LEAST_LOAD_N
from gaitdisc.recording import Recording, Surface, Trial
from gaitdisc.recording.arrays import Span, Values, freeze, mean_rate
from gaitdisc.signals.butterworth import low_pass
from gaitdisc.signals.contacts import loaded


@dataclass(frozen=True, eq=False)
class Wrench:
    """Force and moment in the laboratory's frame, sample by sample.

    >>> Wrench.at(np.array([[0.5, 0.0, 0.0]]), np.array([[0.0, 0.0, 700.0]])).moment
    array([[   0., -350.,    0.]])
    """

    force: Values  # (sample, 3) [N], of the ground on the foot, where it is a ground reaction
    moment: Values  # (sample, 3) [N m], about the origin of the laboratory

    def __post_init__(self) -> None:
        freeze(self, "force", "moment")
        force, moment = self.force, self.moment
        if force.ndim != 2 or force.shape[1] != 3 or moment.shape != force.shape:
            raise ShapeError(
                "a wrench must have a force and a moment of shape (sample, 3)",
                f"their shapes are {force.shape} and {moment.shape}",
                "Put samples first, the laboratory's axes second.",
            )

    @classmethod
    def at(cls, point: Values, force: Values, moment: Values | float = 0.0) -> Wrench:
        """Wrench of a force (sample, 3) [N] at a point (sample, 3) or (3,) [m], and a moment about it [N m]."""
        return cls(force, np.cross(point, force) + moment)

    def __add__(self, other: Wrench) -> Wrench:
        return Wrench(self.force + other.force, self.moment + other.moment)

    def __sub__(self, other: Wrench) -> Wrench:
        return Wrench(self.force - other.force, self.moment - other.moment)

    def __len__(self) -> int:
        return len(self.force)

    def about(self, point: Values) -> Values:
        """Moment (sample, 3) [N m] about another point (sample, 3) or (3,) [m] of the laboratory's frame."""
        return self.moment - np.cross(point, self.force)

    def pressure_centre(self, point: Values, up: Values) -> Values:
        """Where a force meets a surface of unit normal `up`, (sample, 3) [m]; NaN below 20 N along it.

        >>> step = Wrench.at(np.array([0.2, 0.1, 0.0]), np.array([[30.0, 0.0, 700.0], [0.0, 0.0, 19.0]]))
        >>> step.pressure_centre(np.zeros(3), np.array([0.0, 0.0, 1.0])).round(9)
        array([[0.2, 0.1, 0. ],
               [nan, nan, nan]])
        """
        normal = self.force @ up
        pressed = normal > LEAST_LOAD_N
        centre = np.full(self.force.shape, np.nan)
        centre[pressed] = point + np.cross(up, self.about(point)[pressed]) / normal[pressed, None]
        return centre


_PLATE = re.compile(r"(plate_\d+)_f[xyz]")
_SIDED = re.compile(r"ground_force_(\w+?)_v[xyz]")


@dataclass(frozen=True, eq=False)
class Platform:
    """What measures the force of the ground on a foot."""

    name: str
    time: Values  # (sample,) [s], on the trial's clock
    wrench: Wrench
    up: Values  # (3,), unit vector from the ground to the foot, against gravity
    point: Values  # (3,) [m], a point of its surface
    surface: Surface | None = None  # where it lies; None where only forces and centres of pressure were written
    side: str = ""  # `r` or `l` where the file says whose foot it is, empty otherwise

    @property
    def rate_hz(self) -> float:
        """Samples a second."""
        return mean_rate(self.time)

    @property
    def span(self) -> Span:
        """From its first to its last sample."""
        return Span(float(self.time[0]), float(self.time[-1]))

    @property
    def load_n(self) -> Values:
        """Force against gravity, (sample,) [N]."""
        return self.wrench.force @ self.up

    def pressure_centre(self) -> Values:
        """Where the force meets the surface, (sample, 3) [m]; NaN where its normal part is below 20 N."""
        return self.wrench.pressure_centre(self.point, self.up)

    def loadings(self) -> NDArray[np.intp]:
        """First and last sample (loading, 2) of each loading, from 50 N down to 20 N."""
        return loaded(self.load_n, self.rate_hz, LEAST_LOAD_N / 0.4)

    def smoothed(self, cutoff_hz: float, spans: Sequence[Span]) -> Wrench:
        """Wrench within spans without what is faster than the cut-off, zero elsewhere.

        What an empty plate shows is no force on a foot and is taken as zero before the filter. Force and moment about
        the surface are filtered; the centre of pressure is not, as it is a quotient.
        """
        on = np.any([span.holds(self.time) for span in spans], axis=0)
        values = np.hstack([self.wrench.force, self.wrench.about(self.point)]) * on[:, None]
        values = low_passed(self.time, values, cutoff_hz)
        return Wrench.at(self.point, values[:, :3], values[:, 3:])


def low_passed(time: Values, values: Values, cutoff_hz: float) -> Values:
    """Columns (sample, column) on even times without what is faster than the cut-off; an infinite one leaves all."""
    if not np.isfinite(cutoff_hz):
        return values
    channels = tuple(Channel(f"column_{number}", "signal", "1") for number in range(values.shape[1]))
    return low_pass(Recording(time, values, channels), cutoff_hz).values


def platforms(trial: Trial) -> list[Platform]:
    """Force platforms of a trial.

    Plates of a C3D file are `plate_1_fx` to `plate_1_mz`, with their corners in `trial.surfaces`; forces of a `.mot`
    or `.sto` file are `ground_force_r_vx`, with their point `ground_force_r_px` and moment `ground_torque_r_x`, in
    OpenSim's frame, y up.
    """
    forces = trial.stream("forces")
    surfaces = {surface.name: surface for surface in trial.surfaces}
    plates = dict.fromkeys(match[1] for name in forces.names if (match := _PLATE.fullmatch(name)))
    feet = dict.fromkeys(match[1] for name in forces.names if (match := _SIDED.fullmatch(name)))
    all_platforms = [_plate(forces, name, surfaces) for name in plates] + [_foot_force(forces, name) for name in feet]
    if not all_platforms:
        raise ChannelError(
            "for joint moments, force and moment of the ground must be given in three directions",
            f"{forces.source.file or trial.name} has {', '.join(forces.names[:6])}",
            "Provide plates with FORCE_PLATFORM (C3D), or ground_force_r_vx to ground_torque_r_z (.mot).",
        )
    for platform in all_platforms:  # one that carries a foot pushes it up
        load = platform.load_n
        lowest = int(np.argmin(load))
        if load.max() < CLEAR_LOAD_N < -load[lowest]:
            found_n = f"{load[lowest]:.0f} N at {platform.time[lowest]:.3f} s and never more than {load.max():.0f} N"
            raise UnitError(
                f"the force of the ground on the foot must be positive upwards on {platform.name}",
                f"{forces.source.file or trial.name} has {found_n}",
                "The sign of the force is wrong. Export the force of the ground on the foot.",
            )
    return all_platforms


def _plate(forces: Recording, name: str, surfaces: dict[str, Surface]) -> Platform:
    if name not in surfaces:
        raise ChannelError(
            f"for the wrench of {name}, the corners of its surface must be given",
            f"{forces.source.file or 'the trial'} has corners for {', '.join(surfaces) or 'no plate'}",
            "Keep the corners of the trial's plates, or correct FORCE_PLATFORM:CORNERS.",
        )
    surface = surfaces[name]
    force, moment = _three(forces, f"{name}_f{{}}"), _three(forces, f"{name}_m{{}}")
    vertical = int(np.argmax(np.abs(surface.normal)))
    # ingest gives the laboratory's vertical as positive upwards
    up = surface.normal * (np.sign(surface.normal[vertical]))
    return Platform(name, forces.time, Wrench.at(surface.centre, force, moment), up, surface.centre, surface)


def _foot_force(forces: Recording, key: str) -> Platform:
    force = _three(forces, f"ground_force_{key}_v{{}}")
    point, moment = _three(forces, f"ground_force_{key}_p{{}}"), _three(forces, f"ground_torque_{key}_{{}}")
    up = np.array([0.0, 1.0, 0.0])
    pressed = np.abs(force[:, 1]) > LEAST_LOAD_N
    lost = pressed & ~np.isfinite(np.hstack([point, moment])).all(axis=1)
    if lost.any():
        first, file = int(np.argmax(lost)), forces.source.file or "the trial"
        raise ReadError(
            f"ground_force_{key} must have its point and moment in every loaded sample",
            f"loaded samples of {file} without point or moment: {lost.sum()} (first: {force[first, 1]:.0f} N at "
            f"{forces.time[first]:.3f} s)",
            "Export the centre of pressure in m, and 0 where the foot is in the air.",
        )
    floor = float(np.median(point[pressed, 1])) if pressed.any() else 0.0
    wrench = Wrench.at(np.nan_to_num(point), force, np.nan_to_num(moment))
    side = key if key in ("r", "l") else ""
    return Platform(
        f"ground_force_{key}", forces.time, wrench, up, point=np.array([0.0, floor, 0.0]), surface=None, side=side
    )


def _three(forces: Recording, pattern: str) -> Values:
    names = [pattern.format(axis) for axis in AXES]
    lacking = [name for name in names if name not in forces.names]
    if lacking:
        raise ChannelError(
            f"a wrench must have {', '.join(names)}",
            f"{forces.source.file or 'the trial'} lacks {', '.join(lacking)}",
            "Export force, point and moment of the ground in all three directions, or map them in [channels].",
        )
    return np.stack([forces[name] for name in names], axis=1)
