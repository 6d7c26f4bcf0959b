"""From a trajectory to the samples of Eq. 4.2: state, rate and percent stride in, accelerations out."""

from collections.abc import Sequence

import numpy as np

from gaitdisc.channel import hint_nearest
from gaitdisc.errors import ChannelError
from gaitdisc.recording import Finding, Samples, Trajectory

PHASE = "phi"


def gait_samples(trajectory: Trajectory, outputs: Sequence[str]) -> tuple[Samples, Finding]:
    """Samples of a trajectory: x, xdot and percent stride in, second derivatives of chosen channels out (Eq. 4.2).

    A sample is left away unless every channel is usable and it lies within a stride. Percent stride goes in as it is,
    from 0 to 100 and back to 0 in one step; sine and cosine in its place changed the mean R2 of a network by .0004 at
    most, up and down, on 60 s of running (ten angles), and are not offered.

    returns samples: inputs `knee_angle_r`, ..., `d(knee_angle_r)/dt`, ..., `phi`; outputs `d2(knee_angle_r)/dt2`, ..
    returns excluded: how many are left away and why; a warning where a fifth of the walk is lost
    """
    walk = " ".join(part for part in (trajectory.subject, trajectory.condition) if part)
    named = walk or "the trajectory"
    if not outputs:
        raise ChannelError(
            "a response must predict at least one channel", f"none is named for {named}", "Name one in outputs."
        )
    if absent := [name for name in outputs if name not in trajectory.names]:
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
    lost, outside = int((~rows).sum()), int((~within).sum())
    reasons = [f"{outside} outside strides"] if outside else []
    bad = (~trajectory.usable & within[:, None]).sum(axis=0)  # one sample may count for many channels
    worst = sorted((-int(count), place) for place, count in enumerate(bad) if count)
    reasons += [f"{-count} of {trajectory.names[place]} not usable" for count, place in worst[:3]]
    reasons += [f"and {len(worst) - 3} more channels"] if len(worst) > 3 else []
    what = f"excluded samples: {lost} of {len(rows)}" + (f" ({', '.join(reasons)})" if reasons else "")
    spoils = "a fifth or more of the walk; check the channels named here" if lost >= 0.2 * len(rows) else ""
    return samples, Finding("warning" if spoils else "note", "samples left away", walk, what, spoils)
