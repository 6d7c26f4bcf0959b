import numpy as np
import pytest

from gaitdisc.report.r2_summary import (
    R2_TABLE,
    held_out_text,
    medians,
    participant_medians,
    quartiles_over_participants,
    r2_by_variable,
    sample_counts,
    variables,
)

OUTPUTS = ("hip_flexion_r", "ankle_angle_l")


def test_every_column_stands_where_the_response_says(response_maker):
    response = response_maker("P01", outputs=OUTPUTS)
    table = r2_by_variable(response)
    for column in R2_TABLE:
        model = column.model or "nominal"
        for variable in OUTPUTS:
            wanted = response.r2_of(variable, model, column.kind, column.walk)
            assert table.loc[variable, column.key] == pytest.approx(wanted)
    assert [column.title for column in R2_TABLE][:2] == ["Nominal, no device", "Nominal"]


def test_what_was_not_computed_is_nan_and_leaves_the_median_alone(response_maker):
    response = response_maker("P01", outputs=OUTPUTS)
    response.r2.loc[response.r2["variable"] == "ankle_angle_l", "r2"] = np.nan
    table = r2_by_variable(response)
    assert table.loc["ankle_angle_l"].isna().all()
    assert medians(table)["exo_on_exo"] == table.loc["hip_flexion_r", "exo_on_exo"]


def test_quartiles_over_participants_count_who_has_the_variable(run_maker):
    run = run_maker(3, outputs=OUTPUTS)
    long = quartiles_over_participants(run).set_index(["variable", "column"])
    values = [r.r2_of("ankle_angle_l", "augmented") for r in run.responses]
    row = long.loc[("ankle_angle_l", "augmented_on_exo")]
    assert row["median"] == pytest.approx(np.median(values))
    assert row["q1"] == pytest.approx(np.quantile(values, 0.25))
    assert row["n"] == 3
    people = participant_medians(run)
    assert people.loc["P02", "exo_on_exo"] == pytest.approx(
        np.median([run.responses[1].r2_of(v, "exo") for v in OUTPUTS])
    )


def test_counts_and_lengths_in_words(run_maker, response_maker):
    assert variables(run_maker(2, outputs=OUTPUTS)) == OUTPUTS
    response = response_maker("P01", outputs=OUTPUTS)
    assert sample_counts(response) == "749"
    response.r2.loc[0, "n"] = 700
    assert sample_counts(response) == "700-749"
    assert held_out_text(run_maker(2, outputs=OUTPUTS, held_out_s=10.0)) == "10"
    assert held_out_text(run_maker(0)) == ""
