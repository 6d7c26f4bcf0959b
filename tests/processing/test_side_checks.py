import re
from dataclasses import replace

import numpy as np
import pytest
from changed_trials import gained
from texts import says

from gaitdisc.errors import UnitError
from gaitdisc.ingest.reading import read_trial
from gaitdisc.processing.inspection import inspect_trial
from gaitdisc.processing.side_checks import check_weight, side_findings, standing_weight_n
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
    assert "the channels of plate_1 and plate_2 are swapped" in finding.what


def test_forces_that_bear_the_other_foots_name_are_found_in_a_published_walk(gait_data):
    folder = gait_data / "opensim_walks" / "mrs_emg_walking"
    trial = read_trial([folder / "IK_gait.mot", folder / "GRF_gait.mot"], crop_s=(1.06, 3.23))
    (finding,) = side_findings(trial, {})
    assert says(finding.what, "left", "right", "forces")
    moments = read_trial(folder / "ID_gait.sto").stream("moments")  # its authors' own, which know the feet
    left, named_right = moments["ankle_angle_l_moment"], trial.stream("forces")
    push_off = moments.time[left.argmin()]
    assert named_right["ground_force_r_vy"][abs(named_right.time - push_off).argmin()] > 500


@pytest.fixture(scope="module")
def plates(gait_data):
    """Straight walk and static trial of one person on two plates."""
    walk = gait_data / "young_straight_and_turn" / "HC030A" / "straight" / "HC030A05.c3d"
    return read_trial(walk), read_trial(gait_data / "young_static" / "HC030A" / "HC030A01.c3d")


def plate_words(trial, weight_n: float | None = 45.8 * 9.80665):
    return [one for one in side_findings(trial, {}, weight_n) if one.kind in ("plate step", "swapped plates")]


def test_a_plate_of_another_gain_contradicts_the_person_s_weight(plates):
    walk, _ = plates
    assert plate_words(walk) == [] == plate_words(gained(walk, 2, 1.3), None)
    for plate, gain, start in ((1, 1.3, 0.70), (2, 1.3, 0.18), (1, 0.77, 0.70), (2, 0.77, 0.18)):
        (said,) = plate_words(gained(walk, plate, gain))
        assert (said.severity, said.kind, said.file) == ("warning", "plate step", "HC030A05.c3d")
        shown = re.search(rf"plate_{plate} .* force is (\S+) .*449 N", said.what)
        assert shown and float(shown[1]) == pytest.approx(gain, abs=0.04)
        assert said.spans[0][0] == pytest.approx(start, abs=0.02)  # s


def test_an_edge_under_the_sole_explains_what_is_missing_and_never_too_much(plates):
    walk, _ = plates
    middles = [np.mean(one.corners, axis=0) for one in walk.surfaces]
    small = [
        replace(s, corners=m + [0.4, 0.4, 1] * (s.corners - m)) for s, m in zip(walk.surfaces, middles, strict=True)
    ]
    cut = replace(walk, surfaces=tuple(small))
    for gain, severity in ((0.77, "note"), (1.3, "warning")):
        (said,) = (one for one in plate_words(gained(cut, 2, gain)) if "plate_2" in one.what)
        assert said.severity == severity, said.what
        assert (says(said.what, "body weight", "449 N")) == (gain > 1)
        assert ("edge" in said.what) == (gain < 1)


def test_two_plates_that_are_exchanged_have_no_foot_under_their_force(plates):
    walk, static = plates
    first, second = walk.surfaces
    swapped = (replace(first, corners=second.corners), replace(second, corners=first.corners))
    moved = replace(walk, surfaces=swapped)
    said = plate_words(moved)
    assert sum(len(one.spans) for one in said) == 2 and all(one.severity == "warning" for one in said)
    assert any("swapped" in one.what or "cm from the nearest foot" in one.what for one in said)
    assert standing_weight_n(replace(static, surfaces=swapped)) is None  # nobody stands on the plate that is loaded


def test_a_static_trial_of_one_frame_is_looked_at_without_a_walk(plates, recwarn):
    starts = {key: (one, float(one.time[0])) for key, one in plates[1].streams.items()}
    static = replace(plates[1], streams={key: one.between(at, at + 0.009) for key, (one, at) in starts.items()})
    assert side_findings(static, {}) == []
    seen = inspect_trial(static, "static.c3d")
    assert seen.streams["markers"].endswith(", one frame") and says(seen.refusal, "a single frame")
    assert not recwarn.list


def test_who_stands_on_the_plates_is_weighed(plates):
    walk, static = plates
    weighed = standing_weight_n(static)
    assert weighed == pytest.approx(45.8 * 9.81, rel=0.005) and standing_weight_n(walk) is None
    assert check_weight(weighed, 45.8, "s.c3d") == [] == check_weight(None, 45.8, "s.c3d")
    (said,) = check_weight(weighed, 47.5, "s.c3d")
    assert says(said.line(), "s.c3d", "45.9 kg", "47.5 kg", "3 %")
    with pytest.raises(UnitError, match=r"45\.9 kg.*49\.5 kg"):
        check_weight(weighed, 49.5, "s.c3d")
    moved = [replace(one, corners=np.add(one.corners, [0.25, 0, 0])) for one in static.surfaces]
    assert standing_weight_n(replace(static, surfaces=tuple(moved))) is None  # a foot beside the plate
