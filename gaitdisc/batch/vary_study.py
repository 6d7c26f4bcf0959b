"""Participants' models with one thing changed at a time: less training data, inputs left away, other filters."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import pandas as pd

from gaitdisc.batch.processed_walks import processed_walks, response_key, unit_keys
from gaitdisc.batch.public_words import words_of
from gaitdisc.batch.run_study import response_settings, run_study
from gaitdisc.batch.workers import StudyProgress, Workers, computed_units
from gaitdisc.errors import GaitdiscError, SchemaError
from gaitdisc.ingest.c3d import C3DReader
from gaitdisc.ingest.reading import read_planned_trial
from gaitdisc.ingest.study import Participant, Study
from gaitdisc.processing.filter_null import filter_null_of
from gaitdisc.processing.process import ReadWalk, StudyWalks
from gaitdisc.recording import Trajectory
from gaitdisc.response.fit_response import ResponseSettings, fit_response, held_out_part
from gaitdisc.response.modalities import (
    LENGTHS_S,
    Setting,
    compare_variants,
    fit_data_quantity,
    fit_without,
    settings_around,
    shortened,
)
from gaitdisc.response.over_participants import compare_participants
from gaitdisc.results.over_participants import OVER
from gaitdisc.results.participant_response import QUANTITY, RESPONSE, DataQuantity, ResponseRun
from gaitdisc.results.provenance import Refusal
from gaitdisc.results.study_run import save_run
from gaitdisc.results.variants import QUESTIONS, VARIANT_COLUMNS, VARIANTS, VariantRun, Variants, save_variant_run
from gaitdisc.write_lock import write_lock

Progress = Callable[[float], None]


def vary_study(
    study: Study, folder: Path, question: str, workers: Workers | None = None, progress: StudyProgress = lambda *_: None
) -> VariantRun:
    """Fit every participant's models with one thing changed at a time; the run itself is made first if it is not there.

    question: `modalities`, without one family of inputs at a time, or `sensitivity`, other cut-offs and lengths; its
        result also lies in a folder of that name in the run's
    progress: called with a pseudonym and the fraction of that participant's work that is done
    """
    if question not in QUESTIONS:
        raise SchemaError(f"questions are {', '.join(QUESTIONS)}", f"found {question!r}", "Use one of these.")
    workers = workers or Workers()
    run = run_study(study, folder, workers)
    with write_lock(folder, run=True):
        people = [study.participant(response.participant) for response in run.responses]
        compute = partial(computed_variants, study, folder=folder.absolute(), question=question)
        found = list(computed_units(workers, compute, people, progress, lambda refusal: refusal))
        computed = tuple(each for each in found if isinstance(each, Variants))
        lengths = [response.held_out_s for response in run.responses] or [0.0]
        varied = VariantRun(
            run.title,
            run.exo,
            question,
            computed,
            compare_variants(computed, question),
            (*run.refusals, *(each for each in found if isinstance(each, Refusal))),
            (min(lengths), max(lengths)),
            run.renewed,
        )
        save_variant_run(varied, folder / question)
    return varied


def computed_variants(
    study: Study, participant: Participant, folder: Path, question: str, progress: Progress
) -> Variants | Refusal:
    """Compute one participant's variants, or load what was computed from the same files and settings."""
    place = folder / question / "people" / participant.id
    varied = [question, *(repr(setting) for setting in _settings(study) if question == "sensitivity")]
    parts = [response_key(unit_keys(study, participant)), *varied]
    key = hashlib.sha256("\n".join(parts).encode()).hexdigest()
    stored = VARIANTS.kept(place, key)
    if stored is not None:
        return stored
    found = (_modalities if question == "modalities" else _sensitivity)(study, participant, progress)
    if isinstance(found, Variants):
        VARIANTS.save(found, place, key)
    return found


def _modalities(study: Study, participant: Participant, progress: Progress) -> Variants | Refusal:
    walks, refusals = processed_walks(study, participant)
    if refusals:
        return refusals[0]
    nominal, exo = (walks[word].trajectory for word in study.conditions.both)
    try:
        table = fit_without(nominal, exo, response_settings(study), progress)
    except GaitdiscError as error:
        return Refusal(participant.id, "", str(error))
    return Variants(participant.id, "modalities", table, {})


def _sensitivity(study: Study, participant: Participant, progress: Progress) -> Variants | Refusal:
    public = words_of(study, participant)
    try:
        with C3DReader() as reader:
            planned = {word: participant.trials_of(word)[0] for word in study.conditions.both}
            own = StudyWalks(study, participant, lambda one: read_planned_trial(study, participant, one, reader))
            trials = {word: own.read_walk(one) for word, one in planned.items()}
    except GaitdiscError as error:
        return Refusal(participant.id, "", str(public.error(error)))
    tables, left_away = [], {}
    settings = _settings(study)
    for number, setting in enumerate(settings):
        try:
            share = partial(lambda before, done: progress((before + done) / len(settings)), number)
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
    null = filter_null_of(exo, filtered.filters)
    less_nominal, less_exo = (_first_share(walk.trajectory, fits, setting.share) for walk in (nominal, exo))
    found = fit_response(less_nominal, less_exo, fits, null, progress).r2
    return found[found["walk"] == "exo"]


def _first_share(walk: Trajectory, fits: ResponseSettings, share: float) -> Trajectory:
    """Walk of whose training part the first so much is used."""
    if share == 1:
        return walk
    return shortened(walk, fits, share * len(held_out_part(walk, fits)[0].time) / walk.rate_hz, "first")


def _settings(study: Study) -> tuple[Setting, ...]:
    filters = study.filters
    return settings_around(filters.kinematics_hz, filters.emg_lowpass_hz, bool(study.models.emg))


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
    workers = workers or Workers()
    run = run_study(study, folder, workers)
    with write_lock(folder, run=True):
        people = [study.participant(response.participant) for response in run.responses]
        compute = partial(computed_quantity, study, folder=folder.absolute(), lengths_s=lengths_s, part=part)
        found = list(computed_units(workers, compute, people, progress, lambda refusal: refusal))
        quantities = tuple(each for each in found if isinstance(each, DataQuantity))
        run = replace(
            run.with_units(QUANTITY, quantities).with_units(
                OVER, (compare_participants(run.responses, quantities, study.models.seed),)
            ),
            refusals=(*run.refusals, *(each for each in found if isinstance(each, Refusal))),
        )
        save_run(run, folder)
    return run


def computed_quantity(
    study: Study,
    participant: Participant,
    folder: Path,
    lengths_s: Sequence[float],
    part: str,
    progress: Callable[[float], None],
) -> DataQuantity | Refusal:
    """Compute what less data (lengths [s]) gives a participant, or load what rests on the same files and settings."""
    key = response_key(unit_keys(study, participant))
    place = folder / "quantities" / participant.id
    stored = QUANTITY.kept(place, key)
    if stored is not None and stored.part == part:
        there = {round(float(length), 6) for length in stored.table["length_s"]} | set(stored.left_away)
        if {round(length, 6) for length in lengths_s} <= there:
            return stored
    walks, refusals = processed_walks(study, participant)
    if refusals:
        return refusals[0]
    nominal, exo = (walks[word].trajectory for word in study.conditions.both)
    try:
        whole = RESPONSE.kept(folder / "responses" / participant.id, key)
        quantity = fit_data_quantity(nominal, exo, response_settings(study), lengths_s, part, progress, whole)
    except GaitdiscError as error:
        return Refusal(participant.id, "", str(error))
    QUANTITY.save(quantity, place, key)
    return QUANTITY.kept(place, key) or quantity
