import numpy as np
import pytest
from manufactured_field import travelling_wave

from gaitdisc.errors import TrainingError
from gaitdisc.sensing.field_task import FieldTask
from gaitdisc.sensing.latent_size import latent_sizes, latent_states
from gaitdisc.sensing.reconstructor import fit_reconstructor
from gaitdisc.sensing.routes import fixed
from gaitdisc.sensing.windows import Lags


@pytest.mark.parametrize("kind", ["shred", "shred-text"])
def test_the_latent_state_decoded_is_what_the_model_estimates(pair, untrained, kind):
    done, windows = untrained(kind), pair.parts.judged()
    latent = latent_states(done, windows)
    assert latent.shape == (len(windows), 64)
    np.testing.assert_allclose(done.model.decoded(latent), done(windows), rtol=1e-5, atol=1e-5)


def test_a_model_without_a_recurrent_network_has_no_latent_state(pair):
    ridge = fit_reconstructor("delay ridge", pair.what, pair.parts.fitted(), pair.parts.checked())
    with pytest.raises(TrainingError, match="the model is 'delay ridge', which has none"):
        latent_states(ridge, pair.parts.judged())


@pytest.mark.slow
def test_four_modes_need_more_than_one_node(monkeypatch):
    monkeypatch.setattr("gaitdisc.networks.schedule.epochs_of", lambda *_: 100)  # of two steps each
    wave = travelling_wave(200)
    found = latent_sizes(wave, fixed(wave, [30]), FieldTask("wave", Lags(3, 6), energy=0.999), (1, 8), epochs=5)
    assert found["nodes"].tolist() == [1, 8]
    assert found["r2"].iloc[1] > found["r2"].iloc[0]
    assert found["energy_left"].iloc[0] > 0.05
    assert found["energy_left"].iloc[1] < 1e-6
