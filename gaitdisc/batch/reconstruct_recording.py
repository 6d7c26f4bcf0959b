"""Reconstruct the states of a new recording by a saved model."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from gaitdisc.errors import SamplingError
from gaitdisc.ingest.reading import read_trial
from gaitdisc.ingest.storage import write_storage
from gaitdisc.recording import Recording
from gaitdisc.sensing.calibration import calibrated
from gaitdisc.sensing.model_folder import SensingModel, load_model
from gaitdisc.sensing.reconstructor import Reconstructor
from gaitdisc.sensing.state_errors import LEVEL, coverage
from gaitdisc.signals.butterworth import KINEMATICS_HZ, lowpassed


@dataclass(frozen=True, eq=False)
class ReconstructedRecording:
    """States reconstructed from a recording, and how far they are from those that were measured too."""

    states: Recording  # what the model reconstructs, from the first full window on
    path: Path
    rmse: dict[str, float]  # of every state that the recording has itself [its unit]; empty where it has sensors alone
    coverage: dict[str, float]  # share of these inside the model's interval
    level: float  # share that the interval was made for

    def lines(self) -> list[str]:
        """Return what is said of it."""
        said = [f"{len(self.states.names)} states of {self.states.duration_s:.2f} s: {self.path}"]
        for channel in self.states.channels:
            if channel.name in self.rmse:
                inside = f"{100 * self.coverage[channel.name]:.0f} % inside the {100 * self.level:.0f} % interval"
                said.append(f"  {channel.name}: RMSE {self.rmse[channel.name]:.3g} {channel.unit}, {inside}")
        return said


def reconstruct_recording(
    file: Path,
    model: Path,
    out: Path,
    cutoff_hz: float = KINEMATICS_HZ,
    calibration: Path | None = None,
    missing: str = "none",
) -> ReconstructedRecording:
    """Reconstruct the states of one recording, and write them as a `.mot`.

    cutoff_hz: -3 dB frequency of one pass of the low-pass; the model's own recordings had the study's
    calibration: kinematics of the same person that hold the sensors and every state, some ten strides: the model is
        corrected for the person by them. Its intervals stay as they are, and are too wide then
    missing: what stands for a reading that is missing: a word of `gaitdisc.sensing.missing.WAYS`
    """
    saved, kinematics = load_model(model), read_trial(file).stream("kinematics")
    if calibration is not None:
        saved = replace(saved, reconstructor=_for_person(saved, calibration, cutoff_hz))
    what = saved.reconstructor.sensing
    names = [name for name in (*what.sensors, *what.states) if name in kinematics.names or name in what.sensors]
    filtered = lowpassed(kinematics.selected(names), cutoff_hz)
    states = saved(filtered, missing)
    known = np.isfinite(states.values).all(axis=1)
    if known.sum() < 2:
        raise SamplingError(
            f"states are reconstructed from {what.reach_s:.2f} s of readings",
            f"{file.name} lasts {kinematics.duration_s:.2f} s, and no such stretch of it lacks no value",
            "Record longer, or fill the gaps.",
        )
    first, last = np.flatnonzero(known)[[0, -1]]
    kept = states.between(float(states.time[first]), float(states.time[last]) + 0.5 / states.rate_hz)
    write_storage(kept, out)
    rmse, inside = {}, {}
    for column, name in enumerate(what.states):
        if name in filtered.names:
            both = known & np.isfinite(filtered[name])
            error = states[name][both] - filtered[name][both]
            rmse[name] = float(np.sqrt(np.mean(error**2)))
            inside[name] = float(coverage(error[:, None], saved.half_widths[column : column + 1])[0])
    return ReconstructedRecording(kept, out, rmse, inside, LEVEL)


def _for_person(saved: SensingModel, calibration: Path, cutoff_hz: float) -> Reconstructor:
    what, kinematics = saved.reconstructor.sensing, read_trial(calibration).stream("kinematics")
    walk = lowpassed(kinematics.selected([*what.sensors, *what.states]), cutoff_hz)
    saved(walk)  # refuses another rate or unit
    return calibrated(saved.reconstructor, what.windows(walk, np.zeros(len(walk.time))))
