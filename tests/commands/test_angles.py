"""`gaitdisc angles` and `gaitdisc moments`: files of angles, moments and powers, with all that was inferred said."""

import numpy as np
import pytest
from manufactured_body import (
    PLUG_IN_GAIT,
    RAJAGOPAL,
    Laboratory,
    body_frames,
    known_angles,
    markers_of,
    static_of,
    without,
)
from texts import says

from gaitdisc.commands.options import REFUSED
from gaitdisc.ingest.reading import read_trial
from gaitdisc.recording import Recording


def write_trc(markers: Recording, path) -> None:
    labels = [name[:-2] for name in markers.names if name.endswith(".x")]
    rows = [
        "\t".join([str(i + 1), f"{t:.6f}", *(f"{1000 * x:.9f}" for x in row)])
        for i, (t, row) in enumerate(zip(markers.time, markers.values, strict=True))
    ]
    head = [
        f"PathFileType\t4\t(X/Y/Z)\t{path.name}",
        "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits",
        f"100\t100\t{len(rows)}\t{len(labels)}\tmm",
        "Frame#\tTime\t" + "\t\t\t".join(labels),
        "\t\t" + "\t".join(f"{axis}{i + 1}" for i in range(len(labels)) for axis in "XYZ"),
        "",
    ]
    path.write_text("\n".join([*head, *rows]) + "\n", encoding="utf-8")


def test_angles_of_two_marker_files(tmp_path, called):
    known = known_angles(150)
    away = Laboratory(origin=np.array([0.5, 0.1, 0.3]))  # nobody's marker lies in the origin, which would be a gap
    write_trc(markers_of(known, RAJAGOPAL, away), tmp_path / "walk.trc")
    write_trc(static_of(RAJAGOPAL, away), tmp_path / "static.trc")
    done = called("angles", tmp_path / "walk.trc", "--static", tmp_path / "static.trc", "--out", tmp_path / "a.mot",
                  "--forward", 1, 0, 0, ends=0)  # fmt: skip
    assert "marker set: rajagopal: " in done.stdout
    assert "direction: forward as given" in done.stdout
    assert "26 channels, 150 samples" in done.stdout
    angles = read_trial(tmp_path / "a.mot").stream("kinematics")
    for name, values in known.items():
        np.testing.assert_allclose(angles[name], values, atol=1e-5, err_msg=name)


def test_widths_may_be_given(tmp_path, called):
    known = known_angles(150)
    away = Laboratory(origin=np.array([0.5, 0.1, 0.3]))
    write_trc(markers_of(known, PLUG_IN_GAIT, away), tmp_path / "walk.trc")
    write_trc(static_of(PLUG_IN_GAIT, away), tmp_path / "static.trc")
    words = ("angles", tmp_path / "walk.trc", "--static", tmp_path / "static.trc", "--out", tmp_path / "a.csv")
    refused = called(*words, ends=REFUSED)
    assert says(refused.stderr, "neither static.trc nor the measures")
    called(*words, "--widths", 0.1, 0.1, 0.07, 0.07, "--forward", 1, 0, 0, ends=0)
    angles = read_trial(tmp_path / "a.csv").stream("kinematics")
    np.testing.assert_allclose(angles["knee_angle_r"], known["knee_angle_r"], atol=1e-5)


def test_a_walk_without_a_marker_is_refused_in_one_sentence(tmp_path, called):
    write_trc(markers_of(known_angles(150), RAJAGOPAL), tmp_path / "walk.trc")
    write_trc(without(static_of(RAJAGOPAL), "LMFC"), tmp_path / "static.trc")
    done = called("angles", tmp_path / "walk.trc", "--static", tmp_path / "static.trc", "--out", tmp_path / "a.csv",
                  "--marker-set", "rajagopal", ends=REFUSED)  # fmt: skip
    assert says(done.stderr, "static.trc", "no LMFC")
    assert not (tmp_path / "a.csv").exists()


def test_what_the_reader_found_is_said(tmp_path, called, gait_data):
    walk = gait_data / "young_straight_and_turn" / "HC030A" / "straight" / "HC030A05.c3d"
    static = gait_data / "young_static" / "HC030A" / "HC030A01.c3d"
    done = called("angles", walk, "--static", static, "--out", tmp_path / "a.mot", ends=0)
    of_reader = [finding.line() for finding in (*read_trial(static).findings, *read_trial(walk).findings)]
    assert of_reader and set(of_reader) < set(done.stdout.splitlines())


def test_segments_need_no_static_trial_and_markers_do(tmp_path, called):
    import ezc3d

    known = known_angles(120)
    file, rotations = ezc3d.c3d(), np.zeros((4, 4, 7, 120))
    labels = []
    for place, (name, (origin, rotation)) in enumerate(body_frames(known).items()):
        part, _, side = name.partition("_")
        labels.append(f"{side}_{part}_4X4" if side else f"{part}_4X4")
        rotations[:3, :3, place] = rotation[:, :, [2, 0, 1]].transpose(1, 2, 0)  # right, forward, up
        rotations[:3, 3, place] = 1000 * origin.T
    file["parameters"]["POINT"]["RATE"]["value"] = [100.0]
    file["parameters"]["POINT"]["UNITS"]["value"] = ["mm"]
    file["data"]["points"] = np.zeros((4, 0, 120))
    file.add_parameter("ROTATION", "RATE", [100.0])
    file.add_parameter("ROTATION", "LABELS", labels)
    file["data"]["rotations"] = rotations
    file.write(str(tmp_path / "walk.c3d"))
    called("angles", tmp_path / "walk.c3d", "--out", tmp_path / "a.mot", ends=0)
    found = read_trial(tmp_path / "a.mot").stream("kinematics")
    for name in ("hip_adduction_l", "knee_rotation_r", "ankle_inversion_l"):
        np.testing.assert_allclose(found[name], known[name], atol=1e-3)
    write_trc(markers_of(known, RAJAGOPAL), tmp_path / "walk.trc")
    refused = called("angles", tmp_path / "walk.trc", "--out", tmp_path / "b.mot", ends=REFUSED)
    assert says(refused.stderr, "angles", "a static trial")


@pytest.fixture(scope="module")
def files(gait_data):
    person = gait_data / "young_straight_and_turn" / "HC030A" / "straight" / "HC030A05.c3d"
    return person, gait_data / "young_static" / "HC030A" / "HC030A01.c3d"


@pytest.mark.parametrize("ending", ["csv", "mot"])
def test_moments_of_a_walk(tmp_path, called, files, ending):
    walk, static = files
    out = tmp_path / f"moments.{ending}"
    done = called("moments", walk, "--static", static, "--out", out, "--marker-set", "plug_in_gait", ends=0)
    assert says(done.stdout, "plate_2", "0.18", "0.79 s")
    assert "force balance over " in done.stdout and "24 channels, 197 samples" in done.stdout
    assert says(done.stdout, "plate 1", "451 N", "LGroundReactionForce", "9.845")  # what the reader found
    assert len(set(done.stdout.splitlines())) == len(done.stdout.splitlines())
    written = read_trial(out).stream("moments")
    channel = written.channels[written.index("ankle_angle_r_moment")]
    assert channel.unit == "N m/kg"
    assert np.nanmin(written["ankle_angle_r_moment"]) == pytest.approx(-1.19, abs=0.05)
    assert np.nanmax(written["ankle_power_r"]) == pytest.approx(3.08, rel=0.2)  # the file's own


def test_a_mass_in_grams_is_refused_in_one_sentence(tmp_path, called, files):
    walk, static = files
    done = called("moments", walk, "--static", static, "--out", tmp_path / "a.csv", "--mass", 45800, ends=REFUSED)
    assert says(done.stderr, "5", "300 kg", "45800 kg")
    assert not (tmp_path / "a.csv").exists()


def test_who_stands_on_one_plate_with_both_feet_has_no_moments(tmp_path, called, files):
    _, static = files
    done = called(
        "moments", static, "--static", static, "--out", tmp_path / "a.csv", "--marker-set", "plug_in_gait", ends=REFUSED
    )
    assert says(done.stderr, "HC030A01.c3d", "plate_1", "0.00 s: both")


def test_markers_and_forces_in_two_files_need_the_mass(tmp_path, called, gait_data):
    walk = gait_data.parent / "opensim_gait10dof" / "ExperimentalData"
    words = ("moments", walk / "subject01_walk.trc", walk / "subject01_walk_grf.mot", "--static",
             walk / "subject01_static.trc", "--out", tmp_path / "a.sto", "--marker-set", "gait2354")  # fmt: skip
    refused = called(*words, ends=REFUSED)
    assert says(refused.stderr, "person's body mass [kg] must be known;")
    called(*words, "--mass", 72.6, "--sex", "m", ends=0)
    written = read_trial(tmp_path / "a.sto").stream("moments")
    assert np.nanmin(written["ankle_angle_l_moment"]) == pytest.approx(-1.55, abs=0.2)
