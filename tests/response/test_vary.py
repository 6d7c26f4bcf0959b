"""Models with one thing changed at a time: inputs left away, filters, less data."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from gaitdisc.errors import SamplingError
from gaitdisc.response.variants import VARIANT_COLUMNS, Variants
from gaitdisc.response.vary import (
    ALL,
    AS_STUDIED,
    compare_variants,
    fit_data_quantity,
    fit_without,
    input_families,
    settings_around,
)

INPUTS = tuple(
    [f"{name}_{side}" for name in ("knee_angle", "emg_sol") for side in "rl"]
    + [f"d({name}_{side})/dt" for name in ("knee_angle", "emg_sol") for side in "rl"]
    + ["phi"]
)


def fallen(count, fall):
    """R2 .9 with all inputs; without `EMG` lower by `fall` in the knee, by nothing but its scatter in the ankle."""
    rng = np.random.default_rng(3)
    found = []
    for number in range(count):
        rows = []
        for model in ("augmented", "exo"):
            for variant, less in ((ALL, 0.0), ("EMG", fall)):
                for variable, own in (("knee_angle_r", less), ("ankle_angle_r", 0.0)):
                    scatter = 0.002 * rng.normal()
                    rows += [(variant, variable, model, kind, 0.9 - own + scatter, 99) for kind in ("network", "ridge")]
        found.append(Variants(f"P{number}", "modalities", pd.DataFrame(rows, columns=pd.Index(VARIANT_COLUMNS)), {}))
    return found


def test_families_are_kinds_of_measurement_then_joints_and_muscles():
    families = input_families(INPUTS)
    assert list(families) == [
        "percent stride",
        "angles and their velocities",
        "EMG and its velocities",
        "angles",
        "angle velocities",
        "EMG",
        "EMG velocities",
    ]  # one joint and one muscle are all angles and all EMG, and not listed twice
    assert families["EMG velocities"] == ("d(emg_sol_r)/dt", "d(emg_sol_l)/dt")
    more = input_families((*INPUTS, "hip_flexion_r", "d(hip_flexion_r)/dt"))
    assert more["hip_flexion"] == ("hip_flexion_r", "d(hip_flexion_r)/dt")
    assert set(more["knee_angle"]) | set(more["hip_flexion"]) == set(more["angles and their velocities"])


def test_a_family_that_would_leave_nothing_is_none():
    assert input_families(("knee_angle_r", "d(knee_angle_r)/dt")) == {
        "angles": ("knee_angle_r",),
        "angle velocities": ("d(knee_angle_r)/dt",),
    }


@pytest.fixture(scope="module")
def found(nominal, linear_exo, settings, briefly):
    told = []
    with briefly():
        table = fit_without(nominal, linear_exo, settings, told.append)
    assert told == sorted(told)
    assert told[-1] == pytest.approx(1.0)
    return table.pivot_table(index=["variant", "kind", "model"], columns="variable", values="r2")["ankle_angle_r"]


def test_a_spring_on_the_ankle_is_carried_by_the_ankle(found):
    """The response is -40 times the ankle's angle, which ridge can have exactly, and nothing else can replace."""
    assert found[ALL, "ridge", "augmented"] - found["ankle_angle", "ridge", "augmented"] > 0.02
    for other in ("knee_angle", "angle velocities", "percent stride"):
        assert abs(found[ALL, "ridge", "augmented"] - found[other, "ridge", "augmented"]) < 0.005


def test_a_network_says_the_same(found):
    falls = {
        name: found[ALL, "network", "augmented"] - found[name, "network", "augmented"]
        for name in ("ankle_angle", "knee_angle")
    }
    assert falls["ankle_angle"] > 0.02
    assert falls["knee_angle"] < 0.5 * falls["ankle_angle"]


def test_exo_loses_more_than_augmented_whose_nominal_model_keeps_its_inputs(found):
    exo = found[ALL, "ridge", "exo"] - found["ankle_angle", "ridge", "exo"]
    assert exo > found[ALL, "ridge", "augmented"] - found["ankle_angle", "ridge", "augmented"]


def test_the_fall_is_tested_over_participants():
    tests = compare_variants(fallen(8, 0.1), "modalities")
    knee = tests[(tests["variable"] == "knee_angle_r") & (tests["model"] == "augmented")].iloc[0]
    ankle = tests[(tests["variable"] == "ankle_angle_r") & (tests["model"] == "augmented")].iloc[0]
    assert (knee["first"], knee["second"], knee["n"]) == (ALL, "without", 8)
    assert knee["shift"] == pytest.approx(-0.1, abs=0.003)
    assert knee["p"] == pytest.approx(2 / 2**8)
    assert bool(knee["different"])
    assert not bool(ankle["different"])


def studied(name, gain):
    rows = [
        (variant, variable, model, "network", value + 0.01 * place, 99)
        for variant, lift in ((AS_STUDIED, gain), ("angles 4 Hz", -gain))
        for place, variable in enumerate(("knee_angle_r", "emg_sol_r"))
        for model, value in (("nominal", 0.5), ("augmented", 0.5 + lift), ("exo", 0.6))
    ]
    return Variants(name, "sensitivity", pd.DataFrame(rows, columns=pd.Index(VARIANT_COLUMNS)), {})


def test_one_thing_is_changed_at_a_time_and_the_studys_own_comes_first():
    own, *others = settings_around(6.0, 10.0)
    assert (own.name, own.angles_hz, own.emg_hz, own.share) == (AS_STUDIED, 6.0, 10.0, 1.0)
    assert len(others) == 4 + 4 + 2
    for other in others:
        changed = (other.angles_hz != 6.0) + (other.emg_hz != 10.0) + (other.share != 1.0)
        assert changed == 1, other
    assert len({setting.name for setting in (own, *others)}) == 11


def test_a_study_with_cut_offs_of_its_own_tries_the_usual_ones_too():
    names = [setting.name for setting in settings_around(7.0, 12.0)]
    assert "angles 6 Hz" in names
    assert "EMG 10 Hz" in names
    assert not any("EMG" in setting.name for setting in settings_around(6.0, 10.0, emg=False))


def test_nominal_and_augmented_are_compared_under_each_setting():
    tests = compare_variants([studied(f"P{number}", 0.1 + 0.001 * number) for number in range(8)], "sensitivity")
    shifts = tests.pivot_table(index="variant", columns="variable", values="shift")
    assert shifts.loc[AS_STUDIED, "knee_angle_r"] == pytest.approx(0.1035)
    assert shifts.loc["angles 4 Hz", "emg_sol_r"] == pytest.approx(-0.1035)
    assert tests["different"].all()
    assert set(tests["tests"]) == {2}


def test_few_participants_are_not_tested():
    assert len(compare_variants(fallen(5, 0.1), "modalities")) == 0
    assert len(compare_variants([studied("P0", 0.1)], "sensitivity")) == 0


ANKLE = "ankle_angle_r"


@pytest.fixture(scope="module")
def quantity(nominal, exo, settings):
    return fit_data_quantity(nominal, exo, settings, (1.0, 10.0, 500.0))


@pytest.fixture(scope="module")
def ten(nominal, exo, settings, briefly):
    """Return what 10 s give where networks hardly learn."""
    with briefly():
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
    assert len(set(quantity.table[quantity.table["walk"] == "exo"]["n"])) == 1


def test_a_length_that_the_trial_does_not_have_is_told(quantity):
    assert quantity.left_away[500.0].startswith("the training part is")


@pytest.mark.usefixtures("trained_briefly")
def test_the_last_seconds_are_other_seconds(ten, nominal, exo, settings):
    last = fit_data_quantity(nominal, exo, settings, (10.0,), part="last")
    assert r2_at(last, 10.0, "exo", "ridge") != r2_at(ten, 10.0, "exo", "ridge")
    with pytest.raises(SamplingError, match="found 'middle'"):
        fit_data_quantity(nominal, exo, settings, part="middle")


@pytest.mark.usefixtures("trained_briefly")
def test_held_out_seconds_are_never_seen(ten, nominal, exo, settings):
    spoiled = np.array(exo.xddot)
    spoiled[-200:] += 1e4
    before = ten.table
    after = fit_data_quantity(nominal, replace(exo, xddot=spoiled), settings, (10.0,)).table
    assert (before["n_training"] == after["n_training"]).all()
    on_nominal = before["walk"] == "nominal"
    np.testing.assert_array_equal(before[on_nominal]["r2"], after[on_nominal]["r2"])
