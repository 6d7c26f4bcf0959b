"""Running the known model with what was learned: in its rates (Eq. 3.4), or on its states (Eq. 3.5)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.model import Model
from gaitdisc.recording.arrays import read_only
from gaitdisc.simulation.operations import BLOCK, execute

from .burgers import LONGEST_STEP_S
from .known_rates import KnownRates
from .learned_term import learned_term
from .system import Rates, System

LEARNED_STEP_S = 2.5e-3  # of Runge-Kutta order 4 with a learned term: its error is below that of any fit
FIELD_STEP_S = LONGEST_STEP_S  # where the known rates are a field's: as the field itself runs


@dataclass(frozen=True, eq=False)
class AugmentedRun:
    """States or channels of the augmented model."""

    values: NDArray[np.float64]  # (sample, channel), NaN from where it diverged
    diverged_s: float | None  # time of the last finite sample [s], where it left every bound

    def __post_init__(self) -> None:
        """Freeze the numbers."""
        object.__setattr__(self, "values", read_only(self.values))


def with_learned_rates(
    known: Rates, learned: Model, start: NDArray[np.float64], time: NDArray[np.float64], step_s: float | None = None
) -> AugmentedRun:
    """Integrate f + delta_f (Eq. 3.4)."""
    dt = float(time[1] - time[0])
    longest = step_s or (LEARNED_STEP_S if isinstance(known, KnownRates) else FIELD_STEP_S)
    substeps = max(1, int(np.ceil(dt / longest - 1e-9)))
    h = dt / substeps
    halves = time[0] + 0.5 * h * np.arange(2 * substeps * (len(time) - 1) + 1)
    found = np.full((len(time), len(start)), np.nan)
    if isinstance(known, KnownRates):
        from .learned_rates import integrate_augmented

        term = learned_term(learned, halves)
        plan = (len(time) - 1, substeps, h)
        integrate_augmented(_program(known), (term.kind, term.tables), np.array(start, float), plan, found)
    else:
        _in_python((known, learned), np.asarray(start, float), halves, substeps, found)
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
        values = _integrated(learned, values.shape, dt)
    return AugmentedRun(states[:, : len(system.channels)] + values, None)


def _integrated(learned: Model, shape: tuple[int, ...], dt_s: float) -> NDArray[np.float64]:
    """De/dt = delta(e) from zero, by Runge-Kutta of order 4."""
    error, found = np.zeros((1, len(learned.inputs))), np.zeros(shape)
    with np.errstate(all="ignore"):
        for sample in range(1, shape[0]):
            one = learned(error)
            two = learned(error + 0.5 * dt_s * one)
            three = learned(error + 0.5 * dt_s * two)
            error = error + dt_s / 6 * (one + 2 * two + 2 * three + learned(error + dt_s * three))
            found[sample] = error[0, : shape[1]]
    return found


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


def _in_python(
    models: tuple[Rates, Model],
    start: NDArray[np.float64],
    halves: NDArray[np.float64],
    substeps: int,
    found: NDArray[np.float64],
) -> None:
    """Runge-Kutta of order 4 for rates that are not of a simulation file; a model of time is evaluated at once."""
    known, learned = models
    of_time = learned.inputs == ("t",)
    table = learned(halves[:, None]) if of_time else None
    h, x = 2 * (halves[1] - halves[0]), start[None].copy()

    def rates(state: NDArray[np.float64], place: int) -> NDArray[np.float64]:
        return known(state) + (table[place] if table is not None else learned(state))

    found[0] = start
    with np.errstate(all="ignore"):
        for step in range((len(halves) - 1) // 2):
            one = rates(x, 2 * step)
            two = rates(x + 0.5 * h * one, 2 * step + 1)
            three = rates(x + 0.5 * h * two, 2 * step + 1)
            x = x + h / 6 * (one + 2 * two + 2 * three + rates(x + h * three, 2 * step + 2))
            if not np.all(np.abs(x) < 1e6):
                return
            if (step + 1) % substeps == 0:
                found[(step + 1) // substeps] = x[0]
