"""The laboratory's own controls, processed as everybody else and kept in one file: `reference.json`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import SchemaError
from gaitdisc.results.published_reference import PublishedGroup, read_published
from gaitdisc.results.sealed_json import read_sealed, sealed_text
from gaitdisc.whole_file import write_whole

FILE, FORMAT = "reference.json", 1
PUBLISHED = "published.csv"
DIGITS = 4


@dataclass(frozen=True, eq=False)
class ReferenceLeg:
    """Mean cycle of one leg of one control."""

    person: int  # number of the control; no pseudonym is kept
    side: str
    cycles: int
    stance_percent: float
    # each (phase,), clinical variable -> mean over the leg's cycles on 101 points
    curves: Mapping[str, NDArray[np.float64]]
    values: Mapping[str, float]  # spatiotemporal value -> mean over the leg's cycles
    leg_m: float | None = None  # leg length [m] and age in whole years; None where they are not known
    age_years: int | None = None  # leg length [m] and age in whole years; None where they are not known


@dataclass(frozen=True, eq=False)
class ClinicalReference:
    """Controls by condition."""

    title: str
    legs: Mapping[str, tuple[ReferenceLeg, ...]]  # condition -> legs
    settings: Mapping[str, object]  # filters and rules for strides they were processed with; what processed them
    versions: Mapping[str, str]  # filters and rules for strides they were processed with; what processed them
    created: str
    # where it is no laboratory's own: groups of speed, of which there are no legs
    published: tuple[PublishedGroup, ...] = ()

    def of(self, condition: str) -> tuple[ReferenceLeg, ...]:
        """Legs of a condition; none where the controls did not walk so."""
        return self.legs.get(condition, ())

    def people(self, condition: str) -> int:
        """Number of controls of a condition."""
        return len({leg.person for leg in self.of(condition)})

    def without(self, person: int) -> ClinicalReference:
        """Reference of all controls but one."""
        legs = {word: tuple(leg for leg in own if leg.person != person) for word, own in self.legs.items()}
        return ClinicalReference(self.title, legs, self.settings, self.versions, self.created)


def save_reference(reference: ClinicalReference, folder: Path) -> Path:
    """Save a reference as `reference.json`, whole, with a hash of its own."""
    if reference.published:
        raise SchemaError("a reference of legs is saved", f"{reference.title} is a published one", "Keep its table.")
    data = {
        "format": FORMAT,
        "title": reference.title,
        "created": reference.created,
        "settings": dict(reference.settings),
        "versions": dict(reference.versions),
        "legs": {word: [_leg_data(leg) for leg in own] for word, own in reference.legs.items()},
    }
    return write_whole(folder / FILE, sealed_text(data))


def load_reference(place: Path) -> ClinicalReference:
    """Load a reference from its folder or file, or a published one from its table."""
    table = place / PUBLISHED if place.is_dir() else place
    if table.suffix == ".csv" and table.is_file():
        source, groups = read_published(table)
        return ClinicalReference(source, {}, {}, {}, "", groups)
    path = place / FILE if place.is_dir() else place
    if not path.is_file():
        raise SchemaError(
            f"a reference is a folder with {FILE}",
            f"{place} has none",
            "Make it from the controls' recordings: gaitdisc reference CONTROLS --out FOLDER.",
        )
    data = read_sealed(path)
    if data.get("format") != FORMAT:
        raise SchemaError(
            f"a reference of format {FORMAT} is needed", f"{path} has {data.get('format')!r}", "Make it again."
        )
    try:
        legs = {word: tuple(map(_leg, own)) for word, own in data["legs"].items()}
        return ClinicalReference(data["title"], legs, data["settings"], data["versions"], data["created"])
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise SchemaError(
            "a reference holds legs with curves of 101 points", f"{path}: {error!r}", "Make it again."
        ) from error


def _leg_data(leg: ReferenceLeg) -> dict[str, object]:
    return {
        "person": leg.person,
        "side": leg.side,
        "cycles": leg.cycles,
        "stance_percent": None if np.isnan(leg.stance_percent) else round(leg.stance_percent, DIGITS),
        "curves": {name: _plain(curve) for name, curve in leg.curves.items()},
        "values": {name: round(value, DIGITS) for name, value in leg.values.items()},
        "leg_m": None if leg.leg_m is None else round(leg.leg_m, DIGITS),
        "age_years": leg.age_years,
    }


def _plain(curve: NDArray[np.float64]) -> list[float | None]:
    """Numbers as JSON has them, nothing where none is known."""
    return [round(float(value), DIGITS) if np.isfinite(value) else None for value in curve]


def _leg(data: Mapping[str, object]) -> ReferenceLeg:
    curves = {str(name): np.array(curve, float) for name, curve in dict(data["curves"]).items()}  # type: ignore[call-overload]
    if any(curve.shape != (101,) for curve in curves.values()):
        raise ValueError("a curve has not 101 points")
    stance = float("nan") if data["stance_percent"] is None else float(data["stance_percent"])  # type: ignore[arg-type]
    values = {str(name): float(value) for name, value in dict(data["values"]).items()}  # type: ignore[call-overload]
    leg_m, age = data.get("leg_m"), data.get("age_years")  # absent in older references
    if not (leg_m is None or isinstance(leg_m, float)) or not (age is None or isinstance(age, int)):
        raise ValueError(f"leg length {leg_m!r} and age {age!r} are no numbers")
    own = (str(data["side"]), int(data["cycles"]), stance, curves, values, leg_m, age)  # type: ignore[call-overload]
    return ReferenceLeg(int(data["person"]), *own)  # type: ignore[call-overload]
