"""Measures of a person: read-only, and refused where the unit must be another one."""

from __future__ import annotations

import pytest

from gaitdisc.errors import UnitError
from gaitdisc.recording.body_measures import BodyMeasures


def test_sides_are_read_only():
    measures = BodyMeasures(knee_width_m={"l": 0.1})
    with pytest.raises(TypeError):
        measures.knee_width_m["l"] = 0.2  # pyright: ignore


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"knee_width_m": {"r": 102.0}}, r"knee_width_m of side 'r' is between 0\.03 and 0\.25 m; found 102 m"),
        ({"mass_kg": 0.7}, "mass_kg is between 5 and 300 kg; found 0.7 kg"),
        ({"mass_kg": 700.0}, "found 700 kg"),
        ({"height_m": 1580.0}, r"found 1580 m\. Give it in m"),
        ({"inter_asis_m": float("nan")}, "found nan m"),
    ],
)
def test_what_no_person_measures_is_refused(given, words):
    with pytest.raises(UnitError, match=words):
        BodyMeasures(**given)
