"""Running the known model with what was learned: in its rates (Eq. 3.4), or on its states (Eq. 3.5)."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.compiled import compiled
from gaitdisc.errors import TrainingError
from gaitdisc.model import Model
from gaitdisc.simulation.operations import BLOCK, execute, exponential

from .dmd import Dmd
from .gaussian_process import KERNELS as KERNEL_KINDS
from .gaussian_process import GaussianProcess
from .methods import ByOutput
from .record import LONGEST_STEP_S, KnownRates, Rates, System, rk4_step
from .sindy import Sindy

BOUND = 1e6  # a state beyond has diverged
PRODUCTS, KERNELS, LAYERS, TIMES = 0, 1, 2, 3  # what `tables` holds
TABLES = 6
LEARNED_STEP_S = 2.5e-3  # of Runge-Kutta order 4 with a learned term: its error is below that of any fit


@compiled
def learned_rate(kind, tables, place, x, out):
    """Outputs of a learned term at one state.

    tables each ndarray: six matrices, as `learned_term` lays them out
    """
    if kind == 0:
        _sum_products(tables, x, out)
    elif kind == 1:
        _sum_kernels(tables, x, out)
    elif kind == 2:
        _sum_layers(tables, x, out)
    else:
        for o in range(out.size):
            out[o] = tables[0][place, o]


@compiled
def _sum_products(tables, x, out):
    powers, weights = tables[0], tables[1]
    for o in range(out.size):
        out[o] = 0.0
    for k in range(powers.shape[0]):
        value = 1.0
        for j in range(x.size):
            for _ in range(int(powers[k, j])):
                value *= x[j]
        for o in range(out.size):
            out[o] += weights[k, o] * value


@compiled(error_model="numpy", fastmath=True)
def _sum_kernels(tables, x, out):
    centres, weights, inverse, scale, offset = tables[0], tables[1], tables[2], tables[3], tables[4]
    kind = int(tables[5][0, 0])
    scaled = np.empty(x.size)
    for j in range(x.size):
        scaled[j] = (x[j] - scale[0, j]) * scale[1, j]
    for o in range(out.size):
        total = 0.0
        for k in range(centres.shape[0]):
            apart = 0.0
            for j in range(x.size):
                step = (scaled[j] - centres[k, j]) * inverse[o, j]
                apart += step * step
            if kind == 0:
                total += weights[k, o] * exponential(-0.5 * apart)
            elif kind == 1:
                far = math.sqrt(3.0 * apart)
                total += weights[k, o] * (1.0 + far) * exponential(-far)
            else:
                far = math.sqrt(5.0 * apart)
                total += weights[k, o] * (1.0 + far + far * far / 3.0) * exponential(-far)
        out[o] = total + offset[0, o]


@compiled(error_model="numpy", fastmath=True)
def _sum_layers(tables, x, out):
    first, second, third, scale, offset = tables[0], tables[1], tables[2], tables[3], tables[4]
    nodes, n = second.shape[1] - 1, x.size
    networks = second.shape[0] // nodes  # one for all outputs, or one for each
    sigmoid = np.empty(nodes)
    for o in range(out.size):
        out[o] = offset[0, o]
    for each in range(networks):
        low, high = (0, out.size) if networks == 1 else (each, each + 1)
        for k in range(nodes):
            total = first[each * nodes + k, n]
            for j in range(n):
                total += first[each * nodes + k, j] * (x[j] - scale[0, j]) * scale[1, j]
            sigmoid[k] = 1.0 / (1.0 + exponential(-total))
        for k in range(nodes):
            total = second[each * nodes + k, nodes]
            for j in range(nodes):
                total += second[each * nodes + k, j] * sigmoid[j]
            radial = exponential(-total * total)
            for o in range(low, high):
                out[o] += third[o, k] * radial


@compiled
def integrate_augmented(program, learned, start, plan, found):
    """Known rates plus a learned term, by Runge-Kutta of order 4; ends where a state leaves every bound."""
    code, registers = program
    kind, tables = learned
    steps, substeps, h = plan
    n = start.size
    rates, flat = np.zeros(n * BLOCK), registers.reshape(-1)
    x, stage, total, extra = start.copy(), np.empty(n), np.empty(n), np.empty(n)
    found[0] = x
    for sample in range(steps):
        for sub in range(substeps):
            place = 2 * (sample * substeps + sub)
            stage[:] = x
            total[:] = 0.0
            for part in range(4):
                for s in range(n):
                    registers[1 + s, 0] = stage[s]
                execute(code, flat, rates, np.uint64(1))
                learned_rate(kind, tables, place + (part + 1) // 2, stage, extra)
                weight = 1.0 if part in (0, 3) else 2.0
                ahead = 0.5 * h if part < 2 else h
                for s in range(n):
                    rate = rates[s * BLOCK] + extra[s]
                    total[s] += weight * rate
                    stage[s] = x[s] + ahead * rate
            for s in range(n):
                x[s] += h / 6.0 * total[s]
        for s in range(n):
            if not (math.isfinite(x[s]) and abs(x[s]) < BOUND):
                return
        found[sample + 1] = x


@dataclass(frozen=True, eq=False)
class LearnedTerm:
    """Features and weights."""

    kind: int
    tables: tuple[NDArray[np.float64], ...]  # each ndarray, six matrices


def learned_term(model: Model, times: NDArray[np.float64]) -> LearnedTerm:
    """Lay out a learned model."""
    if isinstance(model, Sindy):
        return LearnedTerm(PRODUCTS, _six(model.powers, model.coefficients))
    if isinstance(model, GaussianProcess):
        scale = np.vstack([model.scale.mean, 1 / model.scale.sd])
        kind = np.array([[KERNEL_KINDS.index(model.kind)]])
        return LearnedTerm(KERNELS, _six(model.centres, model.weights, 1 / model.lengths, scale, model.offset, kind))
    if isinstance(model, Dmd):
        return LearnedTerm(TIMES, _six(model(times[:, None])))
    return LearnedTerm(LAYERS, _six(*_layer_tables(model)))


def _layer_tables(model: Model) -> tuple[NDArray[np.float64], ...]:
    """Weights with offsets in a last column, network under network; the scale of the outputs goes into the readout."""
    from gaitdisc.models.trained_network import TrainedNetwork

    networks = model.models if isinstance(model, ByOutput) else (model,)
    first, second, third, offset, scale = [], [], [], [], np.empty((2, 0))
    for network in networks:
        if not isinstance(network, TrainedNetwork) or "radial.weight" not in network.weights():
            raise TrainingError(
                "a learned term is a Sindy, a Dmd, a GaussianProcess, or trained FeedForwards",
                f"found {type(network).__name__}",
                "Fit one of these.",
            )
        weights = {name: np.asarray(values, float) for name, values in network.weights().items()}
        for rows, each in ((first, "sigmoid"), (second, "radial")):
            rows.append(np.column_stack([weights[f"{each}.weight"], weights[f"{each}.bias"]]))
        size = np.where(network.y_scale.constant, 0.0, network.y_scale.sd)
        third.append(weights["readout.weight"] * size[:, None])
        offset.append(weights["readout.bias"] * size + network.y_scale.mean)
        scale = np.vstack([network.x_scale.mean, 1 / network.x_scale.sd])  # all have seen the same inputs
    return np.vstack(first), np.vstack(second), np.vstack(third), scale, np.concatenate(offset)


def _six(*tables: NDArray) -> tuple[NDArray[np.float64], ...]:
    full = [np.ascontiguousarray(np.atleast_2d(np.array(table, float))) for table in tables]
    return tuple(full + [np.zeros((1, 1))] * (TABLES - len(full)))


@dataclass(frozen=True, eq=False)
class AugmentedRun:
    """States or channels of the augmented model."""

    values: NDArray[np.float64]  # (sample, channel), NaN from where it diverged
    diverged_s: float | None  # time of the last finite sample [s], where it left every bound


def with_learned_rates(
    known: Rates, learned: Model, start: NDArray[np.float64], time: NDArray[np.float64]
) -> AugmentedRun:
    """Integrate f + delta_f (Eq. 3.4)."""
    dt = float(time[1] - time[0])
    longest = LEARNED_STEP_S if isinstance(known, KnownRates) else LONGEST_STEP_S
    substeps = max(1, int(np.ceil(dt / longest - 1e-9)))
    h = dt / substeps
    halves = time[0] + 0.5 * h * np.arange(2 * substeps * (len(time) - 1) + 1)
    found = np.full((len(time), len(start)), np.nan)
    if isinstance(known, KnownRates):
        term = learned_term(learned, halves)
        plan = (len(time) - 1, substeps, h)
        integrate_augmented(_program(known), (term.kind, term.tables), np.array(start, float), plan, found)
    else:
        table = learned(halves[:, None]) if learned.inputs == ("t",) else None  # a model of time, evaluated at once

        def rates(state: NDArray[np.float64], place: int) -> NDArray[np.float64]:
            return known(state) + (learned(state) if table is None else table[place])

        _in_python(rates, np.asarray(start, float), h, substeps, found)
    finite = np.isfinite(found).all(axis=1)
    return AugmentedRun(found, None if finite.all() else float(time[max(int(np.argmin(finite)) - 1, 0)]))


def on_states(
    system: System, learned: Model, start: NDArray[np.float64], time: NDArray[np.float64], summed: bool = False
) -> AugmentedRun:
    """Correct the known model's solution (Eq. 3.5)."""
    dt = float(time[1] - time[0])
    states = system.known.run(start[None], dt, len(time) - 1)[0]
    values = learned(time[:, None] if learned.inputs == ("t",) else states)
    if summed:
        error, values = np.zeros((1, len(learned.inputs))), np.zeros_like(values)
        with np.errstate(all="ignore"):  # De/dt = delta(e) from zero
            for sample in range(1, len(values)):
                error = rk4_step(learned, error, dt)
                values[sample] = error[0, : values.shape[1]]
    return AugmentedRun(states[:, : len(system.channels)] + values, None)


def _program(known: KnownRates) -> tuple[NDArray[np.uint64], NDArray[np.float64]]:
    """Code of a stage, and registers with what does not change in their places."""
    compiled = known.compiled
    program = compiled.right_hand_side
    registers = np.zeros((program.registers, BLOCK))
    first = 1 + len(compiled.states)
    registers[first : first + len(compiled.parameters)] = np.asarray(compiled.defaults)[:, None]
    first += len(compiled.parameters)
    registers[first : first + len(program.constants)] = np.asarray(program.constants)[:, None]
    code = program.placed(BLOCK)
    execute(code[: program.setup], registers.reshape(-1), np.zeros(program.outputs * BLOCK), np.uint64(1))
    return np.ascontiguousarray(code[program.setup :]), registers


def _in_python(rates: Callable, start: NDArray[np.float64], h: float, substeps: int, found: NDArray) -> None:
    """Runge-Kutta of order 4 for rates that are not of a simulation file."""
    x = found[0] = start[None]
    with np.errstate(all="ignore"):
        for step in range(substeps * (len(found) - 1)):
            one = rates(x, 2 * step)
            two = rates(x + 0.5 * h * one, 2 * step + 1)
            three = rates(x + 0.5 * h * two, 2 * step + 1)
            x = x + h / 6 * (one + 2 * two + 2 * three + rates(x + h * three, 2 * step + 2))
            if not np.all(np.abs(x) < 1e6):
                return
            if (step + 1) % substeps == 0:
                found[(step + 1) // substeps] = x[0]
