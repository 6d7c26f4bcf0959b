"""Cases of guards.py: a simulation of guards/systems, run by SciPy with what guards/cases.toml hides in it."""

from __future__ import annotations

import json
import math
import re
import tomllib
import zlib
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.signal import butter, sosfiltfilt

HERE = Path(__file__).parent / "guards"
CASES = tomllib.loads((HERE / "cases.toml").read_text(encoding="utf-8"))
FUNCTIONS = {name: getattr(math, name) for name in ("sin", "tanh", "exp", "sqrt")} | {
    "abs": abs, "max": max, "sign": lambda a: math.tanh(a / 0.02)}  # fmt: skip
TRIALS = 4
SETTLING = 0.25  # of a trial, which is run before the record begins
SHARES = (0.1, 0.25)  # of the rms of a rate, which a law makes
WEAK = (0.01, 0.1)  # of it, where it is not always found
PUSHES = (0.01, 0.1)  # of the motion's standard deviation, by which pushes move it
NOISE = (0.01, 0.04)  # of each channel's standard deviation
CONSTANT = 0.1  # of a law's rms: what moves less about its mean is a constant
PUSH_TURNS = 3  # in which the size of pushes is found
CUTOFF = 0.06  # of the sampling rate: the low-pass that the file does not say
OFF = 0.05  # of each number
GAIN, WANDER = (0.08, 0.2), (0.06, 0.15)  # of an input, and of its standard deviation: together 10 to 25 %
SLOW = 0.5  # of the least frequency of an input: the highest of its wander


@dataclass(frozen=True)
class Trial:
    """What a simulation is driven by; the clock [s] begins before the record does."""

    clock: NDArray
    inputs: dict[str, NDArray]
    start: NDArray
    push: NDArray  # at the port where something acts

    @property
    def moments(self) -> list[dict[str, float]]:
        """Inputs, sample by sample."""
        return [dict(zip(self.inputs, now, strict=True)) for now in zip(*self.inputs.values(), strict=True)]


class Model:
    """A simulation of benchmarks/guards/systems, integrated by SciPy, with something at one of its ports."""

    def __init__(self, name: str) -> None:
        self.text = (HERE / "systems" / f"{name}.toml").read_text(encoding="utf-8")
        read: dict[str, Any] = tomllib.loads(self.text)
        self.states, self.channels = [*read["states"]], [*read["observations"]]
        self.begun = np.array([one.get("initial", 0.0) for one in read["states"].values()])
        self.values = FUNCTIONS | {key: one["value"] for key, one in read["parameters"].items()}
        self.values |= dict.fromkeys(read.get("ports", {}), 0.0)
        texts = read.get("definitions", {}) | {f"d {key}": text for key, text in read["equations"].items()}
        self.codes = [(key, compile(text, key, "eval")) for key, text in texts.items()]
        self.port, self.law = "", compile("0.0", "nothing", "eval")

    def rates(self, state: NDArray, inputs: dict[str, float], push: float = 0.0) -> list[float]:
        """Return the derivatives of the states."""
        names = {**self.values, **inputs, **dict(zip(self.states, state.tolist(), strict=True))}
        names[self.port] = push + eval(self.law, names)
        for key, code in self.codes:
            names[key] = eval(code, names)
        return [names[f"d {key}"] for key in self.states]

    def run(self, trial: Trial) -> NDArray:
        """Integrate over a trial (sample, state); inputs and pushes are linear between samples."""
        clock = trial.clock

        def rates(t: float, state: NDArray) -> list[float]:
            now = {key: float(np.interp(t, clock, wave)) for key, wave in trial.inputs.items()}
            return self.rates(state, now, float(np.interp(t, clock, trial.push)))

        ends, step = (clock[0], clock[-1]), clock[1] - clock[0]
        done = solve_ivp(rates, ends, trial.start, "LSODA", clock, rtol=1e-7, atol=1e-9, max_step=step)
        if not done.success:
            raise ValueError(f"{self.states}: {done.message}")
        return done.y.T

    def along(self, text: str, states: NDArray) -> NDArray:
        """Return an expression of the states along a run."""
        code = compile(text, text, "eval")
        return np.array([eval(code, dict(zip(self.states, state, strict=True))) for state in states])


def draw_wave(clock: NDArray, low: float, high: float, rng: np.random.Generator) -> NDArray:
    """Draw a sum of six sines of frequencies [Hz] between two, its mean 0 and its standard deviation 1."""
    wave = np.sin(np.outer(clock, 2 * np.pi * rng.uniform(low, high, 6)) + rng.uniform(0, 2 * np.pi, 6)).sum(axis=1)
    return (wave - wave.mean()) / wave.std()


def draw_share(limits: tuple[float, float], rng: np.random.Generator) -> float:
    """Draw a share, all orders of magnitude alike."""
    return math.exp(rng.uniform(*np.log(limits)))


def hide_law(model: Model, kind: str, trial: Trial, motion: list[str], rng: np.random.Generator) -> dict[str, str]:
    """Put a law at the model's port, scaled along a run without it.

    motion: the position (empty where there is none) and the rate that the law sees
    """
    laws = CASES["laws"][kind.removeprefix("pushed_")]
    choices = laws["rates"] | (laws["positions"] if motion[0] else {})
    effect, states = str(rng.choice([*choices])), model.run(trial)
    names: dict[str, Any] = {key: f"{rng.uniform(*limits):.3g}" for key, limits in CASES["constants"].items()}
    for key, text in zip("pr", motion, strict=True):
        names |= {key: text, f"s{key}": f"{model.along(text or '0.0', states).std():.4g}"}
    text, rates = choices[effect].format(**names), []
    for law in ("0.0", text):
        model.law = compile(law, effect, "eval")
        rates.append([model.rates(*one) for one in zip(states, trial.moments, strict=True)])
    moved = np.subtract(*rates)
    base, change = (np.sqrt(np.mean(np.square(one), axis=0)) for one in (rates[0], moved))
    column = int(np.argmax(change))
    # a spring that the run never reaches; friction that never reverses is a constant load, whatever its name
    if moved[:, column].std() < CONSTANT * change[column] or change[column] == 0:
        model.law = compile("0.0", "nothing", "eval")
        return hide_law(model, kind, trial, motion, rng)
    shares = WEAK if kind == "term" else SHARES
    term = f"{rng.uniform(*shares) * base[column] / change[column]:.5g}*({text})"
    model.law = compile(term, effect, "eval")
    return {"effect": effect, "term": term}


def push_trials(model: Model, trials: list[Trial], share: float, rng: np.random.Generator) -> list[Trial]:
    """Add random pushes at the model's port that move it by a share of its motion."""
    calm, size = np.stack([model.run(one) for one in trials]), 1.0
    pushes = [rng.standard_normal(len(one.clock)) for one in trials]
    columns = [model.states.index(one) for one in model.channels]
    for _ in range(PUSH_TURNS):
        pushed = [replace(one, push=size * push) for one, push in zip(trials, pushes, strict=True)]
        moved = np.stack([model.run(one) for one in pushed]) - calm
        size *= share / (np.std(moved, axis=(0, 1)) / np.std(calm, axis=(0, 1)))[columns].max()
    return [replace(one, push=size * push) for one, push in zip(trials, pushes, strict=True)]


def put_off(found: re.Match[str], rng: np.random.Generator) -> str:
    """Return a number of a file that is off, with bounds that hold the truth."""
    wrong = float(found[2]) * (1 + OFF * float(np.clip(rng.standard_normal(), -2, 2)))
    low, high = sorted((wrong * (1 - 2.5 * OFF), wrong * (1 + 2.5 * OFF)))
    return f"{found[1]}{wrong:.6g}\nlow = {low:.6g}\nhigh = {high:.6g}"


def draw_trials(system: dict[str, Any], model: Model, count: int, rng: np.random.Generator) -> list[Trial]:
    """Draw inputs and starts; a single trial is as long as two."""
    seconds = system["seconds"] * (SETTLING + (2 if count == 1 else 1))
    clock, trials = np.arange(int(seconds * system["rate"])) / system["rate"], []
    for _ in range(count):
        drives = system.get("inputs", {}).items()
        inputs = {key: mean + spread * draw_wave(clock, low, high, rng) for key, (mean, spread, low, high) in drives}
        start = system.get("start", model.begun) + system["spread"] * rng.standard_normal(len(model.states))
        trials.append(Trial(clock, inputs, start, np.zeros(len(clock))))
    return trials


def record_inputs(trials: list[Trial], system: dict[str, Any], rng: np.random.Generator) -> None:
    """Give each input of the record a gain, and in each trial a slow wander."""
    for key, (_, spread, low, _) in system["inputs"].items():
        gain = 1 + float(rng.choice([-1, 1])) * draw_share(GAIN, rng)
        for one in trials:
            wander = draw_share(WANDER, rng) * spread * draw_wave(one.clock, 0.2 * SLOW * low, SLOW * low, rng)
            one.inputs[key] = gain * one.inputs[key] + wander


def write_record(path: Path, trials: list[Trial], seen: list[dict[str, NDArray]], skipped: int) -> None:
    """Write the table of all trials, from the sample on where the record begins."""
    tables = []
    for number, (trial, channels) in enumerate(zip(trials, seen, strict=True), 1):
        time_s = trial.clock - trial.clock[skipped]
        tables.append(pd.DataFrame({"trial": number, "time": time_s, **trial.inputs, **channels})[skipped:])
    pd.concat(tables).to_csv(path, index=False, float_format="%.8g")


def make_case(kind: str, number: int, seed: int, folder: Path, again: int = 0) -> dict[str, Any]:
    """Write a case's simulation and record; what is hidden in it is returned.

    again: draws other noise for the same trials
    """
    rng = np.random.default_rng([seed, zlib.crc32(kind.encode()), number])
    name = CASES["kinds"][kind][number % len(CASES["kinds"][kind])]
    system, model = CASES["systems"][name], Model(name)
    trials = draw_trials(system, model, 1 if kind == "one_trial" else TRIALS, rng)
    truth: dict[str, Any] = {"system": name, "noise": draw_share(NOISE, rng)}
    hidden = kind.removeprefix("pushed_") in CASES["laws"]
    if hidden or kind == "pushed":
        model.port = truth["port"] = str(rng.choice([*system["ports"]]))
    if hidden:
        truth |= hide_law(model, kind, trials[0], system["ports"][model.port], rng)
    if kind.startswith("pushed"):
        truth["pushes"] = draw_share(PUSHES, rng)
        trials = push_trials(model, trials, truth["pushes"], rng)
    runs = [pd.DataFrame(model.run(one), columns=model.states) for one in trials]
    channels = system["seen"] if kind == "hidden" else model.channels
    truth["sd"] = (truth["noise"] * pd.concat(runs)[channels].std()).to_dict()
    rng = np.random.default_rng([seed, number, again]) if again else rng
    seen = [{key: run[key] + sd * rng.standard_normal(len(run)) for key, sd in truth["sd"].items()} for run in runs]
    if kind == "filtered":
        lowpass = butter(2, 2 * CUTOFF, output="sos")
        seen = [{key: sosfiltfilt(lowpass, wave) for key, wave in one.items()} for one in seen]
    if kind == "inputs":
        record_inputs(trials, system, rng)
    text = model.text[: model.text.index("[observations]")] + "[observations]\n"
    text += "".join(f'{one} = "{one}"\n' for one in channels)
    if kind == "off":
        text = re.sub(r"(\[parameters\.\w+\]\nvalue = )(\S+)", lambda found: put_off(found, rng), text)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "simulation.toml").write_text(text, encoding="utf-8")
    (folder / "truth.json").write_text(json.dumps(truth, indent=1), encoding="utf-8")
    write_record(folder / "measured.csv", trials, seen, int(SETTLING * system["seconds"] * system["rate"]))
    return truth
