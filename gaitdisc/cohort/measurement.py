"""A walk as a laboratory measures it: joint angles from markers, raw EMG, forces of a split belt; all with noise."""

import numpy as np

from gaitdisc.channel import vocabulary
from gaitdisc.cohort.habit import habitual
from gaitdisc.cohort.person import JOINTS, MUSCLES, Person
from gaitdisc.cohort.walk import QUICK_HZ, SLOW_HZ, TrueWalk
from gaitdisc.recording import Recording, Source, Trial
from gaitdisc.recording.arrays import Values

SIDES = ("r", "l")
# inverse kinematics: what a single frame wavers by, and what skin and markers sway by below 8 Hz [deg]
FRAME_DEG, SWAY_DEG, SWAY_HZ = 0.15, (0.15, 0.12, 0.20, 0.15, 0.15), 8.0
FORCE_N = 4.0


def measure(walk: TrueWalk, name: str, condition: str, emg_late_s: float = 0.0) -> Trial:
    """Measure a walk.

    emg_late_s: delay of the EMG against the rest, a fault that is hidden on request [s]
    returns: `kinematics` (10 angles, 100 Hz), `emg` (14 channels, 1000 Hz, amplified, 16 bits of +-5 V), `forces`
        (forwards and upwards under each foot, 1000 Hz)

    >>> from gaitdisc.cohort.person import draw_one
    >>> from gaitdisc.cohort.walk import walked
    >>> trial = measure(walked(draw_one("W01", 1, "f"), None, 4.0, seed=3), "W01_nominal", "nominal")
    >>> {key: (stream.rate_hz, len(stream.names)) for key, stream in trial.streams.items()}
    {'kinematics': (100.0, 10), 'emg': (1000.0, 14), 'forces': (1000.0, 4)}
    """
    rng = np.random.default_rng([walk.seed, 23])
    subject = walk.person.name
    seen = walk.excitation[:, :, : len(MUSCLES)].reshape(len(walk.excitation), -1)
    flat = walk.force.reshape(len(walk.force), -1)
    streams = {
        "kinematics": (walk.slow_s, _angles(rng, walk), [f"{joint}_{side}" for side in SIDES for joint in JOINTS]),
        "emg": (
            walk.quick_s,
            electrode_volts(rng, seen, walk.person, QUICK_HZ, emg_late_s),
            [f"{name}_{side}" for side in SIDES for name in MUSCLES],
        ),
        "forces": (
            walk.quick_s,
            flat + rng.normal(0.0, FORCE_N, flat.shape),
            [f"ground_force_{side}_v{axis}" for side in SIDES for axis in "xy"],
        ),
    }
    source = Source(reader="cohort")
    recordings = {
        key: Recording(time, values, tuple(vocabulary().by_name[name] for name in names), subject, condition, source)
        for key, (time, values, names) in streams.items()
    }
    return Trial(name, recordings, subject=subject, condition=condition)


def _angles(rng: np.random.Generator, walk: TrueWalk) -> Values:
    from scipy.signal import butter, sosfiltfilt

    person = walk.person
    shown = walk.angles + person.style.offset_deg
    shown[:, :, 0] += habitual("pelvis_tilt", person.dimensionless_speed).mean
    flat = shown.reshape(len(shown), -1)
    sway = sosfiltfilt(butter(2, SWAY_HZ, fs=SLOW_HZ, output="sos"), rng.normal(size=flat.shape), axis=0)
    sway *= np.tile(SWAY_DEG, 2) / sway.std(axis=0)
    return flat + sway + rng.normal(0.0, FRAME_DEG, flat.shape)


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
    rng: np.random.Generator, excitation: Values, person: Person, rate_hz: float, late_s: float = 0.0
) -> Values:
    """Raw EMG (time, channel) of excitations (time, channel), as a converter reads it; `late_s` is a fault [s].

    The electrical signal comes before the force: by the electromechanical delay here, and by the activation dynamics of
    `muscles.py` on top. Its amplitude is the excitation of the fibres under the electrode, a sample of the muscle whose
    share wavers; its spectrum is that of surface electrodes, most of it between 30 and 300 Hz (SENIAM; general
    knowledge). Electrodes differ in what they catch, from the same person in both conditions alike. Neighbours are
    heard as well.
    """
    from scipy.signal import butter, lfilter, sosfilt

    moments = np.arange(len(excitation)) - round((late_s - DELAY_S) * rate_hz)
    drive = excitation[np.clip(moments, 0, len(excitation) - 1)]  # the ends are held
    band = butter(2, BAND_HZ, "bandpass", fs=rate_hz, output="sos")
    carrier = np.asarray(sosfilt(band, rng.standard_normal(drive.shape), axis=0))
    carrier /= carrier.std(axis=0)
    keep = np.exp(-1 / (UNITS_S * rate_hz))
    share = np.asarray(lfilter([np.sqrt(1 - keep**2)], [1.0, -keep], rng.standard_normal(drive.shape), axis=0))
    carrier *= drive * np.maximum(0.1, 1.0 + UNITS * share)
    caught = np.exp(np.random.default_rng(round(person.mass_kg * 1e6)).normal(0.0, CATCH, drive.shape[1]))
    volts = VOLTS * caught * (carrier @ heard(drive.shape[1] // len(MUSCLES)).T)
    volts += FLOOR_V * rng.standard_normal(drive.shape)
    step = RANGE_V / STEPS
    return np.clip(np.round(volts / step), -STEPS, STEPS - 1) * step


def heard(sides: int) -> Values:
    """Share of each muscle's amplitude in each electrode (electrode, muscle), legs apart."""
    leg = np.eye(len(MUSCLES))
    for (electrode, muscle), share in CROSS_TALK.items():
        leg[MUSCLES.index(electrode), MUSCLES.index(muscle)] = share
    return np.asarray(np.kron(np.eye(sides), leg), dtype=np.float64)
