"""A walk as a laboratory measures it: joint angles from markers, raw EMG, forces of a split belt; all with noise."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gaitdisc.channel import Channel, vocabulary
from gaitdisc.cohort.emg import electrode_volts
from gaitdisc.cohort.habit import habitual
from gaitdisc.cohort.person import JOINTS, MUSCLES
from gaitdisc.cohort.walk import QUICK_HZ, SLOW_HZ, TrueWalk
from gaitdisc.recording import Recording, Source, Trial

SIDES = ("r", "l")
# inverse kinematics: what a single frame wavers by, and what skin and markers sway by below 8 Hz [deg]
FRAME_DEG, SWAY_DEG, SWAY_HZ = 0.15, (0.15, 0.12, 0.20, 0.15, 0.15), 8.0
FORCE_N = 4.0


def measured(walk: TrueWalk, name: str, condition: str, emg_late_s: float = 0.0) -> Trial:
    """Measure a walk.

    emg_late_s: delay of the EMG against the rest, a fault that is hidden on request [s]
    returns: `kinematics` (10 angles, 100 Hz), `emg` (14 channels, 1000 Hz, amplified, 16 bits of +-5 V), `forces`
        (forwards and upwards under each foot, 1000 Hz)

    >>> from gaitdisc.cohort.person import drawn
    >>> from gaitdisc.cohort.walk import walked
    >>> trial = measured(walked(drawn("W01", 1, "f"), None, 4.0, seed=3), "W01_nominal", "nominal")
    >>> {key: (stream.rate_hz, len(stream.names)) for key, stream in trial.streams.items()}
    {'kinematics': (100.0, 10), 'emg': (1000.0, 14), 'forces': (1000.0, 4)}
    """
    rng = np.random.default_rng([walk.seed, 23])
    subject = walk.person.name
    seen = walk.excitation[:, :, : len(MUSCLES)].reshape(len(walk.excitation), -1)
    streams = {
        "kinematics": (walk.slow_s, _angles(rng, walk), [f"{joint}_{side}" for side in SIDES for joint in JOINTS]),
        "emg": (
            walk.quick_s,
            electrode_volts(rng, seen, walk.person, QUICK_HZ, emg_late_s),
            [f"{name}_{side}" for side in SIDES for name in MUSCLES],
        ),
        "forces": (
            walk.quick_s,
            _forces(rng, walk),
            [f"ground_force_{side}_v{axis}" for side in SIDES for axis in "xy"],
        ),
    }
    source = Source(reader="cohort")
    recordings = {
        key: Recording(time, values, tuple(_channel(n) for n in names), subject, condition, source)
        for key, (time, values, names) in streams.items()
    }
    return Trial(name, recordings, subject=subject, condition=condition)


def _angles(rng: np.random.Generator, walk: TrueWalk) -> NDArray[np.float64]:
    from scipy.signal import butter, sosfiltfilt

    person = walk.person
    shown = walk.angles + person.style.offset_deg
    shown[:, :, 0] += habitual("pelvis_tilt", person.dimensionless_speed).mean
    flat = shown.reshape(len(shown), -1)
    sway = sosfiltfilt(butter(2, SWAY_HZ, fs=SLOW_HZ, output="sos"), rng.normal(size=flat.shape), axis=0)
    sway *= np.tile(SWAY_DEG, 2) / sway.std(axis=0)
    return flat + sway + rng.normal(0.0, FRAME_DEG, flat.shape)


def _forces(rng: np.random.Generator, walk: TrueWalk) -> NDArray[np.float64]:
    flat = walk.force.reshape(len(walk.force), -1)
    return flat + rng.normal(0.0, FORCE_N, flat.shape)


def _channel(name: str) -> Channel:
    channel = vocabulary().named(name)
    assert channel is not None  # names of this file stand in channels.csv
    return channel
