"""What the participants say together: pairs of models, baselines, residuals, lengths, sub-groups."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from ch4_ours import representative
from texts import says

from gaitdisc.errors import ComparisonError
from gaitdisc.response.over_participants import (
    by_family,
    compare_baselines,
    compare_columns,
    compare_lengths,
    compare_models,
    compare_participants,
    compare_reductions,
    discrepancy_curves,
    residual_reductions,
    responder_table,
    too_few,
)
from gaitdisc.response.participant_response import QUANTITY_COLUMNS, DataQuantity
from gaitdisc.response.participants_result import BASELINE_COLUMNS, LENGTH_COLUMNS, PAIRS, REDUCTION_COLUMNS, WHOLE
from gaitdisc.statistics.groups import find_groups

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


def scored(name, r2):
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
        found.append(scored(f"P{i + 1:02d}", r2))
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
    lacking[2] = scored("P03", {m: np.where(np.arange(8) == 1, np.nan, 0.5) for m in ("nominal", "augmented", "exo")})
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


KIND_R2 = {"network": 0.9, "ridge": 0.9, "linear": 0.7, "null": 0.5}


def networked(i, null=True):
    """Network and ridge differ by noise alone; the network is .2 above ridge on its inputs and .4 above the null."""

    def r2_of(variable, model, kind="network"):
        if kind == "null" and (not null or model != "nominal"):
            return np.nan
        seed = [i, *map(ord, variable[0] + model[0] + kind[0])]
        return KIND_R2[kind] + 0.01 * np.random.default_rng(seed).standard_normal()

    return SimpleNamespace(participant=f"P{i + 1:02d}", outputs=("hip", "knee", "ankle"), r2_of=r2_of)


def test_what_a_network_is_worth():
    tests = compare_baselines([networked(i) for i in range(11)])
    assert list(tests.columns) == list(BASELINE_COLUMNS)
    assert len(tests) == 3 * 3 * 3
    assert not tests.loc[tests["first"] == "ridge", "different"].any()
    for baseline, gain in (("linear", 0.2), ("null", 0.4)):
        rows = tests[tests["first"] == baseline]
        assert rows["different"].all()
        assert np.allclose(rows["shift"], gain, atol=0.02)


def test_a_null_that_was_not_computed_is_not_tested():
    tests = compare_baselines([networked(i, null=i > 5) for i in range(11)])
    rows = tests[tests["first"] == "null"]
    assert rows["p"].isna().all()
    assert rows["left_out"].str.contains("P01").all()


PHASE = np.linspace(0, 2 * np.pi, 101)


def leaving(name, left=0.25, strides=20, noise=0.0):
    """Nominal leaves a sine of 100 and an offset of 10; Augmented `left` of both; Exo nothing in the second output."""
    rng = np.random.default_rng(int(name[1:]))
    nominal = np.stack([100 * np.sin(PHASE), 10 + np.zeros(101)], axis=-1)
    shapes = {"nominal": nominal, "augmented": left * nominal, "exo": nominal * [0.5, 0.0]}
    residuals = {m: s + noise * rng.standard_normal((strides, 101, 2)) for m, s in shapes.items()}
    return SimpleNamespace(participant=name, outputs=("hip", "emg"), units=("deg/s2", "V/s2"), residuals=residuals)


def test_a_quarter_of_a_sine_is_a_reduction_by_three_quarters():
    table = residual_reductions([leaving("P1")]).set_index(["variable", "model"])
    hip = table.loc[("hip", "augmented")]
    assert hip[["peak_to_peak", "rms"]].to_list() == pytest.approx([50.0, 25 / np.sqrt(2)], rel=0.01)
    assert hip[["peak_to_peak_reduction", "rms_reduction"]].to_list() == pytest.approx([0.75, 0.75])
    assert table.loc[("hip", "nominal"), "rms_reduction"] == 0


def test_an_offset_has_no_oscillation_but_a_size():
    table = residual_reductions([leaving("P1")]).set_index(["variable", "model"])
    assert np.isnan(table.loc[("emg", "augmented"), "peak_to_peak_reduction"])
    assert table.loc[("emg", "augmented"), "rms_reduction"] == pytest.approx(0.75)
    assert table.loc[("emg", "exo"), "rms_reduction"] == 1.0


def test_noise_between_strides_averages_out_but_not_wholly():
    table = residual_reductions([leaving("P1", left=0.0, strides=100, noise=50.0)]).set_index(["variable", "model"])
    left = table.loc[("hip", "augmented"), "rms"]
    assert left == pytest.approx(50 / np.sqrt(100), rel=0.2)


def test_too_few_strides_are_no_number():
    table = residual_reductions([leaving("P1", strides=4)])
    assert list(table.columns) == list(REDUCTION_COLUMNS)
    assert table["rms"].isna().all()


def test_over_participants_the_shift_is_the_reduction():
    people = [leaving(f"P{i}", left=0.4 + 0.01 * i) for i in range(1, 12)]
    tests = compare_reductions(residual_reductions(people))
    row = tests[(tests["measure"] == "rms") & (tests["second"] == "augmented") & (tests["variable"] == "hip")].iloc[0]
    assert row["shift"] == pytest.approx(0.54)
    assert row["p"] == 2 / 2**11
    assert row["different"]
    assert row["tests"] == 2
    untested = tests[(tests["measure"] == "peak_to_peak") & (tests["variable"] == "emg")]
    assert untested["left_out"].str.startswith("not computed: P1, P2").all()


def test_the_representative_is_nearest_to_the_middle():
    people = [leaving("P1", left=0.1), leaving("P2", left=0.5), leaving("P3", left=0.9)]
    assert representative(residual_reductions(people)) == "P2"
    assert representative(residual_reductions([])) == ""


def responding(i, kind, outputs=("ankle_angle_r", "emg_sol_r")):
    """Discrepancy of a sine or a cosine, in deg/s2 and in V/s2, with a size of its own."""
    rng = np.random.default_rng(i)
    shape = np.sin(PHASE) if kind else np.cos(PHASE)
    curve = (1 + 0.1 * rng.standard_normal()) * shape[None, :, None] * np.array([1000.0, 0.1])[: len(outputs)]
    noise = 0.5 * rng.standard_normal((20, 101, len(outputs))) * np.array([1000.0, 0.1])[: len(outputs)]
    return SimpleNamespace(participant=f"P{i + 1:02d}", outputs=outputs, residuals={"nominal": curve + noise})


def test_two_kinds_of_responders_are_told_apart():
    found = find_groups(discrepancy_curves([responding(i, i % 2) for i in range(12)]), clouds=39)
    assert found.count == 2
    assert len(set(found.labels[::2])) == len(set(found.labels[1::2])) == 1


def test_one_kind_has_no_sub_groups():
    assert find_groups(discrepancy_curves([responding(i, 0) for i in range(12)]), clouds=39).count == 0


def test_all_outputs_weigh_alike():
    curves = discrepancy_curves([responding(i, i % 2) for i in range(6)])
    assert curves.shape == (6, 202)
    angle, emg = (np.mean(curves[:, part] ** 2) for part in (slice(101), slice(101, None)))
    assert angle == pytest.approx(1.0) == emg


def test_missing_samples_are_left_out_of_the_mean():
    holed = [responding(i, 0) for i in range(6)]
    holed[0].residuals["nominal"][3, 50, 0] = np.nan
    assert np.isfinite(discrepancy_curves(holed)).all()


def test_participants_of_different_outputs_are_refused():
    with pytest.raises(ComparisonError, match=r"2 sets.*6 participants"):
        discrepancy_curves([*(responding(i, 0) for i in range(5)), responding(5, 0, ("ankle_angle_r",))])


def test_each_responder_has_a_group_and_the_sentence_its_n():
    table, said = responder_table([responding(i, i % 2) for i in range(12)])
    assert table["group"].nunique() == 2
    assert says(said, "2 groups")
    assert said.endswith("(n = 12 participants)")


def test_who_lacks_points_of_the_stride_is_left_out_by_name():
    people = [responding(i, 0) for i in range(7)]
    people[2].residuals["nominal"][:, 50, 0] = np.nan
    table, said = responder_table(people)
    assert "P03" not in set(table["participant"])
    assert says(said, "n = 6 participants;", "missing points: P03")


def test_five_are_too_few_and_it_is_said():
    table, said = responder_table([responding(i, 0) for i in range(5)])
    assert not len(table)
    assert says(said, "not", "6 participants (n = 5", "participants)")


TWO = ("hip", "knee")


def quantity(i, lengths=(1.0, 30.0, 60.0), whole=210.0, augmented=0.0):
    """Exo loses .1 with 1 s, .02 with 30 s, and only noise with 60 s."""
    rng = np.random.default_rng(i)
    loss = {1.0: 0.1, 30.0: 0.02}
    rows = [
        (length, int(100 * length), v, model, "network", "exo", r2, 3000)
        for length in (*lengths, whole)
        for v in TWO
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


def test_five_are_too_few():
    lengths = [quantity(i) for i in range(6)]
    assert not len(compare_lengths(lengths[:5]))
    assert "5 participants are too few" in compare_participants([], lengths[:5]).lengths_said
    assert compare_participants([], lengths).lengths_said == compare_participants([]).lengths_said == ""
    assert not len(compare_baselines([networked(i) for i in range(5)]))
    assert not len(compare_reductions(residual_reductions([leaving(f"P{i}") for i in range(1, 6)])))
    assert not len(residual_reductions([]))


def test_one_participant_is_described_but_not_compared(judged):
    over = compare_participants([judged])
    assert set(over.reductions["participant"]) == {judged.participant}
    assert not len(over.lengths) + len(over.baselines) + len(over.reduction_tests) + len(over.responders)
    assert over.lengths_said == ""
    assert says(over.responders_said, "6 participants", "n = 1")
