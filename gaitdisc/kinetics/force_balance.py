"""Does the ground push as hard as the body's motion needs? The check that no part of inverse dynamics passes by luck.

The sum of m (a - g) over all segments is what the ground must give. Legs have their own poses; head, arms and trunk
are taken as one mass that moves with the mean of markers on the trunk, or with the middle of the hips where only legs
have markers. That is right on the whole and wrong in what arms and head do by themselves: it shows a wrong mass, sign,
unit, clock or assignment of feet, and no error of a few per cent of body weight. Forces are filtered as the markers
are, whatever filter the moments have: else an impact would count as an error of the body.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ChannelError
from gaitdisc.kinetics.body_inertia import Person
from gaitdisc.kinetics.foot_loads import FootLoad
from gaitdisc.kinetics.joint_moments import Leg
from gaitdisc.kinetics.newton_euler import GRAVITY, needed_wrench
from gaitdisc.recording import Finding

# of body weight; walks at hand reach 11 % and, where only one foot's stance is seen, 9 %: docs/kinetics.md
LARGEST_RMS, LARGEST_MEAN = 15.0, 12.0
FEWEST_FRAMES = 10


@dataclass(frozen=True)
class ForceBalance:
    """Force that the motion needs against the force that was measured.

    >>> print(ForceBalance(120, 3.21, 2.5, 0.4).line())
    force balance over 120 frames: vertical rms 3.2 % of body weight (mean +0.4 %), horizontal rms 2.5 %
    """

    frames: int  # in which the load of both feet is known
    rms: float  # [% of body weight], of the vertical difference
    level_rms: float  # [% of body weight], of the horizontal difference, both directions together
    # [% of body weight], of the vertical difference, measured less needed: positive where the mass is given too small
    mean: float

    @property
    def tested(self) -> bool:
        """Whether there are enough frames for a balance."""
        return self.frames >= FEWEST_FRAMES

    def line(self) -> str:
        """Return the balance as one line of text."""
        if not self.tested:
            return f"force balance: the load of both feet is known together in {self.frames} frames only; not tested"
        return (
            f"force balance over {self.frames} frames: vertical rms {self.rms:.1f} % of body weight "
            f"(mean {self.mean:+.1f} %), horizontal rms {self.level_rms:.1f} %"
        )

    def finding(self, file: str) -> Finding:
        """Give the balance as a finding: a note, or a warning above rms 15 % or mean 12 % of body weight."""
        wrong = self.tested and (self.rms > LARGEST_RMS or abs(self.mean) > LARGEST_MEAN)
        spoils = "joint moments: check body mass, clocks, and which foot is on which plate" if wrong else ""
        return Finding("warning" if wrong else "note", "force balance", file, self.line(), spoils)


def force_balance(
    found: Mapping[str, Leg],
    loads: Mapping[str, FootLoad],
    up: NDArray[np.float64],
    person: Person,
    trunk: NDArray[np.float64] | None = None,
) -> ForceBalance:
    """Balance of forces over the frames in which the load of both feet is known.

    up (3,): unit vector against gravity
    trunk (frame, 3) [m/s2]: acceleration of head, arms and trunk; that of the middle of the hips by default
    """
    if set(found) != {"l", "r"}:
        raise ChannelError(
            "the balance of forces needs both legs and the pelvis",
            f"there is {'the leg ' + ', '.join(found) if found else 'no leg'}",
            "Give the markers of both legs.",
        )
    needed = np.zeros(loads["r"].wrench.force.shape)
    rest = person.kg
    for leg in found.values():
        for segment, body in leg.bodies.items():
            needed = needed + needed_wrench(leg.moving[segment], body, up).force
            rest -= body.mass_kg
    hips = np.mean([leg.moving["thigh"].acceleration for leg in found.values()], axis=0)
    needed = needed + rest * ((hips if trunk is None else trunk) + GRAVITY * up)
    measured = loads["r"].wrench.force + loads["l"].wrench.force
    known = loads["r"].known & loads["l"].known & np.isfinite(needed).all(axis=1)
    over = (measured - needed)[known] / (person.kg * GRAVITY) * 100
    if not len(over):
        return ForceBalance(0, np.nan, np.nan, np.nan)
    vertical = over @ up
    level = over - vertical[:, None] * up
    return ForceBalance(
        len(over),
        float(np.sqrt(np.mean(vertical**2))),
        float(np.sqrt(np.mean(np.sum(level**2, axis=1)))),
        float(vertical.mean()),
    )
