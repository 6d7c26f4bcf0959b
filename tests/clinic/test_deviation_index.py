from __future__ import annotations

import numpy as np
import pytest
from made_clinic import made_controls, made_person
from texts import says

from gaitdisc.clinic.reading import deviation_index
from gaitdisc.results.leg_curves import LegCurves, legs_of


def test_controls_are_100_with_a_standard_deviation_of_10():
    reference = made_controls(32).of("walk")
    found = []
    for leg in reference:
        cycles = {name: curve[None] for name, curve in leg.curves.items()}
        found.append(deviation_index({leg.side: LegCurves(leg.side, 1, 60.0, cycles, {})}, reference)[0][leg.side])
    assert np.mean(found) == pytest.approx(100.0)
    assert np.std(found, ddof=1) == pytest.approx(10.0)


def test_whoever_walks_otherwise_is_far_below_and_few_controls_give_none():
    stiff = legs_of(made_person("P01", changed={"knee_angle_l": -30.0, "hip_flexion_l": 20.0}))
    assert deviation_index(stiff, made_controls(32).of("walk"))[0]["l"] < 80
    index, why = deviation_index(stiff, made_controls(6).of("walk"))
    assert index == {} and says(why, "30 controls", "6")
