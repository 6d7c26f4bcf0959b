"""Reports: tables, figures and one self-contained page; reads results, never fits; the only home of matplotlib."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from gaitdisc.report.response_page import write_report
    from gaitdisc.report.sentences import participant_sentences, r2_text, study_sentences

_HOME = {
    "participant_sentences": "sentences",
    "r2_text": "sentences",
    "study_sentences": "sentences",
    "write_report": "response_page",
}
__all__ = ["participant_sentences", "r2_text", "study_sentences", "write_report"]


def __getattr__(name: str) -> Any:
    """Bring a verb when it is first used: a command that prints a table need not load every page and figure."""
    if name in _HOME:
        return getattr(import_module(f"gaitdisc.report.{_HOME[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
