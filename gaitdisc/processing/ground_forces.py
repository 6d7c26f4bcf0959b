"""Ground reaction of each foot in percent of body weight, where a model put it into the file: upwards and forwards."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gaitdisc.channel import Channel
from gaitdisc.recording import Recording, Trial
from gaitdisc.recording.runs import runs

LOADED_PERCENT = 10.0  # of body weight: the foot is on the plate


def weighed_forces(trial: Trial) -> Recording | None:
    """Forces of the ground on each foot [% of body weight], zero off the plate; None where the file has none.

    Plug-in Gait's `NormalisedGRF` is fore-aft and vertical in percent of body weight, empty off the plate. Forwards is
    positive here: the first half of a step brakes, and a file in which it does not is turned.
    """
    if "moments" not in trial.streams:
        return None
    moments = trial.stream("moments")
    found: dict[Channel, NDArray[np.float64]] = {}
    for side, letter in (("l", "L"), ("r", "R")):
        labels = [f"{letter}NormalisedGRF.{axis}" for axis in "xz"]
        if any(label not in moments.names or moments.channels[moments.index(label)].unit != "%" for label in labels):
            continue
        along, upwards = (np.nan_to_num(moments[label]) for label in labels)
        if (upwards > LOADED_PERCENT).any():
            found[Channel(f"ground_force_{side}_vx", "force", "%", side)] = _forwards(along, upwards)
            found[Channel(f"ground_force_{side}_vy", "vertical_force", "%", side)] = upwards
    if not found:
        return None
    return Recording(moments.time, np.column_stack(list(found.values())), tuple(found), trial.subject, trial.condition)


def _forwards(along: NDArray[np.float64], upwards: NDArray[np.float64]) -> NDArray[np.float64]:
    """Fore-aft force, negative in the first half of each step on the plate."""
    braking = sum(float(along[a : (a + b) // 2].sum()) for a, b in runs(upwards > LOADED_PERCENT))
    return -along if braking > 0 else along
