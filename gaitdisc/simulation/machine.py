"""The machine that runs a simulation's program over blocks of rows; compiled once, for every simulation.

A simulation is data to it, so nothing is compiled for a new one. Each operation works on all rows of a block before the
next is looked up, and a block's registers stay in the cache. Runge-Kutta of order 4 with a fixed step; inputs are
linear between their samples; a delayed state is linear between the steps of its own row. A Python object's right-hand
side is integrated by the same lines, run by Python, with its function as `derive`.
"""

import math

import numpy as np

from gaitdisc.simulation.operations import BLOCK, compiled, execute

BOUND = 1e6  # a state beyond has diverged
derive = execute  # what a block's derivatives are computed by


@compiled
def evaluate_blocks(code, constants, columns, spread, into):
    """Values of a program at many points.

    code of uint64 (operation, 4): from `Program.placed`
    constants (constant,): of the program
    columns (leaf and delay, point): values of the leaves; of those that have one value for all points the first counts
    spread (register,): for each register of the program: 0 one value for all points, 1 a value for each, 2 not read or
        not a leaf
    into (output, point): changed in place
    """
    leaves, points = columns.shape[0], into.shape[1]
    registers, outputs = np.zeros((spread.size, BLOCK)), np.empty((into.shape[0], BLOCK))
    flat, out = registers.reshape(-1), outputs.reshape(-1)
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
        execute(code, flat, out, np.uint64(width))
        into[:, start : start + width] = outputs[:, :width]


@compiled
def integrate(program, drive, rows, plan, past, into):
    """Integrate any number of rows, block after block.

    program, drive, rows, plan, past, into tuple or ndarray: as for `integrate_block`
    """
    place, starts, values, seconds = rows
    states, ok = into
    blocks = -(-starts.shape[0] // plan[2])
    for block in range(blocks):
        first, end = block * starts.shape[0] // blocks, (block + 1) * starts.shape[0] // blocks
        block_rows = (place[first:end], starts[first:end], values[first:end], seconds[first:end])
        integrate_block(program, drive, block_rows, plan, past, (states[first:end], ok[first:end]))


@compiled
def integrate_block(program, drive, rows, plan, past, into):
    """Integrate a block of rows; what lies beyond a trial's end or a divergence stays as it was in `into`.

    program: code, operations of its setup, constants, delays (delay, 2) as input or state and column, registers
    drive: rate [Hz], first times (trial,), inputs (trial, sample, input), samples (trial,), which inputs wrap (input,)
    rows: place (row, 2) as trial and first sample, starts (row, state), values (row, parameter), seconds (row, delay)
    plan: samples, steps for each, rows that a block has room for, inputs that the program reads (input,)
    past (trial, sample, state): measured states before the rows begin; of no trials where there are none
    into: states (row, sample, state), whether each row stayed finite (row,)
    """
    code, setup, _, delays, _ = program
    rate, _, _, samples, wraps = drive
    place, starts, _, _ = rows
    steps, substeps, lanes, read = plan
    states, ok = into
    width, n = starts.shape
    registers, rates = _fill(program, rows, n + wraps.size, lanes), np.zeros((n, lanes))
    flat, out, there = registers.reshape(-1), rates.reshape(-1), np.uint64(width)
    execute(code[:setup], flat, out, there)
    main, timed = code[setup:], np.any(code[:, 2:] == 0)  # time is the first register
    x, total, ends = np.zeros((n, lanes)), np.zeros((n, lanes)), np.zeros((2, wraps.size, lanes))
    x[:, :width] = starts.T
    registers[1 : 1 + n] = x
    history = np.empty((n, steps * substeps + 1 if np.any(delays[:, 0] == 1) else 1, width))
    history[:, 0, :] = starts.T
    last = samples[place[:, 0]] - 1
    live = ok.copy()
    now = np.zeros(3)  # samples since the start, steps done, steps for each sample
    now[2] = substeps
    for sample in range(steps):
        _gather(ends, drive, place, last, sample, read)
        for sub in range(substeps):
            now[1] = sample * substeps + sub
            for part in range(4):
                half = (part + 1) // 2  # 0, 1, 1, 2 half steps
                if part != 2:
                    now[0] = sample + (2 * sub + half) / (2 * substeps)
                    _set_inputs(registers, 1 + n, ends, wraps, now[0] - sample, read)
                    if timed:
                        _set_times(registers, drive, place, now[0])
                    if delays.shape[0]:
                        _set_delayed(registers, now, program, drive=drive, rows=rows, past=past, history=history)
                derive(main, flat, out, there)
                _advance(x, registers, rates, total, (part, 1.0 / (rate * substeps)), width)
            if history.shape[1] > 1:
                history[:, sample * substeps + sub + 1, :] = x[:, :width]
        _keep(x, place[:, 1] + sample, last, live, states[:, sample + 1], ok)
        if not live.any():
            break


@compiled
def _fill(program, rows, signals, lanes):
    """Registers with parameters and constants in their places."""
    _, _, constants, delays, count = program
    values = rows[2]
    registers = np.zeros((count, lanes))
    for p in range(values.shape[1]):
        registers[1 + signals + p, : values.shape[0]] = values[:, p]
    first = 1 + signals + values.shape[1] + delays.shape[0]
    for k in range(constants.size):
        registers[first + k, :] = constants[k]
    return registers


@compiled
def _gather(ends, drive, place, last, sample, read):
    """Inputs that are read, at a sample of each row, and their slope to the next, (2, input, row)."""
    _, _, inputs, _, wraps = drive
    for r in range(last.size):
        trial, k = place[r, 0], min(place[r, 1] + sample, last[r])
        for j in read:
            value = inputs[trial, k, j]
            slope = inputs[trial, min(k + 1, last[r]), j] - value
            ends[0, j, r] = value
            ends[1, j, r] = slope - np.round(slope) if wraps[j] else slope


@compiled
def _set_inputs(registers, first, ends, wraps, share, read):
    """Inputs that are read into their registers, a share of a sample on; of rows that a block has room for as well."""
    for j in read:
        for r in range(registers.shape[1]):
            registers[first + j, r] = ends[0, j, r] + share * ends[1, j, r]
        if wraps[j]:
            for r in range(registers.shape[1]):
                registers[first + j, r] -= math.floor(registers[first + j, r])


@compiled
def _set_times(registers, drive, place, sample):
    rate, first_times = drive[0], drive[1]
    for r in range(place.shape[0]):
        registers[0, r] = first_times[place[r, 0]] + (place[r, 1] + sample) / rate


@compiled
def _set_delayed(registers, now, program, drive, rows, past, history):
    """Delayed signals into their registers."""
    delays = program[3]
    rate, _, inputs, samples, wraps = drive
    place, starts, values, seconds = rows
    first = 1 + starts.shape[1] + wraps.size + values.shape[1]
    done = now[1]
    for d in range(delays.shape[0]):
        column = delays[d, 1]
        for r in range(place.shape[0]):
            position = now[0] - seconds[r, d] * rate
            trial, begin = place[r, 0], place[r, 1]
            if delays[d, 0] == 0:
                value = _linear(inputs[trial, :, column], samples[trial] - 1, begin + position, wraps[column])
            elif position >= 0.0:
                step = min(position * now[2], done)
                k = int(step)
                value = history[column, k, r]
                if k < done:
                    value += (step - k) * (history[column, k + 1, r] - value)
            else:
                value = _before(past, place[r], position, column, starts[r, column])
            registers[first + d, r] = value


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
def delay_signals(delays, seconds, drive, place, past, states, into):
    """Delayed signals along rows that were run, at their samples.

    Inputs are linear; states are cubic between the samples of their row, near to the finer steps of the run.

    delays (delay, 2), seconds (row, delay), drive, place (row, 2), past: as for `integrate_block`
    states (row, sample, state): of the rows
    into (row, sample, delay): changed in place
    """
    rate, _, inputs, samples, wraps = drive
    for d in range(delays.shape[0]):
        column = delays[d, 1]
        for r in range(place.shape[0]):
            trial, begin = place[r, 0], place[r, 1]
            for step in range(states.shape[1]):
                position = step - seconds[r, d] * rate
                if delays[d, 0] == 0:
                    value = _linear(inputs[trial, :, column], samples[trial] - 1, begin + position, wraps[column])
                elif position >= 0.0:
                    value = _cubic(states[r, :, column], position)
                else:
                    value = _before(past, place[r], position, column, states[r, 0, column])
                into[r, step, d] = value


@compiled
def _cubic(values, position):
    """Value by the polynomial through the four samples around it; linear where there are fewer."""
    if values.size < 4:
        return _linear(values, values.size - 1, position, False)
    first = min(max(int(position) - 1, 0), values.size - 4)
    value = 0.0
    for i in range(4):
        weight = 1.0
        for j in range(4):
            if j != i:
                weight *= (position - first - j) / (i - j)
        if weight != 0.0:
            value += weight * values[first + i]
    return value


@compiled
def _before(past, place, position, column, start):
    """Value of a state before its row began: what was measured, else the row's first value."""
    trial, begin = place[0], place[1]
    if past.shape[0] == 0 or begin == 0:
        return start
    at = max(begin + position, 0.0)
    k = min(int(at), begin - 1)  # a position just below 0 may round to the start
    value = past[trial, k, column]
    after = start if k + 1 == begin else past[trial, k + 1, column]
    value += (at - k) * (after - value)
    return value if math.isfinite(value) else start


@compiled
def _advance(x, registers, rates, total, stage, width):
    """Add a stage's rates to the sum, and put the next stage's states into their registers."""
    part, h = stage
    ahead = 0.5 * h if part < 2 else h
    for s in range(x.shape[0]):
        if part == 0:
            for r in range(width):
                total[s, r] = rates[s, r]
                registers[1 + s, r] = x[s, r] + ahead * rates[s, r]
        elif part < 3:
            for r in range(width):
                total[s, r] += 2.0 * rates[s, r]
                registers[1 + s, r] = x[s, r] + ahead * rates[s, r]
        else:
            for r in range(width):
                x[s, r] += h / 6.0 * (total[s, r] + rates[s, r])
                registers[1 + s, r] = x[s, r]


@compiled
def _keep(x, sample, last, live, states, ok):
    """Keep the states of rows that still run; note which diverged, and which have come to their trial's end."""
    for r in range(last.size):
        if live[r] and sample[r] + 1 <= last[r]:
            for s in range(x.shape[0]):
                ok[r] = ok[r] and abs(x[s, r]) < BOUND
            if ok[r]:
                for s in range(x.shape[0]):
                    states[r, s] = x[s, r]
        live[r] = ok[r] and sample[r] + 1 < last[r]
