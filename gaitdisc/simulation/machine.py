"""The machine that runs a simulation's program over blocks of rows; compiled once, for every simulation.

A simulation is data to it, so nothing is compiled for a new one. Each operation works on all rows of a block before the
next is looked up, and a block's registers stay in the cache. Runge-Kutta of order 4 with a fixed step; inputs are
linear between their samples; a delayed state is linear between the steps of its own row.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

BLOCK = 64  # rows at once
BOUND = 1e6  # a state beyond has diverged

# Without numpy's division there would be a branch in every loop.
compiled = njit(cache=True, error_model="numpy", fastmath=False, nogil=True)


@compiled
def execute(code, registers, outputs, width):
    """Run register operations over the first rows of a block.

    Parameters
    ----------
    code : ndarray of int (operation, 4)
        From `Program.code`.
    registers, outputs : ndarray (register, row), (output, row)
        Changed in place.
    width : int
        Rows that count.
    """
    for i in range(code.shape[0]):
        op, z, a, b = code[i, 0], code[i, 1], code[i, 2], code[i, 3]
        if op == 0:
            for r in range(width):
                outputs[z, r] = registers[a, r]
        elif op == 1:
            for r in range(width):
                registers[z, r] = registers[a, r] + registers[b, r]
        elif op == 2:
            for r in range(width):
                registers[z, r] = registers[a, r] - registers[b, r]
        elif op == 3:
            for r in range(width):
                registers[z, r] = registers[a, r] * registers[b, r]
        elif op == 4:
            for r in range(width):
                registers[z, r] = registers[a, r] / registers[b, r]
        elif op == 5:
            for r in range(width):
                registers[z, r] = registers[a, r] ** registers[b, r]
        elif op == 6:
            for r in range(width):
                registers[z, r] = -registers[a, r]
        elif op == 15:
            for r in range(width):
                x, y = registers[a, r], registers[b, r]
                registers[z, r] = x if x > y or x != x else y
        elif op == 16:
            for r in range(width):
                x, y = registers[a, r], registers[b, r]
                registers[z, r] = x if x < y or x != x else y
        else:
            _function(op, registers, z, a, width)


@compiled
def _function(op, registers, z, a, width):
    if op == 7:
        for r in range(width):
            registers[z, r] = math.sin(registers[a, r])
    elif op == 8:
        for r in range(width):
            registers[z, r] = math.cos(registers[a, r])
    elif op == 9:
        for r in range(width):
            registers[z, r] = math.tan(registers[a, r])
    elif op == 10:
        for r in range(width):
            registers[z, r] = math.tanh(registers[a, r])
    elif op == 11:
        for r in range(width):
            x = registers[a, r]
            registers[z, r] = math.exp(x if x < 700.0 or x != x else 700.0)
    elif op == 12:
        for r in range(width):
            x = registers[a, r]
            registers[z, r] = np.log(x) if x > 0.0 else (-np.inf if x == 0.0 else np.nan)
    elif op == 13:
        for r in range(width):
            x = registers[a, r]
            registers[z, r] = np.sqrt(x) if x >= 0.0 else np.nan
    elif op == 14:
        for r in range(width):
            registers[z, r] = abs(registers[a, r])
    else:
        for r in range(width):
            x = registers[a, r]
            registers[z, r] = x if x != x else (1.0 if x > 0.0 else 0.0)


@compiled
def evaluate_blocks(code, constants, columns, spread, into):
    """Values of a program at many points.

    Parameters
    ----------
    code : ndarray of int (operation, 4)
        From `Program.code`.
    constants : ndarray (constant,)
        Of the program.
    columns : ndarray (leaf and delay, point or 1)
        Values of the leaves; of those that have one value for all points the first counts.
    spread : ndarray of int (register,)
        For each register of the program: 0 one value for all points, 1 a value for each, 2 not a leaf.
    into : ndarray (output, point)
        Changed in place.
    """
    leaves, points = columns.shape[0], into.shape[1]
    registers, outputs = np.empty((spread.size, BLOCK)), np.empty((into.shape[0], BLOCK))
    for leaf in range(leaves):
        if spread[leaf] == 0:
            registers[leaf, :] = columns[leaf, 0]
    for k in range(constants.size):
        registers[leaves + k, :] = constants[k]
    for start in range(0, points, BLOCK):
        width = min(BLOCK, points - start)
        for leaf in range(leaves):
            if spread[leaf] == 1:
                registers[leaf, :width] = columns[leaf, start : start + width]
        execute(code, registers, outputs, width)
        into[:, start : start + width] = outputs[:, :width]


@compiled
def _linear(values, last, position, wraps):
    """Value of a sampled signal between its samples, held beyond them."""
    position = min(max(position, 0.0), float(last))
    k = int(position)
    value = values[k]
    if k < last:
        slope = values[k + 1] - value
        if wraps:
            slope -= np.round(slope)
        value += (position - k) * slope
    return value - math.floor(value) if wraps else value


@compiled
def _set_inputs(registers, first, ends, wraps, share, width):
    """Inputs between two samples into their registers; ends: (2, input, row) value and slope."""
    for j in range(wraps.size):
        for r in range(width):
            registers[first + j, r] = ends[0, j, r] + share * ends[1, j, r]
        if wraps[j]:
            for r in range(width):
                registers[first + j, r] -= math.floor(registers[first + j, r])


@compiled
def _gather(ends, inputs, place, last, sample, wraps):
    """Inputs at a sample of each row and their slope to the next."""
    for r in range(last.size):
        trial, k = place[r, 0], min(place[r, 1] + sample, last[r])
        for j in range(wraps.size):
            value = inputs[trial, k, j]
            slope = inputs[trial, min(k + 1, last[r]), j] - value
            ends[0, j, r] = value
            ends[1, j, r] = slope - np.round(slope) if wraps[j] else slope


@compiled
def _set_delayed(registers, first, delays, seconds, now, signals, history):
    """Delayed signals into their registers.

    delays (delay, 2): 0 input or 1 state, column; seconds (row, delay); now: sample since the start, rate, steps so far;
    signals: inputs, past, place, last, wraps; history (state, step, row).
    """
    sample, rate, done, substeps = now
    inputs, past, place, last, wraps = signals
    for d in range(delays.shape[0]):
        column = delays[d, 1]
        for r in range(last.size):
            position = sample - seconds[r, d] * rate
            trial, begin = place[r, 0], place[r, 1]
            if delays[d, 0] == 0:
                value = _linear(inputs[trial, :, column], last[r], begin + position, wraps[column])
            elif position >= 0.0:
                step = min(position * substeps, float(done))
                k = int(step)
                value = history[column, k, r]
                if k < done:
                    value += (step - k) * (history[column, k + 1, r] - value)
            else:
                value = _before(past, trial, begin, position, column, history[column, 0, r])
            registers[first + d, r] = value


@compiled
def _before(past, trial, begin, position, column, start):
    """Value of a state before its row began: what was measured, else the row's first value."""
    if past.shape[0] == 0 or begin == 0:
        return start
    at = max(begin + position, 0.0)
    k = int(at)
    value = past[trial, k, column]
    after = start if k + 1 == begin else past[trial, k + 1, column]
    value += (at - k) * (after - value)
    return value if math.isfinite(value) else start


@compiled
def _advance(x, stage, rates, total, factors, width):
    """One stage of Runge-Kutta: total += weight * rates, stage = x + share * rates."""
    weight, share = factors
    for s in range(x.shape[0]):
        for r in range(width):
            total[s, r] += weight * rates[s, r]
            stage[s, r] = x[s, r] + share * rates[s, r]


@compiled
def integrate_block(program, drive, rows, plan, past, into):
    """Integrate up to `BLOCK` rows; what lies beyond a trial's end or a divergence stays as it was in `into`.

    Parameters
    ----------
    program : tuple
        Code, operations of its setup, constants, delays (delay, 2) as input or state and column, registers.
    drive : tuple
        Rate [Hz], first times (trial,), inputs (trial, sample, input), samples (trial,), which inputs wrap (input,).
    rows : tuple
        Place (row, 2) as trial and first sample, starts (row, state), values (row, parameter), seconds (row, delay).
    plan : tuple of int
        Samples to go, steps for each.
    past : ndarray (trial, sample, state)
        Measured states before the rows begin; of no trials where there are none.
    into : tuple
        States (row, sample, state), whether each row stayed finite (row,).
    """
    code, setup, constants, delays, count = program
    rate, first_times, inputs, samples, wraps = drive
    place, starts, values, seconds = rows
    steps, substeps = plan
    found, ok = into
    width, n = starts.shape
    drives, parameters = wraps.size, values.shape[1]
    input_at, parameter_at = 1 + n, 1 + n + drives
    delay_at = parameter_at + parameters
    registers = np.zeros((count, BLOCK))
    x, total, rates = np.zeros((n, BLOCK)), np.zeros((n, BLOCK)), np.zeros((n, BLOCK))
    ends = np.zeros((2, drives, BLOCK))
    last, t0 = np.empty(width, np.int64), np.empty(width)
    kept = steps * substeps + 1 if (delays.shape[0] and delays[:, 0].max() == 1) else 1
    history = np.empty((n, kept, width))
    for r in range(width):
        last[r] = samples[place[r, 0]] - 1
        t0[r] = first_times[place[r, 0]] + place[r, 1] / rate
        for s in range(n):
            x[s, r] = starts[r, s]
            history[s, 0, r] = starts[r, s]
        for p in range(parameters):
            registers[parameter_at + p, r] = values[r, p]
    for k in range(constants.size):
        registers[delay_at + delays.shape[0] + k, :] = constants[k]
    execute(code[:setup], registers, rates, width)
    main = code[setup:]
    stage = registers[1 : 1 + n]
    h = 1.0 / (rate * substeps)
    signals = (inputs, past, place, last, wraps)
    live = ok.copy()
    for sample in range(steps):
        _gather(ends, inputs, place, last, sample, wraps)
        for sub in range(substeps):
            total[:, :] = 0.0
            stage[:, :] = x
            done = sample * substeps + sub
            for part in range(4):
                half = (part + 1) // 2  # 0, 1, 1, 2 half steps
                if part != 2:
                    share = (2 * sub + half) / (2 * substeps)
                    _set_inputs(registers, input_at, ends, wraps, share, width)
                    for r in range(width):
                        registers[0, r] = t0[r] + (sample + share) / rate
                    if delays.shape[0]:
                        now = (sample + share, rate, done, substeps)
                        _set_delayed(registers, delay_at, delays, seconds, now, signals, history)
                execute(main, registers, rates, width)
                weight = 1.0 if part in (0, 3) else 2.0
                ahead = 0.5 * h if part < 2 else h
                _advance(x, stage, rates, total, (weight, ahead), width)
            for s in range(n):
                for r in range(width):
                    x[s, r] += h / 6.0 * total[s, r]
            if kept > 1:
                history[:, done + 1, :] = x[:, :width]
        for r in range(width):
            if live[r] and place[r, 1] + sample + 1 <= last[r]:
                for s in range(n):
                    ok[r] = ok[r] and abs(x[s, r]) < BOUND
                if ok[r]:
                    for s in range(n):
                        found[r, sample + 1, s] = x[s, r]
            live[r] = ok[r] and place[r, 1] + sample + 1 < last[r]
        if not live.any():
            break
