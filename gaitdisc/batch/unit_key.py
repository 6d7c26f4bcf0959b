"""What a unit rests on, as a hash: bytes of its files, settings, and the package's own code."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping

from gaitdisc.ingest.raw_file import file_sha256
from gaitdisc.ingest.study import Participant, PlannedTrial, Study
from gaitdisc.ingest.trial_sets import functional_trial, static_trial
from gaitdisc.results.provenance import code_sha256


def unit_keys(study: Study, participant: Participant) -> dict[str, str]:
    """Key of each of the two walks of a complete participant, by condition."""
    keys = {}
    for word in study.conditions.both:
        trial = participant.trials_of(word)[0]
        standing = static_trial(study, participant, trial.session or "")
        circled = functional_trial(study, participant, trial.session or "")
        parts = [person_key(study, participant), *(unit_key(study, one) for one in (trial, standing, circled) if one)]
        keys[word] = hashlib.sha256("\n".join(parts).encode()).hexdigest()
    return keys


def person_key(study: Study, participant: Participant) -> str:
    """What the study says of a person's body, and the bytes of its marker-set file."""
    said = f"{participant.mass_kg} {participant.height_m} {participant.sex} {participant.age_years}"
    named = study.kinematics.marker_set if study.kinematics else ""
    own = named.endswith(".toml") and study.path_of(named).is_file()
    return f"{said} {file_sha256(study.path_of(named))}" if own else said


def response_key(keys: Mapping[str, str]) -> str:
    """Key of what is fitted to both walks."""
    return hashlib.sha256("".join(keys.values()).encode()).hexdigest()


def unit_key(study: Study, trial: PlannedTrial) -> str:
    """Hash of all that decides a walk's numbers: bytes of its files, settings, and the package's own code."""
    settings = study.model_dump(mode="json", exclude={"participants", "title"})
    parts = [code_sha256(), json.dumps(settings, sort_keys=True), trial.model_dump_json(exclude={"files"})]
    for file in trial.files:
        try:
            parts.append(file_sha256(study.path_of(file)))
        except OSError as error:
            parts.append(f"{file}: {error.strerror}")
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()
