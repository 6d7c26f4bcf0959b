"""What the participants say together: residuals, baselines, training lengths, sub-groups, each a part of the page."""

from __future__ import annotations

from typing import TypeVar

from gaitdisc.report.baseline_table import baseline_sentences, baseline_table
from gaitdisc.report.length_table import length_sentences, length_table
from gaitdisc.report.page import Block
from gaitdisc.report.quantity_figure import quantity_figure, quantity_sentences
from gaitdisc.report.reduction_figure import reduction_figure, reduction_sentences, reduction_table
from gaitdisc.report.table import Table
from gaitdisc.results import ResponseRun

Item = TypeVar("Item")


def over_blocks(run: ResponseRun) -> list[Block]:
    """Parts of the page that have something to say, in their order."""
    blocks = [
        Block("reduced", "What the models leave over the stride", tuple(reduction_sentences(run)),
              _there(reduction_figure(run)), _there(reduction_table(run))),
        Block("baselines", "Where a network is worth its trouble", tuple(baseline_sentences(run)),
              (), _there(baseline_table(run))),
        Block("quantity", "How much data is enough", (*quantity_sentences(run), *length_sentences(run)),
              _there(quantity_figure(run)), _there(length_table(run))),
        Block("responders", "Sub-groups of responders", responder_sentences(run), (), _there(responder_table(run))),
    ]  # fmt: skip
    return [block for block in blocks if block.sentences]


def responder_sentences(run: ResponseRun) -> tuple[str, ...]:
    """Verdict on sub-groups, and what `none` is worth; empty for one participant."""
    if run.over is None or len(run.responses) < 2:
        return ()
    verdict = f"{run.over.responders_said}."
    if len(run.over.responders) and not run.over.responders["group"].any():
        return (
            verdict,
            "That none is found is no proof of one kind: so few people show only kinds that differ grossly.",
        )
    return (verdict,)


def responder_table(run: ResponseRun) -> Table | None:
    """Sub-group of each participant; None where there are none."""
    if run.over is None or not len(run.over.responders) or not run.over.responders["group"].any():
        return None
    found = run.over.responders
    rows = tuple((str(group), ", ".join(map(str, own["participant"]))) for group, own in found.groupby("group"))
    caption = (
        f"Sub-groups by the shape over the stride of what the Nominal model leaves on the device walk, all outputs "
        f"together, n = {len(found)}."
    )
    return Table("responders", caption, ("group", "participants"), rows, found)


def _there(thing: Item | None) -> tuple[Item, ...]:
    return () if thing is None else (thing,)
