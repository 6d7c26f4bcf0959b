"""What the ground gives to each foot at the frames of the markers, and in which frames that is known."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.kinetics.plate_steps import FootPath, PlateStep
from gaitdisc.kinetics.platform import Platform
from gaitdisc.kinetics.wrench import Wrench
from gaitdisc.recording import Trial
from gaitdisc.recording.arrays import runs

SWING_AT_MOST_S = 0.7  # between two steps of one foot; a stance between them would not fit
HOLE_S = 0.06  # between what the file calls foot off and the end of the force


@dataclass(frozen=True, eq=False)
class FootLoad:
    """Wrench of the ground on one foot."""

    wrench: Wrench  # at each frame; zero where the foot is in the air
    known: NDArray[np.bool_]  # (frame,), false where the foot may be on the ground and no platform says what it carries


def foot_loads(
    found: Sequence[Platform],
    steps: Sequence[PlateStep],
    time: NDArray[np.float64],
    cutoff_hz: float,
    airborne: Mapping[str, Sequence[tuple[float, float]]] | None = None,
) -> dict[str, FootLoad]:
    """Load of both feet from the clean steps of a trial.

    Known are a foot's clean steps, the swing between two of them, the swings that its markers or the file's events
    show, and every frame where a platform names its foot.

    time (frame,) [s]: of the markers
    cutoff_hz: of the filter of force and moment; infinite for none
    airborne mapping of str to sequence of (float, float): spans in which a foot swings, as `swings` gives them [s]
    """
    loads = {}
    for side in "rl":
        total = Wrench(np.zeros((len(time), 3)), np.zeros((len(time), 3)))
        for platform in found:
            spans = [(s.start, s.end) for s in steps if s.clean and (s.platform, s.side) == (platform.name, side)]
            if spans:
                smooth = platform.smoothed(cutoff_hz, spans)
                columns = np.hstack([smooth.force, smooth.moment]).T
                values = np.stack([np.interp(time, platform.time, column, 0.0, 0.0) for column in columns], axis=1)
                total += Wrench(values[:, :3], values[:, 3:])
        named = any(platform.side == side for platform in found)
        spans = [(time[0], time[-1])] if named else list((airborne or {}).get(side, ()))
        loads[side] = FootLoad(total, _known(steps, side, time, spans))
    return loads


def swings(trial: Trial, feet: Mapping[str, FootPath]) -> dict[str, list[tuple[float, float]]]:
    """Spans in which each foot is in the air: it goes forwards fast, or the file's events say so [s]."""
    found = {side: feet[side].swings() if side in feet else [] for side in "rl"}
    for side, spans in found.items():
        events = [event for event in trial.events if event.side == side]
        for one, after in itertools.pairwise(events):
            if (one.label, after.label) == ("foot off", "initial contact"):
                spans.append((one.time, after.time))
    return found


def _known(
    steps: Sequence[PlateStep], side: str, time: NDArray[np.float64], known_spans: Sequence[tuple[float, float]]
) -> NDArray[np.bool_]:
    own = [step for step in steps if step.side == side and step.clean]
    spans = [(step.start, step.end) for step in own] + list(known_spans)
    spans += [
        (one.end, after.start) for one, after in itertools.pairwise(own) if 0 < after.start - one.end < SWING_AT_MOST_S
    ]
    known = np.zeros(len(time), bool)
    for start, end in spans:
        known |= (time >= start) & (time <= end)
    step = float(time[1] - time[0]) if len(time) > 1 else 0.0
    for start, end in runs(~known):
        if start > 0 and end < len(time) and (end - start) * step <= HOLE_S:
            known[start:end] = True
    for left_out in steps:
        if not left_out.clean and left_out.side in (side, ""):
            known &= ~((time >= left_out.start) & (time <= left_out.end))
    return known
