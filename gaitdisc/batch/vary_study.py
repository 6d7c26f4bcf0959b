"""Every participant's models with one thing changed at a time: inputs left away, or filters and training lengths."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path

from gaitdisc.batch.run_lock import run_lock
from gaitdisc.batch.run_study import Told, run_study
from gaitdisc.batch.variant_unit import computed_variants
from gaitdisc.batch.workers import Workers, computed_side_by_side
from gaitdisc.errors import SchemaError
from gaitdisc.ingest.study import Participant, Study
from gaitdisc.response.modalities import compare_modalities
from gaitdisc.response.sensitivity import compare_settings
from gaitdisc.results import Refusal
from gaitdisc.results.variants import QUESTIONS, VariantRun, Variants


def vary_study(
    study: Study,
    folder: Path,
    question: str,
    workers: Workers | None = None,
    told: Told = lambda *_: None,
) -> VariantRun:
    """Fit every participant's models with one thing changed at a time; the run itself is made first if it is not there.

    Parameters
    ----------
    study : Study
        Who, which files, which settings.
    folder : Path
        Folder of the run; what is computed here goes into a folder of the question's name in it.
    question : str
        `modalities`: without one family of inputs at a time. `sensitivity`: other cut-offs and training lengths.
    workers : Workers, optional
        Where participants are computed; in this process, one after the other, by default.
    told : callable
        Called with a participant's pseudonym and the fraction of that participant's work that is done.

    Returns
    -------
    VariantRun
        Whoever had to be refused is in `refusals`.

    Raises
    ------
    SchemaError
        If the question is none.
    WriteError
        If another run works in the folder, or it cannot be written.
    ClusterError
        If the cluster cannot be reached.
    """
    if question not in QUESTIONS:
        raise SchemaError(f"a question is one of: {', '.join(QUESTIONS)}", f"found {question!r}", "Use one of these.")
    workers = workers or Workers()
    run = run_study(study, folder, workers)
    with run_lock(folder):
        asked = [study.participant(response.participant) for response in run.responses]
        found = list(_people(study, asked, folder, question, workers, told))
    people = tuple(each for each in found if isinstance(each, Variants))
    lengths = [response.held_out_s for response in run.responses] or [0.0]
    return VariantRun(
        run.title,
        run.exo,
        question,
        people,
        compare_modalities(people) if question == "modalities" else compare_settings(people),
        (*run.refusals, *(each for each in found if isinstance(each, Refusal))),
        (min(lengths), max(lengths)),
    )


def _people(
    study: Study, asked: Sequence[Participant], folder: Path, question: str, workers: Workers, told: Told
) -> Iterator[Variants | Refusal]:
    if workers.here:
        for person in asked:
            yield computed_variants(study, person, folder, question, partial(told, person.id))
            told(person.id, 1.0)
        return
    compute = partial(_computed_untold, study, folder.absolute(), question)
    for person, variants in computed_side_by_side(workers, compute, asked):
        told(person.id, 1.0)
        yield variants


def _computed_untold(study: Study, folder: Path, question: str, person: Participant) -> Variants | Refusal:
    """Progress within a participant does not cross the border of a process."""
    return computed_variants(study, person, folder, question, lambda _: None)
