"""Estimates: numbers of explanations and starts under the names a person gives them, with units, signs, intervals."""

import re

import numpy as np

from gaitdisc.discovery.candidate import Candidate, free_name
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.result import Estimate
from gaitdisc.discovery.scored_model import Part, ScoredModel
from gaitdisc.recording.arrays import Values
from gaitdisc.simulation.expression import names, parse
from gaitdisc.simulation.simulation import Simulation
from gaitdisc.simulation.unit_check import divide, find_unit, places_unit, unit_of_channel, unit_of_state

NORMAL_95 = 1.959964
RESISTING = ("stiffness", "damping", "drag", "friction")  # positive where they oppose what they see
NAMES = {"seconds": "delay", "rate": "drift"}  # of the numbers of sensors and inputs
UNIT_OF_GRID = {"delays": "s", "frequencies": "rad/s", "phases": "1", "phase widths": "1"}
_WANING = re.compile(r"max\(0, (-|_\w+ - )")  # max(0, x0 - x), max(0, -v)
_WAVE = re.compile(r"(sin|cos)\((.*)\)")


def list_estimates(model: ScoredModel, number: int, base: Simulation) -> dict[str, Estimate]:
    """Return the numbers of one explanation.

    returns: by name: `stiffness`, `engagement`, ... A stiffness, a damping, a drag and a friction are positive where
        they resist. A sine and a cosine of one argument are an `amplitude` and a `phase`
    """
    part, name_of = model.parts[number], model.names[number]
    rows = [model.fit.free.index(name_of[slot]) for slot in part.candidate.slots]
    return name_estimates(part, np.asarray(model.fit.covariance)[np.ix_(rows, rows)], base)


def name_estimates(part: Part, covariance: Values, base: Simulation) -> dict[str, Estimate]:
    """Return an explanation's numbers under their names, by their covariance (slot, slot), NaN where unknown."""
    candidate, slots = part.candidate, part.candidate.slots
    units, names = slot_units(candidate, base), NAMES | dict(candidate.names or {})
    estimates: dict[str, Estimate] = {}
    waning = candidate.pieces and _WANING.match(candidate.pieces[0])
    for number, slot in enumerate(slots):
        if _is_wave(candidate, number):  # a sin + b cos = A sin(. + phase), with its slopes by a and b
            a, b = (part.values[term] for term in slots[number : number + 2])
            size, both = float(np.hypot(a, b)), covariance[number : number + 2, number : number + 2]
            for name, value, slope, unit in (
                ("amplitude", size, np.array([a, b]) / (size or 1e-300), units[slot]),
                ("phase", np.arctan2(b, a), np.array([-b, a]) / (size or 1e-300) ** 2, "rad"),
            ):
                estimates[free_name(name, estimates)] = _estimate(value, float(slope @ both @ slope), unit)
        elif not (number and _is_wave(candidate, number - 1)):
            name = names.get(slot, slot)
            sign = -1 if name in RESISTING and not waning else 1
            value, variance = sign * part.values[slot], float(covariance[number, number])
            estimates[free_name(name, estimates)] = _estimate(value, variance, units[slot])
    return estimates


def wrong_starts(simulation: Simulation, as_read: ScoredModel) -> dict[str, Estimate]:
    """Find the states that begin elsewhere than the file says.

    Where trials begin at unlike places, no number of the file can be where they all begin: the error of the mean holds
    their spread (the ratio of Birge 1932, Phys. Rev. 40, 207).

    returns: state -> where the trials begin on average, weighted by how well each shows it, with its 95 % interval
    """
    fit, segments = as_read.fit, as_read.shooting.segments
    first = np.flatnonzero(segments.begin == 0)
    slopes = fit.slopes[first][..., : fit.starts.shape[1]]
    variance = np.stack([np.diag(np.linalg.pinv(slope.T @ slope)) for slope in slopes])
    weight = 1 / np.maximum(variance, 1e-300)
    mean = (weight * fit.starts[first]).sum(axis=0) / weight.sum(axis=0)
    unlike = (weight * (fit.starts[first] - mean) ** 2).sum(axis=0) / max(len(first) - 1, 1)
    error = np.sqrt(np.maximum(unlike, 1.0) / weight.sum(axis=0))
    return {
        state.name: Estimate(float(at), float(at - NORMAL_95 * off), float(at + NORMAL_95 * off), state.unit)
        for state, at, off in zip(simulation.states, mean, error, strict=True)
        if state.initial is not None and abs(at - state.initial) > CRITERIA.start * off
    }


def slot_units(candidate: Candidate, base: Simulation) -> dict[str, str]:
    """Return the unit of each number of an explanation."""
    unit_of = {part.name: part.unit for part in (*base.states, *base.inputs, *base.parameters)} | {"t": "s"}
    if candidate.verdict == "missing_physics":
        place = places_unit(base, candidate.kind, candidate.place)
        position = find_unit(candidate.role, unit_of) if candidate.role else "1"
        constants = {slot: UNIT_OF_GRID.get(grid, position) for slot, grid in (candidate.constants or {}).items()}
        known = unit_of | {f"_{slot}": unit for slot, unit in constants.items()}
        known |= {name: unit_of_state(base, rate) for name, rate in candidate.states.items()}
        factors = [divide(place, "1" if piece == "1" else find_unit(piece, known)) for piece in candidate.pieces]
        return dict(zip(candidate.slots, [*factors, *constants.values()], strict=True))
    if candidate.constants:  # limits of an input, or of the force that it makes on a coordinate
        moved = [unit_of[name] for name in names(parse(candidate.role or candidate.place)) if name != candidate.place]
        unit = ("N" if "m" in moved else "N m") if moved else unit_of[candidate.place]
        return dict.fromkeys(candidate.slots, unit)
    (slot,) = candidate.slots
    if slot in ("gain", "seconds"):
        return {slot: "1" if slot == "gain" else "s"}
    if candidate.verdict == "wrong_parameter":
        return {slot: unit_of[candidate.place]}
    channel = unit_of_channel(base, candidate.place)
    return {slot: divide(channel, "s") if slot == "rate" else channel}


def _is_wave(candidate: Candidate, number: int) -> bool:
    pair = [_WAVE.fullmatch(piece) for piece in candidate.pieces[number : number + 2]]
    if len(pair) < 2 or pair[0] is None or pair[1] is None:
        return False
    return (pair[0][1], pair[1][1]) == ("sin", "cos") and pair[0][2] == pair[1][2]


def _estimate(value: float, variance: float, unit: str) -> Estimate:
    half = NORMAL_95 * float(np.sqrt(variance)) if variance >= 0 else float("nan")
    return Estimate(float(value), float(value) - half, float(value) + half, unit)
