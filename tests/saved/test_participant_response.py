"""Results of a study of responses: what they hold, and what does not belong together."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from gaitdisc.errors import SchemaError, ShapeError
from gaitdisc.response.participant_response import QUANTITY, QUANTITY_COLUMNS, DataQuantity
from gaitdisc.response.participants_result import (
    LENGTH_COLUMNS,
    OVER,
    TABLES,
    TESTS,
    WHOLE,
    OverParticipants,
    join_rows,
)
from gaitdisc.response.variants import VARIANT_COLUMNS, VARIANT_TEST_COLUMNS, VARIANTS, VariantRun, Variants


def test_r2_of(response):
    assert response.r2_of("hip_flexion_r", "nominal") == pytest.approx(0.3)
    assert np.isnan(response.r2_of("hip_flexion_r", "augmented"))


def test_columns_fit_the_outputs(response):
    with pytest.raises(ShapeError, match=r"residuals\[nominal\].*2.*P01"):
        replace(response, residuals={"nominal": np.zeros((3, 101, 2))})
    with pytest.raises(ShapeError, match="101 points per stride"):
        replace(response, residuals={"nominal": np.zeros((3, 51, 1))})


@pytest.fixture
def quantity():
    rows = [
        (length, int(length * 100), variable, model, "network", "exo", r2, 300)
        for length, low in ((1.0, 0.1), (10.0, 0.6))
        for variable, more in (("knee", 0.0), ("ankle", 0.2), ("hip", 0.3))
        for model, r2 in (("nominal", low + more), ("exo", low + more + 0.05))
    ]
    return DataQuantity("P01", "first", pd.DataFrame(rows, columns=pd.Index(QUANTITY_COLUMNS)), {500.0: "too long"})


def test_medians_over_variables(quantity):
    medians = quantity.medians()
    assert medians.loc[1.0, "nominal"] == pytest.approx(0.3)
    assert medians.loc[10.0, "exo"] == pytest.approx(0.85)


def test_one_pair_of_models(pair_tests):
    assert pair_tests.of_pair("augmented", "exo")["variable"].tolist() == ["hip_flexion_r"]
    assert not len(pair_tests.of_pair("exo", "perfect"))


def over(lengths=None, **other):
    tables = {name: join_rows(name) for name in TABLES} | other
    tables |= {} if lengths is None else {"lengths": lengths}
    return OverParticipants(**tables, lengths_said="", responders_said="")


def lengths(different, second=WHOLE):
    rows = [{"length_s": length, "second": second, "different": d, "p": 0.5} for length, d in different.items()]
    return pd.DataFrame(rows).reindex(columns=list(LENGTH_COLUMNS))


def test_enough_is_the_shortest_length_after_the_last_that_differs():
    assert over(lengths({1.0: True, 30.0: False, 60.0: True, 90.0: False, 120.0: False})).enough_length() == 90.0


def test_nothing_is_enough_where_the_longest_still_differs():
    assert over(lengths({1.0: False, 60.0: True})).enough_length() is None
    assert over().enough_length("exo") is None


def test_each_comparison_has_its_own_length():
    both = pd.concat([lengths({1.0: True, 30.0: False}), lengths({1.0: False, 30.0: False}, "exo")])
    assert (over(both).enough_length(), over(both).enough_length("exo")) == (30.0, 1.0)


TABLE = pd.DataFrame([("EMG", "knee_angle_r", "exo", "network", 0.9, 99)], columns=pd.Index(VARIANT_COLUMNS))


def test_a_table_without_one_of_its_columns_is_refused_by_its_name(tmp_path, pair_tests, quantity):
    for kind, column, saved in (
        (QUANTITY, "n_training", replace(quantity, table=quantity.table.drop(columns="n_training"))),
        (TESTS, "p_adjusted", replace(pair_tests, tests=pair_tests.tests.drop(columns="p_adjusted"))),
        (OVER, "rank_biserial", over(baselines=join_rows("baselines").drop(columns="rank_biserial"))),
        (VARIANTS, "variant", Variants("P01", "modalities", TABLE.drop(columns="variant"), {})),
    ):
        kind.save(saved, tmp_path)
        with pytest.raises(SchemaError, match=f"lacks the columns {column}"):
            kind.load(tmp_path)


def test_a_question_is_one_of_two(tmp_path):
    VARIANTS.save(Variants("P01", "why", TABLE, {}), tmp_path)
    with pytest.raises(SchemaError, match=r"at \$\.question: 'why'"):
        VARIANTS.load(tmp_path)


def test_every_participant_is_in_the_table():
    people = tuple(Variants(name, "modalities", TABLE, {}) for name in ("P01", "P02"))
    empty = pd.DataFrame(columns=pd.Index(VARIANT_TEST_COLUMNS))
    run = VariantRun("study", "exo", "modalities", people, empty, (), (7.5, 7.5))
    assert run.r2_table()["participant"].tolist() == ["P01", "P02"]
    assert len(VariantRun("study", "exo", "modalities", (), empty, (), (0.0, 0.0)).r2_table()) == 0
