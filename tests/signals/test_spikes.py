from __future__ import annotations

import numpy as np
import pytest

from gaitdisc.channel import Channel
from gaitdisc.ingest.reading import read_trial
from gaitdisc.recording import Recording, Strides
from gaitdisc.recording.strides import interpolated
from gaitdisc.signals.butterworth import lowpassed
from gaitdisc.signals.derivatives import differentiated
from gaitdisc.signals.spikes import spike_findings, spikes, without_spikes


def test_walks_without_spikes_have_none(made):
    for seed in range(5):
        walk, _ = made.walk(20, seed=seed)
        assert not spikes(walk).any()
        assert without_spikes(walk) is walk


@pytest.mark.parametrize("height", [35.0, -35.0, 1e6])
@pytest.mark.parametrize("samples", [1, 3])
def test_a_spike_is_found_within_the_range_of_a_joint_and_does_not_spread(made, height, samples):
    walk, _ = made.walk(20)
    values = walk.values.copy()
    values[700 : 700 + samples, 1] += height
    spiked = walk.with_values(values)
    assert np.flatnonzero(spikes(spiked).any(axis=1)).tolist() == list(range(700, 700 + samples))
    smooth = lowpassed(without_spikes(spiked))
    assert np.abs(smooth.values - lowpassed(walk).values).max() < 1.0
    assert np.asarray(smooth.suspect)[700 : 700 + samples, 1].all()
    [finding] = spike_findings(spiked)
    assert finding.channel == "knee_angle_r"
    assert "(frame 70" in finding.what
    assert finding.spans[0][0] == pytest.approx(7.0)


def test_a_step_and_a_force_are_no_spikes():
    t = np.arange(600) / 100
    step = np.where(t > 3, 40.0, 0.0) + 20 * np.sin(6 * t)
    blow = np.where((t > 3) & (t < 3.02), 900.0, 0.0) + np.sin(t)
    channels = (Channel("knee_angle_r", "angle", "deg", "r"), Channel("plate1", "vertical_force", "N"))
    assert not spikes(Recording(t, np.stack([step, blow], axis=1), channels)).any()


def test_what_is_not_finite_spreads_nowhere():
    """An infinite sample is a gap for filters, derivatives, resampling and stride curves alike."""
    t = np.arange(400) / 100
    x = 30 * np.sin(2 * np.pi * t)
    knee = Channel("knee_angle_r", "angle", "deg", "r")
    broken = x.copy()
    broken[200] = np.inf
    walk = Recording(t, broken[:, None], (knee,))
    assert np.abs(lowpassed(walk).values - lowpassed(walk.with_values(x[:, None])).values).max() < 0.05
    assert not np.isinf(differentiated(broken[:, None], 100.0)).any()
    assert np.isnan(differentiated(broken[:, None], 100.0)[198:203]).all()
    read = interpolated(t, broken[:, None], np.array([1.995, 2.0, 2.005]))
    assert np.isnan(read).all()
    curves = Strides(np.array([1.0, 2.5]), np.array([2.4, 3.5]), "r", "events").normalised(walk)
    assert not np.isinf(curves).any()
    assert np.isfinite(curves[1]).all()


def test_real_gait_angles_and_their_stumbles_have_hardly_any(gait_data, real):
    """Each treadmill walk holds a stumble, in which inverse kinematics loses an ankle for a frame at the most."""
    for file in sorted((gait_data / "exotendon_run").rglob("*.mot")):
        assert not spikes(real.mot(file).selected(real.legs)).any(), file.name
    marked = {
        name: int(spikes(walk.selected(real.legs)).sum())
        for name, walk in real.treadmill_walks(gait_data).items()
        if name != "S01DE503"
    }
    assert len(marked) == 12
    assert sum(marked.values()) <= 3, marked


def test_real_one_frame_flips_are_found(gait_data):
    """The tibia of HC030A22: 2, -48 and 179 deg in three frames of a turn."""
    file = gait_data / "young_straight_and_turn" / "HC030A" / "turn" / "HC030A22.c3d"
    kinematics = read_trial(file).stream("kinematics")
    found = {name for name, here in zip(kinematics.names, spikes(kinematics).any(axis=0), strict=True) if here}
    assert {"LTIBA.x", "LTIBA.y", "LTIBA.z", "LHFTFL.x"} <= found
    assert not [name for name in found if name.startswith(("hip_", "knee_", "ankle_"))]
