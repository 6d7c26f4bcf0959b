"""One participant's models fitted to less and less data; kept on disk as soon as it is whole."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from gaitdisc.batch.participant_unit import response_settings
from gaitdisc.batch.processed_walks import processed_walks
from gaitdisc.batch.unit_key import response_key, unit_keys
from gaitdisc.errors import GaitdiscError, SchemaError
from gaitdisc.ingest.study import Participant, Study
from gaitdisc.response.data_quantity import fit_data_quantity
from gaitdisc.results import DataQuantity, ParticipantResponse, Refusal
from gaitdisc.results.stores import QUANTITY, RESPONSE


def computed_quantity(
    study: Study,
    participant: Participant,
    folder: Path,
    lengths_s: Sequence[float],
    part: str,
    progress: Callable[[float], None],
) -> DataQuantity | Refusal:
    """Compute what less data gives one participant, or load what was computed from the same files and settings.

    lengths_s: lengths of the training part [s]
    """
    key = response_key(unit_keys(study, participant))
    stored = stored_quantity(participant, folder, key)
    if stored is not None and stored.part == part and _has(stored, lengths_s):
        return stored
    walks, refusals = processed_walks(study, participant)
    if refusals:
        return refusals[0]
    nominal, exo = (walks[word].trajectory for word in study.conditions.both)
    try:
        whole = _whole(participant, folder, key)
        quantity = fit_data_quantity(nominal, exo, response_settings(study), lengths_s, part, progress, whole)
    except GaitdiscError as error:
        return Refusal(participant.id, "", str(error))
    QUANTITY.save(quantity, _folder(folder, participant), key)
    return stored_quantity(participant, folder, key) or quantity


def stored_quantity(participant: Participant, folder: Path, key: str) -> DataQuantity | None:
    """Load what an earlier `ablate` computed from the same files and settings, if it is there and whole."""
    try:
        quantity, stored_key = QUANTITY.load_keyed(_folder(folder, participant))
    except SchemaError:
        return None
    return quantity if stored_key == key else None


def _whole(participant: Participant, folder: Path, key: str) -> ParticipantResponse | None:
    """What the run has of the whole training part, if it rests on the same files and settings."""
    try:
        response, stored_key = RESPONSE.load_keyed(folder / "responses" / participant.id)
    except SchemaError:
        return None
    return response if stored_key == key else None


def _has(quantity: DataQuantity, lengths_s: Sequence[float]) -> bool:
    there = {round(float(length), 6) for length in quantity.table["length_s"]} | set(quantity.left_away)
    return {round(length, 6) for length in lengths_s} <= there


def _folder(folder: Path, participant: Participant) -> Path:
    return folder / "quantities" / participant.id
