from types import SimpleNamespace

import numpy as np
import pytest

from gaitdisc.response.over_participants import compare_reductions, representative, residual_reductions
from gaitdisc.results.over_participants import REDUCTION_COLUMNS

PHASE = np.linspace(0, 2 * np.pi, 101)


def response(name, left=0.25, strides=20, noise=0.0):
    """Nominal leaves a sine of 100 and an offset of 10; Augmented `left` of both; Exo nothing in the second output."""
    rng = np.random.default_rng(int(name[1:]))
    nominal = np.stack([100 * np.sin(PHASE), 10 + np.zeros(101)], axis=-1)
    shapes = {"nominal": nominal, "augmented": left * nominal, "exo": nominal * [0.5, 0.0]}
    residuals = {m: s + noise * rng.standard_normal((strides, 101, 2)) for m, s in shapes.items()}
    return SimpleNamespace(participant=name, outputs=("hip", "emg"), units=("deg/s2", "V/s2"), residuals=residuals)


def test_a_quarter_of_a_sine_is_a_reduction_by_three_quarters():
    table = residual_reductions([response("P1")]).set_index(["variable", "model"])
    hip = table.loc[("hip", "augmented")]
    assert hip[["peak_to_peak", "rms"]].to_list() == pytest.approx([50.0, 25 / np.sqrt(2)], rel=0.01)
    assert hip[["peak_to_peak_reduction", "rms_reduction"]].to_list() == pytest.approx([0.75, 0.75])
    assert table.loc[("hip", "nominal"), "rms_reduction"] == 0


def test_an_offset_has_no_oscillation_but_a_size():
    table = residual_reductions([response("P1")]).set_index(["variable", "model"])
    assert np.isnan(table.loc[("emg", "augmented"), "peak_to_peak_reduction"])
    assert table.loc[("emg", "augmented"), "rms_reduction"] == pytest.approx(0.75)
    assert table.loc[("emg", "exo"), "rms_reduction"] == 1.0


def test_noise_between_strides_averages_out_but_not_wholly():
    table = residual_reductions([response("P1", left=0.0, strides=100, noise=50.0)]).set_index(["variable", "model"])
    left = table.loc[("hip", "augmented"), "rms"]
    assert left == pytest.approx(50 / np.sqrt(100), rel=0.2)


def test_too_few_strides_are_no_number():
    table = residual_reductions([response("P1", strides=4)])
    assert list(table.columns) == list(REDUCTION_COLUMNS)
    assert table["rms"].isna().all()


def test_over_participants_the_shift_is_the_reduction():
    people = [response(f"P{i}", left=0.4 + 0.01 * i) for i in range(1, 12)]
    tests = compare_reductions(residual_reductions(people))
    row = tests[(tests["measure"] == "rms") & (tests["second"] == "augmented") & (tests["variable"] == "hip")].iloc[0]
    assert row["shift"] == pytest.approx(0.54)
    assert row["p"] == 2 / 2**11
    assert row["different"]
    assert row["tests"] == 2
    untested = tests[(tests["measure"] == "peak_to_peak") & (tests["variable"] == "emg")]
    assert untested["left_out"].str.startswith("not computed: P1, P2").all()


def test_five_participants_are_not_tested():
    assert not len(compare_reductions(residual_reductions([response(f"P{i}") for i in range(1, 6)])))
    assert not len(residual_reductions([]))


def test_the_representative_is_nearest_to_the_middle():
    people = [response("P1", left=0.1), response("P2", left=0.5), response("P3", left=0.9)]
    assert representative(residual_reductions(people)) == "P2"
    assert representative(residual_reductions([])) == ""
