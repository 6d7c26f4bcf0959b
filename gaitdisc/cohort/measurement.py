"""A walk as a laboratory measures it: joint angles from markers, raw EMG, forces of a split belt; all with noise."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gaitdisc.channel import Channel, vocabulary
from gaitdisc.cohort.habit import habitual
from gaitdisc.cohort.person import JOINTS, MUSCLES
from gaitdisc.cohort.walk import QUICK_HZ, SLOW_HZ, TrueWalk
from gaitdisc.recording import Recording, Source, Trial

SIDES = ("r", "l")
# inverse kinematics: what a single frame wavers by, and what skin and markers sway by below 8 Hz [deg]
FRAME_DEG, SWAY_DEG, SWAY_HZ = 0.15, (0.15, 0.12, 0.20, 0.15, 0.15), 8.0
EMG_BAND_HZ = (30.0, 400.0)
EMG_V = 1.2  # behind the amplifier, standard deviation at full excitation
EMG_FLOOR_V = 0.006
EMG_UNITS, EMG_UNITS_S = 0.10, 0.10  # the fibres under the electrode are a sample of the muscle
RANGE_V, STEPS = 5.0, 2**15  # of a 16-bit converter
FORCE_N = 4.0


def measured(walk: TrueWalk, name: str, condition: str, emg_late_s: float = 0.0) -> Trial:
    """Measure a walk.

    Parameters
    ----------
    emg_late_s : float
        Delay of the EMG against the rest, a fault that is hidden on request [s].

    Returns
    -------
    Trial
        `kinematics` (10 angles, 100 Hz), `emg` (14 channels, 1000 Hz, amplified, 16 bits of +-5 V), `forces` (forwards
        and upwards under each foot, 1000 Hz).

    Examples
    --------
    >>> from gaitdisc.cohort.person import drawn
    >>> from gaitdisc.cohort.walk import walked
    >>> trial = measured(walked(drawn("W01", 1, "f"), None, 4.0, seed=3), "W01_nominal", "nominal")
    >>> {key: (stream.rate_hz, len(stream.names)) for key, stream in trial.streams.items()}
    {'kinematics': (100.0, 10), 'emg': (1000.0, 14), 'forces': (1000.0, 4)}
    """
    rng = np.random.default_rng([walk.seed, 23])
    subject = walk.person.name
    streams = {
        "kinematics": (walk.slow_s, _angles(rng, walk), [f"{joint}_{side}" for side in SIDES for joint in JOINTS]),
        "emg": (walk.quick_s, _emg(rng, walk, emg_late_s), [f"{name}_{side}" for side in SIDES for name in MUSCLES]),
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


def _emg(rng: np.random.Generator, walk: TrueWalk, late_s: float) -> NDArray[np.float64]:
    """Band-limited noise, its amplitude the excitation of the fibres under the electrode, plus the amplifier's own."""
    from scipy.signal import butter, lfilter, sosfilt

    drive = walk.excitation.reshape(len(walk.excitation), -1)
    late = round(late_s * QUICK_HZ)
    drive = np.concatenate([np.repeat(drive[:1], late, axis=0), drive[: len(drive) - late]])
    carrier = np.asarray(
        sosfilt(butter(2, EMG_BAND_HZ, "bandpass", fs=QUICK_HZ, output="sos"), _drawn(rng, drive), axis=0)
    )
    carrier /= carrier.std(axis=0)
    keep = np.exp(-1 / (EMG_UNITS_S * QUICK_HZ))
    sample = np.asarray(lfilter([np.sqrt(1 - keep**2)], [1.0, -keep], _drawn(rng, drive), axis=0))
    # electrodes differ in what they catch: drawn from the person, so that it is the same in both conditions
    caught = np.exp(np.random.default_rng(round(walk.person.mass_kg * 1e6)).normal(0.0, 0.25, drive.shape[1]))
    volts = EMG_V * caught * drive * np.maximum(0.1, 1.0 + EMG_UNITS * sample) * carrier
    volts += EMG_FLOOR_V * _drawn(rng, drive)
    step = RANGE_V / STEPS
    return np.clip(np.round(volts / step), -STEPS, STEPS - 1) * step


def _drawn(rng: np.random.Generator, like: NDArray[np.float64]) -> NDArray[np.float64]:
    return rng.standard_normal(like.shape)


def _forces(rng: np.random.Generator, walk: TrueWalk) -> NDArray[np.float64]:
    flat = walk.force.reshape(len(walk.force), -1)
    return flat + rng.normal(0.0, FORCE_N, flat.shape)


def _channel(name: str) -> Channel:
    channel = vocabulary().named(name)
    assert channel is not None  # names of this file stand in channels.csv
    return channel
