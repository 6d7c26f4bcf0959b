from dataclasses import replace

import numpy as np
import pytest

from gaitdisc.errors import SamplingError
from gaitdisc.response.vary import fit_data_quantity

ANKLE = "ankle_angle_r"


@pytest.fixture(scope="module")
def quantity(nominal, exo, settings):
    return fit_data_quantity(nominal, exo, settings, (1.0, 10.0, 500.0))


@pytest.fixture(scope="module")
def ten(nominal, exo, settings):
    return fit_data_quantity(nominal, exo, settings, (10.0,))


def r2_at(quantity, length_s, model, kind="network"):
    table = quantity.table
    chosen = (
        (table["model"] == model) & (table["kind"] == kind) & (table["walk"] == "exo") & (table["variable"] == ANKLE)
    )
    return float(table[chosen & np.isclose(table["length_s"], length_s)]["r2"].iloc[0])


def test_more_data_explain_more(quantity):
    lengths = sorted(set(quantity.table["length_s"]))
    assert lengths[:2] == [1.0, 10.0]
    assert r2_at(quantity, 1.0, "exo") < r2_at(quantity, lengths[-1], "exo")


def test_the_whole_training_part_is_the_response_itself(quantity, judged):
    whole = max(quantity.table["length_s"])
    assert r2_at(quantity, whole, "augmented") == judged.r2_of(ANKLE, "augmented")


def test_every_length_is_judged_on_the_same_samples(quantity):
    assert quantity.table[quantity.table["walk"] == "exo"]["n"].nunique() == 1


def test_a_length_that_the_trial_does_not_have_is_told(quantity):
    assert quantity.left_away[500.0].startswith("the training part is")


def test_the_last_seconds_are_other_seconds(ten, nominal, exo, settings):
    last = fit_data_quantity(nominal, exo, settings, (10.0,), part="last")
    assert r2_at(last, 10.0, "exo", "ridge") != r2_at(ten, 10.0, "exo", "ridge")
    with pytest.raises(SamplingError, match="found 'middle'"):
        fit_data_quantity(nominal, exo, settings, part="middle")


def test_held_out_seconds_are_never_seen(ten, nominal, exo, settings):
    spoiled = np.array(exo.xddot)
    spoiled[-200:] += 1e4
    before = ten.table
    after = fit_data_quantity(nominal, replace(exo, xddot=spoiled), settings, (10.0,)).table
    assert (before["n_training"] == after["n_training"]).all()
    on_nominal = before["walk"] == "nominal"
    np.testing.assert_array_equal(before[on_nominal]["r2"], after[on_nominal]["r2"])
