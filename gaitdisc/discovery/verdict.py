"""A verdict: what a search came to, before its numbers are written down."""

from __future__ import annotations

from dataclasses import dataclass, field

from gaitdisc.discovery.candidate_model import Part
from gaitdisc.discovery.held_out import Proof
from gaitdisc.discovery.process_noise import ProcessNoise
from gaitdisc.discovery.scored_model import ScoredModel
from gaitdisc.results.discovery import Estimate


@dataclass(frozen=True)
class Verdict:
    """What the search came to."""

    word: str
    found: ScoredModel  # the simulation with what was found in it
    rivals: tuple[ScoredModel, ...]
    process_noise: ProcessNoise | None = None  # for process noise: where, and how strong
    starts: dict[str, Estimate] = field(default_factory=dict)  # for wrong initial conditions: where the trials begin
    # Held-out runs that bear the model out; where nothing is named, those that do not bear the first rival out
    proof: Proof | None = None
    small: tuple[Part, ...] = ()  # explanations that close too little of the gap to be named
    # of a shape without a name: whether it was read as an expression of few pieces, which stands in its place
    read: bool = False
    reads_as: str = ""  # the catalogue's effect that this expression is; empty where it is none
