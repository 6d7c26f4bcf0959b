"""Systems that `discover` was not built with, what is hidden in each, and their numbers drawn."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

import gaitdisc as gd

SYSTEMS = Path(__file__).parent / "systems"


class Hidden(NamedTuple):
    """What is missing in a model; `{a}` and `{b}` of its term are drawn between their limits."""

    model: str
    port: str
    effect: str
    term: str
    a: list[float]
    b: list[float]
    driven_by: list[float]
    fastest_hz: float


FILE = Path(__file__).with_name("joints_and_chains.toml")
KNOWN = {name: Hidden(**each) for name, each in tomllib.loads(FILE.read_text(encoding="utf-8")).items()}


def model_of(hidden: Hidden) -> gd.Simulation:
    """The model as its author believes it."""
    own = SYSTEMS / f"{hidden.model}.toml"
    return gd.read_simulation(own) if own.is_file() else gd.bundled_simulation(hidden.model)


def complete(model: gd.Simulation, hidden: Hidden, rng: np.random.Generator) -> gd.Simulation:
    """The model with what is hidden in it."""
    a, b = (f"{rng.uniform(low, high):.4g}" for low, high in (hidden.a, hidden.b))
    return model.with_effect(gd.Term(hidden.port, "port", hidden.effect, hidden.term.format(a=a, b=b)))


def put_off(model: gd.Simulation, share: float, rng: np.random.Generator) -> gd.Simulation:
    """The model with each number a little wrong, and bounds that say so."""
    if not share:
        return model
    wrong = []
    for one in model.parameters:
        value = one.value * (1 + share * float(np.clip(rng.standard_normal(), -2, 2)))
        low, high = sorted((value * (1 - 2.5 * share), value * (1 + 2.5 * share)))
        wrong.append(replace(one, value=value, low=low, high=high))
    return replace(model, parameters=tuple(wrong))
