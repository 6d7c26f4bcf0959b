"""Values that cannot be are missing before anything is filtered, and named; no real file that is sound loses one."""

import csv

import numpy as np
import pytest
from texts import says

from gaitdisc.channel import QUANTITIES, Channel, schema_folder, vocabulary
from gaitdisc.errors import ReadError
from gaitdisc.ingest.plausible import plausible_ranges, without_frozen, without_impossible
from gaitdisc.ingest.reading import read_trial
from gaitdisc.recording import Recording, Source
from gaitdisc.units import list_units


def _of(channel, *values):
    return Recording(np.arange(len(values)) / 100, np.array(values)[:, None], (channel,), source=Source("walk.mot"))


@pytest.mark.parametrize(
    ("channel", "sound", "absurd"),
    [
        (vocabulary().named("knee_angle_r"), 140.0, 1e6),
        (vocabulary().named("hip_flexion_l"), -40.0, -373.0),
        (vocabulary().named("ankle_angle_l"), 40.0, 1e3),
        (vocabulary().named("pelvis_rotation"), 720.0, 1e5),
        (vocabulary().named("pelvis_tx"), 400.0, 1e7),
        (Channel("RHEE.x", "marker", "m"), 9.0, 1e3),
        (Channel("ankle_angle_r_moment", "moment", "N m/kg", "r"), -1.4, 1e3),
        (Channel("ankle_angle_r_moment", "moment", "N m", "r"), -140.0, 1e6),
        (Channel("RKneeForce.x", "force", "N/kg", "r"), 14.0, 1e4),
        (Channel("RAnklePower.z", "power", "W/kg", "r"), 5.0, -1e4),
    ],
)
def test_each_quantity_has_a_range(channel, sound, absurd):
    kept, (finding,) = without_impossible({"kinematics": _of(channel, sound, absurd, sound)})
    np.testing.assert_array_equal(kept["kinematics"].values[:, 0], [sound, np.nan, sound])
    assert (finding.severity, finding.file, finding.channel) == ("warning", "walk.mot", channel.name)
    unit = "" if channel.unit == "1" else f" {channel.unit}"
    assert says(finding.what, f"{absurd:.6g}{unit}", "frame 2", "= 0.01 s")
    assert finding.spans == ((0.01, 0.02),)


@pytest.mark.parametrize(("unit", "sound", "absurd"), [("V", -4.9, 2047.0), ("1", 1790.0, 1e9), ("%", 300.0, 1e7)])
def test_one_absurd_cell_of_emg_is_missing(unit, sound, absurd):
    channel = Channel("emg_sol_r", "emg", unit, "r")
    kept, (finding,) = without_impossible({"emg": _of(channel, *[sound] * 150, absurd)})
    assert np.isnan(kept["emg"].values[:, 0]).nonzero()[0].tolist() == [150]
    assert finding.kind == "out of range" and "in frame 151" in finding.what


def test_a_ground_force_that_cannot_be_is_refused_as_a_missing_one_is():
    force = vocabulary().named("ground_force_r_vy")
    with pytest.raises(ReadError, match=r"walk\.mot: ground_force_r_vy.*1e\+09 N.*frame 3.*0\.02 s"):
        without_impossible({"forces": _of(force, 700.0, 0.0, 1e9)})


def test_a_channel_beyond_its_range_throughout_has_a_wrong_unit():
    _, (finding,) = without_impossible({"markers": _of(Channel("RHEE.x", "marker", "m"), 2047.0, 2046.0, 2047.0)})
    assert says(finding.what, "2 more", "3 frames")
    assert says(finding.spoils, "the entire channel", "unit")


def test_emg_in_counts_of_a_converter_is_left_and_named():
    counts = _of(Channel("emg_ta_r", "emg", "V", "r"), 3.0, 2047.0, -40.0, 7.0)
    kept, (finding,) = without_impossible({"emg": counts})
    np.testing.assert_array_equal(kept["emg"].values, counts.values)
    assert (finding.severity, finding.kind, finding.channel) == ("warning", "unit", "emg_ta_r")
    assert says(finding.what, "2047 V, but EMG", "15", "mV")


def test_the_table_of_ranges_uses_known_words_and_covers_the_vocabulary():
    with (schema_folder() / "ranges.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert {row["quantity"] for row in rows} == set(QUANTITIES) - {"signal"}
    assert {row["unit"] for row in rows} <= set(list_units())
    assert all(one.low < one.high for one in plausible_ranges())
    assert [c.name for c in vocabulary().channels if not any(one.covers(c) for one in plausible_ranges())] == []


def test_real_files_lose_only_what_is_wrong_in_them(real_trials):
    """One file is not tracked outside of 1.06 to 3.23 s."""
    files = {path.name for path, _, findings in real_trials if any(f.kind == "out of range" for f in findings)}
    assert len(real_trials) > 55
    assert files == {"IK_gait.mot"}


def test_real_files_with_emg_in_counts_are_named(real_trials):
    files = {path.name for path, _, findings in real_trials if any(" counts" in f.what for f in findings)}
    assert files == {"parameterOverflow.c3d", "sub_labels.c3d", "PlugInC3D.c3d"}


def test_what_a_crop_leaves_out_is_not_checked(gait_data):
    path = gait_data / "opensim_walks" / "mrs_emg_walking" / "IK_gait.mot"
    assert "out of range" not in {f.kind for f in read_trial(path, crop_s=(1.06, 3.23)).findings}
    (said,) = [f for f in read_trial(path, crop_s=(1.06, 4.0)).findings if f.channel == "hip_flexion_r"]
    frame = int(said.what.split("in frame ")[1].split()[0])
    line = path.read_text().splitlines()[10 + frame]  # eleven lines of header and labels before frame 1
    assert float(said.what.split(" deg")[0]) == pytest.approx(float(line.split()[7]), rel=1e-5)


def _walk(rng, n=300):
    phases = rng.uniform(0, 6, 4)
    return sum(30 / k**1.5 * np.sin(2 * np.pi * k * np.arange(n) / 100 + phase) for k, phase in enumerate(phases, 1))


def _made(kind, rng):
    """Angles as laboratories have them, none of which is frozen."""
    x = _walk(rng)
    return {
        "smooth": x,
        "noisy": x + rng.normal(0, 0.3, len(x)),
        "0.1 deg": np.round(x, 1),
        "1 deg": np.round(x),
        "held": np.repeat(x[::5], 5),
        "clamped": np.maximum(x, np.percentile(x, 12)),
        "locked": np.full(len(x), 12.0),
        "stands first": np.round(np.r_[x[0] + np.cumsum(rng.normal(0, 0.01, 150)), x[:150]], 1),
    }[kind]


@pytest.mark.parametrize("kind", ["smooth", "noisy", "0.1 deg", "1 deg", "held", "clamped", "locked", "stands first"])
def test_what_repeats_by_nature_is_not_frozen(kind):
    rng = np.random.default_rng(7)
    for _ in range(60):
        walk = {"kinematics": _of(vocabulary().named("knee_angle_r"), *_made(kind, rng))}
        assert without_frozen(walk)[1] == []


@pytest.mark.parametrize("held", [True, False])
def test_a_frozen_or_zero_stretch_of_an_angle_is_a_gap(held):
    x = _walk(np.random.default_rng(1)) + 5.0
    x[100:130] = x[100] if held else 0.0
    kept, (finding,) = without_frozen({"kinematics": _of(vocabulary().named("knee_angle_r"), *x)})
    assert np.flatnonzero(np.isnan(kept["kinematics"].values[:, 0])).tolist() == list(range(100, 130))
    assert (finding.severity, finding.kind, finding.channel) == ("warning", "frozen", "knee_angle_r")
    value = f"{x[100]:.4g}" if held else "0"
    assert says(finding.what, f"{value} deg", "1.000", "1.300 s")


def test_a_marker_is_frozen_where_all_its_coordinates_are():
    rng = np.random.default_rng(2)
    places = np.column_stack([_walk(rng), _walk(rng), np.full(300, 3.0)]) / 100
    places[100:120, 0] = places[100, 0]
    channels = tuple(Channel(f"RHEE.{axis}", "marker", "m") for axis in "xyz")
    walk = Recording(np.arange(300) / 100, places, channels)
    assert without_frozen({"markers": walk})[1] == []
    places[100:120] = places[100]
    kept, (finding,) = without_frozen({"markers": walk.with_values(places)})
    assert finding.channel == "RHEE" and finding.spans == ((1.0, 1.2),)
    assert np.isnan(kept["markers"].values[100:120]).all()


def test_a_force_that_drops_to_zero_under_a_standing_foot_is_a_gap_and_one_that_rests_is_none():
    load = np.clip(np.sin(2 * np.pi * np.arange(3000) / 1500), 0, None) * 700.0
    channels = tuple(Channel(f"plate_1_f{axis}", "vertical_force" if axis == "z" else "force", "N") for axis in "xz")
    forces = Recording(np.arange(3000) / 1000, np.column_stack([0.1 * load, load]), channels)
    assert without_frozen({"forces": forces})[1] == []
    values = np.array(forces.values)
    values[300:450] = 0.0
    kept, (finding,) = without_frozen({"forces": forces.with_values(values)})
    assert says(finding.what, "0 N", "0.300", "0.450 s") and finding.channel == "plate_1_fz"
    assert np.flatnonzero(np.isnan(kept["forces"].values).all(axis=1)).tolist() == list(range(300, 450))


def test_no_walk_at_hand_is_frozen_in_its_legs(real_trials):
    """Arms of two runs stand at a default of their model; nothing else does."""
    found = {(path.name, f.channel[:3]) for path, _, findings in real_trials for f in findings if f.kind == "frozen"}
    assert {part for _, part in found} <= {"arm", "elb", "pro"}


@pytest.mark.parametrize(("least_n", "is_read"), [(-27.0, True), (-1810.0, False)])
def test_a_plate_does_not_pull(least_n, is_read):
    force = _of(Channel("plate_1_fz", "vertical_force", "N"), least_n, 0.0, 800.0)
    if is_read:
        assert not without_impossible({"forces": force})[1]
        return
    with pytest.raises(ReadError, match=r"-1810 N.*frame 1.*-100.*20000 N"):
        without_impossible({"forces": force})


def test_a_plate_that_was_not_zeroed_is_left_out_and_the_others_stay():
    """A plate that rests at -103 N takes its own channels with it, not the walk; alone it is refused."""
    names = ("plate_1_fz", "plate_2_fx", "plate_2_fz")
    channels = tuple(Channel(name, "vertical_force" if name.endswith("z") else "force", "N") for name in names)
    values = np.array([[0.0, 2.0, -103.0], [700.0, 80.0, 590.0], [0.0, 1.0, -103.0]])
    forces = Recording(np.arange(3) / 100, values, channels, source=Source("walk.c3d"))
    kept, (finding,) = without_impossible({"forces": forces})
    assert kept["forces"].names == ("plate_1_fz",)
    assert (finding.severity, finding.channel) == ("refused", "plate_2_fz")
    assert says(finding.what, "-103 N in frame 1", "-100 to 20000 N")
    with pytest.raises(ReadError, match="plate_2_fz must have a plausible force"):
        without_impossible({"forces": forces.selected(names[1:])})
