"""Where the landmarks of a standing person lie to each other, whoever it is; which exchanged labels contradict it."""

from __future__ import annotations

import itertools
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from gaitdisc.kinematics.marker_set import PARTS, SIDED, MarkerSet

SIDE_BY_SIDE_M = 0.01  # a right marker this far to the left of its left one is exchanged
DOWN_THE_LEG = ("thigh_wand", "knee_lateral", "shank_wand", "ankle_lateral")
ABOVE = (("pelvis", "thigh"), ("pelvis", "shank"), ("pelvis", "foot"), ("thigh", "foot"), ("shank", "foot"))
Places = Mapping[str, NDArray[np.float64]]


def landmark_order(marker_set: MarkerSet, places: Places, up: NDArray[np.float64]) -> list[tuple[float, str]]:
    """By how much each landmark of a standing person is on its side of another [m]; below 0 a label is wrong.

    Right is right of left, the leg's landmarks come down in their order, ankle between heel and toe, and pelvis and
    toes point to the same side. Joints that are bent and feet that turn by less than 90 deg do not change that.

    places each (3,) [m]: markers, by the names of the set, in the static trial
    returns: how far on the right side, and what is said where it is not
    """
    labels = {(key, side): marker_set.landmark(key, side, places) for key in (*SIDED, "sacrum") for side in "lr"}
    at = {who: np.mean([places[one] for one in names], axis=0) for who, names in labels.items() if names}
    apart = {pair: places[pair[1]] - places[pair[0]] for pair in marker_set.sided_pairs(places)}
    across = np.sum([*apart.values()], axis=0)
    across -= (across @ up) * up
    across = across / np.linalg.norm(across)
    forward = np.cross(up, across)
    found = [
        (one @ across + SIDE_BY_SIDE_M, f"{right} is not to the right of {left}")
        for (left, right), one in apart.items()
    ]
    for side, sign in (("l", -1.0), ("r", 1.0)):
        knee, ankle, heel, toe = ((key, side) for key in ("knee_lateral", "ankle_lateral", "heel", "toe"))
        leg = [(key, side) for key in DOWN_THE_LEG if (key, side) in at]
        along = at[toe] - at[heel]
        ordered = [(one, "above", other, up) for one, other in itertools.pairwise(leg)]
        ordered += [(toe, "ahead of", heel, forward)]
        along = along / np.linalg.norm(along)
        ordered += [(ankle, "ahead of", heel, along), (toe, "ahead of", ankle, along)]
        ordered += [(knee, "outside of", ("knee_medial", side), sign * across)]
        ordered += [(ankle, "outside of", ("ankle_medial", side), sign * across)]
        found += [
            ((at[one] - at[other]) @ way, f"{' + '.join(labels[one])} is not {words} {' + '.join(labels[other])}")
            for one, words, other, way in ordered
            if other in at
        ]
        on = {part: [one for one in marker_set.followers(f"{part}_{side}") if one in places] for part in PARTS[1:]}
        on |= {"pelvis": [one for one in marker_set.followers("pelvis") if one in places]}
        on["shank"] = [one for one in on["shank"] if one not in labels[ankle]]
        found += [
            ((places[one] - places[other]) @ up, f"{one} is not above {other}")
            for upper, lower in ABOVE
            for one, other in itertools.product(on[upper], on[lower])
        ]
        found += [
            ((places[one] - places[other]) @ forward, f"{one} is not ahead of {other}")
            for one, other in itertools.product(labels["asis", side], labels["sacrum", side])
        ]
    return [(float(value), what) for value, what in found]


def exchanged_in_static(marker_set: MarkerSet, places: Places, up: NDArray[np.float64]) -> tuple[str, str] | None:
    """Pair of markers whose exchange puts all landmarks right, by the most; None where no pair does."""
    names = [name for name in marker_set.markers() if name in places]
    ranked = [
        (min(landmark_order(marker_set, {**places, a: places[b], b: places[a]}, up))[0], (a, b))
        for a, b in itertools.combinations(names, 2)
    ]
    margin, pair = max(ranked)
    return pair if margin > 0 else None
