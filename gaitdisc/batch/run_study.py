"""Run a study: every participant, one after the other or side by side, kept as they come, taken up where it stopped."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict
from datetime import UTC, datetime
from pathlib import Path

from gaitdisc.batch.participant_unit import ParticipantUnit, computed_unit, response_settings
from gaitdisc.batch.quantity_unit import stored_quantity
from gaitdisc.batch.run_lock import run_lock
from gaitdisc.ingest.study import Participant, Study
from gaitdisc.response.comparison import compare_models
from gaitdisc.results import DataQuantity, ParticipantResponse, Provenance, ResponseRun
from gaitdisc.results.provenance import installed_versions
from gaitdisc.results.store import save_run

SECTION = "4.2, Eqs. 4.1-4.5"
Told = Callable[[str, float], None]


def run_study(
    study: Study,
    folder: Path,
    jobs: int = 1,
    told: Told = lambda *_: None,
) -> ResponseRun:
    """Process every walk of a study and fit every participant's models.

    A participant whose files, settings and package version are those of an earlier run in the same folder is loaded,
    not computed; so a run that was stopped goes on, and loses at most the participant it was at.

    Parameters
    ----------
    study : Study
        Who, which files, which settings.
    folder : Path
        Folder of the run; made where it is missing.
    jobs : int
        Processes side by side, each with one thread; 1 works in this process.
    told : callable
        Called with a participant's pseudonym and the fraction of that participant's work that is done.

    Returns
    -------
    ResponseRun
        Also saved in the folder; refusals are part of it.

    Raises
    ------
    WriteError
        If another run works in the folder, or it cannot be written.
    """
    with run_lock(folder):
        units = list(_units(study, folder, jobs, told))
        responses = tuple(unit.response for unit in units if unit.response is not None)
        run = ResponseRun(
            study.title or study.folder.name,
            study.conditions.nominal,
            study.conditions.device,
            tuple(walk for unit in units for walk in unit.walks),
            responses,
            tuple(refusal for unit in units for refusal in unit.refusals),
            _provenance(study, units),
            compare_models(responses),
            _stored_quantities(study, responses, folder),
        )
        save_run(run, folder)
    return run


def _units(study: Study, folder: Path, jobs: int, told: Told) -> Iterator[ParticipantUnit]:
    people: Sequence[Participant] = study.participants
    if jobs == 1 or len(people) == 1:
        for person in people:
            yield computed_unit(study, person, folder, lambda share, who=person.id: told(who, share))
            told(person.id, 1.0)
        return
    from joblib import Parallel, delayed

    work = (delayed(computed_unit)(study, person, folder, _untold) for person in people)
    results = Parallel(n_jobs=jobs, return_as="generator", inner_max_num_threads=1, backend="loky")(work)
    for person, unit in zip(people, results, strict=True):
        assert isinstance(unit, ParticipantUnit)
        told(person.id, 1.0)
        yield unit


def _stored_quantities(
    study: Study, responses: Sequence[ParticipantResponse], folder: Path
) -> tuple[DataQuantity, ...]:
    found = (stored_quantity(study, study.participant(each.participant), folder) for each in responses)
    return tuple(quantity for quantity in found if quantity is not None)


def _provenance(study: Study, units: Sequence[ParticipantUnit]) -> Provenance:
    files = {name: sha for unit in units for walk in unit.walks for name, sha in walk.files.items()}
    created = datetime.now(UTC).isoformat(timespec="seconds")
    settings = {**study.model_dump(mode="json"), "fits": asdict(response_settings(study))}
    return Provenance(settings, study.models.seed, files, installed_versions(), SECTION, created)


def _untold(fraction: float) -> None:
    """Progress within a participant does not cross the border of a process."""
