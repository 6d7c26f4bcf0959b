"""Movement analysis profile as bars: both legs for each curve, over the reference's own scores."""

from __future__ import annotations

from collections.abc import Callable
from html import escape

import numpy as np

from gaitdisc.report.clinic.panels import ticks
from gaitdisc.report.palette import SIDES
from gaitdisc.report.wording import SIDE_WORDS, number
from gaitdisc.results.clinical_reading import Profile, Score
from gaitdisc.results.clinical_variables import BY_NAME, PROFILE
from gaitdisc.results.leg_curves import FEET

WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 240, 365, 104, 232, 6, 346


def profile_svg(profile: Profile, say: Callable[[str], str] = str) -> str:
    """Bars of a profile; left above right, the reference's mean and spread behind."""
    rows: list[tuple[str, dict[str, Score]]] = [
        (BY_NAME[n].words, {s: profile.variables[n, s] for s in FEET if (n, s) in profile.variables}) for n in PROFILE
    ]
    rows.append(("gait profile score", dict(profile.legs)))
    top = max(_reach(score) for _, scores in rows for score in scores.values())
    height = (BOTTOM - TOP) / len(rows)

    def x(value: float) -> float:
        return LEFT + value / top * (RIGHT - LEFT)

    alt = "; ".join(
        f"{say(words)} {', '.join(f'{say(SIDE_WORDS[s])} {number(one.value, 1)}' for s, one in scores.items())}"
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
    if not scores:
        return parts
    some = next(iter(scores.values()))
    if np.isfinite(some.reference_mean):
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


def _reach(score: Score) -> float:
    own = score.reference_mean + score.reference_sd
    return 1.08 * max(score.value, own if np.isfinite(own) else 0.0, 1e-6)
