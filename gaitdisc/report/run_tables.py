"""Tables of a run: walks, refusals, findings, dropped strides, fits."""

from __future__ import annotations

import pandas as pd

from gaitdisc.report.strides_figure import reason_kind, stride_numbers
from gaitdisc.report.table import Table, left_out_table
from gaitdisc.report.wording import LIGHTS, MODEL_WORDS, SIDE_WORDS
from gaitdisc.results import ResponseRun


def walks_table(run: ResponseRun) -> Table:
    """Every walk with its light, its strides and what found them."""
    rows, records = [], []
    for walk in run.walks:
        colour, word = LIGHTS[walk.worst]
        kept, dropped = walk.counted(True), walk.counted(False)
        sides = sorted({*kept, *dropped}, reverse=True)
        strides = "; ".join(f"{SIDE_WORDS.get(s, s) or 'all'} {kept.get(s, 0)} / {dropped.get(s, 0)}" for s in sides)
        rows.append((
            f"light:{colour}:{word}", walk.subject, walk.condition, f"{walk.duration_s:.1f}", f"{walk.rate_hz:g}",
            walk.detector, strides or "none", str(len(walk.findings)),
        ))  # fmt: skip
        records.append({
            "participant": walk.subject, "condition": walk.condition, "light": colour, "worst": walk.worst,
            "duration_s": walk.duration_s, "rate_hz": walk.rate_hz, "detector": walk.detector,
            **{f"kept_{s or 'all'}": kept.get(s, 0) for s in sides},
            **{f"dropped_{s or 'all'}": dropped.get(s, 0) for s in sides},
            "findings": len(walk.findings),
        })  # fmt: skip
    columns = (
        "quality",
        "participant",
        "walk",
        "length [s]",
        "rate [Hz]",
        "contacts by",
        "strides kept / dropped",
        "findings",
    )
    caption = (
        f"Walks that could be processed, n = {len(run.walks)}. Green: nothing, or notes only; amber: warnings, some "
        f"samples or channels are spoiled; red: the trial is refused."
    )
    return Table("walks", caption, columns, tuple(rows), pd.DataFrame(records))


def refusals_table(run: ResponseRun) -> Table:
    """Everybody and everything left out, with the reason."""
    return left_out_table(run.refusals, "refusals", f"Left out, n = {len(run.refusals)}, and why.")


def findings_table(run: ResponseRun) -> Table:
    """Every finding of every walk, the severest first."""
    numbers = run.findings_table()
    rows = tuple(
        (
            str(row.severity),
            f"{row.participant} {row.condition}",
            ", ".join(part for part in (str(row.file), str(row.channel)) if part),
            f"{row.kind}: {row.what}" + (f" (from-to: {row.spans_s} s)" if row.spans_s else ""),
            str(row.spoils),
        )
        for row in numbers.itertuples(index=False)
    )
    headings = ("severity", "walk", "where", "what was seen", "spoils")
    caption = f"Findings of the reader and of the quality checks, n = {len(rows)}; none is left away."
    return Table("findings", caption, headings, rows, numbers)


def dropped_table(run: ResponseRun, participant: str, name: str) -> Table | None:
    """Dropped strides of a participant counted by kind of reason, or None where none was dropped."""
    strides = stride_numbers(run, participant)
    dropped = strides[~strides["kept"].astype(bool)]
    if not len(dropped):
        return None
    rows = []
    for (code, condition, side), chosen in dropped.groupby(["code", "condition", "side"], sort=False):
        rows.append((
            str(code), str(condition), SIDE_WORDS.get(str(side), str(side)), str(len(chosen)),
            reason_kind(str(chosen["reason"].iloc[0])), str(chosen["reason"].iloc[0]),
        ))  # fmt: skip
    rows.sort()
    caption = f"{participant}: dropped strides by reason, n = {len(dropped)} of {len(strides)}."
    columns = ("letter", "walk", "side", "strides", "kind of reason", "the first of them")
    return Table(f"dropped-{name}", caption, columns, tuple(rows), dropped)


def fits_table(run: ResponseRun) -> Table:
    """What was fitted, on how much, with which decay, in how long."""
    tables = [r.fits.assign(participant=r.participant) for r in run.responses]
    columns = ["participant", "model", "kind", "decay", "epochs", "n_training", "n_inner"]
    numbers = pd.concat(tables, ignore_index=True)[columns] if tables else pd.DataFrame(columns=pd.Index(columns))
    rows = [
        (str(row.participant), MODEL_WORDS.get(str(row.model), str(row.model)), str(row.kind), _plain(row.decay),
         _plain(row.epochs), _plain(row.n_training), _plain(row.n_inner))
        for row in numbers.itertuples(index=False)
    ]  # fmt: skip
    headings = (
        "participant", "model", "kind", "decay chosen", "epochs", "training samples", "inner samples",
    )  # fmt: skip
    caption = (
        f"Fits, n = {len(rows)}; decay: strength of the regularisation, chosen on inner samples, a contiguous last "
        f"part of the training samples; no held-out sample was used."
    )
    return Table("fits", caption, headings, tuple(rows), numbers)


def _plain(value: object) -> str:
    if not isinstance(value, int | float) and not hasattr(value, "item"):
        return str(value)
    figure = float(value)  # type: ignore[arg-type]
    return "–" if pd.isna(figure) else f"{figure:g}" if abs(figure) < 1e5 else f"{figure:.0f}"
