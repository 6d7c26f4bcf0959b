"""Every participant's models with one thing changed at a time: inputs left away, or filters and training lengths."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path

from gaitdisc.batch.run_study import run_study
from gaitdisc.batch.variant_unit import computed_variants
from gaitdisc.batch.workers import StudyProgress, Workers, computed_units
from gaitdisc.errors import SchemaError
from gaitdisc.ingest.study import Study
from gaitdisc.response.modalities import compare_modalities, compare_settings
from gaitdisc.results import Refusal, ResponseRun
from gaitdisc.results.stores import save_variant_run
from gaitdisc.results.variants import QUESTIONS, VariantRun, Variants
from gaitdisc.write_lock import write_lock


def vary_study(
    study: Study,
    folder: Path,
    question: str,
    workers: Workers | None = None,
    progress: StudyProgress = lambda *_: None,
) -> VariantRun:
    """Fit every participant's models with one thing changed at a time; the run itself is made first if it is not there.

    folder: folder of the run; what is computed here goes into a folder of the question's name in it
    question: `modalities`: without one family of inputs at a time. `sensitivity`: other cut-offs and training lengths
    workers: where participants are computed; in this process, one after the other, by default
    progress: called with a participant's pseudonym and the fraction of that participant's work that is done
    returns: also saved in the folder of the question; whoever had to be refused is in `refusals`
    """
    if question not in QUESTIONS:
        raise SchemaError(f"a question is one of: {', '.join(QUESTIONS)}", f"found {question!r}", "Use one of these.")
    workers = workers or Workers()
    run = run_study(study, folder, workers)
    with write_lock(folder, run=True):
        people = [study.participant(response.participant) for response in run.responses]
        compute = partial(computed_variants, study, folder=folder.absolute(), question=question)
        found = list(computed_units(workers, compute, people, progress, lambda refusal: refusal))
        varied = _varied(run, question, found)
        save_variant_run(varied, folder / question)
    return varied


def _varied(run: ResponseRun, question: str, found: Sequence[Variants | Refusal]) -> VariantRun:
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
        run.renewed,
    )
