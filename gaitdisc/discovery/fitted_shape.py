"""A fitted shape: bumps over the states, where no known effect explains what is left."""

import re
from collections.abc import Iterator
from dataclasses import replace
from itertools import product

import numpy as np

from gaitdisc.discovery.candidate import Candidate, no_shape
from gaitdisc.discovery.case import Case
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.gap_share import CrossValidated, cross_validated
from gaitdisc.discovery.places import Place
from gaitdisc.discovery.score import Score
from gaitdisc.discovery.scored_model import Part, ScoredModel, score
from gaitdisc.discovery.search import Search
from gaitdisc.recording.arrays import Values

VISITED = (0.02, 0.98)  # quantiles of a state or difference between which its runs mostly lie
BUMPS = 5
FLAT_BUMPS, FINE_BUMPS = 7, 15
STRIDE_BUMPS = 10
DEGREE = 3  # of a product of powers of two states
SHARPNESS = 1.2  # of a bump's width against the distance to the next
SHARE_OF_SPEED = 0.2  # at which friction that depends on place has risen
_RISE = re.compile(r"\*tanh\((.+)/(\S+)\)")
_ONE_BUMP = re.compile(r"exp\(-\(\(\((\w+|\(.*?\)) - (\S+?)\)/(\S+?)\)\*\*2\)\)(.*)")
FITTED = 8  # shapes, of those that promise most


def shapes_at(place: Place, now: ScoredModel, search: Search) -> list[Candidate]:
    """Return the shapes that could be fitted at a place: over one state, over two (bumps, and powers), over the stride.

    At a place between bodies the states may be differences of two, and another body's.
    """
    shapes = [shape for motion in place.motions for shape in _shapes_over(place, *motion, now, search)]
    if any(signal.name == "phase" for signal in search.base.inputs):
        centres = (np.arange(STRIDE_BUMPS) + 0.5) / STRIDE_BUMPS
        sharp = (STRIDE_BUMPS / (SHARPNESS * 2 * np.pi)) ** 2 * 2
        pieces = [f"exp({sharp:.4g}*(cos(6.283185307179586*(phase - {c:.4g})) - 1))" for c in centres]
        shapes.append(no_shape(place, tuple(pieces), place.motions[0][0]))
    return shapes


def _shapes_over(place: Place, x: str, v: str, now: ScoredModel, search: Search) -> list[Candidate]:
    """Shapes over a position and its rate; where it has none, over it and another state."""
    v = "" if v == x else v
    axes = [x, v] if v else [x, *place.others[:1]]
    ranges = {axis: np.quantile(search.along(now, axis), VISITED) for axis in axes}
    shapes = [_bumps(ranges, {axis: count}) for axis in axes for count in (FLAT_BUMPS, FINE_BUMPS)]
    name, across = _bracket(v or x), _bumps(ranges, {x: FLAT_BUMPS})
    shapes.append([f"{piece}*tanh({name}/{SHARE_OF_SPEED * max(map(abs, ranges[v or x])):.4g})" for piece in across])
    if v:
        shapes.append([f"{piece}*{name}" for piece in across])
    if len(axes) > 1:
        shapes += [_bumps(ranges, dict.fromkeys(axes, BUMPS)), _powers(ranges)]
    return [no_shape(place, tuple(pieces), x) for pieces in shapes]


def fit_shape(case: Case, now: ScoredModel) -> ScoredModel | None:
    """Fit a shape at every place and return the one that closes most of the gap on runs left out of the fit.

    The slopes of the simulation as read say which shapes promise most; these are fitted, and the best ones thinned out
    and tried as one bump. Each number costs a little of the gap. Residuals are autocorrelated as long as a shape is
    wrong: under noise that is so too, the wrong one would be the likelier.

    returns: under the noise that it leaves; None where no shape can be fitted
    """
    search, scale = case.search, case.scale
    plain = cross_validated(scale, now, ())
    if not np.isfinite(plain.gap):
        return None
    tried = [cross_validated(scale, plain, (part,)) for part in _promising(now, search, plain)]
    best = _cheapest(tried, plain)[:2]
    tried = best + [
        cross_validated(scale, plain, (part,)) for shape in best for part in (*_thin_shape(shape), *_local(shape))
    ]
    kept = _cheapest([model for model in tried if search.sensible(model)], plain)
    return score(replace(kept[0], shooting=now.shooting)) if kept else None


def find_cost(model: CrossValidated, plain: CrossValidated) -> float:
    """Return what a model leaves of the gap on runs left out of the fit, and a little for each of its numbers."""
    return model.gap / plain.gap + CRITERIA.each_number * model.size if plain.gap > 0 else np.inf


def _cheapest(tried: list[CrossValidated], plain: CrossValidated) -> list[CrossValidated]:
    return sorted((model for model in tried if np.isfinite(model.gap)), key=lambda model: find_cost(model, plain))


def _promising(now: ScoredModel, search: Search, plain: CrossValidated) -> list[Score]:
    """Shapes that promise most, to first order, and more than their numbers cost if what is left were mere noise."""
    scorer = search.scorer(plain)
    shapes = tuple(shape for place in search.places for shape in shapes_at(place, now, search))
    numbers, each = plain.shooting.known.sum(), CRITERIA.independent
    worth = [fit for fit in scorer.scores(shapes) if each * fit.gain > np.log(numbers) * len(fit.candidate.slots)]
    scores = sorted(worth, key=lambda fit: np.log(numbers / each) * len(fit.candidate.slots) - fit.gain)
    return scores[:FITTED]


def _thin_shape(model: ScoredModel) -> Iterator[Part]:
    """Yield the shape without the bumps whose factor is lost in its error."""
    (part,) = model.parts
    error = np.sqrt(np.diag(model.fit.covariance))[: model.size]
    value = np.array([part.values[slot] for slot in part.candidate.slots])
    keep = np.abs(value) > CRITERIA.certain * error
    if not keep.all() and keep.any():
        pieces = tuple(piece for piece, stays in zip(part.candidate.pieces, keep, strict=True) if stays)
        fewer = replace(part.candidate, pieces=pieces)
        yield Part(fewer, dict(zip(fewer.slots, value[keep].tolist(), strict=True)))


def _local(model: ScoredModel) -> Iterator[Part]:
    """Yield one bump whose place and width are free, from each of the two strongest of a shape over one state."""
    (part,) = model.parts
    pairs = zip(part.candidate.slots, part.candidate.pieces, strict=False)  # constants come after the factors
    strongest = sorted(pairs, key=lambda pair: -abs(part.values[pair[0]]))[:2]
    for factor, piece in strongest:
        bump = _ONE_BUMP.fullmatch(piece)
        if not bump:
            continue
        name, centre, width, rest = bump.groups()
        constants = {"c": "quantiles of x", "w": "half widths of x"}
        begin = {"factor": part.values[factor], "c": float(centre.strip("()")), "w": float(width) / 2}
        rise = _RISE.fullmatch(rest)
        if rise:
            rest, begin["s"] = f"*tanh({rise[1]}/_s)", float(rise[2]) / 2
            constants["s"] = "half widths of x"
        yield Part(
            replace(part.candidate, pieces=(f"exp(-((({name} - _c)/_w)**2)){rest}",), constants=constants), begin
        )


def _bumps(ranges: dict[str, Values], counts: dict[str, int]) -> list[str]:
    centres: list[list[str]] = []
    for axis, count in counts.items():
        low, high = ranges[axis]
        step = (high - low) / (count - 1) or 1.0
        name = _bracket(axis)
        at: Values = np.linspace(low, high, count)
        centres.append([f"(({name} - {_number(centre)})/{SHARPNESS * step:.4g})**2" for centre in at])
    return [f"exp(-({' + '.join(parts)}))" for parts in product(*centres)]


def _powers(ranges: dict[str, Values]) -> list[str]:
    """Return the products of powers of two states, each between -1 and 1 where it mostly lies."""
    scaled = []
    for axis, (low, high) in ranges.items():
        name = _bracket(axis)
        scaled.append(f"(({name} - {_number((low + high) / 2)})/{(high - low) / 2 or 1.0:.4g})")
    orders = [(i, j) for i in range(DEGREE + 1) for j in range(DEGREE + 1 - i)]
    return ["*".join(f"{state}**{n}" for state, n in zip(scaled, order, strict=True) if n) or "1" for order in orders]


def _bracket(axis: str) -> str:
    return f"({axis})" if " " in axis else axis


def _number(value: float) -> str:
    return f"{value:.4g}" if value >= 0 else f"({value:.4g})"
