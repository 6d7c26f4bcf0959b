"""A small walker for tests: ten joint angles driven towards a habit, with and without an ankle spring.

It is no model of a body. Each angle is a damped oscillator that is driven towards its habitual curve by a phase that
speeds up and slows down from stride to stride; a device adds the acceleration of a one-sided spring at the ankles. So
the missing effect is known to the last digit, which is what a test needs. The people of `gaitdisc demo` are those of
`cohort.py`, with muscles, ground and load.

The habitual curves are smooth curves of ordinary size (hip 40 deg, knee 60 deg, ankle 27 deg of range), not norm data.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.channel import Channel, vocabulary
from gaitdisc.compiled import compiled
from gaitdisc.recording import Recording, Source, Trial

STEP_S = 0.001
KINEMATICS_HZ = 100.0
JOINTS = ("hip_flexion", "hip_adduction", "hip_rotation", "knee_angle", "ankle_angle")
MUSCLES = ("sol", "ta")

# Fourier coefficients of the habitual curve over one stride from contact: mean, (cosine, sine) of 1, 2, ... [deg]
HABIT: dict[str, tuple[float, tuple[tuple[float, float], ...]]] = {
    "hip_flexion": (9.0, ((20.0, -3.5), (-1.5, -4.0), (0.3, 0.8))),
    "hip_adduction": (0.5, ((-1.0, 5.0), (-1.5, 1.5), (0.5, 0.2))),
    "hip_rotation": (1.0, ((-3.0, 2.0), (0.8, 1.2), (0.2, -0.3))),
    "knee_angle": (22.0, ((-4.0, -20.0), (-14.0, 6.0), (-1.0, 5.0), (0.5, 0.8))),
    "ankle_angle": (-0.5, ((-1.0, 6.0), (1.5, -7.0), (-2.5, 2.5), (0.5, -1.0))),
}
# phase of the burst's middle, width [share of a stride], height [V]
BURST = {"sol": (0.38, 0.11, 2.0e-4), "ta": (0.95, 0.10, 1.2e-4)}


@dataclass(frozen=True)
class DrivenWalker:
    """One person.

    >>> trial = DrivenWalker("P01", seed=1).walked(5.0, "nominal")
    >>> trial.stream("kinematics").rate_hz, len(trial.stream("kinematics").names)
    (100.0, 10)
    """

    name: str  # pseudonym
    stride_s: float = 1.1  # mean stride time
    size: float = 1.0  # factor on the habitual curves
    spring_per_s2: float = 0.0  # spring stiffness over effective inertia; 0 for no device
    engaged_deg: float = 1.0  # dorsiflexion above which the spring acts
    seed: int = 0  # of the person's variability

    def walked(self, duration_s: float, condition: str) -> Trial:
        """Walk for a while and be measured: angles at 100 Hz, EMG and vertical force at 1000 Hz."""
        rng = np.random.default_rng([self.seed, int(self.spring_per_s2 * 1000)])
        count = round(duration_s / STEP_S)
        time: NDArray[np.float64] = np.arange(float(count)) * STEP_S
        phase = self._phase(rng, count)
        angles = np.hstack([self._joints(rng, phase + shift) for shift in (0.0, 0.5)])
        every = round(1 / KINEMATICS_HZ / STEP_S)
        names = [f"{joint}_{side}" for side in "rl" for joint in JOINTS]
        kinematics = _recording(time[::every], angles[::every] + rng.normal(0, 0.05, angles[::every].shape), names)
        return Trial(
            f"{self.name}_{condition}",
            {"kinematics": kinematics, "emg": self._emg(rng, time, phase, angles), "forces": _forces(rng, time, phase)},
            subject=self.name,
            condition=condition,
        )

    def spring(self, ankle_deg: NDArray[np.float64]) -> NDArray[np.float64]:
        """Acceleration that the device adds at an ankle, the effect that is to be found [deg/s2]."""
        return -self.spring_per_s2 * np.maximum(0.0, ankle_deg - self.engaged_deg)

    def _phase(self, rng: np.random.Generator, count: int) -> NDArray[np.float64]:
        quick = _wandering(rng, count, 0.4, 0.015)
        slow = _wandering(rng, count, 8.0, 0.010)
        return np.cumsum((1.0 + quick + slow) * STEP_S / self.stride_s)

    def _joints(self, rng: np.random.Generator, phase: NDArray[np.float64]) -> NDArray[np.float64]:
        natural, damping = 2 * np.pi * 2.5, 0.7  # [rad/s], [1]
        habits = np.column_stack([self.size * _habit(joint, phase) for joint in JOINTS])
        rate = np.gradient(habits, STEP_S, axis=0)
        drive = np.gradient(rate, STEP_S, axis=0) + natural**2 * habits + 2 * damping * natural * rate
        for column, joint in enumerate(JOINTS):
            spread = 60.0 if joint in ("knee_angle", "hip_flexion") else 25.0
            drive[:, column] += _wandering(rng, len(phase), 0.15, spread * 4)
        springs = np.array([self.spring_per_s2 if joint == "ankle_angle" else 0.0 for joint in JOINTS])
        start = np.vstack([habits[0], rate[0]])
        return _oscillated(drive, start, natural**2, 2 * damping * natural, springs, self.engaged_deg)

    def _emg(
        self,
        rng: np.random.Generator,
        time: NDArray[np.float64],
        phase: NDArray[np.float64],
        angles: NDArray[np.float64],
    ) -> Recording:
        columns, names = [], []
        for number, side in enumerate("rl"):
            own = (phase + 0.5 * number) % 1.0
            ankle = angles[:, number * len(JOINTS) + JOINTS.index("ankle_angle")]
            relief = 1.0 + self.spring(ankle) / 4000.0  # the spring does part of what soleus did
            for muscle in MUSCLES:
                middle, width, height = BURST[muscle]
                apart = (own - middle + 0.5) % 1.0 - 0.5
                burst = height * np.exp(-0.5 * (apart / width) ** 2)
                burst = burst * np.clip(relief, 0.2, 1.0) if muscle == "sol" else burst
                burst = burst * (1.0 + _wandering(rng, len(time), 0.5, 0.1))
                columns.append((burst + 4e-6) * rng.normal(size=len(time)))
                names.append(f"emg_{muscle}_{side}")
        return _recording(time, np.column_stack(columns), names)


@compiled
def _oscillated(drive, start, stiffness, damping, springs, engaged):
    """Angles (sample, joint) [deg] of driven oscillators; springs (joint,) [1/s2] act above `engaged` [deg]."""
    angles = np.empty_like(drive)
    for joint in range(drive.shape[1]):
        theta, omega = start[0, joint], start[1, joint]
        for sample in range(drive.shape[0]):
            angles[sample, joint] = theta
            acceleration = drive[sample, joint] - stiffness * theta - damping * omega
            omega += (acceleration - springs[joint] * max(0.0, theta - engaged)) * STEP_S
            theta += omega * STEP_S
    return angles


def _habit(joint: str, phase: NDArray[np.float64]) -> NDArray[np.float64]:
    mean, pairs = HABIT[joint]
    turn = 2 * np.pi * phase
    waves = [c * np.cos(k * turn) + s * np.sin(k * turn) for k, (c, s) in enumerate(pairs, start=1)]
    return mean + np.sum(waves, axis=0)


def _wandering(rng: np.random.Generator, count: int, time_s: float, spread: float) -> NDArray[np.float64]:
    """Ornstein-Uhlenbeck noise of a given time constant and standard deviation."""
    from scipy.signal import lfilter

    keep = np.exp(-STEP_S / time_s)
    shocks = rng.normal(size=count) * spread * np.sqrt(1 - keep**2)
    shocks[0] = rng.normal() * spread
    return np.asarray(lfilter([1.0], [1.0, -keep], shocks))


def _forces(rng: np.random.Generator, time: NDArray[np.float64], phase: NDArray[np.float64]) -> Recording:
    columns = []
    for shift in (0.0, 0.5):
        own = (phase + shift) % 1.0
        stance = own / 0.61
        humps = np.sin(np.pi * stance) + 0.28 * np.sin(3 * np.pi * stance)
        force = np.where(stance < 1.0, 750.0 * np.maximum(humps, 0.0), 0.0)
        columns.append(force + rng.normal(0, 4.0, len(time)))
    return _recording(time, np.column_stack(columns), ["ground_force_r_vy", "ground_force_l_vy"])


def _recording(time: NDArray[np.float64], values: NDArray[np.float64], names: list[str]) -> Recording:
    return Recording(time, values, tuple(_channel(name) for name in names), source=Source(reader="driven walker"))


def _channel(name: str) -> Channel:
    channel = vocabulary().named(name)
    assert channel is not None  # names of this file stand in channels.csv
    return channel
