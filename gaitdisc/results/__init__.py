"""Results: frozen, with provenance, saved and loaded; never plots, trains or logs."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from gaitdisc.results.over_participants import OverParticipants as OverParticipants
    from gaitdisc.results.over_participants import PairTests as PairTests
    from gaitdisc.results.participant_response import DataQuantity as DataQuantity
    from gaitdisc.results.participant_response import HeldOut as HeldOut
    from gaitdisc.results.participant_response import ParticipantResponse as ParticipantResponse
    from gaitdisc.results.pooled_cycles import PooledCycles as PooledCycles
    from gaitdisc.results.provenance import Provenance as Provenance
    from gaitdisc.results.provenance import Refusal as Refusal
    from gaitdisc.results.response_run import ResponseRun as ResponseRun
    from gaitdisc.results.walk_summary import WalkSummary as WalkSummary

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


def __getattr__(name: str) -> Any:
    """Bring a noun when it is first used: most of them bring pandas, which not every command needs."""
    if name in _HOME:
        return getattr(import_module(f"gaitdisc.results.{_HOME[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
