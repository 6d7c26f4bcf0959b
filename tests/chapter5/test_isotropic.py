import numpy as np
import pytest
from chapter5 import turbulence
from chapter5.turbulence import Box, FlowSettings, first_velocity, record_turbulence

from gaitdisc.errors import ReadError, SchemaError, ShapeError

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


def test_settings_that_keep_nothing_are_refused():
    with pytest.raises(ShapeError, match=r"2 to 16 nodes.*17 nodes"):
        FlowSettings(nodes=16, cut=17)


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
