import numpy as np
import pytest
from chapter5.turbulence import Box, energy_spectrum, first_velocity, flow_numbers

BOX = Box(16)


def test_the_spectrum_adds_up_to_the_energy():
    u = first_velocity(BOX, 0.7, 0)
    assert energy_spectrum(BOX, u).sum() == pytest.approx(0.7, rel=1e-5)


def test_numbers_of_a_single_shear_mode_are_known():
    x = 2 * np.pi * np.arange(16) / 16
    shear = np.zeros((3, 16, 16, 16))
    shear[1] = np.sin(2 * x)[:, None, None]
    found = flow_numbers(BOX, BOX.to_modes(shear), 0.1)
    assert found.energy == pytest.approx(0.25)
    assert found.dissipation == pytest.approx(2 * 0.1 * 4 * 0.25)  # 2 nu k^2 E
    speed = np.sqrt(2 * 0.25 / 3)
    assert found.re_lambda == pytest.approx(speed**2 * np.sqrt(15 / (0.1 * 0.2)))
    assert found.kmax_eta == pytest.approx(5 * (0.1**3 / 0.2) ** 0.25)
    assert found.integral_length == pytest.approx(np.pi / (2 * speed**2) * 0.25 / 2)
    assert found.turnover == pytest.approx(found.integral_length / speed)
