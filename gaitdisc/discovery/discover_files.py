"""A simulation file and measured data, from their files to what was discovered."""

import re
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import cast

import numpy as np

from gaitdisc.discovery.answer import answer
from gaitdisc.discovery.catalogue import ALL, Request
from gaitdisc.discovery.discover import explain, refuse_blow_up
from gaitdisc.discovery.kept_work import recall
from gaitdisc.discovery.result import SIMULATION, Discovery, GapSize
from gaitdisc.discovery.twins import search_twins
from gaitdisc.errors import SamplingError
from gaitdisc.ingest.public_words import PublicWords
from gaitdisc.processing.kept_parts import hash_content
from gaitdisc.recording import Finding
from gaitdisc.regular_file import file_sha256
from gaitdisc.saved.provenance import provenance_now
from gaitdisc.simulation.even_time import MILLISECONDS
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.measured_table import read_measured
from gaitdisc.simulation.python_simulation import PythonSimulation
from gaitdisc.simulation.simulation import Simulation
from gaitdisc.simulation.simulation_file import read_simulation
from gaitdisc.simulation.unit_check import unit_findings
from gaitdisc.simulation.writing import simulation_text


def discover_files(simulation: Path, measured: Path, request: Request = ALL) -> tuple[Discovery, Simulation]:
    """Find what a simulation file lacks against a table of measured trials."""
    request.progress(f"reading {simulation.name} and {measured.name}")
    model = read_simulation(simulation)
    data = read_measured(measured, model)
    files = {simulation: "simulation", measured: "measured table"}
    return find_missing(model, data, request, files)


def find_missing(
    model: Simulation, data: Measured, request: Request, files: dict[Path, str]
) -> tuple[Discovery, Simulation]:
    """Find what a model lacks against trials read from files, each by what it is called in the result."""
    recall(hash_content((model, data, data.drive), repr((request.shapes, request.effects, request.alpha))))
    request.progress("checking that the simulation stays finite (gaitdisc is compiled at its first use, in about 20 s)")
    if refuse_blow_up(model, data):  # the model moves as slowly as the clock says: no milliseconds
        data = replace(data, findings=tuple(finding for finding in data.findings if finding.spoils != MILLISECONDS))
    try:
        with np.errstate(over="ignore", invalid="ignore"):  # an explanation that runs away explains nothing
            explained = explain(model, data, request)
            discovery, augmented = answer(*explained, request.refitted)
    except np.linalg.LinAlgError as error:
        raise SamplingError(
            "each sample of a simulation must be predictable from the previous one",
            f"samples are {1 / data.rate:.4g} s apart, and the simulation's derivatives overflow within one step",
            "Write times in seconds, not in milliseconds, or record at a higher rate.",
        ) from error
    files = {**files, **({request.catalogue: "catalogue"} if request.catalogue else {})}
    listed = unit_findings(model) if isinstance(model, Simulation) else ()  # a function has no units to check
    discovery = seal(replace(discovery, findings=(*listed, *discovery.findings)), augmented, data, files)
    if request.twins:
        request.answered(discovery, augmented)
        discovery = search_twins(discovery, *explained, model, request)
    return discovery, augmented


def seal(discovery: Discovery, model: Simulation, data: Measured, files: dict[Path, str]) -> Discovery:
    """Return an answer with what it and its augmented model rest on; it is written without a name of a person."""
    settings = {"title": model.title, "trials": len(data.trials), "rate_hz": data.rate, "channels": list(data.channels)}
    hashes = {called: file_sha256(path) for path, called in files.items()}
    made = provenance_now(settings, 0, hashes, SIMULATION)
    written = model if isinstance(model, Simulation) else cast("PythonSimulation", model).parts
    words = frozenset(re.findall(r"\w+", simulation_text(written)))  # of the user's model, which names no person
    public = PublicWords(words, {path.name: called for path, called in files.items()})
    numbered = {name: f"trial {number}" for number, name in enumerate(data.trials, 1)}
    trials = {name: called for name, called in numbered.items() if PublicWords().said(name) != name}
    hidden = {
        finding: public.finding(replace(finding, what=_without(finding.what, trials))) for finding in discovery.findings
    }
    return replace(discovery, provenance=made, hide=partial(_hidden, trials=trials, findings=hidden))


def _hidden(discovery: Discovery, trials: Mapping[str, str], findings: Mapping[Finding, Finding]) -> Discovery:
    """Return an answer without a name of a person.

    trials: names of trials that may be one, and what they are called
    findings: each about the data, and as it is written
    """

    def sized(size: GapSize) -> GapSize:
        return replace(size, of=_without(size.of, trials))

    return replace(
        discovery,
        sentence=_without(discovery.sentence, trials),
        train=sized(discovery.train),
        held_out=sized(discovery.held_out),
        runs=replace(discovery.runs, names=tuple(_without(name, trials) for name in discovery.runs.names)),
        findings=tuple(findings.get(finding, finding) for finding in discovery.findings),
        explanations=tuple(
            replace(explanation, held_out=explanation.held_out and sized(explanation.held_out))
            for explanation in discovery.explanations
        ),
        hide=None,
    )


def _without(text: str, trials: Mapping[str, str]) -> str:
    for name, called in trials.items():
        text = re.sub(rf"(?<!\w){re.escape(name)}(?!\w)", called, text)
    return text
