"""Participants' models with one thing changed at a time: less training data, inputs left away, other filters."""

import hashlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TypeVar

import pandas as pd

from gaitdisc.errors import GaitdiscError, SchemaError
from gaitdisc.ingest.c3d import C3DReader
from gaitdisc.ingest.public_words import list_words
from gaitdisc.ingest.reading import read_planned_trial
from gaitdisc.ingest.study import Participant, Study
from gaitdisc.processing.process import ReadWalk, StudyWalks, make_filter_null
from gaitdisc.processing.processed_walks import process_walks, response_key, unit_keys
from gaitdisc.recording import Trajectory
from gaitdisc.response.fit_response import fit_response, report_share
from gaitdisc.response.over_participants import compare_participants
from gaitdisc.response.participant_response import QUANTITY, QUESTIONS, RESPONSE, DataQuantity, ResponseRun
from gaitdisc.response.participants_result import OVER
from gaitdisc.response.variants import VARIANT_COLUMNS, VARIANTS, VariantRun, Variants, save_variant_run
from gaitdisc.response.vary import (
    LENGTHS_S,
    Setting,
    compare_variants,
    first_share,
    fit_data_quantity,
    fit_without,
    settings_around,
)
from gaitdisc.run.run_study import Progress, response_settings, run_study
from gaitdisc.run.workers import StudyProgress, Workers, compute_units
from gaitdisc.saved.provenance import Refusal
from gaitdisc.saved.study_run import save_run
from gaitdisc.write_lock import write_lock

Unit = TypeVar("Unit")


def vary_study(
    study: Study, folder: Path, question: str, workers: Workers | None = None, progress: StudyProgress = lambda *_: None
) -> VariantRun:
    """Fit every participant's models with one thing changed at a time; the run itself is made first if it is not there.

    question: `modalities`, without one family of inputs at a time, or `sensitivity`, other cut-offs and lengths; its
        result also lies in a folder of that name in the run's
    """
    if question not in QUESTIONS:
        raise SchemaError(f"the question must be {' or '.join(QUESTIONS)}", f"found {question!r}", "Use one of these.")
    compute = partial(compute_variants, study, folder=folder.absolute(), question=question)
    with _vary(study, folder, compute, workers, progress) as (run, people):
        lengths = [response.held_out_s for response in run.responses] or [0.0]
        tests = compare_variants(people, question)
        held_out_s = (min(lengths), max(lengths))
        varied = VariantRun(
            run.title, run.exo, question, people, tests, run.refusals, held_out_s=held_out_s, renewed=run.renewed
        )
        save_variant_run(varied, folder / question)
    return varied


def ablate_study(
    study: Study,
    folder: Path,
    lengths_s: Sequence[float] = LENGTHS_S,
    part: str = "first",
    workers: Workers | None = None,
    progress: StudyProgress = lambda *_: None,
) -> ResponseRun:
    """Fit every participant's models to less and less data; the run itself is made first where it is not there.

    lengths_s: of the training part [s]; its whole length is always added. Who had to be refused is in `refusals`.
    """
    compute = partial(compute_quantity, study, folder=folder.absolute(), lengths_s=lengths_s, part=part)
    with _vary(study, folder, compute, workers, progress) as (run, quantities):
        over = compare_participants(run.responses, quantities, study.models.seed)
        ablated = run.with_units(QUANTITY, quantities).with_units(OVER, (over,))
        save_run(ablated, folder)
    return ablated


@contextmanager
def _vary(
    study: Study, folder: Path, compute: Callable[..., Unit | Refusal], workers: Workers | None, progress: StudyProgress
) -> Iterator[tuple[ResponseRun, tuple[Unit, ...]]]:
    """Run of a study with those who are refused now, and what is computed of each participant; the run is locked."""
    workers = workers or Workers()
    run = run_study(study, folder, workers)
    with write_lock(folder, run=True):
        people = [study.participant(response.participant) for response in run.responses]
        units = list(compute_units(workers, compute, people, progress, lambda refusal: refusal))
        run = replace(run, refusals=(*run.refusals, *(unit for unit in units if isinstance(unit, Refusal))))
        yield run, tuple(unit for unit in units if not isinstance(unit, Refusal))


def compute_variants(
    study: Study, participant: Participant, folder: Path, question: str, progress: Progress
) -> Variants | Refusal:
    """Compute one participant's variants, or load what was computed from the same files and settings."""
    place = folder / question / "people" / participant.id
    varied = [question, *(repr(setting) for setting in _settings(study) if question == "sensitivity")]
    key = hashlib.sha256("\n".join([response_key(unit_keys(study, participant)), *varied]).encode()).hexdigest()
    stored = VARIANTS.kept(place, key)
    if stored is not None:
        return stored
    if question == "sensitivity":
        variants = _sensitivity(study, participant, progress)
    else:
        table = _fitted(study, participant, partial(fit_without, settings=response_settings(study), progress=progress))
        variants = table if isinstance(table, Refusal) else Variants(participant.id, question, table, {})
    if isinstance(variants, Variants):
        VARIANTS.save(variants, place, key)
    return variants


def compute_quantity(
    study: Study, participant: Participant, folder: Path, lengths_s: Sequence[float], part: str, progress: Progress
) -> DataQuantity | Refusal:
    """Compute what less data (lengths [s]) gives a participant, or load what rests on the same files and settings."""
    key = response_key(unit_keys(study, participant))
    place = folder / "quantities" / participant.id
    stored = QUANTITY.kept(place, key)
    if stored is not None and stored.part == part:
        there = {round(float(length), 6) for length in stored.table["length_s"]} | set(stored.left_away)
        if {round(length, 6) for length in lengths_s} <= there:
            return stored
    response = RESPONSE.kept(folder / "responses" / participant.id, key)
    fit = partial(fit_data_quantity, settings=response_settings(study), lengths_s=lengths_s, part=part, whole=response)
    quantity = _fitted(study, participant, partial(fit, progress=progress))
    if isinstance(quantity, Refusal):
        return quantity
    QUANTITY.save(quantity, place, key)
    return QUANTITY.kept(place, key) or quantity


def _fitted(study: Study, participant: Participant, fit: Callable[[Trajectory, Trajectory], Unit]) -> Unit | Refusal:
    """What is fitted to both walks of a participant, or why it cannot be."""
    walks, refusals = process_walks(study, participant)
    if refusals:
        return refusals[0]
    nominal, exo = (walks[word].trajectory for word in study.conditions.both)
    try:
        return fit(nominal, exo)
    except GaitdiscError as error:
        return Refusal(participant.id, "", str(error))


def _sensitivity(study: Study, participant: Participant, progress: Progress) -> Variants | Refusal:
    public = list_words(study, participant)
    try:
        with C3DReader() as reader:
            planned = {word: participant.trials_of(word)[0] for word in study.conditions.both}
            walks = StudyWalks(study, participant, lambda trial: read_planned_trial(study, participant, trial, reader))
            trials = {word: walks.read_walk(trial) for word, trial in planned.items()}
    except GaitdiscError as error:
        return Refusal(participant.id, "", str(public.error(error)))
    tables, left_away = [], {}
    settings = _settings(study)
    for number, setting in enumerate(settings):
        try:
            share = partial(report_share, progress, number, len(settings))
            tables.append(_under(study, trials, setting, share).assign(variant=setting.name))
        except GaitdiscError as error:
            left_away[setting.name] = str(public.error(error))
    if not tables:
        return Refusal(participant.id, "", next(iter(left_away.values())))
    table = pd.concat(tables, ignore_index=True)[list(VARIANT_COLUMNS)]
    return Variants(participant.id, "sensitivity", table, left_away)


def _under(study: Study, trials: Mapping[str, ReadWalk], setting: Setting, progress: Progress) -> pd.DataFrame:
    """R2 on device walking under one setting."""
    cut_offs = {"kinematics_hz": setting.angles_hz, "emg_lowpass_hz": setting.emg_hz}
    filtered = study.model_copy(update={"filters": study.filters.model_copy(update=cut_offs)})
    nominal, exo = (trials[word].processed(filtered) for word in study.conditions.both)
    fits = response_settings(study)
    null = make_filter_null(exo, filtered.filters)
    less = [first_share(walk.trajectory, fits, setting.share) for walk in (nominal, exo)]
    scores = fit_response(less[0], less[1], fits, null, progress).r2
    return scores[scores["walk"] == "exo"]


def _settings(study: Study) -> tuple[Setting, ...]:
    filters = study.filters
    return settings_around(filters.kinematics_hz, filters.emg_lowpass_hz, bool(study.models.emg))
