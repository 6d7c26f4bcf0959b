"""Reference of controls, of a laboratory or published; what is read of a person's cycles beside it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gaitdisc.errors import SchemaError
from gaitdisc.processing.leg_curves import BY_NAME, LegCurves
from gaitdisc.processing.pooled_cycles import PooledCycles
from gaitdisc.recording import PERCENT
from gaitdisc.report.curve_panels import Band
from gaitdisc.saved.unit_folder import read_sealed, seal_text
from gaitdisc.spreadsheet import read_csv
from gaitdisc.whole_file import write_whole

COLUMNS = ("group", "speed_low", "speed_high", "people", "variable", "percent", "mean", "sd")
FEWEST_POINTS = 20  # a curve of fewer is none
FORM = f"a published reference must be a CSV with a line '# source, people, licence', then columns {', '.join(COLUMNS)}"
FILE, FORMAT = "reference.json", 1
PUBLISHED = "published.csv"
DIGITS = 4
SPEED = "speed_m_per_s"
FEW = 3  # cycles of a leg below which a mean is that of single steps: no sentence is made of it
SCORE_LEAST = 1.6  # [deg] of the gait profile score, the smallest difference that matters (Baker et al. 2012)


@dataclass(frozen=True, eq=False)
class PublishedGroup:
    """People of one group."""

    name: str
    speeds: tuple[float, float]  # tuple of (float, float), dimensionless, from and to; NaN where the table has none
    people: int
    bands: dict[str, Band]


def read_published(path: Path) -> tuple[str, tuple[PublishedGroup, ...]]:
    """Source of a published reference, as its first line has it, and its groups."""
    try:
        first = path.open(encoding="utf-8").readline()
        table = read_csv(path, ("group", "variable"), skiprows=1) if first.startswith("#") else pd.DataFrame()
    except (OSError, ValueError) as error:
        raise SchemaError(FORM, f"{path.name}: {str(error)[:200]}", "Correct the table.") from error
    source, lacking = first.lstrip("# ").strip(), [name for name in COLUMNS if name not in table]
    if lacking or not source:
        defect = "no source" if not source or not first.startswith("#") else f"no column {', '.join(lacking)}"
        raise SchemaError(FORM, f"{path.name} has {defect}", "Write it as docs/clinic.md shows.")
    groups = [_group(str(name), rows, path.name) for name, rows in table.groupby("group", sort=False)]
    return source, tuple(groups)


def _group(name: str, rows: pd.DataFrame, file: str) -> PublishedGroup:
    bands, first = {}, rows.iloc[0]
    for variable, points in rows.groupby("variable", sort=False):
        where = f"{file}, {name} {variable}"
        if variable not in BY_NAME:
            raise SchemaError(
                f"{file}, {name}: a variable must be one of {', '.join(BY_NAME)}", f"found {variable!r}", "Correct it."
            )
        curve = points.sort_values("percent")[["percent", "mean", "sd"]].to_numpy(float)
        at, mean, sd = curve.T
        complete = len(at) >= FEWEST_POINTS and np.isfinite(curve).all() and (np.diff(at) > 0).all() and (sd >= 0).all()
        if not (complete and at[0] <= PERCENT[0] + 2.5 and at[-1] >= PERCENT[-1] - 2.5):
            raise SchemaError(
                f"{where}: a curve must have {FEWEST_POINTS} points or more from 0 to 100 %, each with mean and sd",
                f"found {len(at)} points from {at.min():g} to {at.max():g} %",
                "Correct the table.",
            )
        bands[str(variable)] = Band(
            np.interp(PERCENT, at, mean), np.interp(PERCENT, at, sd), int(points["people"].iloc[0])
        )
    people = max(band.people for band in bands.values())
    return PublishedGroup(name, (float(first["speed_low"]), float(first["speed_high"])), people, bands)


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
    leg_m: float | None = None  # leg length [m]; None where it is not known
    age_years: int | None = None  # None where it is not known


@dataclass(frozen=True, eq=False)
class ClinicalReference:
    """Controls by condition."""

    title: str
    legs: Mapping[str, tuple[ReferenceLeg, ...]]  # condition -> legs
    settings: Mapping[str, object]  # filters and rules for strides they were processed with
    versions: Mapping[str, str]  # what processed them
    created: str
    # where it is no laboratory's own: groups of speed, of which there are no legs
    published: tuple[PublishedGroup, ...] = ()

    def of(self, condition: str) -> tuple[ReferenceLeg, ...]:
        """Legs of a condition; none where the controls did not walk so."""
        return self.legs.get(condition, ())

    def people(self, condition: str) -> int:
        """Number of controls of a condition."""
        return len({leg.person for leg in self.of(condition)})


def save_reference(reference: ClinicalReference, folder: Path) -> Path:
    """Save a reference as `reference.json`, whole, with a hash of its own."""
    if reference.published:
        raise SchemaError("a saved reference must contain single legs", f"{reference.title} has none", "Use the table.")
    data = {
        "format": FORMAT,
        "title": reference.title,
        "created": reference.created,
        "settings": dict(reference.settings),
        "versions": dict(reference.versions),
        "legs": {word: [_round(vars(leg)) for leg in legs] for word, legs in reference.legs.items()},
    }
    return write_whole(folder / FILE, seal_text(data))


def load_reference(place: Path) -> ClinicalReference:
    """Load a reference from its folder or file, or a published one from its table."""
    table = place / PUBLISHED if place.is_dir() else place
    if table.suffix == ".csv" and table.is_file():
        source, groups = read_published(table)
        return ClinicalReference(source, {}, {}, {}, "", groups)
    path = place / FILE if place.is_dir() else place
    if not path.is_file():
        raise SchemaError(
            f"a reference must be a folder with {FILE}",
            f"{place} has no such file",
            "Make a reference: gaitdisc reference CONTROLS --out FOLDER.",
        )
    data = read_sealed(path)
    if data.get("format") != FORMAT:
        raise SchemaError(
            f"a reference must have format {FORMAT}", f"{path} has {data.get('format')!r}", "Save the reference again."
        )
    try:
        legs = {word: tuple(map(_leg, records)) for word, records in data["legs"].items()}
        return ClinicalReference(data["title"], legs, data["settings"], data["versions"], data["created"])
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise SchemaError(
            "a reference must contain legs with curves of 101 points", f"{path}: {error!r}", "Compute it again."
        ) from error


def _round(value: Any) -> Any:
    """What JSON holds of a leg: four digits, and null for what is not known."""
    if isinstance(value, Mapping):
        return {name: _round(item) for name, item in value.items()}
    if isinstance(value, np.ndarray):
        return [_round(float(number)) for number in value]
    if isinstance(value, float):
        return round(value, DIGITS) if np.isfinite(value) else None
    return value


def _leg(data: Mapping[str, Any]) -> ReferenceLeg:
    curves = {str(name): np.array(curve, float) for name, curve in data["curves"].items()}
    if any(curve.shape != (101,) for curve in curves.values()):
        raise ValueError("a curve does not have 101 points")
    stance = float("nan") if data["stance_percent"] is None else float(data["stance_percent"])
    values = {str(name): float(value) for name, value in data["values"].items()}
    leg_m, age = data.get("leg_m"), data.get("age_years")  # absent in older references
    if not (leg_m is None or isinstance(leg_m, float)) or not (age is None or isinstance(age, int)):
        raise ValueError(f"leg length {leg_m!r} and age {age!r} are not numbers")
    identity = int(data["person"]), str(data["side"]), int(data["cycles"])
    return ReferenceLeg(*identity, stance, curves, values, leg_m=leg_m, age_years=age)


@dataclass(frozen=True)
class Limits:
    """Limits of a value in a reference."""

    low: float  # prediction limit for one more healthy leg, corrected for all rules of the page
    high: float  # the upper one
    mean: float  # over the legs of the reference, at the person's speed where limits follow it
    sd: float  # over the legs of the reference, at the person's speed where limits follow it
    people: int

    @property
    def band(self) -> tuple[float, float]:
        """Mean less and more two standard deviations: what an eye takes for usual."""
        return self.mean - 2 * self.sd, self.mean + 2 * self.sd


@dataclass(frozen=True)
class Noted:
    """A value of one leg that a rule looks at, or how much more than the other leg's it is."""

    rule: str  # its name
    words: str  # what it calls a value that stands out; no words for one that does not
    side: str
    value: float
    unit: str
    digits: int
    limits: Limits
    cycles: int
    excess: float  # distance from the reference's mean over that of the limit; beyond 1 outside
    tier: int = 0  # 2 beyond the prediction limits, 1 outside two standard deviations of the reference, 0 within
    group: str = ""  # what else says the same thing, and in which direction
    other: str = ""  # the other side, where the value is the difference to it


@dataclass(frozen=True)
class Score:
    """A score of a leg or of both."""

    value: float
    low: float  # smallest of single cycles; NaN where they are not computed one by one
    high: float  # largest of them
    cycles: int
    reference_mean: float  # the same score of each control against the others
    reference_sd: float  # its spread over the controls
    people: int


@dataclass(frozen=True)
class Profile:
    """Movement analysis profile and gait profile score."""

    # mapping of (str, str) to Score, variable and side -> rms difference to the reference's mean [deg]
    variables: Mapping[tuple[str, str], Score]
    legs: Mapping[str, Score]  # side -> gait profile score of the leg [deg]
    both: Score | None  # gait profile score over fifteen curves; None where a leg or a curve is missing


@dataclass(frozen=True, eq=False, kw_only=True)
class ClinicalReading:
    """One person, session and condition, read beside a reference."""

    pooled: PooledCycles
    legs: Mapping[str, LegCurves]
    light: str  # `green`, `amber` or `red`
    reasons: tuple[str, ...]  # why it is amber or red
    numbers: tuple[Noted, ...] = ()  # every value that a rule looks at, those that stand out first
    silent: str  # why nothing can be said to stand out; empty where the rules were applied
    profile: Profile | None
    no_profile: str
    deviation_index: Mapping[str, float] = field(default_factory=dict)  # side -> GDI; empty: why is in `no_index`
    no_index: str
    # mapping of (str, str) to float, variable and side -> coefficient of multiple correlation of its cycles, NaN where
    # it is not defined
    consistency: Mapping[tuple[str, str], float]
    bands: Mapping[str, Band]
    spatiotemporal: Mapping[str, Limits] = field(default_factory=dict)  # value -> mean and spread of the reference
    # which controls of the reference the person is read beside, and what could not be allowed for
    beside: tuple[str, ...] = ()
    nearest: str = ""  # in what the controls for curves are the nearest; empty where they are the entire reference

    @property
    def noted(self) -> tuple[Noted, ...]:
        """What stands out, the farthest first."""
        return tuple(note for note in self.numbers if note.tier)


@dataclass(frozen=True)
class DifferingSpan:
    """A stretch of the cycle in which two sets of cycles of a leg differ."""

    variable: str
    side: str
    first: int  # [% of the cycle]
    last: int  # [% of the cycle]
    difference: float  # largest in the stretch, second minus first [the variable's unit]
    p: float  # corrected for the whole cycle and all variables of the leg
    matters: bool  # whether the difference is as large as the smallest that matters


@dataclass(frozen=True, eq=False)
class Contrast:
    """Two sessions or conditions of one person, one over the other."""

    first: ClinicalReading
    second: ClinicalReading
    spans: tuple[DifferingSpan, ...]
    untested: Mapping[str, str]  # side -> why no test was done
    tested: Mapping[str, int]

    @property
    def names(self) -> tuple[str, str]:
        """Names of the two: their sessions, or within a session their conditions."""
        first, second = self.first.pooled, self.second.pooled
        if first.session == second.session:
            return first.condition, second.condition
        return first.session or first.condition, second.session or second.condition


@dataclass(frozen=True, eq=False)
class PersonSession:
    """A person's session: its conditions, the first the one that page 1 shows, and what is compared."""

    title: str  # pseudonym, and session where there are sessions
    readings: tuple[ClinicalReading, ...]
    contrasts: tuple[Contrast, ...] = ()

    @property
    def before_after(self) -> Contrast | None:
        """Comparison with what came before, which the first sheet shows; None where conditions are compared."""
        return next((contrast for contrast in self.contrasts if contrast.second is self.readings[0]), None)
