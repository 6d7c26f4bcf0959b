"""A forced isotropic flow against its own laws."""

import ch5_turbulence
import numpy as np
import pytest
from chapter5 import turbulence
from chapter5.turbulence import (
    Box,
    FlowSettings,
    Stepper,
    energy_spectrum,
    first_velocity,
    flow_numbers,
    record_turbulence,
)
from hypothesis import given, settings
from hypothesis import strategies as st

from gaitdisc.errors import ReadError, SamplingError, SchemaError, ShapeError

SMALL = FlowSettings(nodes=16, cut=12, snapshots=30, every=2, spin_up=40)


def test_a_record_is_the_cut_of_the_velocity(tmp_path):
    seen = []
    field, numbers = record_turbulence(SMALL, tmp_path, seen.append)
    assert (field.values.shape, field.quantities, field.time_unit) == ((30, 12**3, 1), ("u",), "s")
    assert field.time[1] == pytest.approx(2 * SMALL.dt)
    assert field.axes[0].coordinates[1] == pytest.approx(2 * np.pi / 16)
    assert numbers["snapshot"].tolist() == [0, 10, 20]
    assert seen[-1] == 1
    assert all(np.diff(seen) >= 0)


def test_what_was_interrupted_goes_on_to_the_same_numbers(tmp_path, monkeypatch):
    whole, numbers = record_turbulence(SMALL, tmp_path / "whole")
    monkeypatch.setattr(turbulence, "KEPT_EVERY", 7)

    def stop(fraction):
        if fraction > 0.8:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        record_turbulence(SMALL, tmp_path / "cut", stop)
    again, numbers_again = record_turbulence(SMALL, tmp_path / "cut")
    np.testing.assert_array_equal(again.values, whole.values)
    assert numbers_again.equals(numbers)


def test_what_is_there_is_not_computed_again(tmp_path, monkeypatch):
    first, _ = record_turbulence(SMALL, tmp_path)
    monkeypatch.setattr(turbulence.Stepper, "step", None)
    np.testing.assert_array_equal(record_turbulence(SMALL, tmp_path)[0].values, first.values)


def test_a_folder_of_another_flow_is_refused(tmp_path):
    record_turbulence(SMALL, tmp_path / "flow")
    with pytest.raises(SchemaError, match=r"flow.*snapshots 30, seed 0"):
        record_turbulence(FlowSettings(nodes=16, cut=12, snapshots=31, spin_up=40, seed=1), tmp_path / "flow")
    (tmp_path / "flow" / "state.npz").write_bytes(b"x")
    with pytest.raises(ReadError, match=r"state.npz.*Delete the folder"):
        record_turbulence(SMALL, tmp_path / "flow")
    (tmp_path / "flow" / "flow.json").write_text("{")
    with pytest.raises(ReadError, match=r"flow.json.*Delete the folder"):
        record_turbulence(SMALL, tmp_path / "flow")


def test_settings_that_keep_nothing_and_too_coarse_a_box_are_refused():
    with pytest.raises(ShapeError, match=r"2 to 16 nodes.*17 nodes"):
        FlowSettings(nodes=16, cut=17)
    with pytest.raises(ShapeError, match=r"8 or more.*33"):
        Box(33)


def test_the_flow_is_resolved_and_its_power_is_dissipated_in_the_mean(tmp_path):
    """32 nodes, two turnovers after the spin-up: dissipation equals input, and the spectrum falls throughout."""
    settings = FlowSettings(nodes=32, cut=4, snapshots=110, spin_up=350)
    _, numbers = record_turbulence(settings, tmp_path)
    mean = numbers.mean()
    assert mean["dissipation"] == pytest.approx(settings.power, rel=0.15)
    assert mean["kmax_eta"] == pytest.approx(1.3, rel=0.1)
    assert 15 < mean["re_lambda"] < 30
    spectrum = mean[[f"e_{k}" for k in range(1, 11)]].to_numpy()
    assert (np.diff(spectrum) < 0).all()
    assert spectrum[0] / spectrum[-1] > 1e3


def test_the_first_velocity_has_no_divergence():
    box = Box(16)
    u = first_velocity(box, 1.0, 5)
    assert np.abs((box.k * u).sum(axis=0)).max() < 1e-5


BOX = Box(16)


@given(st.integers(0, 2**31))
@settings(max_examples=10, deadline=None)
def test_modes_and_nodes_are_one_field_and_energy_is_its_mean_square(seed):
    velocity = np.random.default_rng(seed).normal(size=(3, 16, 16, 16))
    modes = BOX.to_modes(velocity)
    np.testing.assert_allclose(BOX.to_nodes(modes), velocity, atol=1e-12)
    assert BOX.energy(modes).sum() == pytest.approx(0.5 * (velocity**2).sum(axis=0).mean(), rel=1e-6)


@given(st.integers(0, 2**31))
@settings(max_examples=10, deadline=None)
def test_what_is_projected_has_no_divergence_and_is_not_projected_again(seed):
    modes = BOX.to_modes(np.random.default_rng(seed).normal(size=(3, 16, 16, 16)))
    once = BOX.projected(modes)
    assert np.abs((BOX.k * once).sum(axis=0)).max() < 1e-6 * np.abs(once).max() * BOX.nodes
    np.testing.assert_allclose(BOX.projected(once), once, atol=1e-7)
    assert not once[:, ~BOX.kept].any()


def test_a_gradient_is_taken_away_whole():
    x = 2 * np.pi * np.arange(16) / 16
    gradient = np.zeros((3, 16, 16, 16))
    gradient[0] = np.cos(2 * x)[:, None, None]  # of sin(2 x) / 2
    assert np.abs(BOX.projected(BOX.to_modes(gradient))).max() < 1e-12


def test_two_thirds_of_the_wavenumbers_are_kept():
    assert [Box(n).largest for n in (32, 48, 64)] == [10, 15, 21]
    assert 3 * BOX.largest < BOX.nodes  # a product of three kept modes cannot fold back onto a kept one


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


@pytest.mark.slow
def test_one_sensor_does_not_tell_a_turbulent_flow_ahead_of_time(tmp_path):
    result = ch5_turbulence.run(quick=True, folder=tmp_path, models=3)
    r2 = {
        split: np.median([c.r2 for c in result.cells if (c.split, c.model) == (split, "delay ridge")])
        for split in ch5_turbulence.SPLITS
    }
    assert r2["temporal"] < r2[ch5_turbulence.RANDOM] < 0.9
    ceiling = {c.split: c.r2 for c in result.cells if c.model == ch5_turbulence.CEILING}
    assert ceiling[ch5_turbulence.RANDOM] > 0.95
    assert ceiling["temporal"] > r2["temporal"]
    assert (tmp_path / "figures" / "boxes.png").exists()
