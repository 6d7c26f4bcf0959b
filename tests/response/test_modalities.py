import numpy as np
import pandas as pd
import pytest

from gaitdisc.response.vary import ALL, compare_variants, fit_without, input_families
from gaitdisc.results.variants import Variants

INPUTS = tuple(
    [f"{name}_{side}" for name in ("knee_angle", "emg_sol") for side in "rl"]
    + [f"d({name}_{side})/dt" for name in ("knee_angle", "emg_sol") for side in "rl"]
    + ["phi"]
)


def people(count, fall):
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
        table = pd.DataFrame(rows, columns=["variant", "variable", "model", "kind", "r2", "n"])
        found.append(Variants(f"P{number}", "modalities", table, {}))
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
def found(nominal, linear_exo, settings):
    told = []
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
    tests = compare_variants(people(8, 0.1), "modalities")
    knee = tests[(tests["variable"] == "knee_angle_r") & (tests["model"] == "augmented")].iloc[0]
    ankle = tests[(tests["variable"] == "ankle_angle_r") & (tests["model"] == "augmented")].iloc[0]
    assert (knee["first"], knee["second"], knee["n"]) == (ALL, "without", 8)
    assert knee["shift"] == pytest.approx(-0.1, abs=0.003)
    assert knee["p"] == pytest.approx(2 / 2**8)
    assert bool(knee["different"])
    assert not bool(ankle["different"])


def test_few_participants_are_not_tested():
    assert len(compare_variants(people(5, 0.1), "modalities")) == 0
