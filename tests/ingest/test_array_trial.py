"""A trial out of variables: channels, units and clocks that the study names."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.io import savemat

from gaitdisc.errors import GaitdiscError
from gaitdisc.ingest.array_file import read_arrays
from gaitdisc.ingest.reading import read_planned_trial, read_trial
from gaitdisc.ingest.study_file import load_study

T = np.arange(200) / 100
KNEE = np.column_stack([30 + 25 * np.sin(6 * T), 2 * np.cos(6 * T), 0 * T])


@pytest.fixture(scope="module")
def visual3d(tmp_path_factory):
    """As Visual3D exports it: a cell array a signal, a cell a trial, and rates in cells."""
    path = tmp_path_factory.mktemp("v3d") / "export.mat"

    def cells(*arrays):
        held = np.empty((len(arrays), 1), dtype=object)
        held[:, 0] = arrays
        return held

    heel = np.column_stack([1.2 * T, 0 * T, 0.05 + 0 * T, 0.001 + 0 * T])
    savemat(
        path,
        {
            "RKNEE_ANGLE": cells(KNEE, KNEE + 5),
            "RHEE": cells(heel, 2 * heel),
            "FP1": cells(np.tile([0.0, 0, 700], (2000, 1)), np.tile([0.0, 0, 600], (2000, 1))),
            "FRAME_RATE": cells(np.array([[100.0]]), np.array([[100.0]])),
            "ANALOG_RATE": cells(np.array([[1000.0]]), np.array([[1000.0]])),
            "TIME": cells(T[:, None], T[:, None] + 1),
            "FILE_NAME": cells("one.c3d", "two.c3d"),
        },
    )
    return path


CHANNELS = {
    "RKNEE_ANGLE(:,1)": "knee_angle_r [deg] @ FRAME_RATE",
    "RHEE": "RHEE [m] @ 100 Hz",
    "FP1(:,3)": "ground_force_r_vy [N] @ ANALOG_RATE",
}


def test_a_trial_of_visual3d(visual3d):
    trial = read_arrays(visual3d, CHANNELS, "2")
    assert trial.name == "export"
    np.testing.assert_allclose(trial.stream("kinematics")["knee_angle_r"], KNEE[:, 0] + 5)
    assert trial.stream("markers").names == ("RHEE.x", "RHEE.y", "RHEE.z")
    np.testing.assert_allclose(trial.stream("markers")["RHEE.x"], 2.4 * T)
    assert (trial.stream("forces").rate_hz, trial.stream("markers").rate_hz) == (1000.0, 100.0)
    assert trial.stream("forces").source.sha256 and trial.stream("forces").source.reader == "mat"


def test_times_may_be_a_variable(visual3d):
    trial = read_arrays(visual3d, {"RKNEE_ANGLE(:,1)": "knee_angle_r @ TIME"}, "2")
    np.testing.assert_allclose(trial.stream("kinematics").time, T + 1)


@pytest.mark.parametrize(
    ("channels", "said"),
    [
        ({}, r"needs the study's \[channels\] to say which variable .* export.mat holds RKNEE_ANGLE, RHEE, FP1"),
        ({"RKNEE_ANGLE": "knee_angle_r @ 100 Hz"}, r"needs one column for 'knee_angle_r', .* it is 200 x 3"),
        ({"RHEE": "RHEE @ 100 Hz"}, r"the marker 'RHEE' of 'RHEE' needs a unit"),
        ({"RHEE(:,1)": "heel [furlong] @ 100 Hz"}, r"needs a unit of the closed list; found 'furlong'"),
        ({"FP1(:,3)": "ground_force_r_vy [N] @ TIME"}, r"it has 2000 samples, 'TIME' has 200 times"),
        ({"FP1(:,3)": "ground_force_r_vy [N] @ 0 Hz"}, r"needs a rate between 0.01 Hz and 1 MHz.* gives 0 Hz"),
        ({"FP1(:,3)": "ground_force_r_vy [N] @ FRAMERATE"}, r"at 'FRAMERATE'; it has .*the nearest is 'FRAME_RATE'"),
        ({"RKNEE_ANGLE(:,1)": "knee_angle_r [rad] @ 100 Hz"}, r"rad"),
        (
            {"RHEE(:,1)": "a [V] @ 100 Hz", "RHEE(:,2)": "b [V] @ 50 Hz"},
            r"all signals must share one time base; a has 200 samples at 100 Hz, b 200 at 50",
        ),
    ],
)
def test_what_does_not_fit_is_said(visual3d, channels, said):
    with pytest.raises(GaitdiscError, match=said):
        read_arrays(visual3d, channels, "1")


def test_a_real_published_file_by_a_study(gait_data, tmp_path):
    """An .npz with a table a trial: against the .mot of the same trial."""
    names = np.load(gait_data / "treadmill_walk_ik" / "addbio_expert3_ik.npz")["columns"].tolist()
    wanted = ("knee_angle_r", "hip_flexion_l", "pelvis_tx")
    lines = [f'"*(:,{names.index(name) + 1})" = "{name} @ rate_hz"' for name in wanted]
    (tmp_path / "study.toml").write_text(
        "[conditions]\nnominal = 'walk'\n[channels]\n" + "\n".join(lines) + "\n[[participants]]\nid = 'P01'\n"
        "[[participants.trials]]\ncondition = 'walk'\npart = 'S01DE504'\n"
        f"files = ['{gait_data / 'treadmill_walk_ik' / 'addbio_expert3_ik.npz'}']\n"
    )
    study = load_study(tmp_path)
    found = read_planned_trial(study, study.participants[0], study.participants[0].trials[0]).stream("kinematics")
    same = read_trial(gait_data / "treadmill_walk_ik" / "S01DE504_ik.mot").stream("kinematics")
    assert found.names == wanted and found.rate_hz == 100.0
    for name in wanted:
        np.testing.assert_allclose(found[name], same[name], atol=1e-4)
