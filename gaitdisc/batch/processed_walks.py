"""Both walks of a participant, from the study's files to filtered, stride-cut walks."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from gaitdisc.batch.public_words import PublicWords, of_trial, words_of
from gaitdisc.errors import GaitdiscError
from gaitdisc.ingest.c3d import C3DReader
from gaitdisc.ingest.reading import read_planned_trial
from gaitdisc.ingest.study import Participant, PlannedTrial, Study
from gaitdisc.ingest.trial_sets import not_compared
from gaitdisc.processing.study_walks import StudyWalks
from gaitdisc.processing.walk import Walk
from gaitdisc.recording import Trial
from gaitdisc.response.samples import gait_samples
from gaitdisc.results.provenance import Refusal


def processed_walks(study: Study, participant: Participant) -> tuple[dict[str, Walk], tuple[Refusal, ...]]:
    """Both walks of a participant by condition, and why one could not be had, in public words; it needs one of each."""
    lacking = not_compared(study, participant)
    if lacking:
        return {}, (Refusal(participant.id, "", lacking),)
    walks, errors = walks_and_errors(study, participant)
    return walks, tuple(Refusal(participant.id, word, str(error)) for word, error in errors.items())


def walks_and_errors(study: Study, participant: Participant) -> tuple[dict[str, Walk], dict[str, GaitdiscError]]:
    """Both walks of a complete participant, by condition, and the error of one that could not be, in public words."""
    walks, errors = {}, {}
    words = words_of(study, participant)
    with C3DReader() as reader:  # starts its process at the first C3D file, one for both walks
        own = StudyWalks(study, participant, partial(public_trial, study, participant, words, reader))
        for word in study.conditions.both:
            try:
                planned = participant.trials_of(word)[0]
                public = of_trial(words, participant, planned)
                walks[word] = public.of(partial(_walk, own, planned, public))
            except GaitdiscError as error:
                errors[word] = error
    return walks, errors


def public_trial(
    study: Study, participant: Participant, words: PublicWords, reader: C3DReader, planned: PlannedTrial
) -> Trial:
    """Trial of a study, read, whose files and findings are called by public words alone."""
    public = of_trial(words, participant, planned)
    return public.of(lambda: public.trial(read_planned_trial(study, participant, planned, reader)))


def _walk(own: StudyWalks, planned: PlannedTrial, public: PublicWords) -> Walk:
    walk = own.walk(planned)
    left_away = gait_samples(walk.trajectory, own.study.models.outputs)[1].finding()
    return replace(walk, findings=tuple(map(public.finding, (*walk.findings, left_away))))
