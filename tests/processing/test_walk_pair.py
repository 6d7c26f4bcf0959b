"""Two walks side by side, and a single stride of each."""

from dataclasses import replace

import numpy as np
import pytest
from driven_walker import HABIT, JOINTS, DrivenWalker
from texts import says

from gaitdisc.channel import Channel, vocabulary
from gaitdisc.errors import StrideError
from gaitdisc.ingest.reading import read_trial
from gaitdisc.processing.walk_pair import TIMES, repeat_stride, walk_pair
from gaitdisc.recording import Recording, Trial


def walk(seed=1, seconds=20.0):
    return DrivenWalker("A", seed=seed).walked(seconds, "nominal")


def only(trial, *keys, names=None):
    streams = {key: trial.stream(key) for key in keys}
    if names:
        streams["kinematics"] = streams["kinematics"].selected(names)
    return replace(trial, streams=streams)


def one_stride(samples=120):
    phase = np.arange(samples) / samples
    columns = [
        mean + sum(c * np.cos(2 * np.pi * k * p) + s * np.sin(2 * np.pi * k * p) for k, (c, s) in enumerate(pairs, 1))
        for p in (phase, phase + 0.5)
        for mean, pairs in (HABIT[joint] for joint in JOINTS)
    ]
    names = [f"{joint}_{side}" for side in "rl" for joint in JOINTS]
    channels = tuple(vocabulary().named(name) for name in names)
    return Trial("periodic", {"kinematics": Recording(phase * 1.1, np.column_stack(columns), channels)})


def test_both_are_cut_by_what_serves_both():
    by_force = walk_pair(walk(1), walk(2))
    assert [one.detector for one in by_force] == ["force", "force"]
    by_angles = walk_pair(only(walk(1), "kinematics"), walk(2))
    assert [one.detector for one in by_angles] == ["angles", "angles"]
    assert says(by_angles[1].findings[-1].what, "percent stride begins", "angles", "both")


def test_another_rate_gives_the_same_curves():
    trial = only(walk(1), "kinematics")
    fast = trial.stream("kinematics")
    time = np.arange(0, 19.9, 1 / 250)
    resampled = Recording(
        time, np.column_stack([np.interp(time, fast.time, column) for column in fast.values.T]), fast.channels
    )
    one, other = walk_pair(trial, Trial("fast", {"kinematics": resampled}))
    assert other.rate_hz == pytest.approx(250)
    means = [np.nanmean(w.curves, axis=0) for w in (one, other)]
    assert np.abs(means[0] - means[1]).max() < 0.5  # deg; contacts fall on other samples


def test_one_stride_counts_as_one_wherever_it_begins():
    trial = one_stride()
    curves, measured = walk_pair(trial, only(walk(1), "kinematics"))
    assert curves.curves.shape[0] == 1
    assert len(measured.curves) > 10
    turned = np.roll(trial.stream("kinematics").values, 50, axis=0)
    later = replace(trial, streams={"kinematics": trial.stream("kinematics").with_values(turned)})
    again, _ = walk_pair(later, only(walk(1), "kinematics"))
    np.testing.assert_allclose(again.curves, curves.curves, atol=0.5)
    gap = np.abs(curves.curves[0] - np.nanmean(measured.curves, axis=0)).max()
    assert gap < 6.0  # the walker wanders about this habit


def test_one_leg_is_enough_and_the_knee_counts_only_where_both_have_it():
    right = only(walk(1), "kinematics", names=["hip_flexion_r", "ankle_angle_r"])
    one, other = walk_pair(right, only(walk(2), "kinematics"))
    assert set(one.strides["side"]) == set(other.strides["side"]) == {"r"}
    lag = [
        np.argmin(np.nanmean(w.curves, axis=0)[:, [c.name for c in w.channels].index("ankle_angle_r")])
        for w in (one, other)
    ]
    assert abs(lag[0] - lag[1]) <= 3


def test_a_stumble_is_left_out_and_said():
    trial = only(walk(1, 40.0), "kinematics")
    kinematics = trial.stream("kinematics")
    values = np.array(kinematics.values)
    at = (kinematics.time > 20.0) & (kinematics.time < 20.6)
    values[at] += 15.0 * np.sin(np.pi * (kinematics.time[at] - 20.0) / 0.6)[:, None]
    stumbled = replace(trial, streams={"kinematics": kinematics.with_values(values)})
    _, found = walk_pair(only(walk(2), "kinematics"), stumbled)
    assert any("outlying" in finding.what for finding in found.findings)


def test_no_strides_in_common_is_refused_in_words():
    forces = replace(only(walk(1), "forces"), name="plates")
    angles = replace(only(walk(2), "kinematics"), name="angles")
    with pytest.raises(StrideError, match=r"same detector must find.*both") as refused:
        walk_pair(forces, angles)
    assert "plates by" in str(refused.value)
    with pytest.raises(StrideError, match=r"plates has contacts by force\. angles by force: "):
        walk_pair(forces, angles, detector="force")
    assert says(str(refused.value), "no hip angle in common")
    assert says(refused.value.remedy, "two walks with hip flexion, with forces")


def test_standing_is_refused(gait_data):
    folder = gait_data / "treadmill_walk_ik"
    calibration, walked = (read_trial(folder / f"{name}_ik.mot") for name in ("S01DN603", "S01DE504"))
    with pytest.raises(StrideError):
        walk_pair(calibration, walked)


def test_the_force_of_one_foot_is_enough_where_force_is_requested():
    both = [only(walk(seed), "kinematics", "forces") for seed in (1, 2)]
    rights = [trial.stream("forces").selected_by(lambda channel: channel.side == "r") for trial in both]
    one_foot = [replace(one, streams={**one.streams, "forces": right}) for one, right in zip(both, rights, strict=True)]
    walks = walk_pair(*one_foot, detector="force")
    assert [one.detector for one in walks] == ["force", "force"]
    by_both = walk_pair(walk(1), walk(2), detector="force")
    knee = [[channel.name for channel in one.channels].index("knee_angle_r") for one in (walks[0], by_both[0])]
    np.testing.assert_allclose(walks[0].curves[:, :, knee[0]], by_both[0].curves[: len(walks[0].curves), :, knee[1]])
    note = walks[1].findings[-1]
    assert note.severity == "warning" and says(note.spoils, "percent stride", "other leg")
    assert says(note.what, "right foot is used for both")
    assert [one.detector for one in walk_pair(*one_foot)] == ["angles", "angles"]  # which see both feet
    other = replace(one_foot[1], streams={"forces": walk(2).stream("forces").selected_by(lambda one: one.side == "l")})
    with pytest.raises(StrideError, match="the same detector must find strides in both"):
        walk_pair(one_foot[0], other, detector="force")


HIP = Channel("hip_flexion_r", "angle", "deg", "r")


def stride(samples=101, end=1.0):
    t = np.linspace(0.0, end, samples)
    return Recording(t, 30 * np.cos(2 * np.pi * t)[:, None], (HIP,))


@pytest.mark.parametrize(("samples", "end"), [(101, 1.0), (100, 0.99)])
def test_the_closing_sample_is_not_walked_twice(samples, end):
    walk = repeat_stride(Trial("sim", {"kinematics": stride(samples, end)}))
    angle = walk.stream("kinematics")
    assert len(angle.time) == TIMES * 100
    np.testing.assert_allclose(angle.values[:, 0], 30 * np.cos(2 * np.pi * angle.time), atol=1e-9)
    assert walk.findings[-1].kind == "one stride"


def test_streams_on_another_base_are_left_out_and_said():
    force = Recording(np.arange(1000) / 1000, np.ones((1000, 1)), (Channel("f", "vertical_force", "N", "r"),))
    walk = repeat_stride(Trial("sim", {"kinematics": stride(), "forces": force}))
    assert set(walk.streams) == {"kinematics"}
    assert says(walk.findings[-1].what, "different time base: forces")


def test_half_a_stride_and_a_long_walk_are_refused_in_words():
    with pytest.raises(StrideError, match=r"hip_flexion_r.*60\.0 deg"):
        repeat_stride(Trial("half", {"kinematics": stride(51, end=0.5)}))
    with pytest.raises(StrideError, match=r"0\.4.*2\.5 s.*long.*5\.01 s"):
        repeat_stride(Trial("long", {"kinematics": stride(501, end=5.0)}))
    still = Recording(np.arange(100) / 100, np.ones((100, 1)), (HIP,))
    with pytest.raises(StrideError, match=r"no leg angle that varies"):
        repeat_stride(Trial("still", {"kinematics": still}))
