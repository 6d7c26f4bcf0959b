import numpy as np
import pytest

from gaitdisc.discrepancy.burgers import LENGTH, BurgersRates, burgers, places
from gaitdisc.discrepancy.record import Conditions, recorded
from gaitdisc.errors import SamplingError


def test_a_small_wave_decays_as_diffusion_says():
    wave = 1e-6 * np.sin(2 * np.pi * places() / LENGTH)
    found = BurgersRates(0.1).run(wave[None], 0.01, 200)[0, -1]
    assert np.allclose(found, wave * np.exp(-0.1 * (2 * np.pi / LENGTH) ** 2 * 2.0), atol=1e-11)


def test_the_sum_is_kept_without_the_hidden_term():
    system = burgers(0.1)
    known, true = (rates.run(system.start[None], 0.01, 100)[0, -1].sum() for rates in (system.known, system.true))
    assert known == pytest.approx(system.start.sum(), rel=1e-10)
    assert true < known


def test_the_first_pulse_of_the_text_cannot_run():
    with pytest.raises(SamplingError, match="leaves every bound at 0 s"):
        recorded(burgers(0.01, +1.0), Conditions(duration_s=2.0))
