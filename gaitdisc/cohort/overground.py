"""Walking over ground, cut from walking on belts: the laboratory stands still, and two plates see one step each."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.cohort.marker_trial import FORCE_N, MOMENT_NM
from gaitdisc.recording import Recording, Surface, Trial
from gaitdisc.recording.runs import runs

STRIDES = 2.9  # in the cameras' view
BEFORE = 0.7  # strides before the step on the first plate
PLATE_M = (0.6, 0.9)  # along and across the walkway; shorter where a step is
STANDS_N = 20.0


def overground(belts: Trial, start_s: float, stride_s: float, speed_m_per_s: float, name: str) -> Trial:
    """Trial of two to three strides over two plates, of a walk on two belts with markers.

    The belts' frame moves on at the belts' speed. The right foot's step is seen by `plate_1`, the left foot's after it
    by `plate_2`; other steps fall beside the plates.
    """
    end_s = start_s + STRIDES * stride_s
    parts = {key: one.between(start_s, end_s) for key, one in belts.streams.items()}
    right = _step(parts["forces"], "plate_1", start_s + BEFORE * stride_s)
    left = _step(parts["forces"], "plate_2", right.start_s)
    length = min(PLATE_M[0], 0.9 * 0.5 * stride_s * speed_m_per_s)
    plates, columns = [], []
    rng = np.random.default_rng([round(1000 * start_s), 47])
    for step, belt in zip((right, left), belts.surfaces, strict=True):
        plate = _plate(step, belt, length, speed_m_per_s * (step.middle_s - start_s))
        columns += _seen(step, belt, plate, speed_m_per_s * (parts["forces"].time - start_s), rng)
        plates.append(plate)
    walked = np.zeros_like(parts["markers"].values)
    walked[:, 0::3] = speed_m_per_s * (parts["markers"].time - start_s)[:, None]
    parts["markers"] = parts["markers"].with_values(parts["markers"].values + walked)
    parts["forces"] = parts["forces"].with_values(np.hstack(columns))
    streams = {key: replace(one, time=one.time - one.time[0]) for key, one in parts.items()}
    return Trial(name, streams, subject=belts.subject, condition=belts.condition, surfaces=tuple(plates))


class _Step:
    """One step on one belt: its force and its moment about the belt's middle while the foot stands, else zero."""

    def __init__(self, time: NDArray[np.float64], loads: NDArray[np.float64], rows: slice) -> None:
        stands = np.zeros((len(time), 1))
        stands[rows] = 1.0
        self.force, self.moment = loads[:, :3] * stands, loads[:, 3:] * stands
        self.start_s, self.middle_s = float(time[rows.start]), float(0.5 * (time[rows.start] + time[rows.stop - 1]))
        self.rows = rows

    @property
    def along_m(self) -> float:
        """Where the pressure stands in mid-stance, from the belt's middle."""
        middle = (self.rows.start + self.rows.stop) // 2
        return float(-self.moment[middle, 1] / self.force[middle, 2])


def _step(forces: Recording, belt: str, after_s: float) -> _Step:
    """First step on a belt that begins after a time and ends within the recording."""
    loads = forces.selected([f"{belt}_{kind}{axis}" for kind in "fm" for axis in "xyz"]).values
    stands = runs(loads[:, 2] > STANDS_N)
    whole = [(a, b) for a, b in stands if forces.time[a] > after_s and b < len(loads) and b - a > 0.2 * forces.rate_hz]
    return _Step(forces.time, loads, slice(*whole[0]))


def _plate(step: _Step, belt: Surface, length: float, walked_m: float) -> Surface:
    """Plate around the step, across the whole walkway."""
    middle = belt.corners.mean(axis=0)[0] + step.along_m + walked_m
    half = PLATE_M[1] / 2
    corners = [[length / 2, -half, 0.0], [-length / 2, -half, 0.0], [-length / 2, half, 0.0], [length / 2, half, 0.0]]
    return Surface(belt.name, np.array(corners) + np.array([middle, 0.0, 0.0]))


def _seen(
    step: _Step, belt: Surface, plate: Surface, walked_m: NDArray[np.float64], rng: np.random.Generator
) -> list[NDArray[np.float64]]:
    """Force and moment about the middle of the plate, as it reports them."""
    apart = belt.corners.mean(axis=0) - plate.corners.mean(axis=0) + walked_m[:, None] * np.array([1.0, 0.0, 0.0])
    moment = step.moment + np.cross(apart, step.force)
    return [
        step.force + rng.normal(0.0, FORCE_N, step.force.shape),
        moment + rng.normal(0.0, MOMENT_NM, moment.shape),
    ]
