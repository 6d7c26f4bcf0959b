"""The ankle exoskeleton: a one-sided linear spring beside the ankle, and the mass that it adds to the leg."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

STIFFNESS = 5.0  # N m/deg, Ebers (2023), section 4.2.1
SHANK_KG, FOOT_KG = 0.6, 0.4  # worn in both conditions; general knowledge of such devices


@dataclass(frozen=True)
class Spring:
    """A spring that resists dorsiflexion beyond the angle where it engages.

    >>> Spring(5.0).moment(np.array([-3.0, 4.0]), engaged_deg=-1.0).tolist()
    [-0.0, -25.0]
    """

    stiffness: float = STIFFNESS  # [N m/deg]; 0 is the device without its spring, the Nominal condition
    slack_deg: float = 0.0  # shift of the angle of engagement against the person's own fit [deg]

    def moment(self, ankle_deg: NDArray[np.float64], engaged_deg: float) -> NDArray[np.float64]:
        """Moment on the ankle, towards dorsiflexion [N m].

        ankle_deg , any shape [deg]: dorsiflexion
        engaged_deg: dorsiflexion at which the person's spring engages [deg]
        """
        return -self.stiffness * np.maximum(0.0, ankle_deg - engaged_deg - self.slack_deg)
