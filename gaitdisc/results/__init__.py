"""Results: frozen, with provenance, saved and loaded; never plots, trains or logs."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from gaitdisc.results.over_participants import OverParticipants, PairTests
    from gaitdisc.results.participant_response import DataQuantity, HeldOut, ParticipantResponse
    from gaitdisc.results.pooled_cycles import PooledCycles
    from gaitdisc.results.provenance import Provenance, Refusal
    from gaitdisc.results.response_run import ResponseRun
    from gaitdisc.results.walk_summary import WalkSummary

_HOME = {
    "DataQuantity": "participant_response",
    "HeldOut": "participant_response",
    "OverParticipants": "over_participants",
    "PairTests": "over_participants",
    "ParticipantResponse": "participant_response",
    "PooledCycles": "pooled_cycles",
    "Provenance": "provenance",
    "Refusal": "provenance",
    "ResponseRun": "response_run",
    "WalkSummary": "walk_summary",
}
__all__ = [
    "DataQuantity",
    "HeldOut",
    "OverParticipants",
    "PairTests",
    "ParticipantResponse",
    "PooledCycles",
    "Provenance",
    "Refusal",
    "ResponseRun",
    "WalkSummary",
]


def __getattr__(name: str) -> Any:
    """Bring a noun when it is first used: most of them bring pandas, which not every command needs."""
    if name in _HOME:
        return getattr(import_module(f"gaitdisc.results.{_HOME[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
