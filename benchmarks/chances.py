"""How often a name that `gaitdisc discover` gives is right, and the function behind `Discovery.probability`.

    python benchmarks/chances.py OUT BENCH [--cases 900] [--seed 35] [--twins 0]

Cases are of guards.py and of BENCH/make_cases.py (../shared/bench/hidden_effects), of mixed size, noise, length,
number of trials, filter and gaps. OUT/answers.jsonl gets a line for each, and what stands there is not run again.
Right is a name where all that is named is hidden, or stands in the benchmark's list of what equals it; an answer that
is tied with others shares the probability with them, and is right with them where one of them is right.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "studies"))
from command_line import argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("out", "where cases and answers go", Path("chances-out")),
    argument("bench", "folder of make_cases.py", type=Path),
    argument("--cases", "cases, of which some are answered with a name", 900),
    argument("--seed", "of the cases", 35),
    argument("--twins", "of each named record, with the effect", 0),
    argument("--fit", "print how often a logistic function of the answers is right", False),
    argument("--rigs", "answers to rigs: case (set/name), right, shared and found, a line of JSON each", type=Path),
)  # before the slow imports

import importlib.util
import json
import math
import shutil
import signal
import time
from dataclasses import replace
from functools import cache, partial
from itertools import pairwise
from types import ModuleType
from typing import Any

import guard_cases
import guards
import numpy as np
from kept_answers import keep_answers
from numpy.typing import NDArray
from sklearn.linear_model import LogisticRegression

from gaitdisc.discovery.answer import answer
from gaitdisc.discovery.catalogue import ALL
from gaitdisc.discovery.discover import explain
from gaitdisc.discovery.result import NAMED, Discovery, Explanation
from gaitdisc.discovery.twins import TwinSource, _name, search_records
from gaitdisc.simulation.measured_table import read_measured
from gaitdisc.simulation.simulation_file import read_simulation

PLACES = ("port", "equation", "observation", "input", "parameter")
KINDS = ("term", "term", "term", "term", "pushed_term", "outside", "outside", "off", "one_trial", "inputs")
SIZES = ((0.005, 0.02), (0.02, 0.06), (0.06, 0.2))  # of a rate, which a hidden term is
NOISE = (0.01, 0.03, 0.1, 0.2)  # of each channel's standard deviation
LENGTHS = (0.25, 0.5, 1.0)  # of the benchmark's own records
LIMIT_S = 60
SAID = (0.85, 0.95)  # probabilities between which answers are counted
FITTED = (("closed",), ("margin",), ("closed", "margin"), ("closed", "tied"), ("closed", "margin", "left"))


@cache
def load_bench(folder: Path) -> ModuleType:
    """Load make_cases.py, and the systems beside it."""
    sys.path.insert(0, str(folder))
    spec = importlib.util.spec_from_file_location("make_cases", folder / "make_cases.py")
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def make_blind(bench: Path, number: int, seed: int, folder: Path) -> tuple[dict[str, Any], set[tuple[str, str]]]:
    """Write a case of the blind benchmark; what it is, and the names and places that are right."""
    made, rng = load_bench(bench), np.random.default_rng([seed, number])
    systems = made.load_systems(bench / "systems.py")
    name = str(rng.choice([*systems]))
    system = systems[name] | {"duration": systems[name]["duration"] * float(rng.choice(LENGTHS))}
    hidden = system["hidden"][rng.integers(len(system["hidden"]))]
    terms = [one for one in system["hidden"] if one[2] and one[0] not in ("unnamed", hidden[0])]
    second = terms[rng.integers(len(terms))] if terms and hidden[2] and rng.random() < 0.2 else None
    vars(made)["SIZE"] = SIZES[rng.integers(len(SIZES))]
    real = {"lowpass": 6 if rng.random() < 0.25 else None, "off": 0.05 if rng.random() < 0.25 else 0.0}
    real |= {"gaps": 3 if rng.random() < 0.15 else 0, "say": bool(rng.random() < 0.1)}
    level, trials = float(rng.choice(NOISE)), int(rng.integers(1, 5))
    colour = 6 if not real["lowpass"] and rng.random() < 0.2 else None
    made.make_case(folder, "case", name, system, hidden, level, seed + number, trials, colour, second, real)
    key = json.loads((folder / "truth" / "case" / "truth.json").read_text(encoding="utf-8"))["answer"]
    right = {(key["name"], key["where"]), *((what, where) for _, what, where in key["same"])}
    right |= {(one["name"], one["where"]) for one in key.get("also", ())}
    said = {"system": name, "hidden": key["name"], "two": bool(second), "size": made.SIZE, "noise": level}
    return said | real | {"trials": trials, "colour": colour, "length": system["duration"]}, right


def make_guard(number: int, seed: int, folder: Path) -> tuple[str, dict[str, Any]]:
    """Write a case of the guards; its kind, and what is hidden in it."""
    rng = np.random.default_rng([seed, number, 1])
    kind = str(rng.choice(KINDS))
    guard_cases.TRIALS = int(rng.integers(2, 5))
    guard_cases.WEAK = SIZES[rng.integers(len(SIZES))]
    guard_cases.NOISE = (0.01, 0.15)
    return kind, guard_cases.make_case(kind, number, seed, folder)


def ask(number: int, bench: Path, seed: int, out: Path, twins: int) -> dict[str, Any]:
    """Make a case, answer it, and return what the answer says and whether it is right."""
    folder, began = out / "cases" / f"{number:04d}", time.process_time()
    if number % 5 < 3:
        made, right = make_blind(bench, number, seed, folder)
        line: dict[str, Any] = {"number": number, "kind": "blind", "made": made}
        where, kind, truth = folder / "cases" / "case", "blind", {}
    else:
        kind, truth = make_guard(number, seed, folder)
        line = {"number": number, "kind": kind, "made": truth}
        where, right = folder, {(truth["effect"], truth["port"])} if kind in ("term", "pushed_term") else set()
    made_in, began = time.process_time() - began, time.process_time()
    model = read_simulation(where / "simulation.toml")
    with np.errstate(over="ignore", invalid="ignore"):
        case, as_read, verdict = explain(model, read_measured(where / "measured.csv", model), ALL)
        found, _ = answer(case, as_read, verdict)
    said = found.to_json()
    for one in said["explanations"]:
        del one["left"]
    named = found.verdict in NAMED
    tied = [one for one in found.explanations if one.tied]
    tied += [Explanation((rival,)) for rival in found.rivals if rival.tied]
    rights = [says_truth(kind, truth, right, one, found) for one in (Explanation(found.effects, found.held_out), *tied)]
    line |= {"made in": made_in, "seconds": time.process_time() - began, "named": named, "accepted": [*right]}
    line |= {"right": named and rights[0], "shared": named and any(rights)}
    line |= {"found": {key: one for key, one in said.items() if key not in ("findings", "provenance", "where")}}
    if named and twins:
        source = TwinSource(case, verdict.found, verdict.found.noise)
        if source.draw(0) is not None:
            answers = [*search_records([source], model, replace(ALL, twins=twins))]
            line |= {"twins": [one == _name(found) for one in answers], "with twins": time.process_time() - began}
    shutil.rmtree(folder)
    return line


def says_truth(
    kind: str, truth: dict[str, Any], right: set[tuple[str, str]], one: Explanation, found: Discovery
) -> bool:
    """Whether an explanation names what is hidden, and no more."""
    if kind == "outside":
        return guards.is_right(
            kind, truth, replace(found, effects=one.effects, held_out=one.held_out or found.held_out)
        )
    if kind == "inputs":  # each errs by a gain and drifts
        return all(effect.kind == "input" for effect in one.effects)
    return {(effect.name, effect.place) for effect in one.effects} <= right


def ask_in_time(number: int, limit: int = LIMIT_S, **given: Any) -> dict[str, Any]:
    """Answer a case, or say what it failed of."""
    signal.signal(signal.SIGALRM, guards.stop)
    signal.alarm(limit)
    try:
        return ask(number, **given)
    except Exception as error:
        return {"number": number, "failed": f"{type(error).__name__}: {error}"[:200]}
    finally:
        signal.alarm(0)


def describe(found: dict[str, Any]) -> dict[str, float]:
    """What an answer says of itself."""
    gain, held_out = found["effects"][0]["evidence"]["bic"] or 0.0, found["gap"]["held_out"]
    untied = [one["evidence"]["bic"] or 0.0 for one in found["rivals"] if not (one["small"] or one["tied"])]
    return {
        "closed": 1 - held_out["unexplained"],
        "margin": math.log1p(min(max(gain - max(untied, default=0.0), 0.0), gain)),
        "tied": float(any(one["tied"] for one in found["rivals"])),
        "left": math.log(max(held_out["after"], 1e-9) / max(held_out["noise_floor"], 1e-9)),
    }


def print_fits(answers: list[dict[str, Any]], rigs: NDArray[np.bool_]) -> None:
    """Fit to every second answer, print how often the others are right as it says, and the numbers fitted to all."""
    told, shared = [describe(one["found"]) for one in answers], np.array([one["shared"] for one in answers], bool)
    second = np.zeros(len(answers), bool)
    for some in (rigs, ~rigs):
        second[np.flatnonzero(some)[1::2]] = True
    for names in FITTED:
        x, said = np.array([[one[name] for name in names] for one in told]), np.empty(len(answers))
        for kept in (second, ~second):
            said[kept] = LogisticRegression(C=np.inf).fit(x[~kept], shared[~kept]).predict_proba(x[kept])[:, 1]
        whole = LogisticRegression(C=np.inf).fit(x, shared)
        print(f"{', '.join(names)}: {whole.intercept_[0]:.2f}, {', '.join(f'{one:.2f}' for one in whole.coef_[0])}")
        for which, some in (("made", ~rigs), ("rigs", rigs), ("all", rigs | ~rigs)):
            if some.any():
                print(f"  {which}: {say_fit(said[some], shared[some])}")


def say_fit(said: NDArray[np.float64], right: NDArray[np.bool_]) -> str:
    """Right of those that a probability is said of, by its size, and the Brier score beside that of the mean alone."""
    sizes = ((low, right[(low <= said) & (said < high)]) for low, high in pairwise((0.0, *SAID, 1.01)))
    parts = [f"from {low:g}: {some.sum()} of {len(some)}" for low, some in sizes if len(some)]
    return f"{'; '.join(parts)}; Brier {np.mean((said - right) ** 2):.3f} ({right.mean() * (1 - right.mean()):.3f})"


if __name__ == "__main__":
    cases = ((number,) for number in range(GIVEN.cases))
    answering = partial(ask_in_time, bench=GIVEN.bench, seed=GIVEN.seed, out=GIVEN.out, twins=GIVEN.twins)
    made = [one for one in keep_answers(GIVEN.out, cases, answering, ("number",)) if one.get("named")]
    if GIVEN.fit:
        lines = GIVEN.rigs.read_text(encoding="utf-8").splitlines() if GIVEN.rigs else []
        rigs = [one for one in map(json.loads, lines) if one["found"]["verdict"] in NAMED]
        print_fits([*made, *rigs], np.arange(len(made) + len(rigs)) >= len(made))
