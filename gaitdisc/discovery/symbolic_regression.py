"""A learned shape, read: an expression of few pieces of the catalogue and their products that does what the shape does.

The shape's values along the runs, which are where the data were, are regressed on every piece and every product of a
piece over the position with one over its rate: the best one, two and three of them (best-subset selection). The few
that come nearest are fitted inside the integrator, and the one that the data speak for most is the reading, if it
closes about as much of the held-out gap as the shape.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from gaitdisc.discovery.candidate import UNNAMED, Candidate
from gaitdisc.discovery.case import Case
from gaitdisc.discovery.catalogue import Shape, read_shapes, with_names
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.decision import Verdict, prove_held_out
from gaitdisc.discovery.fitted_shape import find_cost, fit_shape
from gaitdisc.discovery.gap_share import cross_validated
from gaitdisc.discovery.grids import cells
from gaitdisc.discovery.scored_model import Part, ScoredModel, score
from gaitdisc.discovery.search import Search
from gaitdisc.recording.arrays import Values
from gaitdisc.simulation.evaluating import Points, evaluate_many

BUMP = Shape("bump", ("exp(-((x - c)/w)**2)",), {"c": "quantiles of x", "w": "half widths of x"})
MOST_SAMPLES = 3000  # of the curve
PAIRS_BEYOND = 40  # pairs, to which a third piece is sought
TRIED = (4, 4, 2)  # readings of one, two and three pieces that are fitted
ALIKE = 0.98  # correlation of two pieces, beyond which they are one
FEWEST_NUMBERS = 3  # of several names at one place, for a reading to be sought that has fewer


@dataclass(frozen=True)
class Piece:
    """A piece that a reading may be made of, at one point of its constants' grid."""

    text: str  # over the simulation's names, its constants as words that begin with `_`
    kinds: dict[str, str]
    values: dict[str, float]

    @property
    def at(self) -> str:
        """The piece with its numbers written in."""
        return with_names(self.text, {f"_{slot}": f"{value:.9g}" for slot, value in self.values.items()})


def read_shape(case: Case, as_read: ScoredModel, verdict: Verdict) -> Verdict:
    """Return a verdict on a learned shape with its reading in its place; as it was where there is none.

    Source: Brunton, Proctor and Kutz 2016, PNAS 113, 3932 (a library of pieces, few of which act); Miller 2002, Subset
        Selection in Regression (all pairs are tried here, in place of thresholds); Rackauckas et al. 2020, arXiv
        2001.04385 (a learned term of an equation, read by regression).
    """
    shape = verdict.found
    if verdict.word != UNNAMED or len(shape.parts) != 1 or not verdict.proof:
        return verdict
    search, scale = case.search, case.scale
    plain = cross_validated(scale, shape, ())
    if not np.isfinite(plain.gap):
        return verdict
    begun = replace(plain, shooting=shape.shooting)
    readings = [cross_validated(scale, begun, (part,)) for part in _readings(search, shape)]
    for reading in sorted(filter(search.sensible, readings), key=lambda reading: find_cost(reading, plain)):
        model = score(replace(reading, shooting=shape.shooting))
        proof = prove_held_out(case, as_read, model)
        if proof.bears_out and proof.closed >= CRITERIA.reading * verdict.proof.closed:
            reads_as = find_effect(search, reading.parts[0].candidate)
            return replace(verdict, found=model, proof=proof, reads_as=reads_as)
    return verdict


def read_instead(case: Case, as_read: ScoredModel, verdict: Verdict) -> Verdict:
    """Return a verdict on several names at one place, or on a shape that reads as less than they are and errs less.

    Pieces of the catalogue laid beside each other imitate any curve, above all one piece laid twice; other names
    that leave mere noise are never given up.
    """
    named = verdict.found
    places = [part.candidate.place for part in named.parts if part.candidate.verdict == "missing_physics"]
    if named.size < FEWEST_NUMBERS or len(set(places)) == len(places):
        return verdict
    twice = len(set(named.labels)) < len(named.labels)
    if case.leaves_noise(named) and not twice:
        return verdict
    shape = fit_shape(case, as_read)
    if shape is None:
        return verdict
    proof = prove_held_out(case, as_read, shape)
    instead = read_shape(case, as_read, Verdict(shape, (named, *verdict.rivals), proof=proof))
    less = instead.reads_as is not None and instead.found.size < named.size
    return instead if less and prove_held_out(case, named, instead.found, as_read).bears_out else verdict


def find_effect(search: Search, candidate: Candidate) -> str:
    """Return the name of the catalogue's effect that a reading is, or nothing."""
    alike = (effect for effect in search.candidates if (effect.kind, effect.place) == (candidate.kind, candidate.place))
    return next((effect.name for effect in alike if effect.pieces == candidate.pieces), "")


def _readings(search: Search, shape: ScoredModel) -> Iterator[Part]:
    """Yield what a shape may read as, with numbers to begin from; itself, where it has few pieces."""
    (part,) = shape.parts
    candidate = part.candidate
    if len(candidate.pieces) <= len(TRIED):
        yield part
    place = next(place for place in search.places if (place.kind, place.name) == (candidate.kind, candidate.place))
    motion = next((motion for motion in place.motions if motion[0] == candidate.role), None)
    for pieces, factors in _subsets(*_regression(search, shape, motion)) if motion else ():
        kinds: dict[str, str] = {}  # of the constants, each under a name of its own
        values: dict[str, float] = {}
        texts = []
        for number, piece in enumerate(pieces):
            name_of = {slot: f"{slot}_{number + 1}" if number else slot for slot in piece.kinds}
            kinds |= {name_of[slot]: kind for slot, kind in piece.kinds.items()}
            values |= {name_of[slot]: value for slot, value in piece.values.items()}
            texts.append(with_names(piece.text, {f"_{slot}": f"_{name}" for slot, name in name_of.items()}))
        reading = replace(candidate, pieces=tuple(texts), constants=kinds)
        yield Part(reading, dict(zip(reading.slots, [*factors, *values.values()], strict=True)))


def _subsets(pieces: list[Piece], columns: Values, curve: Values) -> Iterator[tuple[list[Piece], list[float]]]:
    """Yield the best one, two and three pieces of a curve, no structure twice, with their factors."""
    size = np.linalg.norm(columns, axis=0)
    unit = columns / size
    gram, match = unit.T @ unit, unit.T @ curve
    singles = [(i,) for i in np.argsort(-(match**2)).tolist()]
    apart = np.where(np.abs(gram) < ALIKE, 1 - gram**2, np.inf)
    explained = (match[:, None] ** 2 + match**2 - 2 * gram * np.outer(match, match)) / apart
    first, second = np.triu_indices(len(match), 1)
    order = np.argsort(-explained[first, second])
    pairs: list[tuple[int, ...]] = list(zip(first[order].tolist(), second[order].tolist(), strict=True))
    triples = _best_triples(gram, match, pairs[:PAIRS_BEYOND])
    for ranked, most in zip((singles, pairs, triples), TRIED, strict=True):
        seen: set[tuple[str, ...]] = set()
        for some in ranked:
            structure = tuple(sorted(pieces[i].text for i in some))
            if structure in seen:
                continue
            seen.add(structure)
            which = list(some)
            factors = np.linalg.lstsq(gram[np.ix_(which, which)], match[which], rcond=1e-10)[0] / size[which]
            yield [pieces[i] for i in some], factors.tolist()
            if len(seen) == most:
                break


def _regression(search: Search, shape: ScoredModel, motion: tuple[str, str]) -> tuple[list[Piece], Values, Values]:
    """Pieces that vary along a shape's runs, their values there (sample, piece), and the shape's own (sample,)."""
    known, segments, drive = len(search.base.states), shape.shooting.segments, shape.shooting.measured.drive
    states = shape.fit.states[..., :known].reshape(-1, known)
    inputs = segments.of(drive.inputs).reshape(len(states), -1)
    some = slice(None, None, max(len(states) // MOST_SAMPLES, 1))  # spread over all of the runs
    points = Points(segments.times(drive).ravel()[some], states[some], inputs[some])
    pieces = list(_pieces(search, motion, evaluate_many(search.base, [motion[0]], points)[0]))
    (part,) = shape.parts
    values = evaluate_many(search.base, [part.term, *(piece.at for piece in pieces)], points).T
    size = np.linalg.norm(values, axis=0)
    good = np.flatnonzero(np.isfinite(size[1:]) & (size[1:] > 0))
    return [pieces[i] for i in good], values[:, 1 + good], values[:, 0]


def _pieces(search: Search, motion: tuple[str, str], along: Values) -> Iterator[Piece]:
    """Yield pieces over a position, over its rate, over both, and products of one and the other."""
    x, v = motion
    angle = any(place.motions[0] == motion and place.angle for place in search.places)
    known = [form for form in read_shapes() if angle or form.needs != "angle"]
    known = [form for form in known if len(form.pieces) == 1 and not form.states and "delay" not in form.pieces[0]]
    still = [form for form in (*known, BUMP) if form.roles == ("x",) and x != v]
    moving = [form for form in known if form.roles == ("v",)] if v else []
    load = Shape("constant_load", ("1",))
    mixed = [form for form in known if set(form.roles) == {"x", "v"}] if v else []
    products = [
        Shape("", (f"{_factor(over_x.pieces[0])}*{_factor(over_v.pieces[0])}",), over_x.constants)
        for over_x in still
        for over_v in moving
    ]
    for form in (load, *still, *moving, *mixed, *products):
        (text,) = form.written({"x": x, "v": v} | {slot: f"_{slot}" for slot in form.constants})
        for values in cells(dict(form.constants), along, search.rhythm):
            yield Piece(text, dict(form.constants), values)


def _factor(piece: str) -> str:
    """A piece as it stands in a product."""
    return f"({piece})" if " - max(" in piece else piece


def _best_triples(gram: Values, match: Values, pairs: list[tuple[int, ...]]) -> list[tuple[int, int, int]]:
    """Pairs with a third column beside them, what they explain together the most first."""
    triples = []
    for pair in pairs:
        two = list(pair)
        inverse = np.linalg.inv(gram[np.ix_(two, two)])
        residual = match - gram[:, two] @ (inverse @ match[two])
        size = 1 - np.einsum("ij,jk,ik->i", gram[:, two], inverse, gram[:, two])
        gained = np.where(size > 1 - ALIKE**2, residual**2 / np.maximum(size, 1e-12), 0.0)
        third = int(np.argmax(gained))
        triples.append((float(match[two] @ inverse @ match[two] + gained[third]), (*pair, third)))
    return [some for _, some in sorted(triples, reverse=True)]
