"""What electrodes see of the muscles under them: a carrier that follows excitation, cross-talk, and the amplifier.

The electrical signal comes before the force: by the electromechanical delay here, and by the activation dynamics of
`muscles.py` on top. Its amplitude is the excitation of the fibres under the electrode, a sample of the muscle whose
share wavers; its spectrum is that of surface electrodes, most of it between 30 and 300 Hz (SENIAM; general knowledge).
Electrodes differ in what they catch, from the same person in both conditions alike. Neighbours are heard as well.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gaitdisc.cohort.person import MUSCLES, Person

DELAY_S = 0.010  # electromechanical, before activation dynamics
BAND_HZ = (30.0, 300.0)
VOLTS = 1.2  # behind the amplifier, standard deviation at full excitation
FLOOR_V = 0.004
UNITS, UNITS_S = 0.10, 0.10  # how the share of the fibres under the electrode wavers
CATCH = 0.25  # logarithmic standard deviation of what electrodes catch
RANGE_V, STEPS = 5.0, 2**15  # of a 16-bit converter
# (heard at, of): share of the neighbour's amplitude; a few percent over the thigh, more within the calf
CROSS_TALK = {
    ("emg_rf", "emg_vas"): 0.06,
    ("emg_vas", "emg_rf"): 0.05,
    ("emg_gas", "emg_sol"): 0.06,
    ("emg_sol", "emg_gas"): 0.08,
    ("emg_ta", "emg_gas"): 0.02,
}


def electrode_volts(
    rng: np.random.Generator, excitation: NDArray[np.float64], person: Person, rate_hz: float, late_s: float = 0.0
) -> NDArray[np.float64]:
    """Raw EMG (time, channel) of excitations (time, channel), as a converter reads it; `late_s` is a fault [s]."""
    from scipy.signal import butter, lfilter, sosfilt

    drive = _delayed(excitation, round((late_s - DELAY_S) * rate_hz))
    carrier = np.asarray(sosfilt(butter(2, BAND_HZ, "bandpass", fs=rate_hz, output="sos"), _drawn(rng, drive), axis=0))
    carrier /= carrier.std(axis=0)
    keep = np.exp(-1 / (UNITS_S * rate_hz))
    share = np.asarray(lfilter([np.sqrt(1 - keep**2)], [1.0, -keep], _drawn(rng, drive), axis=0))
    carrier *= drive * np.maximum(0.1, 1.0 + UNITS * share)
    caught = np.exp(np.random.default_rng(round(person.mass_kg * 1e6)).normal(0.0, CATCH, drive.shape[1]))
    volts = VOLTS * caught * (carrier @ heard(drive.shape[1] // len(MUSCLES)).T)
    volts += FLOOR_V * _drawn(rng, drive)
    step = RANGE_V / STEPS
    return np.clip(np.round(volts / step), -STEPS, STEPS - 1) * step


def heard(sides: int) -> NDArray[np.float64]:
    """Share of each muscle's amplitude in each electrode (electrode, muscle), legs apart."""
    leg = np.eye(len(MUSCLES))
    for (electrode, muscle), share in CROSS_TALK.items():
        leg[MUSCLES.index(electrode), MUSCLES.index(muscle)] = share
    return np.asarray(np.kron(np.eye(sides), leg), dtype=np.float64)


def _delayed(values: NDArray[np.float64], samples: int) -> NDArray[np.float64]:
    """Later by some samples, or earlier where they are negative; the ends are held."""
    return values[np.clip(np.arange(len(values)) - samples, 0, len(values) - 1)]


def _drawn(rng: np.random.Generator, like: NDArray[np.float64]) -> NDArray[np.float64]:
    return rng.standard_normal(like.shape)
