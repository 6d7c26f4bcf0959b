"""Learned terms inside the integrator: every model as features and weights, without a Python call a step."""

from __future__ import annotations

import math

import numpy as np

from gaitdisc.compiled import compiled
from gaitdisc.simulation.operations import BLOCK, execute, exponential

BOUND = 1e6  # a state beyond has diverged
PRODUCTS, KERNELS, LAYERS, TIMES = 0, 1, 2, 3  # what `tables` holds


@compiled
def learned_rate(kind, tables, place, x, out):
    """Outputs of a learned term at one state.

    tables each ndarray: six matrices, as `learned_term` lays them out
    """
    if kind == 0:
        _products(tables, x, out)
    elif kind == 1:
        _kernels(tables, x, out)
    elif kind == 2:
        _layers(tables, x, out)
    else:
        for o in range(out.size):
            out[o] = tables[0][place, o]


@compiled
def _products(tables, x, out):
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
def _kernels(tables, x, out):
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
def _layers(tables, x, out):
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
