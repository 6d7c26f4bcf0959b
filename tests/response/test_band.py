"""Bands of refits: they cover what they promise where blocks are alike, and less where the walk is another."""

from __future__ import annotations

import numpy as np
import pytest

from gaitdisc.recording import Samples
from gaitdisc.response.fit_response import BLOCKS, covered, fit_linear, fit_models, parted, response_bands


def walk(seed: int, gain: float, count: int = 2000) -> Samples:
    """y = gain x + noise that is three times as large in the first half of the stride."""
    rng, time = np.random.default_rng(seed), np.arange(count) / 100
    phi, x = 100 * (time % 1.0), rng.normal(size=(count, 1))
    noise = rng.normal(size=(count, 1)) * np.where(phi < 50, 0.3, 0.1)[:, None]
    return Samples(np.column_stack([x, phi]), gain * x + noise, ("a", "phi"), ("b",), time, phi)


@pytest.fixture(scope="module")
def bands():
    nominal, exo, held = walk(0, 1.0), walk(1, 2.0), walk(2, 2.0)
    models = fit_models(nominal, exo, fit=lambda part, _: fit_linear(part, harmonics=2))
    found = response_bands(models, lambda _, samples: fit_linear(samples, harmonics=2).model, nominal, exo, held)
    return held, found


def test_nine_in_ten_lie_inside_and_fewer_inside_the_nominal_models(bands):
    held, found = bands
    for model in (
        "exo",
        "augmented",
    ):  # 20 strides are ten blocks: 90 % times 1.1, for samples that do not err together
        assert covered(held.y, found[model])[0] == pytest.approx(0.975, abs=0.02)
    assert covered(held.y, found["nominal"])[0] < 0.5


def test_a_band_is_wide_where_errors_are_large(bands):
    held, found = bands
    width = (found["exo"][1] - found["exo"][0])[:, 0]
    wide, narrow = (np.median(width[part]) for part in (held.phi < 45, held.phi > 55))
    assert wide / narrow == pytest.approx(3.0, rel=0.2)


def test_the_more_strides_the_nearer_to_nine_in_ten():
    nominal, exo, held = walk(0, 1.0, 16000), walk(1, 2.0, 16000), walk(2, 2.0)
    models = fit_models(nominal, exo, fit=lambda part, _: fit_linear(part, harmonics=2))
    found = response_bands(models, lambda _, samples: fit_linear(samples, harmonics=2).model, nominal, exo, held)
    assert covered(held.y, found["exo"])[0] == pytest.approx(0.9 * (1 + 2 / 160), abs=0.012)


def test_a_block_and_what_lies_within_the_seam_are_left_out():
    samples = walk(0, 1.0, 800)
    rest, block = parted(samples, 3)
    assert block.time[[0, -1]].tolist() == [3.0, 3.99]
    assert rest.time[np.searchsorted(rest.time, 3.0) + np.array([-1, 0])].round(2).tolist() == [2.69, 4.3]
    assert sum(len(parted(samples, number)[1]) for number in range(BLOCKS)) == 800


def test_a_short_walk_has_no_band():
    models = fit_models(walk(0, 1.0), walk(1, 2.0), fit=lambda part, _: fit_linear(part, harmonics=2))
    short = walk(0, 1.0, 1500)
    assert response_bands(models, lambda model, _: model, short, walk(1, 2.0), walk(2, 2.0)) == {}
