"""Reconstruct states from a few sensors: of a study's participants, or of a new recording by a saved model."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
import pandas as pd

from gaitdisc.errors import GaitdiscError, SamplingError, SchemaError
from gaitdisc.ingest.reading import read_trial
from gaitdisc.ingest.storage import write_storage
from gaitdisc.ingest.study import Study
from gaitdisc.reconstruction.calibration import calibrate
from gaitdisc.reconstruction.model_folder import load_model
from gaitdisc.reconstruction.reconstruct import BASELINES, Fits, PersonReconstruction, reconstruct
from gaitdisc.reconstruction.reconstruction import CALIBRATED, Reconstruction
from gaitdisc.reconstruction.sensed_walks import STATES, SensedWalk, SensedWalks, read_walks
from gaitdisc.reconstruction.sensor_search import search_sensors
from gaitdisc.reconstruction.state_errors import INTERVAL_LEVEL, coverage
from gaitdisc.reconstruction.window_model import KINDS, ON_REQUEST, Sensing, fitting_device, sensing
from gaitdisc.reconstruction.windows import (
    RULES,
    Lags,
    Parts,
    cut_windows,
    split_by_subject,
    split_by_trial,
    split_within,
)
from gaitdisc.recording import Recording, Samples
from gaitdisc.saved.provenance import Refusal, provenance_now
from gaitdisc.signals.butterworth import low_pass

SECTION = "5.3.3, Table 5.2"
SUBJECT, CONDITION = "subject", "condition"
ACROSS = {
    SUBJECT: "each person is reconstructed by models of the others; the next person is used for validation",
    CONDITION: "each condition is reconstructed by models of the person's other walks (validation: their last 15 %)",
}
CALIBRATION_STRIDES = 10


@dataclass(frozen=True)
class ReconstructionSettings:
    """How a study is reconstructed."""

    split: str = "temporal"  # a word of `gaitdisc.reconstruction.windows.RULES` or of `ACROSS`
    history_s: float = 1.0  # reach of a window [s]
    spacing_s: float = 0.04  # from one of its readings to the next [s]
    kinds: tuple[str, ...] = tuple(KINDS)
    # walks of this condition alone, of both where it is empty; with the split `condition`, those that are tested
    condition: str = ""
    targets: str = STATES  # what is reconstructed: `states`, or a word of `sensed_walks.TARGETS`
    ahead_s: float = 0.0  # how far ahead of the last reading the states are forecast [s]; 0 is the present
    seed: int = 0
    device: str = "auto"  # that networks are fitted on: `cpu`, `cuda`, or `auto`, the GPU where there is one

    @property
    def condition_read(self) -> str:
        """Condition to which reading is limited; empty for none."""
        return "" if self.split == CONDITION else self.condition

    def lags(self, rate_hz: float) -> Lags:
        """Return the windows for a rate."""
        count, spacing = round(self.history_s / self.spacing_s), round(self.spacing_s * rate_hz)
        return Lags(max(1, count), max(1, spacing), round(self.ahead_s * rate_hz))


def reconstruct_study(
    study: Study,
    sensors: Sequence[str],
    settings: ReconstructionSettings,
    progress: Callable[[str, float], None] = lambda *_: None,
) -> tuple[Reconstruction, list[PersonReconstruction]]:
    """Fit and test every kind of model for every participant."""
    settings = replace(settings, device=fitting_device(settings.kinds, settings.device))
    walks = read_walks(study, sensors, settings.condition_read, settings.targets)
    names = tuple(c.name for c in walks.channels if settings.targets == STATES or c.name not in sensors)
    what = sensing(names, tuple(sensors), settings.lags(walks.rate_hz), walks.rate_hz)
    channels = walks.named((*what.sensors, *what.states))
    fits = Fits(settings.kinds, settings.seed, settings.device, CALIBRATION_STRIDES if settings.split == SUBJECT else 0)
    windows = {
        person: [what.windows(walk.recording, walk.phi) for walk in trials] for person, trials in walks.people.items()
    }
    done, refusals = [], list(walks.refusals)
    refused: GaitdiscError | None = None
    for person in windows:
        try:
            parts = partition(walks, windows, person, settings)
            done.append(reconstruct(person, parts, what, channels, fits))
        except GaitdiscError as error:
            refusals.append(Refusal(person, "", str(error)))
            refused = error
        progress(person, 1.0)
    if not done and refused is not None:
        raise refused
    return _result(study, walks, what, settings, done, refusals), done


def partition(
    walks: SensedWalks, windows: dict[str, list[Samples]], person: str, settings: ReconstructionSettings
) -> Parts:
    """Windows to fit, to choose by and to test on, for one person."""
    reach_s = settings.lags(walks.rate_hz).reach / walks.rate_hz
    if settings.split == SUBJECT:
        return split_by_subject(list(windows.values()), list(windows).index(person))
    if settings.split == CONDITION:
        return split_by_trial(windows[person], _test(walks.people[person], person, settings.condition), reach_s)
    return split_within(windows[person], settings.split, reach_s, settings.seed)


def _test(walks: Sequence[SensedWalk], person: str, condition: str) -> list[int]:
    words = [walk.recording.condition for walk in walks]
    tested = [k for k, word in enumerate(words) if word == condition]
    if not tested or len(tested) == len(words):
        raise SchemaError(
            "a split across conditions must have walks of the tested condition, and others for training",
            f"--condition is {condition!r}, but {person} has only {', '.join(sorted(set(words)))}",
            "Name a condition with --condition, or use another split.",
        )
    return tested


def _result(
    study: Study,
    walks: SensedWalks,
    what: Sensing,
    settings: ReconstructionSettings,
    done: Sequence[PersonReconstruction],
    refusals: Sequence[Refusal],
) -> Reconstruction:
    models = {kind: (KINDS | ON_REQUEST)[kind] for kind in settings.kinds}
    rule = (RULES | ACROSS)[settings.split]
    if settings.split == SUBJECT:
        models |= {
            CALIBRATED.format(kind): f"{kind}, corrected for the person with {CALIBRATION_STRIDES} strides"
            for kind in settings.kinds
        }
    if what.lags.ahead:
        models |= BASELINES
    used = {**study.public_settings({"filters", "strides", "conditions"}), "reconstruct": asdict(settings)}
    when = f"the states {what.lags.ahead / what.rate_hz:.2f} s after" if what.lags.ahead else "the states at"
    errors, summary, curves = (
        pd.concat([getattr(p, name) for p in done], ignore_index=True) for name in ("errors", "summary", "curves")
    )
    return Reconstruction(
        title=study.public_title,
        sensors=walks.named(what.sensors),
        states=walks.named(what.states),
        split=f"{settings.split}: {rule}",
        history=f"{what.lags.count} samples of each sensor, {what.lags.spacing / what.rate_hz:.2f} s apart; each model "
        f"estimates {when} the last of them",
        models=models,
        errors=errors,
        summary=summary,
        curves=curves,
        refusals=tuple(refusals),
        findings=walks.findings,
        provenance=provenance_now(used, settings.seed, walks.files, SECTION),
    )


def search_study(study: Study, most: int, settings: ReconstructionSettings) -> pd.DataFrame:
    """Find the best sets of sensors among the states of a study, for all participants; as of `search_sensors`."""
    if settings.targets != STATES or settings.ahead_s:
        raise SchemaError(
            "a sensor search is possible only for the present states",
            f"requested: {settings.targets}, {settings.ahead_s:g} s ahead",
            "Search without --targets and --ahead. Then name the sensors with --sensors.",
        )
    walks = read_walks(study, (), settings.condition_read)
    names, lags = [channel.name for channel in walks.channels], settings.lags(walks.rate_hz)
    windows = {
        person: [cut_windows(walk.recording, names, names, lags, walk.phi) for walk in trials]
        for person, trials in walks.people.items()
    }
    return search_sensors([partition(walks, windows, person, settings) for person in windows], walks.channels, most)


@dataclass(frozen=True, eq=False)
class ReconstructedRecording:
    """States reconstructed from a recording, and how far they are from those that were measured too."""

    states: Recording  # what the model reconstructs, from the first full window on
    path: Path
    rmse: dict[str, float]  # of every state that the recording has itself [its unit]; empty where it has sensors alone
    coverage: dict[str, float]  # share of these inside the model's interval

    def lines(self) -> list[str]:
        """Return what is said of it."""
        lines = [f"{len(self.states.names)} states of {self.states.duration_s:.2f} s: {self.path}"]
        for channel in self.states.channels:
            if channel.name in self.rmse:
                inside = f"{100 * self.coverage[channel.name]:.0f} % inside the {100 * INTERVAL_LEVEL:.0f} % interval"
                lines.append(f"  {channel.name}: RMSE {self.rmse[channel.name]:.3g} {channel.unit}, {inside}")
        return lines


def reconstruct_recording(
    file: Path, model: Path, out: Path, calibration: Path | None = None, missing: str = "none"
) -> ReconstructedRecording:
    """Reconstruct the states of one recording, low-passed as kinematics, and write them as a `.mot`.

    calibration: kinematics of the same person that hold the sensors and every state, some ten strides: the model is
        corrected for the person by them. Its intervals stay as they are, and are too wide then
    missing: what stands for a reading that is missing: a word of `gaitdisc.reconstruction.windows.WAYS`
    """
    saved, kinematics = load_model(model), read_trial(file).stream("kinematics")
    what = saved.reconstructor.sensing
    if calibration is not None:
        same = read_trial(calibration).stream("kinematics")
        walk = low_pass(same.selected([*what.sensors, *what.states]))
        saved(walk)  # refuses another rate or unit
        strides = what.windows(walk, np.zeros(len(walk.time)))
        saved = replace(saved, reconstructor=calibrate(saved.reconstructor, strides))
    names = [name for name in (*what.sensors, *what.states) if name in kinematics.names or name in what.sensors]
    filtered = low_pass(kinematics.selected(names))
    states = saved(filtered, missing)
    known = np.isfinite(states.values).all(axis=1)
    if known.sum() < 2:
        raise SamplingError(
            f"the sensors must have a period of {what.reach_s:.2f} s without gaps",
            f"{file.name} lasts {kinematics.duration_s:.2f} s, and every such period has a missing value",
            "Record longer, or fill the gaps.",
        )
    first, last = np.flatnonzero(known)[[0, -1]]
    trimmed = states.between(float(states.time[first]), float(states.time[last]) + 0.5 / states.rate_hz)
    write_storage(trimmed, out)
    rmse, inside = {}, {}
    for column, name in enumerate(what.states):
        if name in filtered.names:
            both = known & np.isfinite(filtered[name])
            error = states[name][both] - filtered[name][both]
            rmse[name] = float(np.sqrt(np.mean(error**2)))
            inside[name] = float(coverage(error[:, None], saved.half_widths[column : column + 1])[0])
    return ReconstructedRecording(trimmed, out, rmse, inside)
