"""Ridge, with phase harmonics and on Fourier features."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sklearn.linear_model import Ridge as SklearnRidge

from gaitdisc.errors import SchemaError, TrainingError
from gaitdisc.model import Model
from gaitdisc.models.fourier_ridge import fit_fourier_ridge
from gaitdisc.models.ridge import PENALTIES, fit_ridge
from gaitdisc.reconstruction.model_folder import load_weights, save_weights
from gaitdisc.recording import Samples


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
    with pytest.raises(TrainingError, match=r"1.*1000 samples"):
        fit_ridge(walk().with_outputs(np.column_stack([walk().y[:, 0], np.ones(1000)])))


def samples(x, y):
    time = np.arange(len(x)) / 100
    return Samples(x, y, tuple(f"x{k}" for k in range(x.shape[1])), ("y",), time, time % 1)


@pytest.fixture
def curve():
    rng = np.random.default_rng(0)
    x = rng.uniform(-2, 2, (900, 2))
    return samples(x, (np.sin(2 * x[:, :1]) * x[:, 1:] + 5))


def test_without_features_it_is_ridge_regression_with_the_known_solution():
    rng = np.random.default_rng(1)
    x = rng.normal(size=(400, 3)) * [1, 10, 0.1] + 3
    s = samples(x, x @ np.array([[2.0], [-0.5], [40.0]]) + 7)
    model = fit_fourier_ridge(s.rows(slice(0, 300)), s.rows(slice(300, None)))
    np.testing.assert_allclose(model(x[300:]), s.y[300:], atol=1e-3)
    assert model.penalty < 1e-6


def test_features_learn_what_a_line_cannot(curve):
    parts = [curve.rows(part) for part in (slice(0, 600), slice(600, 750), slice(750, None))]
    line, cosines = (fit_fourier_ridge(*parts[:2], features=n) for n in (0, 300))
    errors = [np.std(model(parts[2].x) - parts[2].y) for model in (line, cosines)]
    assert errors[1] < 0.05
    assert errors[0] > 0.5


def test_the_scale_never_sees_the_check_part(curve):
    part, check = curve.rows(slice(0, 600)), curve.rows(slice(600, None))
    shifted = samples(check.x + 100, check.y - 50)
    one, other = (fit_fourier_ridge(part, judged, 20).x_scale.mean for judged in (check, shifted))
    np.testing.assert_array_equal(one, other)


def test_same_seed_same_model_and_a_missing_input_gives_a_missing_output(curve):
    part, check = curve.rows(slice(0, 600)), curve.rows(slice(600, None))
    one, same, other = (fit_fourier_ridge(part, check, 50, seed)(check.x) for seed in (0, 0, 1))
    np.testing.assert_array_equal(one, same)
    assert not np.array_equal(one, other)
    assert np.isnan(fit_fourier_ridge(part, check, 50)(np.array([[np.nan, 1.0]]))).all()


def test_without_a_check_part(curve):
    with pytest.raises(TrainingError, match="penalty"):
        fit_fourier_ridge(curve, curve.rows(slice(0, 0)))


def test_columns_that_say_the_same_share_their_weight_as_the_smallest_weights_do():
    t = np.arange(1200) / 100
    a, b = np.sin(2 * t), np.cos(3.3 * t)
    x = np.column_stack([a, b, a + b, 2 * a - 0.5 * b])
    s = Samples(x, (3 * a - b)[:, None], tuple("abcd"), ("y",), t, t)
    found = fit_fourier_ridge(s.rows(slice(0, 900)), s.rows(slice(900, None)))
    scaled = found.x_scale.scaled(x[:900])
    smallest = np.linalg.pinv(scaled, rcond=1e-6) @ found.y_scale.scaled(s.y[:900])
    assert np.allclose(found.weights, smallest, rtol=0, atol=1e-4)


@pytest.fixture
def model():
    x = np.random.default_rng(0).normal(size=(200, 2))
    t = np.arange(200) / 100
    s = Samples(x, x[:, :1] * x[:, 1:], ("a", "b"), ("c",), t, t)
    return fit_fourier_ridge(s.rows(slice(0, 150)), s.rows(slice(150, None)), features=30)


def test_what_is_loaded_equals_what_was_saved(model, tmp_path):
    save_weights(model, tmp_path / "m.npz")
    kept, x = load_weights(tmp_path / "m.npz"), np.random.default_rng(1).normal(size=(9, 2))
    np.testing.assert_array_equal(kept(x), model(x))
    assert (kept.inputs, kept.outputs, kept.penalty) == (model.inputs, model.outputs, model.penalty)


def test_a_damaged_or_missing_file(model, tmp_path):
    path = tmp_path / "m.npz"
    with pytest.raises(SchemaError, match=r"m\.npz.*a ridge regression"):
        load_weights(path)
    save_weights(model, path)
    path.write_bytes(path.read_bytes()[:-200])
    with pytest.raises(SchemaError, match="Fit the model again"):
        load_weights(path)
