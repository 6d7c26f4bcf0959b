"""Which literature a saved result rests on: what each method cites, and when a result used it."""

import re
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from gaitdisc._version import __version__
from gaitdisc.channel import schema_folder
from gaitdisc.comparison.mismatch import Mismatch
from gaitdisc.discovery.result import Discovery
from gaitdisc.errors import SchemaError
from gaitdisc.kinematics.marker_set import read_marker_sets
from gaitdisc.processing.pooled_cycles import PooledCycles
from gaitdisc.reconstruction.reconstruction import Reconstruction
from gaitdisc.recording import Finding
from gaitdisc.response.participant_response import ResponseRun
from gaitdisc.response.variants import VariantRun
from gaitdisc.run.chapter_parts import PARTS
from gaitdisc.run.chapter_run import NAME as CHAPTER
from gaitdisc.saved.kind import find_kind
from gaitdisc.saved.unit_folder import read_sealed

MENTIONED = {  # a method in words -> the keys of data_schema/methods.bib
    "this program": ("gaitdisc",),
    "the Nominal, Exo, Discrepancy and Augmented models": ("ebers2023", "ebers2023exoskeletons"),
    "discrepancies of dynamics and of state": ("ebers2023", "ebers2024discrepancy"),
    "reconstruction of states from a few sensors": ("ebers2023", "ebers2024sensors"),
    "networks trained with AdamW": ("loshchilov2019",),
    "networks trained with Bayesian regularisation": ("mackay1992", "levenberg1944", "marquardt1963"),
    "ridge regression": ("hoerl1970",),
    "random Fourier features": ("rahimi2007",),
    "SHRED": ("williams2024",),
    "shallow decoder": ("erichson2020",),
    "an ensemble of networks": ("lakshminarayanan2017",),
    "Wilcoxon's signed-rank test": ("wilcoxon1945", "vallat2018"),
    "Holm-Sidak corrections": ("holm1979", "sidak1967"),
    "permutation test over the stride": ("nichols2002", "pataky2015"),
    "sub-groups of people": ("ward1963",),
    "reading of C3D files (if the run read any)": ("michaud2021",),
    "contacts from markers": ("zeni2008",),
    "segments from markers": ("soderkvist1993",),
    "joint angles": ("grood1983", "wu2002"),
    "hip centres after Davis": ("davis1991",),
    "hip centres after Harrington": ("harrington2007",),
    "inertia of the segments": ("dumas2007",),
    "intervals from models fitted without part of the data": ("barber2021",),
    "multiple shooting": ("bock1984",),
    "damped least squares": ("levenberg1944", "marquardt1963"),
    "information criterion": ("schwarz1978",),
    "a term identified by regression on a library": ("brunton2016",),
    "spiked samples": ("hampel1974",),
    "SINDy": ("brunton2016",),
    "ensemble SINDy": ("fasel2022",),
    "SINDy in weak form": ("messenger2021",),
    "exact dynamic mode decomposition": ("tu2014",),
    "optimised dynamic mode decomposition": ("askham2018",),
    "bagged optimised dynamic mode decomposition": ("sashidhar2022",),
    "Gaussian processes": ("rasmussen2006",),
    "a Kalman filter": ("kalman1960",),
    "an unscented Kalman filter": ("julier2004",),
    "an ensemble Kalman filter": ("evensen1994", "burgers1998"),
}
OF_MODELS = {
    "linear": ("ridge regression",),
    "delay ridge": ("ridge regression",),
    "fourier ridge": ("ridge regression", "random Fourier features"),
    "shallow decoder": ("shallow decoder", "networks trained with AdamW"),
    "shred": ("SHRED", "networks trained with AdamW"),
    "masked shred": ("SHRED", "networks trained with AdamW"),
    "shred ensemble": ("SHRED", "an ensemble of networks", "networks trained with AdamW"),
    "shred-text": ("SHRED", "networks trained with AdamW"),
}
DISCREPANCIES = (
    "discrepancies of dynamics and of state",
    "SINDy",
    "optimised dynamic mode decomposition",
    "Gaussian processes",
    "networks trained with Bayesian regularisation",
)
RESPONSES = ("the Nominal, Exo, Discrepancy and Augmented models", "networks trained with AdamW", "ridge regression")
SENSED = (
    "reconstruction of states from a few sensors",
    *dict.fromkeys(method for methods in OF_MODELS.values() for method in methods),
)
TESTED = ("Wilcoxon's signed-rank test", "Holm-Sidak corrections")
SEARCHED = ("multiple shooting", "damped least squares", "information criterion")
CONTACTS = ("contacts from markers",)
LEFT_OUT = "intervals from models fitted without part of the data"
OF_CHAPTERS = {3: DISCREPANCIES, 4: (*RESPONSES, *TESTED), 5: SENSED}
BAGS = ("bagged optimised dynamic mode decomposition",)
MORE = {  # of these parts, beside what their chapter cites
    "tables": TESTED,
    "van_der_pol": BAGS,
    "lorenz": BAGS,
    "measurement_bias": (*BAGS, "a Kalman filter", "an unscented Kalman filter"),
    "who_names": SEARCHED,
    "further": (
        "ensemble SINDy",
        "SINDy in weak form",
        "exact dynamic mode decomposition",
        "an unscented Kalman filter",
        "an ensemble Kalman filter",
    ),
}
OF_PARTS = {part.name: (*OF_CHAPTERS[part.chapter], *MORE.get(part.name, ())) for part in PARTS}


class Cited(NamedTuple):
    """An entry of BibTeX, and the methods that it is cited for."""

    key: str
    methods: tuple[str, ...]
    entry: str


def list_citations(folder: Path) -> list[Cited]:
    """Literature of the methods that the result in a folder used, in the order of the table."""
    if (folder / CHAPTER).is_file():
        part = read_sealed(folder / CHAPTER).get("part")
        if part not in OF_PARTS:
            raise SchemaError(
                f"the part of a chapter must be one of {', '.join(OF_PARTS)}",
                f"{folder.name}/{CHAPTER} names {str(part)[:40]!r}",
                "Another version of gaitdisc wrote this folder. Cite with that version.",
            )
        used = {"this program", *OF_PARTS[part]}
    else:
        used = {"this program", *list_methods(find_kind(folder, drawn=True).load(folder))}
    by_key: dict[str, list[str]] = {}
    for method, keys in MENTIONED.items():
        for key in keys if method in used else ():
            by_key.setdefault(key, []).append(method)
    return [Cited(key, tuple(words), entries()[key]) for key, words in by_key.items()]


def list_methods(result: Any) -> Iterator[str]:
    """Methods, in words of `MENTIONED`, that a result used."""
    if isinstance(result, ResponseRun):
        yield from _of_run(result)
    elif isinstance(result, VariantRun):
        yield from RESPONSES[:2]
        yield from TESTED if len(result.tests) else ()
    elif isinstance(result, PooledCycles):
        yield from _of_files(result.files)
        yield from CONTACTS if "markers" in result.detectors else ()
        yield from _of_markers(result.findings, None)
    elif isinstance(result, Discovery):
        yield from SEARCHED
        if result.held_out.p == result.held_out.p:  # a test was made
            yield TESTED[0]
        if any(effect.reads_as for effect in (*result.effects, *result.rivals)):
            yield "a term identified by regression on a library"
        if any("spike" in finding.kind for finding in result.findings):
            yield "spiked samples"
    elif isinstance(result, Mismatch):
        yield "permutation test over the stride"
        yield from _of_files(result.provenance.files)
    elif isinstance(result, Reconstruction):
        yield "reconstruction of states from a few sensors"
        for name in result.models:
            yield from OF_MODELS.get(name, ())
        if result.split.startswith("subject"):  # each person was left out in turn
            yield LEFT_OUT
        yield from _of_files(result.provenance.files)


def _of_run(run: ResponseRun) -> Iterator[str]:
    kinds = {str(kind) for response in run.responses for kind in response.r2["kind"]}
    yield from RESPONSES[:1] if run.responses else ()
    if "network" in kinds:
        yield "networks trained with AdamW"
    if kinds & {"ridge", "linear"}:
        yield "ridge regression"
    if any(response.held_out.bands for response in run.responses):
        yield LEFT_OUT
    yield from TESTED if run.tests is not None and len(run.tests.tests) else ()
    if run.over is not None and run.over.responders["silhouette"].notna().any():
        yield "sub-groups of people"
    yield from _of_files(run.provenance.files)
    detectors = {*(walk.detector for walk in run.walks), *(name for pooled in run.cycles for name in pooled.detectors)}
    yield from CONTACTS if "markers" in detectors else ()
    kinematics = run.provenance.settings.get("kinematics") or {}
    for unit in (*run.walks, *run.cycles):
        yield from _of_markers(unit.findings, kinematics.get("hip"))


def _of_files(files: Iterable[str]) -> Iterator[str]:
    """Of files named by person and walk the ending is not kept: they may be C3D."""
    if any(name.lower().endswith(".c3d") or re.search(r", file \d+$", name) for name in files):
        yield "reading of C3D files (if the run read any)"


def _of_markers(findings: Iterable[Finding], hip: str | None) -> Iterator[str]:
    """Where angles were computed from markers, which a note on the marker set says: segments, angles, hips."""
    by_kind = {finding.kind: finding.what for finding in findings}
    if "marker set" not in by_kind:
        return
    yield from ("segments from markers", "joint angles")
    named = read_marker_sets().get(by_kind["marker set"].partition(":")[0])
    first = hip or (named.joint_centres["hip"][0] if named else "")
    if first == "davis" and "hip" not in by_kind:
        yield "hip centres after Davis"
    elif first:
        yield "hip centres after Harrington"
    if "residual" in by_kind:  # said where joint moments were computed too
        yield "inertia of the segments"


@cache
def entries() -> dict[str, str]:
    """Every entry of `data_schema/methods.bib`, by key."""
    text = (schema_folder() / "methods.bib").read_text(encoding="utf-8").replace("{VERSION}", f"{{{__version__}}}")
    by_key = {match[1]: match[0] for match in re.finditer(r"^@\w+\{(\w+),\n.*?^\}", text, re.MULTILINE | re.DOTALL)}
    absent = sorted({key for keys in MENTIONED.values() for key in keys} - set(by_key))
    if absent:
        raise SchemaError("methods.bib must contain all methods cited", f"it lacks {', '.join(absent)}", "Add it.")
    return by_key
