"""Cycles of one trial: each with its events, what a plate saw of it, where the feet were, and why it is left out."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.channel import other_side
from gaitdisc.kinetics.plate_steps import PlateStep
from gaitdisc.processing.step_events import trial_markers
from gaitdisc.recording import Cycle, Recording, Trial
from gaitdisc.recording.strides import NAN, interpolated
from gaitdisc.signals.contacts import RISE_N, loaded
from gaitdisc.signals.direction import Direction, marker_position
from gaitdisc.signals.strides import gap_reasons

LONGEST_STANCE = 0.8  # of a stride: a plate that is loaded for longer carried two feet
SHORTEST_STRIDE_M = 0.1  # below it the line of a stride has no direction
EDGE_S = 0.06  # by which markers and a plate may differ about one event
Timed = Mapping[str, tuple[tuple[float, str], ...]]


@dataclass(frozen=True)
class Places:
    """Where the feet were in one cycle."""

    step_s: float = NAN  # from the contact of the other foot to the next of this one [s]
    stride_m: float = NAN  # lengths [m]; NaN without markers
    step_m: float = NAN  # from where the other heel landed inside of the cycle to where this one lands at its end
    width_m: float = NAN  # how far beside the line of the stride the other landed


def cut_cycles(contacts: Timed, offs: Timed) -> list[Cycle]:
    """Cycles from each contact to the next of the same foot, with the events inside.

    Left out is a cycle that has no contact of the other foot inside, or more than one, where the contacts of the other
    foot were seen before and after.

    contacts, offs mapping of str to tuple of (float, str): side -> time [s] and what placed it

    >>> contacts = {"r": ((0.0, "force"), (1.0, "force")), "l": ((0.5, "force"),)}
    >>> one = cut_cycles(contacts, {"r": ((0.6, "force"),), "l": ((0.1, "force"),)})[0]
    >>> one.foot_off, one.opposite_off, one.opposite_contact, one.reason
    (0.6, 0.1, 0.5, '')
    """
    found = []
    for side, own in sorted(contacts.items()):
        other = other_side(side)
        across = [at for at, _ in contacts.get(other, ())]
        for (start, by), (end, next_by) in itertools.pairwise(own):
            length = end - start
            off, off_by = _first(offs.get(side, ()), start + 0.2 * length, start + 0.95 * length)
            inside = [at for at in across if start < at < end]
            landed = inside[0] if len(inside) == 1 else NAN
            until = landed if inside else start + 0.5 * length
            left, _ = _first(offs.get(other, ()), start - EDGE_S, until)
            seen = bool(across) and across[0] < start and across[-1] > end
            reason = ""
            if len(inside) > 1 or (seen and not inside):
                count = f"{len(inside)} contacts" if inside else "no contact"
                reason = f"{count} of the other foot inside: one was missed or is false"
            found.append(Cycle(side, start, end, (by, next_by), off, max(left, start), landed, off_by, False, reason))
    return found


@dataclass(frozen=True)
class PlateLoadings:
    """When the plates of a trial were loaded."""

    belts: frozenset[str] = frozenset()  # sides that have a force of their own, as on a split belt
    # from when to when a plate was loaded, whole in the recording [s]; empty where there are belts
    spans: tuple[tuple[float, float], ...] = ()


def plate_loadings(trial: Trial, rise_n: float = RISE_N) -> PlateLoadings:
    """When the plates of a trial were loaded.

    rise_n: force above which a foot is on the ground [N]
    """
    if "forces" not in trial.streams:
        return PlateLoadings()
    forces = trial.stream("forces").selected_by(lambda channel: channel.quantity == "vertical_force")
    belts = frozenset(channel.side for channel in forces.channels if channel.side)
    spans = []
    for force in () if belts else forces.values.T:
        known = force[np.isfinite(force)]
        upward = -force if len(known) and -known.min() > known.max() else force
        found = loaded(upward, forces.rate_hz, rise_n)
        spans += [(float(forces.time[a]), float(forces.time[b - 1])) for a, b in found if a > 0 and b < len(force)]
    return PlateLoadings(belts, tuple(spans))


def with_plates(cycles: list[Cycle], plates: PlateLoadings) -> list[Cycle]:
    """Same cycles, kinetic where the foot alone loaded one plate, or its own belt, for the whole stance."""
    return [replace(one, kinetic=one.side in plates.belts or _alone(one, plates.spans)) for one in cycles]


def with_plate_steps(cycles: list[Cycle], steps: Sequence[PlateStep]) -> list[Cycle]:
    """Same cycles, kinetic where a clean step of the foot, whole in the recording, is this cycle's stance."""
    whole = [(step.side, step.start, step.end) for step in steps if step.clean and step.whole]

    def stance(one: Cycle) -> bool:
        ends = [(start - one.start, end - one.foot_off) for side, start, end in whole if side == one.side]
        return any(max(abs(first), abs(last)) <= EDGE_S for first, last in ends)

    return [replace(one, kinetic=stance(one)) for one in cycles]


def without_doubted(cycles: list[Cycle], spans: Sequence[tuple[float, float]]) -> list[Cycle]:
    """Same cycles, not kinetic where more than half of the stance lies in a step whose force is doubted."""
    inside = [max([0.0, *(min(end, c.foot_off) - max(start, c.start) for start, end in spans)]) for c in cycles]
    halves = [0.5 * (one.foot_off - one.start) for one in cycles]
    return [replace(c, kinetic=c.kinetic and not s > h) for c, s, h in zip(cycles, inside, halves, strict=True)]


@dataclass(frozen=True, eq=False)
class HeelPaths:
    """Where the heels of a trial were, and which way the person walked."""

    time: NDArray[np.float64]  # (frame,) [s], of the markers
    heels: Mapping[str, NDArray[np.float64]]  # each (frame, 3) [m], by side
    way: Direction


def heel_paths(trial: Trial, direction: str = "") -> HeelPaths | None:
    """Paths of the heels of a trial; None where its markers do not show them.

    direction: in the laboratory's axes, `+x` to `-z`; inferred where it is empty
    """
    known = trial_markers(trial, direction)
    if known is None:
        return None
    heels, _, way = known
    markers = trial.stream("markers")
    return HeelPaths(markers.time, {side: marker_position(markers, name) for side, name in heels.items()}, way)


def feet_in(cycles: list[Cycle], feet: HeelPaths | None, belt_m_per_s: float = 0.0) -> list[Places]:
    """Where the feet were in each cycle.

    feet: of the trial; without them only the step's time is known, and on a belt how far it ran in a stride
    belt_m_per_s: speed of a belt, whose length is added to each stride [m/s]
    """
    if feet is None:
        ran = belt_m_per_s or NAN
        return [Places(one.end - one.opposite_contact, ran * one.duration_s) for one in cycles]
    paths, way = feet.heels, feet.way
    found = []
    for one in cycles:
        other = other_side(one.side)
        first, beside, last = (
            interpolated(feet.time, paths[side], np.array([at]))[0]
            for side, at in ((one.side, one.start), (other, one.opposite_contact), (one.side, one.end))
        )
        stride = _level(last - first, way.up)
        length = float(np.linalg.norm(stride))
        over_ground = way.headings is not None and length >= SHORTEST_STRIDE_M
        forward = stride / length if over_ground else _level(way.forward, way.up)
        across = np.cross(forward, way.up) * (1.0 if one.side == "r" else -1.0)
        step_s = one.end - one.opposite_contact
        found.append(
            Places(
                step_s,
                float(np.dot(stride, forward)) + belt_m_per_s * one.duration_s,
                float(np.dot(last - beside, forward)) + belt_m_per_s * step_s,
                float(np.dot(first - beside, across)),
            )
        )
    return found


def with_gaps(cycles: list[Cycle], legs: Recording | None) -> list[Cycle]:
    """Same cycles, left out where an angle of the own leg is missing or the recording does not reach.

    legs: angles, gaps bridged where they may be; None where the trial has none
    """
    if legs is None:
        return cycles
    found = []
    for one in cycles:
        own = [channel.name for channel in legs.channels if channel.side == one.side]
        if one.reason or not own:
            found.append(one)
            continue
        (reason,) = gap_reasons(np.array([one.start]), np.array([one.end]), legs.selected(own))
        found.append(replace(one, reason=reason))
    return found


def _first(times: tuple[tuple[float, str], ...], start: float, end: float) -> tuple[float, str]:
    return next(((at, by) for at, by in times if start <= at <= end), (NAN, ""))


def _level(vector: NDArray[np.float64], up: NDArray[np.float64]) -> NDArray[np.float64]:
    return vector - np.dot(vector, up) * up


def _alone(one: Cycle, spans: Sequence[tuple[float, float]]) -> bool:
    """One plate is loaded from this contact to this foot off, for no longer than a stance, and no other begins then."""
    if not np.isfinite(one.foot_off):
        return False
    own = [span for span in spans if abs(span[0] - one.start) <= EDGE_S and abs(span[1] - one.foot_off) <= EDGE_S]
    at_once = [span for span in spans if abs(span[0] - one.start) <= EDGE_S]
    return len(own) == 1 and len(at_once) == 1 and own[0][1] - own[0][0] <= LONGEST_STANCE * one.duration_s
