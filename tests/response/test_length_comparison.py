import numpy as np
import pandas as pd
import pytest

from gaitdisc.response.over_participants import compare_lengths, why_no_lengths
from gaitdisc.results.over_participants import LENGTH_COLUMNS, WHOLE
from gaitdisc.results.participant_response import QUANTITY_COLUMNS, DataQuantity

VARIABLES = ("hip", "knee")


def quantity(i, lengths=(1.0, 30.0, 60.0), whole=210.0, augmented=0.0):
    """Exo loses .1 with 1 s, .02 with 30 s, and only noise with 60 s."""
    rng = np.random.default_rng(i)
    loss = {1.0: 0.1, 30.0: 0.02}
    rows = [
        (length, int(100 * length), v, model, "network", "exo", r2, 3000)
        for length in (*lengths, whole)
        for v in VARIABLES
        for exo in [0.95 - loss.get(length, 0.0) + 0.001 * rng.standard_normal()]
        for model, r2 in (("exo", exo), ("augmented", exo + augmented + 0.001 * rng.standard_normal()))
    ]
    return DataQuantity(f"P{i + 1:02d}", "first", pd.DataFrame(rows, columns=list(QUANTITY_COLUMNS)), {})


def test_the_length_that_is_enough():
    found = compare_lengths([quantity(i) for i in range(11)])
    assert list(found.columns) == list(LENGTH_COLUMNS)
    whole = found[found["second"] == WHOLE].groupby("length_s")["different"].all()
    assert whole.to_dict() == {1.0: True, 30.0: True, 60.0: False}
    assert (found["tests"] == 2).all()
    short = found[(found["second"] == WHOLE) & (found["length_s"] == 1.0)]
    assert short["shift"].to_numpy() == pytest.approx(0.1, abs=0.002)


def test_augmented_against_exo_at_every_length():
    found = compare_lengths([quantity(i, augmented=-0.05) for i in range(11)])
    assert found.loc[found["second"] == "exo", "different"].all()


def test_whole_parts_of_different_length_are_each_ones_own():
    found = compare_lengths([quantity(i, whole=210.0 - i) for i in range(11)])
    assert sorted(set(found["length_s"])) == [1.0, 30.0, 60.0]
    assert (found["n"] == 11).all()


def test_who_lacks_a_length_is_left_out_by_name():
    people = [quantity(i) for i in range(10)] + [quantity(10, lengths=(1.0, 30.0))]
    found = compare_lengths(people)
    rows = found[found["length_s"] == 60.0]
    assert (rows["n"] == 10).all()
    assert set(rows["left_out"]) == {"not computed: P11"}


def test_too_few():
    few = [quantity(i) for i in range(5)]
    assert not len(compare_lengths(few))
    assert "5 participants are too few" in why_no_lengths(few)
    assert why_no_lengths([quantity(i) for i in range(6)]) == ""
