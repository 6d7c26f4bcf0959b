from types import SimpleNamespace

import numpy as np

from gaitdisc.response.over_participants import compare_baselines
from gaitdisc.results.over_participants import BASELINE_COLUMNS

R2 = {"network": 0.9, "ridge": 0.9, "linear": 0.7, "null": 0.5}


def person(i, null=True):
    """Network and ridge differ by noise alone; the network is .2 above ridge on its inputs and .4 above the null."""

    def r2_of(variable, model, kind="network"):
        if kind == "null" and (not null or model != "nominal"):
            return np.nan
        seed = [i, *map(ord, variable[0] + model[0] + kind[0])]
        return R2[kind] + 0.01 * np.random.default_rng(seed).standard_normal()

    return SimpleNamespace(participant=f"P{i + 1:02d}", outputs=("hip", "knee", "ankle"), r2_of=r2_of)


def test_what_a_network_is_worth():
    tests = compare_baselines([person(i) for i in range(11)])
    assert list(tests.columns) == list(BASELINE_COLUMNS)
    assert len(tests) == 3 * 3 * 3
    assert not tests.loc[tests["first"] == "ridge", "different"].any()
    for baseline, gain in (("linear", 0.2), ("null", 0.4)):
        rows = tests[tests["first"] == baseline]
        assert rows["different"].all()
        assert np.allclose(rows["shift"], gain, atol=0.02)


def test_a_null_that_was_not_computed_is_not_tested():
    tests = compare_baselines([person(i, null=i > 5) for i in range(11)])
    rows = tests[tests["first"] == "null"]
    assert rows["p"].isna().all()
    assert rows["left_out"].str.contains("P01").all()


def test_five_are_too_few():
    assert not len(compare_baselines([person(i) for i in range(5)]))
