import numpy as np
import pytest
from chapter5.turbulence import Box, Stepper, first_velocity, flow_numbers

from gaitdisc.errors import SamplingError

BOX = Box(16)
X = 2 * np.pi * np.arange(16) / 16
ZERO = np.zeros((16, 16, 16))


def after(u, stepper, steps):
    for _ in range(steps):
        u = stepper.step(u)
    return u


def test_taylor_green_decays_at_the_exact_viscous_rate():
    """Taylor and Green 1937: in two dimensions advection is a gradient, and the velocity decays by exp(-2 nu t)."""
    x, y = X[:, None, None], X[None, :, None]
    vortex = np.stack([np.sin(x) * np.cos(y) + ZERO, -np.cos(x) * np.sin(y) + ZERO, ZERO])
    decayed = BOX.to_nodes(after(BOX.to_modes(vortex), Stepper(BOX, 0.1, 0.0, 0.02), 50))
    np.testing.assert_allclose(decayed, vortex * np.exp(-2 * 0.1 * 1.0), atol=1e-5)


def test_a_shear_mode_decays_at_its_own_rate():
    shear = np.stack([ZERO, np.sin(3 * X)[:, None, None] + ZERO, ZERO])
    decayed = BOX.to_nodes(after(BOX.to_modes(shear), Stepper(BOX, 0.05, 0.0, 0.1), 20))
    np.testing.assert_allclose(decayed, shear * np.exp(-9 * 0.05 * 2.0), atol=1e-5)


def test_without_viscosity_and_force_energy_stays_to_second_order_of_the_step():
    u = first_velocity(BOX, 0.5, 1).astype(np.complex128)
    lost = []
    for dt, steps in ((0.04, 10), (0.02, 20)):
        lost.append(abs(float(BOX.energy(after(u, Stepper(BOX, 0.0, 0.0, dt), steps)).astype(float).sum()) - 0.5))
    assert lost[0] < 1e-4
    assert lost[1] < lost[0] / 4


def test_the_force_gives_its_power_and_viscosity_takes_the_dissipation():
    stepper, u = Stepper(BOX, 0.05, 0.2, 0.01), first_velocity(BOX, 0.5, 2)
    numbers = [flow_numbers(BOX, u, 0.05)]
    for _ in range(100):
        u = stepper.step(u)
        numbers.append(flow_numbers(BOX, u, 0.05))
    dissipated = np.trapezoid([n.dissipation for n in numbers], dx=0.01)
    assert numbers[-1].energy - numbers[0].energy == pytest.approx(0.2 * 1.0 - dissipated, abs=2e-3 * dissipated)


def test_a_forced_flow_stays_free_of_divergence():
    u = after(first_velocity(BOX, 0.5, 3), Stepper(BOX, 0.05, 0.2, 0.02), 50)
    assert np.abs((BOX.k * u).sum(axis=0)).max() < 1e-5 * np.abs(u).max()


def test_too_long_a_step_is_refused():
    with np.errstate(all="ignore"), pytest.raises(SamplingError, match=r"steps of 50.*not finite"):
        after(first_velocity(BOX, 10.0, 0), Stepper(BOX, 0.001, 0.1, 50.0), 50)
