"""What every page tells of its recordings: what was seen in the files, and who or what is left out."""

from __future__ import annotations

from collections.abc import Sequence

from gaitdisc.recording import Finding
from gaitdisc.report.table import Table, words_table
from gaitdisc.results import Refusal


def seen_table(findings: Sequence[Finding], caption: str, what: str = "what") -> Table:
    """What was seen in the files, in the order given.

    >>> seen_table([Finding("note", "unit", "a.c3d", "mm taken as m", "")], "Seen, n = 1.").rows
    (('note', 'a.c3d', '', 'unit: mm taken as m', ''),)
    """
    rows = [(f.severity, f.file, f.channel, f"{f.kind}: {f.what}", f.spoils) for f in findings]
    return words_table("findings", caption, ("severity", "file", "channel", what, "spoils"), rows)


def left_out_table(refusals: Sequence[Refusal], name: str, caption: str) -> Table:
    """Everybody and everything left out, with the reason.

    >>> left_out_table([Refusal("P01", "", "no file")], "left-out", "Left out, n = 1.").rows
    (('P01', 'all', 'no file'),)
    """
    rows = [(refusal.participant, refusal.condition or "all", refusal.reason) for refusal in refusals]
    return words_table(name, caption, ("participant", "walk", "reason"), rows)
