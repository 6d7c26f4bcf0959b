from dataclasses import replace

import numpy as np
import pytest

from gaitdisc.errors import ChannelError, StrideError
from gaitdisc.ingest.study import HeldOut, Models, Quality
from gaitdisc.processing.process import is_raw, processed, quality_findings
from gaitdisc.recording import Recording


def with_values(trial, key, values):
    return replace(trial, streams={**trial.streams, key: trial.stream(key).with_values(values)})


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
    with pytest.raises(ChannelError, match=r"ankle_ange_r.*it; the nearest.*'ankle_angle_r'"):
        processed(trial, study.model_copy(update={"models": models}))


def test_a_dead_muscle_is_refused_by_name(trial, study):
    values = np.array(trial.stream("emg").values)
    values[:, trial.stream("emg").index("emg_sol_r")] *= 1e-9
    models = Models(emg=("emg_sol_r", "emg_ta_r"), outputs=("ankle_angle_r",))
    with pytest.raises(ChannelError, match=r"EMG.*emg_sol_r.*emg_sol_r"):
        processed(with_values(trial, "emg", values), study.model_copy(update={"models": models}))


def test_swapped_sides_are_refused(trial, study):
    kinematics = trial.stream("kinematics")
    other = {"r": "l", "l": "r"}
    columns = [kinematics.index(f"{name[:-1]}{other[name[-1]]}") for name in kinematics.names]
    with pytest.raises(StrideError, match="swap"):
        processed(with_values(trial, "kinematics", kinematics.values[:, columns]), study)


def test_a_plateau_is_found_and_its_accelerations_are_left_out(trial, study):
    values = np.array(trial.stream("kinematics").values)
    hip = trial.stream("kinematics").index("hip_flexion_r")
    values[:, hip] = np.maximum(values[:, hip], -8.0)
    walk = processed(with_values(trial, "kinematics", values), study)
    assert any(f.kind == "plateau" and f.channel == "hip_flexion_r" for f in walk.findings)
    assert not walk.trajectory.usable[values[:, hip] == -8.0, hip].any()


@pytest.mark.parametrize(("samples", "kept"), [(8, True), (15, True), (40, False)])
def test_gaps_are_bridged_by_spline_then_by_the_mean_stride_then_not(trial, study, samples, kept):
    values = np.array(trial.stream("kinematics").values)
    hip = trial.stream("kinematics").index("hip_rotation_r")
    true = values[2000 : 2000 + samples, hip].copy()
    values[2000 : 2000 + samples, hip] = np.nan
    walk = processed(with_values(trial, "kinematics", values), study)
    assert any(d.start < 20.0 and d.end > 20.0 for d in walk.strides["r"].dropped) != kept
    assert not walk.trajectory.usable[2000 : 2000 + samples, hip].any()
    if kept:
        np.testing.assert_allclose(walk.state.values[2000 : 2000 + samples, hip], true, atol=1.0)


def test_a_late_change_is_refused_or_told_as_the_study_wants(trial, study):
    values = np.array(trial.stream("kinematics").values)
    values[3000:] += np.where(np.arange(values.shape[1]) % 2, 6.0, -6.0)
    changed = with_values(trial, "kinematics", values)
    with pytest.raises(StrideError, match='late_change = "report"'):
        processed(changed, study)
    told = processed(changed, study.model_copy(update={"quality": Quality(late_change="report")}))
    assert any(finding.kind == "late change" for finding in told.findings)


def test_quality_looks_at_what_is_asked_for(trial):
    values = np.array(trial.stream("kinematics").values)
    values[1000:1030, 0] = np.nan
    gappy = with_values(trial, "kinematics", values)
    name = trial.stream("kinematics").names[0]
    assert [f.channel for f in quality_findings(gappy) if f.kind == "gap"] == [name]
    assert not [f for f in quality_findings(gappy, angles=("knee_angle_l",)) if f.kind == "gap"]


def test_clean_walking_has_no_warning(trial, study):
    walk = processed(trial, study)
    assert [f.line() for f in walk.findings if f.severity != "note" and f.kind != "outlying stride"] == []


def test_held_out_default_is_the_dissertation(study):
    assert HeldOut().length_s(240.0) == 30.0
    assert isinstance(study.held_out, HeldOut)


def test_clocks_that_do_not_meet(trial, study):
    emg = trial.stream("emg")
    later = Recording(emg.time + 1000.0, emg.values, emg.channels)
    models = Models(emg=("emg_sol_r",), outputs=("ankle_angle_r",))
    with pytest.raises(ValueError, match="span of time in common"):
        processed(replace(trial, streams={**trial.streams, "emg": later}), study.model_copy(update={"models": models}))
