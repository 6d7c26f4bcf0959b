import numpy as np
import pytest

from gaitdisc.errors import ChannelError, SchemaError, TrainingError
from gaitdisc.models.trainer import descend
from gaitdisc.reconstruction import window_model
from gaitdisc.reconstruction.window_model import (
    KINDS,
    fit_reconstructor,
    fitting_device,
    latent_states,
    make_network,
    sensing,
)
from gaitdisc.reconstruction.windows import Lags, present


def test_states_are_what_no_sensor_measures():
    what = sensing(("a", "b", "c"), ("c", "x"), Lags(26, 4), 100.0)
    assert what.states == ("a", "b")
    assert what.reach_s == 1.0


def test_refusals(pair):
    with pytest.raises(ChannelError, match="no sensor measures; a"):
        sensing(("a",), ("a",), Lags(), 100.0)
    with pytest.raises(ChannelError, match=r"none.*sensors"):
        sensing(("a",), (), Lags(), 100.0)
    with pytest.raises(ChannelError, match="once; found a, a"):
        sensing(("a", "b"), ("a", "a"), Lags(), 100.0)
    with pytest.raises(SchemaError, match="'forest'"):
        fit_reconstructor("forest", pair.what, pair.parts.fitted(), pair.parts.checked())


def test_models_without_history_see_the_present_readings_alone(pair):
    parts = pair.parts
    linear = fit_reconstructor("linear", pair.what, parts.fitted(), parts.checked())
    test = parts.tested()
    assert linear.model.inputs == ("a",)
    np.testing.assert_array_equal(linear(test), linear.model(present(test, ("a",)).x))


def test_history_tells_a_state_that_lags_behind(pair):
    parts, errors = pair.parts, {}
    for kind in ("linear", "delay ridge", "fourier ridge"):
        done = fit_reconstructor(kind, pair.what, parts.fitted(), parts.checked())
        errors[kind] = np.sqrt(np.mean((done(parts.tested()) - parts.tested().y) ** 2))
    assert errors["delay ridge"] < 0.01
    assert errors["linear"] > 0.5
    assert errors["fourier ridge"] < 0.02


def test_the_networks_of_the_dissertations_code_have_its_weights():
    network = make_network("shred-text", 3)(300, 18)  # 100 readings of 3 sensors
    lstm = 4 * 64 * (3 + 64 + 2) + 4 * 64 * (64 + 64 + 2)
    assert sum(w.numel() for w in network.parameters()) == lstm + 65 * 350 + 351 * 400 + 401 * 18


def test_a_network_is_fitted_for_as_many_steps_as_the_dissertations_code_makes(pair, monkeypatch):
    monkeypatch.setattr(window_model, "TEXT_STEPS", 40)
    seen = {}
    monkeypatch.setattr("gaitdisc.models.training_settings.LEAST_STEPS", 1)
    monkeypatch.setattr("gaitdisc.models.trainer.descend", lambda *a: seen.update(settings=a[4]) or descend(*a))
    done = fit_reconstructor("shred-text", pair.what, pair.parts.fitted().rows(slice(0, 640)), pair.parts.checked())
    kept = seen["settings"]
    assert (done.n_fitted, kept.epochs, kept.patience, kept.batch, kept.learning_rate) == (640, 4, 160, 64, 1e-3)
    assert done(pair.parts.tested()).shape == pair.parts.tested().y.shape


@pytest.mark.parametrize("wanted", ["auto", "cpu", "cuda"])
def test_ridge_regression_takes_the_cpu_whatever_is_wanted(pair, wanted):
    assert fitting_device(("linear", "delay ridge", "fourier ridge"), wanted) == "cpu"
    done = fit_reconstructor("linear", pair.what, pair.parts.fitted(), pair.parts.checked(), device=wanted)
    assert done.device == "cpu"


def test_a_network_takes_the_gpu_where_there_is_one():
    import torch

    assert fitting_device(tuple(KINDS), "cpu") == "cpu"
    assert fitting_device(tuple(KINDS), "auto") == ("cuda" if torch.cuda.is_available() else "cpu")
    with pytest.raises(TrainingError, match=r"requested device.*'gpu'.*'auto'"):
        fitting_device(("linear",), "gpu")


@pytest.mark.parametrize("kind", ["shred", "shred-text"])
def test_the_latent_state_decoded_is_what_the_model_estimates(pair, untrained, kind):
    done, windows = untrained(kind), pair.parts.tested()
    latent = latent_states(done, windows)
    assert latent.shape == (len(windows), 64)
    np.testing.assert_allclose(done.model.decoded(latent), done(windows), rtol=1e-5, atol=1e-5)


def test_a_model_without_a_recurrent_network_has_no_latent_state(pair):
    ridge = fit_reconstructor("delay ridge", pair.what, pair.parts.fitted(), pair.parts.checked())
    with pytest.raises(TrainingError, match="the model is 'delay ridge'"):
        latent_states(ridge, pair.parts.tested())
