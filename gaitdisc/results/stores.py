"""How each kind of result lies in a folder: what its JSON file says, its tables and its arrays, by one typed codec."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields, is_dataclass
from functools import cache, partial
from operator import itemgetter
from pathlib import Path
from typing import Any, Generic, NamedTuple, TypeVar, get_args, get_origin, get_type_hints

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gaitdisc.errors import SchemaError
from gaitdisc.recording import Finding
from gaitdisc.results.mismatch import CHANNEL_COLUMNS, REGION_COLUMNS, Mismatch
from gaitdisc.results.on_disk import Arrays
from gaitdisc.results.over_participants import FAMILY_COLUMNS, TABLES, TEST_COLUMNS, OverParticipants, PairTests
from gaitdisc.results.participant_response import (
    FIT_COLUMNS,
    QUANTITY_COLUMNS,
    R2_COLUMNS,
    DataQuantity,
    HeldOut,
    ParticipantResponse,
)
from gaitdisc.results.pooled_cycles import CYCLE_COLUMNS, PooledCycles
from gaitdisc.results.provenance import Refusal
from gaitdisc.results.reconstruction import Reconstruction
from gaitdisc.results.unit_folder import NO_KEY, Keyed, load_unit, save_unit, stored_finding, with_words
from gaitdisc.results.variants import VARIANT_COLUMNS, VARIANT_TEST_COLUMNS, VariantRun, Variants
from gaitdisc.results.walk_summary import STRIDE_COLUMNS, WalkSummary

T = TypeVar("T")


@dataclass(frozen=True)
class Refused:
    """Why a participant was refused: a run that goes on does not read and process the walks again."""

    refusals: tuple[Refusal, ...]
    walks: tuple[str, ...]  # conditions whose walk was processed


class CSV(NamedTuple):
    """A table beside the JSON file."""

    file: str
    columns: Sequence[str] | None  # that it must have; None: the table may be missing
    alone: bool = False  # whether it is read with these columns and no others


@dataclass(frozen=True)
class Form(Generic[T]):
    """How a kind of result lies in a folder; its fields are read back as they are annotated."""

    kind: type[T]
    name: str  # of the JSON file, and its place in `results.schema.json`
    named: tuple[str, ...]  # what the JSON file says, in its order: fields, or properties that are not read back
    tables: Mapping[str, CSV] = field(default_factory=dict)  # by field
    arrays: Mapping[str, Callable[[Arrays], Any]] = field(default_factory=dict)  # field -> how it is made of the arrays
    written: Callable[[T], Mapping[str, NDArray[np.float64]]] | None = None  # all arrays by name
    later: bool = True  # whether arrays are read when they are looked at
    keyed: bool = True  # whether the JSON file says what the result was computed from
    reasons: str = ""  # what the keys of `left_away` are called
    flags: tuple[str, ...] = ()  # columns that are true or false
    words: tuple[str, ...] = ()  # columns whose cells are words, also where they look like numbers
    blank: tuple[str, ...] = ()  # columns of words that may be empty

    def save(self, result: T, folder: Path, key: str = NO_KEY) -> None:
        """Save a result; key: what it was computed from, a hash of files and settings."""
        data = {"key": key} if self.keyed else {}
        data |= {name: _plain(getattr(result, name), self.reasons) for name in self.named}
        tables = {csv.file: getattr(result, name) for name, csv in self.tables.items()}
        there = {file: table for file, table in tables.items() if table is not None}
        save_unit(folder, self.name, data, there, self.written(result) if self.written else {})

    def load(self, folder: Path) -> T:
        """Load a result."""
        return self.load_keyed(folder).result

    def load_keyed(self, folder: Path) -> Keyed[T]:
        """Load a result, and the key it was computed from."""
        wanted = {csv.file: csv.columns for csv in self.tables.values() if csv.columns is not None}
        data, tables, arrays = load_unit(folder, self.name, wanted, self.words)
        hints = _hints(self.kind)
        found = {name: _typed(hints[name], data[name]) for name in self.named if name in hints and name in data}
        found |= {name: self._table(csv, tables) for name, csv in self.tables.items()}
        found |= {name: arrays.later(made) if self.later else made(arrays) for name, made in self.arrays.items()}
        return Keyed(self.kind(**found), data.get("key", ""))

    def kept(self, folder: Path, key: str) -> T | None:
        """Load a result that was computed from this very key; None where there is none that is whole."""
        try:
            found = self.load_keyed(folder)
        except SchemaError:
            return None
        return found.result if found.key == key else None

    def _table(self, csv: CSV, tables: Mapping[str, pd.DataFrame]) -> pd.DataFrame | None:
        table = tables.get(csv.file)
        if table is None:
            return None
        for column in self.blank:
            with_words(table, column)
        for column in self.flags:
            table[column] = table[column].astype(bool)
        return pd.DataFrame(table, columns=pd.Index(csv.columns or ())) if csv.alone else table


def _plain(value: Any, reasons: str) -> Any:
    """What JSON holds of a field; of a mapping to reasons, rows that name both."""
    if is_dataclass(value) and not isinstance(value, type):
        return asdict(value)
    if isinstance(value, tuple):
        return [_plain(one, reasons) for one in value]
    if isinstance(value, Mapping):
        return [{reasons: name, "reason": why} for name, why in value.items()] if reasons else dict(value)
    return value


def _typed(hint: Any, value: Any) -> Any:
    """A field as it is annotated, of what JSON held of it."""
    if get_origin(hint) is tuple:
        return tuple(_typed(get_args(hint)[0], one) for one in value)
    if hint is Finding:
        return stored_finding(value)
    if is_dataclass(hint) and isinstance(hint, type):
        return hint(**value)
    if get_origin(hint) is Mapping and isinstance(value, list):
        kind = get_args(hint)[0]
        return {kind(one): str(row["reason"]) for row in value for name, one in row.items() if name != "reason"}
    return value


@cache
def _hints(kind: type) -> dict[str, Any]:
    own = {one.name for one in fields(kind)}
    return {name: hint for name, hint in get_type_hints(kind).items() if name in own}


def _curves(result: WalkSummary | PooledCycles) -> dict[str, NDArray[np.float64]]:
    return {"curves": result.curves}


def _keyed(arrays: Arrays, prefix: str) -> dict[str, NDArray[np.float64]]:
    return {key.removeprefix(prefix): values for key, values in arrays.items() if key.startswith(prefix)}


def _held_out(arrays: Arrays) -> HeldOut:
    predicted, bands = _keyed(arrays, "predicted_"), _keyed(arrays, "band_")
    return HeldOut(arrays["time"], arrays["phi"], arrays["measured"], predicted, bands)


def _predicted(response: ParticipantResponse) -> dict[str, NDArray[np.float64]]:
    held = response.held_out
    every = {"predicted": held.predicted, "band": held.bands, "residual": response.residuals}
    own = {f"{word}_{model}": values for word, of in every.items() for model, values in of.items()}
    return {"time": held.time, "phi": held.phi, "measured": held.measured, **own}


WALK = Form(
    WalkSummary,
    "walk.json",
    ("subject", "condition", "duration_s", "rate_hz", "detector", "channels", "findings", "files"),
    {"strides": CSV("strides.csv", STRIDE_COLUMNS)},
    {"curves": itemgetter("curves")},
    _curves,
    blank=("reason",),
)
CYCLES = Form(
    PooledCycles,
    "cycles.json",
    ("subject", "group", "session", "condition", "trials", "detectors", "contact_offset_s", "foot_off_offset_s",
     "offset_steps", "over_ground", "channels", "findings", "refusals", "files", "leg_m", "age_years"),
    {"cycles": CSV("cycles.csv", CYCLE_COLUMNS)},
    {"curves": itemgetter("curves")},
    _curves,
    flags=("kinetic", "kept"),
    blank=("reason", "foot_off_by"),
)  # fmt: skip
RESPONSE = Form(
    ParticipantResponse,
    "response.json",
    ("participant", "inputs", "outputs", "units", "held_out_s"),
    {"r2": CSV("r2.csv", R2_COLUMNS), "fits": CSV("fits.csv", FIT_COLUMNS)},
    {"held_out": _held_out, "residuals": partial(_keyed, prefix="residual_")},
    _predicted,
)
QUANTITY = Form(
    DataQuantity,
    "quantity.json",
    ("participant", "part", "left_away"),
    {"table": CSV("quantity.csv", QUANTITY_COLUMNS)},
    reasons="length_s",
)
VARIANTS = Form(
    Variants,
    "variants.json",
    ("participant", "question", "left_away"),
    {"table": CSV("variants.csv", VARIANT_COLUMNS)},
    reasons="variant",
)
TESTS = Form(
    PairTests,
    "tests.json",
    ("participants", "alpha", "level", "too_few"),
    {"tests": CSV("tests.csv", TEST_COLUMNS), "families": CSV("families.csv", FAMILY_COLUMNS)},
    keyed=False,
    blank=("left_out",),
)
OVER = Form(
    OverParticipants,
    "over.json",
    ("lengths_said", "responders_said"),
    {name: CSV(f"{name}.csv", columns) for name, columns in TABLES.items()},
    keyed=False,
    blank=("left_out",),
)
REFUSED = Form(Refused, "refused.json", ("refusals", "walks"))
MISMATCH = Form(
    Mismatch,
    "mismatch.json",
    ("first", "second", "channels", "exchange", "alignment", "findings", "provenance"),
    {"regions": CSV("regions.csv", REGION_COLUMNS, True), "summary": CSV("summary.csv", CHANNEL_COLUMNS, True)},
    {"curves": dict},
    lambda mismatch: dict(mismatch.curves),
    later=False,
    keyed=False,
)
RECONSTRUCTION = Form(
    Reconstruction,
    "reconstruction.json",
    ("title", "sensors", "states", "split", "history", "models", "recommended", "refusals", "findings", "provenance"),
    {
        "errors": CSV("errors.csv", ("participant", "model", "state", "unit", "rmse")),
        "summary": CSV("summary.csv", ("participant", "model", "strides", "check_loss")),
        "curves": CSV("curves.csv", ("participant", "model", "state", "percent", "measured", "measured_sd")),
        "search": CSV("search.csv", None),
    },
    keyed=False,
    words=("participant", "model", "state", "unit"),
)


def save_variant_run(run: VariantRun, folder: Path) -> None:
    """Save what was found over the participants, beside theirs, which were saved as they were computed."""
    data = {
        "title": run.title,
        "exo": run.exo,
        "question": run.question,
        "people": [each.participant for each in run.people],
        "refusals": _plain(run.refusals, ""),
        "held_out_s": list(run.held_out_s),
    }
    save_unit(folder, "variant_run.json", data, {"tests.csv": run.tests}, {})


def save_whole_variant_run(run: VariantRun, folder: Path) -> None:
    """Save what was found over the participants, and the variants of each, as they are in memory."""
    for each in run.people:
        VARIANTS.save(each, folder / "people" / each.participant)
    save_variant_run(run, folder)


def load_variant_run(folder: Path) -> VariantRun:
    """Load what was found over the participants."""
    data, tables, _ = load_unit(folder, "variant_run.json", {"tests.csv": VARIANT_TEST_COLUMNS})
    return VariantRun(
        data["title"],
        data["exo"],
        data["question"],
        tuple(VARIANTS.load(folder / "people" / name) for name in data["people"]),
        with_words(tables["tests.csv"], "left_out"),
        _typed(tuple[Refusal, ...], data["refusals"]),
        (data["held_out_s"][0], data["held_out_s"][1]),
    )


def unit_name(subject: str, condition: str) -> str:
    """Folder name of a walk: letters, digits, `-` and `_` only, another one for every person and condition.

    >>> unit_name("P01", "exo"), unit_name("P01", "no spring"), unit_name("P01", "no_spring")
    ('P01-exo', 'P01-no_spring-e4cfa24e', 'P01-no_spring')
    """
    who = "".join(letter if letter.isalnum() or letter in "-_" else "_" for letter in subject)
    plain = "".join(letter if letter.isalnum() or letter == "_" else "_" for letter in condition)
    if (who, plain) == (subject, condition):
        return f"{subject}-{condition}"
    hashed = hashlib.sha256(" ".join((subject, condition)).encode()).hexdigest()[:8]
    return f"{who}-{plain}-{hashed}"


def cycles_name(subject: str, session: str, condition: str) -> str:
    """Folder name of pooled cycles, another one for every person, session and condition.

    >>> cycles_name("P01", "", "turn"), cycles_name("P01", "after", "turn")
    ('P01-turn', 'P01-after___turn-c681ddd0')
    """
    return unit_name(subject, f"{session} / {condition}" if session else condition)
