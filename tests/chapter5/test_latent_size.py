import pytest
from chapter5.reconstruct_field import FieldTask, latent_sizes
from chapter5.routes import fixed
from manufactured_field import travelling_wave

from gaitdisc.reconstruction.windows import Lags


@pytest.mark.slow
def test_four_modes_need_more_than_one_node(monkeypatch):
    monkeypatch.setattr("gaitdisc.models.training_settings.epochs_of", lambda *_: 100)  # of two steps each
    wave = travelling_wave(200)
    found = latent_sizes(wave, fixed(wave, [30]), FieldTask("wave", Lags(3, 6), energy=0.999), (1, 8), epochs=5)
    assert found["nodes"].tolist() == [1, 8]
    assert found["r2"].iloc[1] > found["r2"].iloc[0]
    assert found["energy_left"].iloc[0] > 0.05
    assert found["energy_left"].iloc[1] < 1e-6
