"""Distances between markers of one segment: whether a static trial is of the person who walks.

Six young people, each with a static trial and two walks (young_straight_and_turn, young_static; seven distances): the
second largest difference is 0.3 to 2.9 % where the person is the same, 4.3 to 34 % in 60 pairs of two people.
"""

from __future__ import annotations

import itertools

import numpy as np

from gaitdisc.recording import Finding, Recording
from gaitdisc.signals.direction import marker_position

SEGMENTS = (
    ("LASI", "RASI", "LPSI", "RPSI"),
    ("LASIS", "RASIS", "LPSIS", "RPSIS"),
    ("L.ASIS", "R.ASIS", "L.PSIS", "R.PSIS"),
    *((f"{side}KNE", f"{side}ANK") for side in "LR"),
    *((f"{side}KNE", f"{side}TIB") for side in "LR"),
    *((f"{side}HEE", f"{side}TOE") for side in "LR"),
    *((f"{side}.Knee.Lat", f"{side}.Ankle.Lat") for side in "LR"),
    *((f"{side}.Heel", f"{side}.Toe.Tip") for side in "LR"),
)
LIMIT = 0.035  # in two distances
FEWEST = 4  # distances: fewer show nothing


def segment_distances(markers: Recording) -> dict[tuple[str, str], float]:
    """Median distance between markers that lie on one segment [m].

    markers: channels `<marker>.x`, `<marker>.y`, `<marker>.z` [m]
    returns dict of (str, str) to float: two markers -> distance; those that are never seen together are not there
    """
    there = {name.rsplit(".", 1)[0] for name in markers.names}
    found = {}
    for segment in SEGMENTS:
        for one, other in itertools.combinations((name for name in segment if name in there), 2):
            apart = np.linalg.norm(marker_position(markers, one) - marker_position(markers, other), axis=1)
            if np.isfinite(apart).any():
                found[one, other] = float(np.nanmedian(apart))
    return found


def person_findings(static: Recording, walk: Recording, file: str) -> list[Finding]:
    """Say that a static trial is another person's, or that its markers were moved.

    returns: one warning, or none where the distances agree or fewer than four are there
    """
    standing, walking = segment_distances(static), segment_distances(walk)
    both = [pair for pair in standing if pair in walking and min(standing[pair], walking[pair]) > 0]
    if len(both) < FEWEST:
        return []
    apart = {pair: abs(np.log(walking[pair] / standing[pair])) for pair in both}
    worst = sorted(both, key=lambda pair: -apart[pair])[:2]
    if apart[worst[1]] < LIMIT:
        return []
    said = " and ".join(
        f"{one} to {other} {1e3 * standing[one, other]:.0f} mm in it, {1e3 * walking[one, other]:.0f} mm in the walk"
        for one, other in worst
    )
    what = f"the static trial is of another person, or its markers were moved: {said}"
    return [Finding("warning", "static trial", file, what, "angles from these markers; name the right static trial")]
