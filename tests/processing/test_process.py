"""From files of a trial to a walk: one time base, filters, and the null that they leave."""

from dataclasses import replace

import numpy as np
import pytest
from changed_trials import with_column, with_stream

from gaitdisc.channel import Channel
from gaitdisc.errors import ChannelError, StrideError
from gaitdisc.ingest.study import Filters, HeldOut, Models, Quality
from gaitdisc.processing.process import filter_null, is_raw, make_filter_null, on_one_base, processed, quality_findings
from gaitdisc.recording import Recording, Trial


def with_values(trial, key, values):
    return with_stream(trial, key, trial.stream(key).with_values(values))


def test_a_walk_is_filtered_cut_and_differentiated(trial, study):
    walk = processed(trial, study)
    assert walk.state.names == study.models.angles
    assert len(walk.strides["r"]) in (35, 36, 37)
    knee = walk.trajectory.columns(["knee_angle_r"])[0]
    measured = np.gradient(np.gradient(walk.state["knee_angle_r"], 0.01), 0.01)
    inside = slice(200, -200)
    assert np.corrcoef(walk.trajectory.xddot[inside, knee], measured[inside])[0, 1] > 0.999
    assert np.nanmax(walk.trajectory.phi) < 100


def test_plates_under_a_light_body_count_as_loaded_earlier(trial, study):
    forces = trial.stream("forces")
    light = with_values(trial, "forces", forces.values * 25.0 / (np.nanmax(forces.values) / 9.81))
    by_force = study.model_copy(update={"strides": study.strides.model_copy(update={"detector": "force"})})
    usual, own = processed(light, by_force), processed(light, by_force, body_weight_n=25.0 * 9.81)
    earlier = usual.strides["r"].start - own.strides["r"].start
    assert (earlier > 0).all() and earlier.max() < 0.02
    said = [next(one.what for one in walk.findings if one.kind == "detector") for walk in (usual, own)]
    assert "above 50 N" in said[0] and "above 25 N" in said[1]


def test_emg_comes_along_on_the_time_base_of_the_angles(trial, study):
    models = Models(emg=("emg_sol_r",), outputs=("ankle_angle_r", "emg_sol_r"))
    walk = processed(trial, study.model_copy(update={"models": models}))
    assert walk.state.rate_hz == 100.0
    assert walk.state.channels[-1].quantity == "emg"
    peaks = np.nanargmax(np.nanmean(walk.strides["r"].normalised(walk.state.selected(["emg_sol_r"])), axis=0))
    assert 30 <= peaks <= 46  # the burst's middle is at 38 %


def test_an_envelope_is_not_rectified_again(trial, study):
    envelope = with_values(trial, "emg", np.abs(trial.stream("emg").values) + 1e-6)
    models = Models(emg=("emg_sol_r",), outputs=("ankle_angle_r",))
    walk = processed(envelope, study.model_copy(update={"models": models}))
    assert not is_raw(envelope.stream("emg"))
    assert np.nanmean(walk.state["emg_sol_r"]) == pytest.approx(envelope.stream("emg")["emg_sol_r"].mean(), rel=0.02)


def test_a_missing_angle_names_the_nearest(trial, study):
    models = Models(angles=("hip_flexion_r", "ankle_ange_r"), outputs=("hip_flexion_r",))
    with pytest.raises(ChannelError, match=r"10 channels, but not ankle_ange_r; the nearest.*'ankle_angle_r'"):
        processed(trial, study.model_copy(update={"models": models}))


def test_a_dead_muscle_is_refused_by_name(trial, study):
    emg = trial.stream("emg")
    dead = with_column(emg, "emg_sol_r", 1e-9 * emg["emg_sol_r"])
    models = Models(emg=("emg_sol_r", "emg_ta_r"), outputs=("ankle_angle_r",))
    with pytest.raises(ChannelError, match=r"EMG.*emg_sol_r.*emg_sol_r"):
        processed(with_stream(trial, "emg", dead), study.model_copy(update={"models": models}))


def test_swapped_sides_are_refused(trial, study):
    kinematics = trial.stream("kinematics")
    other = {"r": "l", "l": "r"}
    columns = [kinematics.index(f"{name[:-1]}{other[name[-1]]}") for name in kinematics.names]
    with pytest.raises(StrideError, match="exchanged"):
        processed(with_values(trial, "kinematics", kinematics.values[:, columns]), study)


def test_a_plateau_is_found_and_its_accelerations_are_left_out(trial, study):
    free = trial.stream("kinematics")
    held = with_column(free, "hip_flexion_r", np.maximum(free["hip_flexion_r"], -8.0))
    walk = processed(with_stream(trial, "kinematics", held), study)
    assert any(f.kind == "plateau" and f.channel == "hip_flexion_r" for f in walk.findings)
    assert not walk.trajectory.usable[held["hip_flexion_r"] == -8.0, held.index("hip_flexion_r")].any()


@pytest.mark.parametrize(("samples", "kept"), [(8, True), (15, True), (40, False)])
def test_gaps_are_bridged_by_spline_then_by_the_mean_stride_then_not(trial, study, samples, kept):
    whole, rows = trial.stream("kinematics"), slice(2000, 2000 + samples)
    hip = whole.index("hip_rotation_r")
    walk = processed(with_stream(trial, "kinematics", with_column(whole, "hip_rotation_r", np.nan, rows)), study)
    assert any(d.start < 20.0 and d.end > 20.0 for d in walk.strides["r"].dropped) != kept
    assert not walk.trajectory.usable[rows, hip].any()
    if kept:
        np.testing.assert_allclose(walk.state.values[rows, hip], whole.values[rows, hip], atol=1.0)


def test_a_late_change_is_refused_or_told_as_the_study_wants(trial, study):
    values = np.array(trial.stream("kinematics").values)
    values[3000:] += np.where(np.arange(values.shape[1]) % 2, 6.0, -6.0)
    changed = with_values(trial, "kinematics", values)
    with pytest.raises(StrideError, match='late_change = "report"'):
        processed(changed, study)
    told = processed(changed, study.model_copy(update={"quality": Quality(late_change="report")}))
    assert any(finding.kind == "late change" for finding in told.findings)


def test_quality_looks_at_what_is_asked_for(trial):
    name = trial.stream("kinematics").names[0]
    gappy = with_stream(trial, "kinematics", with_column(trial.stream("kinematics"), name, np.nan, slice(1000, 1030)))
    assert [f.channel for f in quality_findings(gappy) if f.kind == "gap"] == [name]
    assert not [f for f in quality_findings(gappy, angles=("knee_angle_l",)) if f.kind == "gap"]


def test_clean_walking_has_no_warning(trial, study):
    walk = processed(trial, study)
    assert [f.line() for f in walk.findings if f.severity != "note" and f.kind != "outlying stride"] == []


def test_held_out_default_is_the_dissertation(study):
    assert 240.0 * HeldOut().share == 30.0
    assert isinstance(study.held_out, HeldOut)


def test_clocks_that_do_not_meet(trial, study):
    emg = trial.stream("emg")
    later = Recording(emg.time + 1000.0, emg.values, emg.channels)
    models = Models(emg=("emg_sol_r",), outputs=("ankle_angle_r",))
    with pytest.raises(ValueError, match="overlap in time"):
        processed(with_stream(trial, "emg", later), study.model_copy(update={"models": models}))


def test_summary_keeps_every_stride_and_cuts_each_side_by_its_own_foot(trial, study):
    walk = processed(trial, study)
    summary = walk.summary()
    assert summary.counted() == {side: len(strides) for side, strides in walk.strides.items()}
    right, left = (summary.curves[:, :, walk.state.index(f"knee_angle_{side}")] for side in "rl")
    assert np.isfinite(right).all(axis=1).sum() >= len(walk.strides["r"]) - 1
    apart = np.abs(np.nanmean(right, axis=0) - np.nanmean(left, axis=0)).max()
    assert apart < 3.0  # the same habit, half a stride later; by the other foot's strides it would be 60 deg apart


def test_summary_says_every_dropped_stride(trial, study):
    longest = float(np.percentile(processed(trial, study).strides["r"].duration_s, 75))
    rules = study.strides.model_copy(update={"max_s": longest})
    summary = processed(trial, study.model_copy(update={"strides": rules})).summary()
    dropped = summary.strides[~summary.strides["kept"]]
    assert len(dropped) > 5
    assert dropped["reason"].str.contains("longer than").all()


def test_streams_meet_on_the_slow_base(trial):
    both = on_one_base(trial, 100.0)
    assert both.rate_hz == 100.0
    assert len(both.names) == sum(len(stream.names) for stream in trial.streams.values())
    emg = both["emg_sol_r"][100:-100]
    assert emg.min() > -1e-5  # an envelope, not the raw signal


def test_what_is_too_fast_does_not_fold_into_the_result():
    time = np.arange(4000) / 1000
    force = Recording(time, np.sin(2 * np.pi * 97 * time)[:, None], (Channel("sync", "signal", "V"),))
    slow = on_one_base(Trial("walk", {"signals": force}), 100.0)  # unfiltered it would alias to 3 Hz
    assert np.abs(slow["sync"][50:-50]).max() < 0.01


def test_streams_that_are_asked_for(trial):
    assert on_one_base(trial, 100.0, ("forces",)).names == ("ground_force_r_vy", "ground_force_l_vy")
    with pytest.raises(ValueError, match="markers"):
        on_one_base(trial, 100.0, ("markers",))


KNEE = Channel("knee_angle_r", "angle", "deg", "r")
SOL = Channel("emg_sol_r", "emg", "V", "r")


def test_angles_agree_with_the_gain_of_the_filter():
    expected = 0.496  # by the filter's gain alone: tests/statistics/test_band_limit_null.py
    assert filter_null([KNEE], Filters(), 100.0)["knee_angle_r"] == pytest.approx(expected, abs=0.02)


def test_raw_emg_reaches_about_half_as_well():
    null = filter_null([KNEE, SOL], Filters(), 100.0, emg_hz=1000.0)
    assert null["emg_sol_r"] == pytest.approx(0.51, abs=0.03)
    assert filter_null([SOL], Filters(), 100.0)["emg_sol_r"] == pytest.approx(0.51, abs=0.03)


def test_the_rate_of_raw_emg_is_taken_from_the_walk(trial, study):
    study = study.model_copy(update={"models": study.models.model_copy(update={"emg": ("emg_sol_r",)})})
    emg = trial.stream("emg")
    envelopes = with_stream(trial, "emg", replace(emg, values=np.abs(emg.values)))
    for given, emg_hz in ((trial, emg.rate_hz), (envelopes, None)):
        walk = replace(processed(trial, study), trial=given)
        expected = filter_null(walk.state.channels, Filters(), walk.state.rate_hz, emg_hz)
        assert make_filter_null(walk, Filters()) == expected
        assert {"ankle_angle_r", "emg_sol_r"} <= set(expected)
