from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sklearn.linear_model import Ridge as SklearnRidge

from gaitdisc.errors import TrainingError
from gaitdisc.model import Model
from gaitdisc.recording import Samples
from gaitdisc.regression.ridge import PENALTIES, fit_ridge


def walk(count=1000, seed=0, noise=0.0, inputs=3):
    rng = np.random.default_rng(seed)
    time = np.arange(count) / 100
    x = rng.normal(5, 2, (count, inputs))
    phi = 100 * (time / 1.1 % 1)
    y = x @ rng.normal(size=(inputs, 2)) + 7 + noise * rng.normal(size=(count, 2))
    names = tuple(f"x{k}" for k in range(inputs))
    return Samples(np.column_stack([x, phi]), y, (*names, "phi"), ("a", "b"), time, phi)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 999), st.integers(1, 6))
def test_a_linear_walk_is_predicted_exactly(seed, inputs):
    train, held_out = walk(seed=seed, inputs=inputs).last_block(0.2)
    ridge = fit_ridge(train)
    assert isinstance(ridge, Model)
    assert ridge.penalty == PENALTIES[0]
    np.testing.assert_allclose(ridge(held_out.x), held_out.y, atol=1e-4)


def test_harmonics_of_the_stride_and_none_without_phase():
    samples = walk()
    third = np.sin(2 * np.pi * 3 * samples.phi / 100)
    wave = samples.with_outputs(np.column_stack([third, samples.y[:, 0] - 4 * third]))
    np.testing.assert_allclose(fit_ridge(wave)(wave.x), wave.y, atol=1e-4)
    assert np.std(fit_ridge(wave, harmonics=2)(wave.x)[:, 0] - third) > 0.6
    plain = replace(wave, x=wave.x[:, :3], inputs=wave.inputs[:3])
    assert fit_ridge(plain).harmonics == 0


def test_it_is_scikit_learns_ridge_at_the_chosen_penalty():
    samples = walk(count=150, noise=30.0, inputs=40)
    ridge = fit_ridge(samples, harmonics=0)
    assert ridge.penalty > 1e-4
    peer = SklearnRidge(alpha=ridge.penalty * len(samples)).fit(ridge.scale.scaled(samples.x), samples.y)
    np.testing.assert_allclose(ridge(samples.x), peer.predict(ridge.scale.scaled(samples.x)), rtol=1e-9)


def test_a_constant_input_weighs_nothing():
    samples = walk()
    still = replace(samples, x=np.column_stack([samples.x[:, :3], np.full(1000, 3.0)]))
    ridge = fit_ridge(still, harmonics=0)
    moved = still.x + np.array([0, 0, 0, 50.0])
    np.testing.assert_array_equal(ridge(still.x), ridge(moved))


def test_refusals():
    with pytest.raises(TrainingError, match=r"50 samples.*30 usable"):
        fit_ridge(walk(30))
    with pytest.raises(TrainingError, match=r"inner_share.*0.*1.*0"):
        fit_ridge(walk(), inner_share=0)
    with pytest.raises(TrainingError, match=r"1.*1000 samples"):
        fit_ridge(walk().with_outputs(np.column_stack([walk().y[:, 0], np.ones(1000)])))
