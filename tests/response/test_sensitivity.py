import pandas as pd
import pytest

from gaitdisc.response.vary import AS_STUDIED, compare_variants, settings_around
from gaitdisc.results.variants import Variants


def person(name, gain):
    rows = [
        (variant, variable, model, "network", value + 0.01 * place, 99)
        for variant, lift in ((AS_STUDIED, gain), ("angles 4 Hz", -gain))
        for place, variable in enumerate(("knee_angle_r", "emg_sol_r"))
        for model, value in (("nominal", 0.5), ("augmented", 0.5 + lift), ("exo", 0.6))
    ]
    return Variants(
        name, "sensitivity", pd.DataFrame(rows, columns=["variant", "variable", "model", "kind", "r2", "n"]), {}
    )


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
    tests = compare_variants([person(f"P{number}", 0.1 + 0.001 * number) for number in range(8)], "sensitivity")
    shifts = tests.pivot_table(index="variant", columns="variable", values="shift")
    assert shifts.loc[AS_STUDIED, "knee_angle_r"] == pytest.approx(0.1035)
    assert shifts.loc["angles 4 Hz", "emg_sol_r"] == pytest.approx(-0.1035)
    assert tests["different"].all()
    assert set(tests["tests"]) == {2}


def test_few_participants_are_not_tested():
    assert len(compare_variants([person("P0", 0.1)], "sensitivity")) == 0
