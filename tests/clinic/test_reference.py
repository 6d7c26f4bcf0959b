from __future__ import annotations

import numpy as np
import pytest
from made_clinic import PROVENANCE, made_person

from gaitdisc.clinic.reference import bands, limits_of, reference_of, spatiotemporal_limits
from gaitdisc.errors import SchemaError


def test_limits_are_the_prediction_limits_of_a_textbook():
    """Four values 58 60 62 60 of 16 people: 60 +- t(.975, 15) 1.633 root(17/16), t = 2.131."""
    found = limits_of(np.array([58.0, 60.0, 62.0, 60.0]), 16)
    reach = 2.131 * np.sqrt(8 / 3) * np.sqrt(17 / 16)
    assert (found.low, found.high) == pytest.approx((60 - reach, 60 + reach), abs=1e-3)
    assert limits_of(np.array([58.0, 60.0, 62.0, 60.0]), 16, tests=40).high > found.high
    assert np.isinf(limits_of(np.array([58.0, 60.0]), 2).high)


def test_most_pages_of_healthy_people_lie_within_their_limits():
    rng = np.random.default_rng(0)
    inside = 0
    for _ in range(300):
        values, one_more = rng.normal(size=(10, 8)), rng.normal(size=8)
        limits = [limits_of(column, 10, tests=8) for column in values.T]
        inside += all(one.low < value < one.high for one, value in zip(limits, one_more, strict=True))
    assert inside >= 0.92 * 300


def test_the_first_session_of_a_person_counts_and_no_pseudonym_is_kept():
    people = [made_person("C1", session="before"), made_person("C1", session="after"), made_person("C2")]
    found = reference_of(people, "controls", PROVENANCE)
    assert found.people("walk") == 2 and len(found.of("walk")) == 4
    assert {leg.person for leg in found.of("walk")} == {1, 2}
    assert found.of("turn") == ()
    assert found.without(1).people("walk") == 1
    with pytest.raises(SchemaError, match=r"controls.*none.*0"):
        reference_of([], "controls", PROVENANCE)


def test_a_band_is_the_mean_and_spread_of_legs():
    legs = reference_of([made_person(f"C{k}") for k in range(3)], "", PROVENANCE).of("walk")
    band = bands(legs)["knee_flexion"]
    each = np.array([leg.curves["knee_flexion"] for leg in legs])
    np.testing.assert_allclose(band.mean, each.mean(axis=0))
    np.testing.assert_allclose(band.sd, each.std(axis=0, ddof=1))
    assert band.people == 3
    assert bands(legs[:2]) == {}
    assert spatiotemporal_limits(legs)["stance_percent"].mean == 60.0
