from __future__ import annotations

from dataclasses import replace

import pytest

from gaitdisc.ingest.reading import read_trial
from gaitdisc.processing.side_checks import side_findings
from gaitdisc.recording import Trial


@pytest.fixture(scope="module")
def belts(gait_data) -> Trial:
    return read_trial(gait_data / "treadmill_c3d_emg" / "walking_1.c3d")


def test_a_real_walk_on_two_belts_is_as_it_says(belts):
    assert side_findings(belts, {}) == []


def test_belts_whose_places_are_exchanged_are_named(belts):
    first, second = belts.surfaces
    swapped = (replace(first, corners=second.corners), replace(second, corners=first.corners))
    forces = {key: belts.stream(key) for key in ("markers", "forces")}
    (finding,) = side_findings(replace(belts, streams=forces, surfaces=swapped), {})
    assert finding.kind == "swapped plates"
    assert "plate_1 and plate_2 are swapped" in finding.what


def test_forces_that_bear_the_other_foots_name_are_found_in_a_published_walk(gait_data):
    folder = gait_data / "opensim_walks" / "mrs_emg_walking"
    trial = read_trial([folder / "IK_gait.mot", folder / "GRF_gait.mot"], crop_s=(1.06, 3.23))
    (finding,) = side_findings(trial, {})
    assert "left and right are swapped in the forces or in the angles" in finding.what
    moments = read_trial(folder / "ID_gait.sto").stream("moments")  # its authors' own, which know the feet
    left, named_right = moments["ankle_angle_l_moment"], trial.stream("forces")
    push_off = moments.time[left.argmin()]
    assert named_right["ground_force_r_vy"][abs(named_right.time - push_off).argmin()] > 500
