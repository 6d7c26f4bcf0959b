from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from texts import says

from gaitdisc.response.over_participants import by_family, compare_columns, compare_models, too_few
from gaitdisc.results.over_participants import PAIRS

VARIABLES = ("hip", "knee", "ankle", "HAM", "RF", "VAS", "GAS", "SOL")


def differences(w, n=11):
    """Distinct differences whose negative ranks sum to w, all positive where w is 0."""
    found, left = np.arange(1.0, n + 1), w
    for rank in range(n, 0, -1):
        if rank <= left:
            found[rank - 1] *= -1
            left -= rank
    return found / 1000


def frame(columns):
    return pd.DataFrame(columns, index=[f"P{i + 1:02d}" for i in range(11)])


def response(name, r2):
    """Stand-in that holds nothing but R2."""
    return SimpleNamespace(
        participant=name, outputs=VARIABLES, r2_of=lambda v, model, kind="network": r2[model][VARIABLES.index(v)]
    )


def people(n, seed=0, effect=0.1):
    rng = np.random.default_rng(seed)
    found = []
    for i in range(n):
        exo = 0.9 + 0.02 * rng.standard_normal(8)
        r2 = {"exo": exo, "augmented": exo - 0.001 * rng.standard_normal(8)}
        r2["nominal"] = r2["augmented"] - effect + 0.01 * rng.standard_normal(8)
        found.append(response(f"P{i + 1:02d}", r2))
    return found


def test_the_dissertations_four_of_eight():
    sums = dict(zip(VARIABLES, (20, 3, 1, 4, 15, 2, 25, 30), strict=True))
    first = frame({v: np.full(11, 0.8) for v in VARIABLES})
    second = frame({v: 0.8 + differences(w) for v, w in sums.items()})
    found = compare_columns(first, second).set_index("variable")
    assert found["w"].to_dict() == {v: float(w) for v, w in sums.items()}
    assert set(found.index[found["different"]]) == {"knee", "ankle", "HAM", "VAS"}
    assert found.loc["RF", "step_level"] == pytest.approx(0.0127, abs=5e-5)
    assert (found["tests"] == 8).all() and (found["n"] == 11).all()


def test_a_weak_second_model_is_said_to_be_weaker():
    found = compare_columns(frame({"hip": np.full(11, 0.9)}), frame({"hip": np.full(11, 0.9) - differences(0)}))
    row = found.iloc[0]
    assert row["rank_biserial"] == -1
    assert row["median_difference"] == pytest.approx(-0.006) == row["shift"]
    assert row["low"] < row["shift"] < row["high"] < 0


def test_three_pairs_and_perfection():
    found = compare_models(people(11))
    assert not found.too_few and found.participants == 11
    assert found.tests.groupby(["first", "second"], sort=False).ngroups == len(PAIRS)
    nominal = found.of_pair("nominal", "augmented")
    assert nominal["different"].all()
    assert nominal["p_adjusted"].to_numpy() == pytest.approx(1 - (1 - 2 / 2**11) ** 8)  # the floor of 8 tests
    assert not found.of_pair("augmented", "exo")["different"].any()
    perfect = found.of_pair("exo", "perfect")
    assert (perfect["median_second"] == 1).all() and (perfect["p"] == 2 / 2**11).all()


def test_families_change_the_level_and_nothing_else():
    tests = compare_models(people(11)).tests
    families = by_family(tests)
    sizes = families.groupby("family")["tests"].unique().to_dict()
    assert {name: set(size) for name, size in sizes.items()} == {"pair": {8}, "all": {24}, "variable": {3}}
    assert "perfect" not in set(families["second"])
    own = families[families["family"] == "pair"].merge(tests, on=["first", "second", "variable"])
    np.testing.assert_array_equal(own["p_adjusted_x"], own["p_adjusted_y"])
    every = families[families["family"] == "all"].sort_values(["variable", "first", "second"])
    pair = families[families["family"] == "pair"].sort_values(["variable", "first", "second"])
    assert (every["p_adjusted"].to_numpy() >= pair["p_adjusted"].to_numpy()).all()


@pytest.mark.parametrize("n", [0, 1, 5])
def test_too_few_are_not_tested(n):
    found = compare_models(people(n))
    assert not len(found.tests) and not len(found.families)
    assert found.too_few == too_few(n)
    if n == 5:
        assert says(found.too_few, "5 participants", "0.0625")


def test_a_number_that_was_not_computed_is_left_out_by_name():
    lacking = people(11)
    lacking[2] = response("P03", {m: np.where(np.arange(8) == 1, np.nan, 0.5) for m in ("nominal", "augmented", "exo")})
    row = compare_models(lacking).of_pair("nominal", "augmented").set_index("variable").loc["knee"]
    assert (row["n"], row["left_out"]) == (10, "not computed: P03")
    assert row["p"] == 2 / 2**10


def test_a_variable_that_few_have_is_not_tested_and_not_of_the_family():
    first = frame({"hip": np.full(11, 0.8), "knee": np.full(11, 0.8)})
    second = first + 0.01 * np.arange(1.0, 12)[:, None]
    second.iloc[:6, 1] = np.nan
    found = compare_columns(first, second).set_index("variable")
    assert np.isnan(found.loc["knee", "p"]) and not found.loc["knee", "different"]
    assert found.loc["knee", "n"] == 5
    assert (found["tests"] == 1).all()
    assert found.loc["hip", "step_level"] == pytest.approx(0.05)
