from dataclasses import replace

import numpy as np
import pytest
from changed_trials import with_column, with_stream
from made_joint import cut_record

from gaitdisc.channel import Channel, vocabulary
from gaitdisc.cohort.marker_trial import marker_trial
from gaitdisc.cohort.measurement import measure
from gaitdisc.cohort.person import draw_one
from gaitdisc.cohort.walk import walked
from gaitdisc.errors import ChannelError, SamplingError, UnitError
from gaitdisc.ingest.study import Conditions, Participant, PlannedTrial, Study
from gaitdisc.processing.joint_record import join_trials, joint_record
from gaitdisc.recording import Recording
from gaitdisc.signals.butterworth import low_pass
from gaitdisc.signals.derivatives import derivative

ONE = Participant(id="W01", trials=(PlannedTrial(condition="nominal", files=("a.mot",)),))
STUDY = Study(title="x", conditions=Conditions(nominal="nominal", device="exo"), participants=(ONE,))


@pytest.fixture(scope="module")
def walk():
    return walked(draw_one("W01", 1, "f"), None, 8.0, seed=3)


@pytest.fixture(scope="module")
def trial(walk):
    seen = measure(walk, "W01_nominal", "nominal")
    channel = vocabulary().named("ankle_angle_r_moment")
    moments = Recording(walk.slow_s, walk.moments[:, :1, 2], (channel,))
    markers = marker_trial(walk, "W01", "nominal").stream("markers")
    return replace(seen, streams={**seen.streams, "moments": moments, "markers": markers})


@pytest.fixture(scope="module")
def record(trial):
    return joint_record(trial, STUDY, "ankle_angle", None)


def test_a_joint_has_its_angle_moment_and_the_legs_muscles(walk, record):
    assert record.muscles == tuple(f"emg_{name}_r" for name in ("ham", "rf", "vas", "gas", "sol", "ta", "gmed"))
    inner = slice(50, -50)
    assert np.sqrt(np.mean((record.moment - walk.moments[:, 0, 2])[inner] ** 2)) < 3.0
    assert np.corrcoef(record.angle, record.seen)[0, 1] > 0.99
    assert (record.envelopes >= 0).all()


def test_strides_are_those_of_the_foot(walk, record):
    own = walk.phase[::10] % 1.0
    inside = record.stride >= 0
    apart = np.abs((record.phase - own + 0.5) % 1 - 0.5)[inside]
    assert np.median(apart) < 0.01
    assert inside.mean() > 0.7


def test_moments_per_kg_need_a_mass(trial, record):
    per_kg = trial.stream("moments")
    channel = Channel("ankle_angle_r_moment", "moment", "N m/kg", "r")
    lighter = with_stream(trial, "moments", replace(per_kg, values=per_kg.values / 60.0, channels=(channel,)))
    again = joint_record(lighter, STUDY, "ankle_angle", 60.0)
    np.testing.assert_allclose(again.moment, record.moment, atol=1e-9)
    with pytest.raises(UnitError, match=r"m/kg.*no.*mass_kg"):
        joint_record(lighter, STUDY, "ankle_angle", None)


def test_markers_of_the_foot_say_what_a_kilogram_there_would_add(record):
    """Standing, its weight at some centimetres before the ankle; in swing, what it takes to move it."""
    stands = (record.phase > 0.15) & (record.phase < 0.35)
    assert 0.1 < np.mean(record.per_kg[stands]) < 1.2
    assert np.nanstd(record.per_kg) > 0.2


def test_radians_that_say_degrees_are_refused(trial):
    angles = trial.stream("kinematics")
    small = with_stream(trial, "kinematics", replace(angles, values=np.radians(angles.values)))
    with pytest.raises(UnitError, match=r"more.*2 deg.*ankle_angle_r.*0.\d+ deg.*inDegrees=no"):
        joint_record(small, STUDY, "ankle_angle", None)


def test_a_leg_without_electrodes_is_refused(trial):
    bare = with_stream(trial, "emg", trial.stream("emg").selected(["emg_sol_l"]))
    with pytest.raises(ChannelError, match=r"EMG.*'r'.*no EMG of this side.*\[strides\]"):
        joint_record(bare, STUDY, "ankle_angle", None)


def test_an_electrode_that_is_an_envelope_already_is_taken_as_one_beside_raw_ones(trial, record):
    """As in the EMG of a published walk, where some muscles swing about zero and others never fall below it."""
    raw = trial.stream("emg")
    envelope = with_column(raw, "emg_sol_r", np.interp(raw.time, record.time, record.envelopes[:, 4]))
    mixed = joint_record(with_stream(trial, "emg", envelope), STUDY, "ankle_angle", None)
    np.testing.assert_allclose(mixed.envelopes[:, 3], record.envelopes[:, 3])
    assert np.corrcoef(mixed.envelopes[:, 4], record.envelopes[:, 4])[0, 1] > 0.98


def test_the_speed_of_push_off_is_kept_which_the_low_pass_of_angles_blunts(walk, record):
    """A muscle's force depends on it; the study's 6 Hz leave less of it than 12 Hz."""
    true = np.gradient(np.radians(walk.angles[:, 0, 4]), 0.01)
    inner = slice(50, -50)
    left = np.sqrt(np.mean((record.rate - true)[inner] ** 2))
    usual = low_pass(walk_angles(walk), STUDY.filters.kinematics_hz, STUDY.filters.order)
    smoother = np.radians(derivative(usual.values, 100.0, 1)[:, 0])
    assert left < 0.7 * np.sqrt(np.mean((smoother - true)[inner] ** 2))


def walk_angles(walk):
    return measure(walk, "W01_nominal", "nominal").stream("kinematics").selected(["ankle_angle_r"])


def test_short_trials_joined_are_one_record_with_a_sample_outside_between(record):
    part = cut_record(record, slice(100, 400), 0)
    count = int(part.stride.max()) + 1
    fewer = replace(part, muscles=part.muscles[1:], envelopes=part.envelopes[:, 1:])
    joined = join_trials([part, fewer, part])
    np.testing.assert_allclose(np.diff(joined.time), 0.01, rtol=1e-9)
    np.testing.assert_array_equal(np.flatnonzero(np.isnan(joined.angle)), [300, 601])
    assert joined.muscles == record.muscles[1:] and joined.envelopes.shape == (902, 6)
    np.testing.assert_array_equal(joined.stride[[300, 601]], -1)
    for trial in range(3):
        rows = slice(301 * trial, 301 * trial + 300)
        outside = part.stride < 0
        np.testing.assert_array_equal(joined.stride[rows], np.where(outside, -1, part.stride + count * trial))
        np.testing.assert_array_equal(joined.moment[rows], part.moment)
    assert joined.findings == part.findings
    assert join_trials([part]) is part


def test_trials_of_two_rates_are_not_joined(record):
    with pytest.raises(SamplingError, match=r"one rate.*W01.*50 Hz and 100 Hz"):
        join_trials([record, replace(record, time=record.time * 2)])
