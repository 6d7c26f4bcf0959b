"""A fitted shape: bumps over the states, where no known effect explains what is left."""

from __future__ import annotations

import re
from itertools import product

import numpy as np
from numpy.typing import NDArray

from gaitdisc.discovery.account import Account, Part, account_for
from gaitdisc.discovery.candidate import Candidate
from gaitdisc.discovery.evidence import Judged, compared
from gaitdisc.discovery.places import Place
from gaitdisc.discovery.search import TURNS, Search
from gaitdisc.simulation.evaluating import Points, evaluate_many

BUMPS = 5
FLAT_BUMPS = 7
STRIDE_BUMPS = 10
DEGREE = 3  # of a product of powers of two states
SHARPNESS = 1.2  # of a bump's width against the distance to the next
SHARE_OF_SPEED = 0.2  # at which friction that depends on place has risen
_RISE = re.compile(r"\*tanh\((.+)/(\S+)\)")
_ONE_BUMP = re.compile(r"exp\(-\(\(\((\w+|\(.*?\)) - (\S+?)\)/(\S+?)\)\*\*2\)\)(.*)")
SIGNIFICANT = 3.0  # standard errors that a bump must have to stay


def shapes_at(place: Place, judged_now: Judged, search: Search) -> list[Candidate]:
    """Return the shapes that could be fitted at a place: over one state, over two (bumps, and powers), over the stride.

    Parameters
    ----------
    place : Place
        Where it enters.
    judged_now : Judged
        An account, whose run says which states are visited.
    search : Search
        What is searched.
    """
    x, v = place.motions[0]
    axes = [x, v] if v else [x, *place.others[:1]]
    ranges = {axis: _visited(axis, judged_now, search) for axis in axes}
    shapes = [_bumps(ranges, dict.fromkeys([one], FLAT_BUMPS)) for one in axes]
    if v:
        speed = max(abs(one) for one in ranges[v])
        name = _bracketed(v)
        across = _bumps(ranges, {x: FLAT_BUMPS})
        shapes += [
            [f"{piece}*{name}" for piece in across],
            [f"{piece}*tanh({name}/{SHARE_OF_SPEED * speed:.4g})" for piece in across],
        ]
    if len(axes) > 1:
        shapes += [_bumps(ranges, dict.fromkeys(axes, BUMPS)), _powers(ranges)]
    if any(one.name == "phase" for one in search.base.inputs):
        centres = (np.arange(STRIDE_BUMPS) + 0.5) / STRIDE_BUMPS
        sharp = (STRIDE_BUMPS / (SHARPNESS * 2 * np.pi)) ** 2 * 2
        shapes.append([f"exp({sharp:.4g}*(cos(6.283185307179586*(phase - {c:.4g})) - 1))" for c in centres])
    return [
        Candidate(
            "missing_physics",
            place.kind,
            place.name,
            "unnamed",
            tuple(pieces),
            None,
            x,
            "an effect that has no name here",
        )
        for pieces in shapes
    ]


def fitted_shape(now: Judged, search: Search) -> Judged | None:
    """Fit a shape at every place and return the best account of one, without the bumps that carry nothing.

    Parameters
    ----------
    now : Judged
        The simulation as read, without any explanation.
    search : Search
        What is searched.

    Returns
    -------
    Judged or None
        None where no shape can be fitted.
    """
    tried = []
    for place in search.places:
        for shape in shapes_at(place, now, search):
            part = Part(shape, dict.fromkeys(shape.slots, 0.0))
            account = account_for(now.shooting, search.base, (part,), now.account.fit.starts, TURNS, like=now.account)
            if np.isfinite(account.fit.misfit):
                tried.append(account)
    best = sorted(tried, key=lambda one: one.criterion)[:2]
    kept = [_thinned(now, search, one) for one in best]
    kept += [local for one in kept for local in _local(now, search, one)]
    weighed = [Judged(one, now.shooting) for one in kept if np.isfinite(one.fit.misfit)]
    return min(compared(weighed, search.base), key=lambda one: one.evidence) if weighed else None


def _thinned(now: Judged, search: Search, account: Account) -> Account:
    """Leave out the bumps whose factor is lost in its error, and fit again."""
    (part,) = account.parts
    error = np.sqrt(np.diag(account.fit.covariance))[: account.size]
    value = np.array([part.values[slot] for slot in part.candidate.slots])
    keep = np.abs(value) > SIGNIFICANT * error
    if keep.all() or not keep.any():
        return account
    pieces = tuple(piece for piece, stays in zip(part.candidate.pieces, keep, strict=True) if stays)
    fewer = Candidate(
        "missing_physics",
        part.candidate.kind,
        part.candidate.place,
        "unnamed",
        pieces,
        None,
        part.candidate.role,
        part.candidate.means,
    )
    values = dict(zip(fewer.slots, value[keep].tolist(), strict=True))
    return account_for(now.shooting, search.base, (Part(fewer, values),), account.fit.starts, TURNS, like=account)


def _local(now: Judged, search: Search, account: Account) -> list[Account]:
    """Fit one bump whose place and width are free, from each of the two strongest of a shape over one state."""
    (part,) = account.parts
    found = []
    strongest = sorted(part.candidate.pieces, key=lambda piece: -abs(part.values[_slot_of(part, piece)]))[:2]
    for piece in strongest:
        bump = _ONE_BUMP.fullmatch(piece)
        if not bump:
            continue
        name, centre, width, rest = bump.groups()
        constants = {"c": "quantiles of x", "w": "half widths of x"}
        begin = {"factor": part.values[_slot_of(part, piece)], "c": float(centre.strip("()")), "w": float(width) / 2}
        rise = _RISE.fullmatch(rest)
        if rise:
            rest, begin["s"] = f"*tanh({rise[1]}/_s)", float(rise[2]) / 2
            constants["s"] = "half widths of x"
        shape = f"exp(-((({name} - _c)/_w)**2)){rest}"
        local = Candidate(
            "missing_physics",
            part.candidate.kind,
            part.candidate.place,
            "unnamed",
            (shape,),
            constants,
            part.candidate.role,
            part.candidate.means,
        )
        one = account_for(
            now.shooting, search.base, (Part(local, begin),), now.account.fit.starts, 2 * TURNS, like=now.account
        )
        if search.sensible(one):
            found.append(one)
    return found


def _slot_of(part: Part, piece: str) -> str:
    return part.candidate.slots[part.candidate.pieces.index(piece)]


def _visited(axis: str, now: Judged, search: Search) -> tuple[float, float]:
    """Return where a state or difference mostly lies."""
    known = len(search.base.states)
    states = now.account.fit.states[..., :known].reshape(-1, known)
    inputs = np.zeros((len(states), len(search.base.inputs)))
    along = evaluate_many(search.base, [axis], Points(np.zeros(len(states)), states, inputs))[0]
    low, high = np.quantile(along, [0.02, 0.98])
    return float(low), float(high)


def _bumps(ranges: dict[str, tuple[float, float]], counts: dict[str, int]) -> list[str]:
    centres: list[list[str]] = []
    for axis, count in counts.items():
        low, high = ranges[axis]
        step = (high - low) / (count - 1) or 1.0
        name = _bracketed(axis)
        at: NDArray[np.float64] = np.linspace(low, high, count)
        centres.append([f"(({name} - {_number(centre)})/{SHARPNESS * step:.4g})**2" for centre in at])
    return [f"exp(-({' + '.join(parts)}))" for parts in product(*centres)]


def _powers(ranges: dict[str, tuple[float, float]]) -> list[str]:
    """Return the products of powers of two states, each between -1 and 1 where it mostly lies."""
    scaled = []
    for axis, (low, high) in ranges.items():
        name = _bracketed(axis)
        scaled.append(f"(({name} - {_number((low + high) / 2)})/{(high - low) / 2 or 1.0:.4g})")
    orders = [(i, j) for i in range(DEGREE + 1) for j in range(DEGREE + 1 - i)]
    return ["*".join(f"{one}**{n}" for one, n in zip(scaled, order, strict=True) if n) or "1" for order in orders]


def _bracketed(axis: str) -> str:
    return f"({axis})" if " " in axis else axis


def _number(value: float) -> str:
    return f"{value:.4g}" if value >= 0 else f"({value:.4g})"
