"""Results: frozen, with provenance, saved and loaded; never plots, trains or logs."""

from gaitdisc.results.data_quantity import DataQuantity
from gaitdisc.results.over_participants import OverParticipants
from gaitdisc.results.pair_test import PairTests
from gaitdisc.results.participant_response import HeldOut, ParticipantResponse
from gaitdisc.results.provenance import Provenance
from gaitdisc.results.response_run import Refusal, ResponseRun
from gaitdisc.results.walk_summary import WalkSummary

__all__ = [
    "DataQuantity",
    "HeldOut",
    "OverParticipants",
    "PairTests",
    "ParticipantResponse",
    "Provenance",
    "Refusal",
    "ResponseRun",
    "WalkSummary",
]
