"""A verdict: what a search came to, before its numbers are written down."""

from __future__ import annotations

from dataclasses import dataclass, field

from gaitdisc.discovery.account import Part
from gaitdisc.discovery.evidence import Judged
from gaitdisc.discovery.held_out import Proof
from gaitdisc.discovery.shaken import Shaken
from gaitdisc.results.discovery import Estimate


@dataclass(frozen=True)
class Verdict:
    """What the search came to.

    Parameters
    ----------
    account : Judged
        The simulation with what was found in it.
    shaking : Shaken or None
        For process noise: where, and how strong.
    starts : dict of str to Estimate
        For wrong initial conditions: where the trials begin.
    proof : Proof or None
        Held-out runs that bear the account out; where nothing is named, those that do not bear the first rival out.
    small : tuple of Part
        Explanations that close too little of the gap to be named.
    read : bool
        Of a shape without a name: whether it was read as an expression of few pieces, which stands in its place.
    reads_as : str
        The catalogue's effect that this expression is; empty where it is none.
    """

    word: str
    account: Judged
    rivals: tuple[Judged, ...]
    shaking: Shaken | None = None
    starts: dict[str, Estimate] = field(default_factory=dict)
    proof: Proof | None = None
    small: tuple[Part, ...] = ()
    read: bool = False
    reads_as: str = ""
