"""Reports: tables, figures and one self-contained page; reads results, never fits; the only home of matplotlib."""

from gaitdisc.report.response_page import write_report
from gaitdisc.report.sentences import participant_sentences, study_sentences
from gaitdisc.report.text import r2_text

__all__ = ["participant_sentences", "r2_text", "study_sentences", "write_report"]
