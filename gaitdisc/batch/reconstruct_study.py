"""Reconstruct the states of a study's participants from a few sensors, each from own walks or from the others'."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from datetime import UTC, datetime

import pandas as pd

from gaitdisc.batch.sensed_walks import SensedWalks, sensed_walks
from gaitdisc.batch.target_walks import STATES
from gaitdisc.errors import GaitdiscError
from gaitdisc.ingest.study import Study
from gaitdisc.recording import Samples
from gaitdisc.results import Provenance, Refusal
from gaitdisc.results.provenance import installed_versions
from gaitdisc.results.reconstruction import CALIBRATED, Reconstruction
from gaitdisc.sensing.reconstruct import PersonReconstruction, reconstruct
from gaitdisc.sensing.reconstructor import KINDS, Sensing, sensing
from gaitdisc.sensing.splits import RULES, Parts, split_by_subject, split_within
from gaitdisc.sensing.windows import Lags

SECTION = "5.3.3, Table 5.2"
SUBJECT = "subject"
CALIBRATION_STRIDES = 10


@dataclass(frozen=True)
class ReconstructionSettings:
    """How a study is reconstructed.

    Parameters
    ----------
    split : str
        A word of `gaitdisc.sensing.splits.RULES`, or `subject`: each person from the others' walks.
    history_s, spacing_s : float
        Reach of a window, and time from one reading to the next [s].
    kinds : tuple of str
        Words of `gaitdisc.sensing.reconstructor.KINDS`.
    condition : str
        Walks of this condition alone; of both where it is empty.
    targets : str
        What is told: `states`, or a word of `gaitdisc.batch.target_walks.TARGETS`.
    seed : int
        Of every random act.
    """

    split: str = "temporal"
    history_s: float = 1.0
    spacing_s: float = 0.04
    kinds: tuple[str, ...] = tuple(KINDS)
    condition: str = ""
    targets: str = STATES
    seed: int = 0

    def lags(self, rate_hz: float) -> Lags:
        """Return the windows for a rate.

        Parameters
        ----------
        rate_hz : float
            Samples a second.
        """
        return Lags(max(1, round(self.history_s / self.spacing_s)), max(1, round(self.spacing_s * rate_hz)))


def reconstruct_study(
    study: Study,
    sensors: Sequence[str],
    settings: ReconstructionSettings | None = None,
    told: Callable[[str, float], None] = lambda *_: None,
) -> tuple[Reconstruction, list[PersonReconstruction]]:
    """Fit and judge every kind of model for every participant.

    Parameters
    ----------
    study : Study
        Who walked, in which files.
    sensors : sequence of str
        Channels that are read.
    settings : ReconstructionSettings, optional
        The defaults without.
    told : callable
        Called with a pseudonym and the fraction done.

    Returns
    -------
    Reconstruction, list of PersonReconstruction
        What a report needs; and the fitted models.

    Raises
    ------
    GaitdiscError
        If no participant can be reconstructed.
    """
    settings = settings or ReconstructionSettings()
    walks = sensed_walks(study, sensors, settings.condition, settings.targets)
    names = tuple(channel.name for channel in walks.channels)
    what = sensing(names, tuple(sensors), settings.lags(walks.rate_hz), walks.rate_hz)
    by_name = {channel.name: channel for channel in walks.channels}
    channels = tuple(by_name[name] for name in (*what.sensors, *what.states))
    calibration = CALIBRATION_STRIDES if settings.split == SUBJECT else 0
    windows = {
        person: [what.windows(walk.recording, walk.phi) for walk in found] for person, found in walks.people.items()
    }
    done, refusals = [], list(walks.refusals)
    refused: GaitdiscError | None = None
    for person in windows:
        try:
            parts = _parts(windows, person, what, settings)
            done.append(reconstruct(person, parts, what, channels, settings.kinds, settings.seed, calibration))
        except GaitdiscError as error:
            refusals.append(Refusal(person, "", str(error)))
            refused = error
        told(person, 1.0)
    if not done and refused is not None:
        raise refused
    return _result(study, walks, what, settings, done, refusals), done


def _parts(windows: dict[str, list[Samples]], person: str, what: Sensing, settings: ReconstructionSettings) -> Parts:
    if settings.split == SUBJECT:
        return split_by_subject(list(windows.values()), list(windows).index(person))
    return split_within(windows[person], settings.split, what.reach_s, settings.seed)


def _result(
    study: Study,
    walks: SensedWalks,
    what: Sensing,
    settings: ReconstructionSettings,
    done: Sequence[PersonReconstruction],
    refusals: Sequence[Refusal],
) -> Reconstruction:
    by_name = {channel.name: channel for channel in walks.channels}
    models = {kind: KINDS[kind] for kind in settings.kinds}
    rule = RULES.get(
        settings.split, "each person by models of the others; the next in the list is who they are chosen by"
    )
    if settings.split == SUBJECT:
        models |= {
            CALIBRATED.format(kind): f"the same, corrected for the person by {CALIBRATION_STRIDES} strides"
            for kind in settings.kinds
        }
    created = datetime.now(UTC).isoformat(timespec="seconds")
    used = {
        **study.model_dump(mode="json", include={"filters", "strides", "conditions"}),
        "reconstruct": asdict(settings),
    }
    return Reconstruction(
        study.title or study.folder.name,
        tuple(by_name[name] for name in what.sensors),
        tuple(by_name[name] for name in what.states),
        f"{settings.split}: {rule}",
        f"{what.lags.count} readings of each sensor, {what.lags.spacing / what.rate_hz:.2f} s apart",
        models,
        *(
            pd.concat([getattr(each, name) for each in done], ignore_index=True)
            for name in ("errors", "summary", "curves")
        ),
        tuple(refusals),
        walks.findings,
        Provenance(used, settings.seed, walks.files, installed_versions(), SECTION, created),
    )
