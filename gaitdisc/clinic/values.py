"""Values and scores of a person beside the reference, as tables and bars."""

from collections.abc import Callable
from html import escape

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gaitdisc.clinic.clinical_reference import FEW, SCORE_LEAST, ClinicalReading, Contrast, Profile, Score
from gaitdisc.processing.leg_curves import BY_NAME, FEET, PROFILE
from gaitdisc.processing.tables import VALUES, mean_cell
from gaitdisc.report.curve_panels import ticks
from gaitdisc.report.panels import SIDES
from gaitdisc.report.table import Table
from gaitdisc.words import NONE, SIDE_WORDS, number, unit_text

WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 330, 205, 110, 322, 2, 190
MARKS = {2: "■", 1: "□", 0: NONE}  # of the tiers of what stands out


def values_table(reading: ClinicalReading) -> Table:
    """Spatiotemporal values of both legs, of the reference, and their asymmetry."""
    rows, records = [], []
    for value, (words, unit, digits) in VALUES.items():
        by_side = {side: leg.values[value] for side, leg in reading.legs.items() if value in leg.values}
        if not by_side:
            continue
        left, right = (float(by_side[side].mean()) if len(by_side.get(side, ())) >= FEW else np.nan for side in FEET)
        uneven = 100 * (left - right) / ((left + right) / 2) if left * right > 0 else None
        limits = reading.spatiotemporal.get(value)
        cells = [_cell(by_side.get(side), digits) for side in FEET]
        norm = number(limits.mean, digits) if limits else NONE
        norm += f" ± {limits.sd:.{digits}f}" if limits and np.isfinite(limits.sd) else ""  # one control has no spread
        rows.append((f"{words} [{unit}]", *cells, norm, NONE if uneven is None else f"{number(uneven, 0)} %"))
        record = {"value": value, "unit": unit, "asymmetry_percent": uneven}
        for side, values in by_side.items():
            record |= {f"mean_{side}": values.mean(), f"sd_{side}": _spread(values), f"n_{side}": len(values)}
        if limits:
            record |= {"reference_mean": limits.mean, "reference_sd": limits.sd, "reference_people": limits.people}
        records.append(record)
    people = max((limits.people for limits in reading.spatiotemporal.values()), default=0)
    known = f"reference mean ± standard deviation over legs (n = {people} people)" if people else "no reference"
    caption = (
        f"Mean ± standard deviation (number of cycles), if at least {FEW} cycles are kept; {known}; asymmetry: left "
        "minus right, divided by the mean of the two."
    )
    columns = ("value", "left", "right", "reference", "asymmetry")
    return Table("spatiotemporal", caption, columns, tuple(rows), pd.DataFrame(records))


def _cell(values: NDArray[np.float64] | None, digits: int) -> str:
    return NONE if values is None else mean_cell(float(values.mean()), _spread(values), len(values), digits)


def _spread(values: NDArray[np.float64]) -> float:
    return float(values.std(ddof=1)) if len(values) >= FEW else np.nan


def numbers_table(reading: ClinicalReading) -> Table:
    """Every value that a rule looks at beside its limits, those that stand out first."""
    rows, records = [], []
    for note in reading.numbers:
        unit, limits = unit_text(note.unit), note.limits
        rows.append((
            note.rule, " less ".join(SIDE_WORDS[side] for side in (note.side, note.other) if side),
            f"{number(note.value, note.digits)} {unit} ({note.cycles})",
            f"{number(limits.low, note.digits)} to {number(limits.high, note.digits)}",
            f"{number(limits.mean, note.digits)} ± {number(limits.sd, max(note.digits, 1))} ({limits.people})",
            f"{MARKS[note.tier]} {note.words}".strip(),
        ))  # fmt: skip
        records.append({
            "rule": note.rule, "words": note.words, "side": note.side, "less": note.other,
            "value": note.value, "unit": note.unit, "low": limits.low, "high": limits.high,
            "reference_mean": limits.mean, "reference_sd": limits.sd,
            "people": limits.people, "cycles": note.cycles, "tier": note.tier,
        })  # fmt: skip
    caption = (
        f"All values that the rules use, n = {len(rows)} (standing out: {len(reading.noted)}). □: outside 2 standard "
        "deviations, ■: outside the prediction limits, which contain all values of a healthy person with probability "
        "0.95. In brackets: number of cycles or controls. Reference: at this speed, if the value depends on it."
    )
    columns = ("value of", "side", "value", "limits", "reference", "stands out")
    return Table("outstanding", caption, columns, tuple(rows), pd.DataFrame(records))


def profile_table(reading: ClinicalReading) -> Table | None:
    """Movement analysis profile: variable scores of both legs beside the reference's own."""
    profile = reading.profile
    if profile is None:
        return None
    rows, records = [], []
    for name in PROFILE:
        scores = {side: profile.variables[name, side] for side in FEET if (name, side) in profile.variables}
        some = next(iter(scores.values()))
        norm = f"{number(some.reference_mean, 1)} ± {number(some.reference_sd, 1)}"
        cells = [number(scores[side].value, 1) if side in scores else NONE for side in FEET]
        rows.append((BY_NAME[name].words, *cells, norm if np.isfinite(some.reference_mean) else NONE))
        for side, score in scores.items():
            records.append({"variable": name, "side": side, "score_deg": score.value, "low": score.low,
                            "high": score.high, "cycles": score.cycles, "reference_mean": score.reference_mean,
                            "reference_sd": score.reference_sd, "people": score.people})  # fmt: skip
    caption = "Movement analysis profile: root mean square difference from the reference mean curve [deg] (Baker 2009)."
    return Table("profile", caption, ("curve", "left", "right", "reference"), tuple(rows), pd.DataFrame(records))


def change_table(contrast: Contrast) -> Table:
    """Values of both legs in the first and the second of two, and the profile scores."""
    pair = (contrast.first, contrast.second)
    columns = ("value", *(f"{SIDE_WORDS[side]}, {name}" for side in FEET for name in contrast.names))
    rows = []
    for value, (words, unit, digits) in VALUES.items():
        samples = [walk.legs[side].values.get(value) if side in walk.legs else None for side in FEET for walk in pair]
        if any(values is not None for values in samples):
            rows.append((f"{words} [{unit}]", *(_cell(values, digits) for values in samples)))
    scores = [walk.profile.legs.get(side) if walk.profile else None for side in FEET for walk in pair]
    if any(scores):
        rows.append(("gait profile score [deg]", *(number(score.value, 1) if score else NONE for score in scores)))
    caption = f"Mean ± standard deviation (cycles). A change of a profile score by {SCORE_LEAST:g} deg or more matters."
    headings = ("value", *(f"{SIDE_WORDS[side]}, {walk.pooled.where}" for side in FEET for walk in pair))
    numbers = pd.DataFrame(rows, columns=pd.Index(headings))
    return Table("changes", caption, columns, tuple(rows), numbers)


def profile_svg(profile: Profile, say: Callable[[str], str] = str) -> str:
    """Bars of a profile, curve by curve, its score last; left above right, the reference's mean and spread behind."""
    known = profile.variables
    rows = [(BY_NAME[n].words, {s: known[n, s] for s in FEET if (n, s) in known}) for n in PROFILE]
    rows.append(("gait profile score", dict(profile.legs)))
    shown = [score for _, scores in rows for score in scores.values()]
    ends = [(score.value, score.reference_mean + score.reference_sd) for score in shown]
    top = 1.08 * max(1e-6, *(end for both in ends for end in both if np.isfinite(end)))
    height = (BOTTOM - TOP) / len(rows)

    def x(value: float) -> float:
        return LEFT + value / top * (RIGHT - LEFT)

    alt = "; ".join(
        f"{say(words)} {', '.join(f'{say(SIDE_WORDS[s])} {number(score.value, 1)}' for s, score in scores.items())}"
        for words, scores in rows
    )
    parts = [f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="Scores [deg]: {escape(alt, quote=True)}">']
    for place in ticks(0.0, top):
        parts.append(f'<path class="zero" d="M{x(place):.1f} {TOP}V{BOTTOM}"/>')
        parts.append(f'<text x="{x(place):.1f}" y="{BOTTOM + 12}" text-anchor="middle">{number(place, 0)}</text>')
    for k, (words, scores) in enumerate(rows):
        at = TOP + k * height
        parts.append(
            f'<text x="{LEFT - 4}" y="{at + height / 2 + 3:.1f}" text-anchor="end">{escape(say(words))}</text>'
        )
        parts += _bars(scores, at, height, x)
    return "".join([*parts, "</svg>"])


def _bars(scores: dict[str, Score], at: float, height: float, x) -> list[str]:
    parts: list[str] = []
    some = next(iter(scores.values()), None)
    if some is not None and np.isfinite(some.reference_mean):
        low, high = max(0.0, some.reference_mean - some.reference_sd), some.reference_mean + some.reference_sd
        parts.append(
            f'<rect class="band" x="{x(low):.1f}" y="{at + 2:.1f}" width="{x(high) - x(low):.1f}" '
            f'height="{height - 4:.1f}"/>'
            f'<path class="axis" d="M{x(some.reference_mean):.1f} {at + 2:.1f}v{height - 4:.1f}"/>'
        )
    for k, side in enumerate(side for side in FEET if side in scores):
        thick = (height - 8) / 2
        y = at + 4 + k * thick
        parts.append(
            f'<rect x="{LEFT}" y="{y:.1f}" width="{x(scores[side].value) - LEFT:.1f}" height="{thick - 1.5:.1f}" '
            f'fill="{SIDES[side].colour}" fill-opacity="{1.0 if side == "l" else 0.55}" stroke="{SIDES[side].colour}"/>'
        )
    return parts
