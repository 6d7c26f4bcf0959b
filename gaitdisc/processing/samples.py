"""From a trajectory to the samples of Eq. 4.2: state, rate and percent stride in, accelerations out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from gaitdisc.channel import hint_nearest
from gaitdisc.errors import ChannelError
from gaitdisc.recording import Finding, Samples, Trajectory

PHASE = "phi"


@dataclass(frozen=True)
class DroppedSamples:
    """Samples of a trajectory that no model sees, and why.

    >>> DroppedSamples(100, 80, 15, {"knee_angle_r": 5}, "P01 exo").finding().what
    '20 of 100 samples are excluded: 15 outside strides, 5 of knee_angle_r not usable'
    """

    total: int  # samples there are
    kept: int  # samples that are used
    outside_strides: int
    # channel -> samples within strides that are missing or not to be trusted; one sample may count for many channels
    unusable: Mapping[str, int]
    walk: str = ""

    def finding(self) -> Finding:
        """Say it: a note, or a warning where a fifth of the walk is lost."""
        lost = self.total - self.kept
        reasons = [f"{self.outside_strides} outside strides"] if self.outside_strides else []
        worst = sorted(self.unusable.items(), key=lambda item: -item[1])
        reasons += [f"{count} of {channel} not usable" for channel, count in worst[:3]]
        if len(worst) > 3:
            reasons.append(f"and {len(worst) - 3} more channels")
        what = f"{lost} of {self.total} samples are excluded" + (": " + ", ".join(reasons) if reasons else "")
        spoils = "a fifth or more of the walk; check the channels that are named" if lost >= 0.2 * self.total else ""
        return Finding("warning" if spoils else "note", "samples left away", self.walk, what, spoils)


def gait_samples(trajectory: Trajectory, outputs: Sequence[str]) -> tuple[Samples, DroppedSamples]:
    """Samples of a trajectory: x, xdot and percent stride in, second derivatives of chosen channels out (Eq. 4.2).

    A sample is left away unless every channel is usable and it lies within a stride. Percent stride goes in as it is,
    from 0 to 100 and back to 0 in one step; sine and cosine in its place changed the mean R2 of a network by .0004 at
    most, up and down, on 60 s of running (ten angles), and are not offered.

    returns samples: inputs `knee_angle_r`, ..., `d(knee_angle_r)/dt`, ..., `phi`; outputs `d2(knee_angle_r)/dt2`, ..
    """
    walk = " ".join(part for part in (trajectory.subject, trajectory.condition) if part)
    named = walk or "the trajectory"
    if not outputs:
        raise ChannelError(
            "a response must predict at least one channel", f"none is named for {named}", "Name them in outputs."
        )
    absent = [name for name in outputs if name not in trajectory.names]
    if absent:
        raise ChannelError(
            f"{absent[0]!r}, whose acceleration is predicted, must be among the channels",
            f"{named} has {len(trajectory.names)} channels{hint_nearest(absent[0], trajectory.names)}",
            "Correct the study's outputs, or map the channel in [channels].",
        )
    columns = trajectory.columns(outputs)
    within = np.isfinite(trajectory.phi)
    rows = within & trajectory.usable.all(axis=1)
    samples = Samples(
        x=np.hstack([trajectory.x, trajectory.xdot, trajectory.phi[:, None]])[rows],
        y=trajectory.xddot[rows][:, columns],
        inputs=(*trajectory.names, *(f"d({name})/dt" for name in trajectory.names), PHASE),
        outputs=tuple(f"d2({name})/dt2" for name in outputs),
        time=trajectory.time[rows],
        phi=trajectory.phi[rows],
        subject=trajectory.subject,
    )
    bad = (~trajectory.usable & within[:, None]).sum(axis=0)
    unusable = {name: int(count) for name, count in zip(trajectory.names, bad, strict=True) if count}
    return samples, DroppedSamples(len(rows), int(rows.sum()), int((~within).sum()), unusable, walk)
