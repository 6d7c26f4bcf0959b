"""Made-up walks whose strides, contacts and faults are known, and small readers of the real recordings."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from changed_trials import markers_at
from scipy.signal import lfilter

from gaitdisc.channel import Channel, vocabulary
from gaitdisc.recording import Recording, Source, Strides

LEGS = tuple(f"{joint}_{side}" for joint in ("hip_flexion", "knee_angle", "ankle_angle") for side in "rl")


def named(label):
    return vocabulary().named(label) or Channel(label, "signal", "1")


def mot(path: Path) -> Recording:
    lines = path.read_text(encoding="utf-8").splitlines()
    head = next(i for i, line in enumerate(lines) if line.strip() == "endheader") + 1
    columns = lines[head].split()
    values = np.array([line.split() for line in lines[head + 1 :] if line.strip()], float)
    return Recording(values[:, 0], values[:, 1:], tuple(map(named, columns[1:])), source=Source(path.name))


def treadmill_walks(folder: Path) -> dict[str, Recording]:
    with np.load(folder / "treadmill_walk_ik" / "addbio_expert3_ik.npz", allow_pickle=True) as file:
        columns = [str(label) for label in file["columns"]]
        trials = {key: np.asarray(file[key], float) for key in file.files if key.startswith("S01")}
    return {
        key: Recording(np.arange(len(v)) / 100, v, tuple(map(named, columns)), source=Source(key))
        for key, v in trials.items()
    }


def c3d_points(c3d) -> tuple[list[str], np.ndarray, np.ndarray]:
    parameters = c3d["parameters"]["POINT"]
    labels = [label for key in sorted(parameters) if key.startswith("LABELS") for label in parameters[key]["value"]]
    points = c3d["data"]["points"][:3]
    first = c3d["header"]["points"]["first_frame"]
    return labels, (first + np.arange(points.shape[2])) / float(parameters["RATE"]["value"][0]), points


def c3d_markers(c3d, wanted) -> Recording:
    labels, time, points = c3d_points(c3d)
    kept = [name for name in wanted if name in labels]
    return markers_at(time, {name: points[:, labels.index(name)].T / 1000 for name in kept})


def c3d_plates(c3d) -> Recording:
    """Both plates, upwards on the foot."""
    labels, (_, time, _) = c3d["parameters"]["ANALOG"]["LABELS"]["value"], c3d_points(c3d)
    analog = c3d["data"]["analogs"][0]
    rate = float(c3d["parameters"]["ANALOG"]["RATE"]["value"][0])
    values = np.stack([-analog[labels.index(f"Force.Fz{plate}")] for plate in (1, 2)], axis=1)
    channels = tuple(Channel(f"plate{plate}", "vertical_force", "N") for plate in (1, 2))
    return Recording(time[0] + np.arange(len(values)) / rate, values, channels)


def c3d_emg(c3d) -> Recording:
    labels = c3d["parameters"]["ANALOG"]["LABELS"]["value"]
    analog = c3d["data"]["analogs"][0]
    rows = [row for row, label in enumerate(labels) if label.startswith("Voltage.")]
    channels = tuple(Channel(labels[row].removeprefix("Voltage."), "emg", "V") for row in rows)
    return Recording(np.arange(analog.shape[1]) / 1000, analog[rows].T, channels)


RATE = 100.0
# cosine and sine amplitudes of three harmonics, deg; knee: least at about 97 % of the stride, most at 72 %
SHAPES = {"hip_flexion": (8.0, (20, -3), (2, 3), (1, 1)), "ankle_angle": (0.0, (1, -6), (-5, 6), (3, -3))}
KNEE = np.array([4, 12, 18, 16, 10, 6, 5, 6, 9, 14, 22, 34, 48, 58, 62, 58, 46, 28, 11, 2.5]), np.arange(0, 100, 5.0)


def channel(name: str) -> Channel:
    return Channel(name, "angle", "deg", name[-1])


def curve(joint: str, phase: np.ndarray) -> np.ndarray:
    """Angle at a phase in strides, deg."""
    if joint == "knee_angle":
        spectrum = np.fft.rfft(KNEE[0]) / len(KNEE[0])
        waves = [2 * np.real(c * np.exp(2j * np.pi * k * phase)) for k, c in enumerate(spectrum[1:9], 1)]
        return spectrum[0].real + np.sum(waves, axis=0)
    mean, *waves = SHAPES[joint]
    angles = [
        a * np.cos(2 * np.pi * k * (phase + 0.13)) + b * np.sin(2 * np.pi * k * (phase + 0.13))
        for k, (a, b) in enumerate(waves, 1)
    ]
    return mean + np.sum(angles, axis=0)


def walk(strides: int = 20, stride_s: float = 1.1, seed: int = 0, spread: float = 0.01) -> tuple[Recording, np.ndarray]:
    """Hip, knee and ankle of both legs, and the right initial contacts [s]."""
    rng = np.random.default_rng(seed)
    contacts = 0.35 + np.concatenate([[0], np.cumsum(stride_s * (1 + spread * rng.normal(size=strides)))])
    time = np.arange(round((contacts[-1] + 0.3) * RATE)) / RATE
    ends = [contacts[0] - stride_s, *contacts, contacts[-1] + stride_s]
    phase = np.interp(time, ends, np.arange(-1, strides + 2))
    names = [f"{joint}_{side}" for side in "rl" for joint in ("hip_flexion", "knee_angle", "ankle_angle")]
    values = [curve(n[:-2], phase + (0.5 if n.endswith("l") else 0.0)) for n in names]
    noisy = np.array(values).T + 0.1 * rng.normal(size=(len(time), len(names)))
    return Recording(time, noisy, tuple(map(channel, names)), source=Source("walk.mot")), contacts


def wandering(count: int, dependence: float, seed: int, shift_sd: float = 0.0) -> tuple[Recording, Strides]:
    """Strides of 1 s whose offsets and amplitudes are autoregressive, three of six angles shifting at 80 %."""
    rng = np.random.default_rng(seed)
    time = np.arange(count * 50) / 50
    columns = []
    for joint in range(6):
        x = 20 * np.cos(2 * np.pi * time + joint)
        for harmonic in (0, 1, 2):
            drive = rng.normal(size=count + 50) * np.sqrt(1 - dependence**2)
            size = lfilter([1.0], [1.0, -dependence], drive)[50:]
            if harmonic == 0 and joint < 3:
                size = size + shift_sd * (np.arange(count) >= 0.8 * count)
            x = x + np.repeat(size, 50) * np.cos(2 * np.pi * harmonic * time)
        columns.append(x)
    names = [f"{joint}_{side}" for side in "rl" for joint in ("hip_flexion", "knee_angle", "ankle_angle")]
    recording = Recording(time, np.array(columns).T, tuple(map(channel, names)), source=Source("walk.mot"))
    return recording, Strides(np.arange(count - 1.0), np.arange(1.0, count), "r", "oscillator")


@pytest.fixture(scope="session")
def made() -> SimpleNamespace:
    """Made-up walks."""
    return SimpleNamespace(walk=walk, wandering=wandering, channel=channel, curve=curve)


@pytest.fixture(scope="session")
def real() -> SimpleNamespace:
    """Readers of real recordings."""
    return SimpleNamespace(
        legs=LEGS, mot=mot, treadmill_walks=treadmill_walks, markers=c3d_markers, plates=c3d_plates, emg=c3d_emg
    )
