"""`gaitdisc moments`: from a walk and a static trial to a file of moments and powers, with what they rest on."""

from __future__ import annotations

import numpy as np
import pytest
from texts import says

from gaitdisc.commands.options import REFUSED
from gaitdisc.ingest.reading import read_trial


@pytest.fixture(scope="module")
def files(gait_data):
    person = gait_data / "young_straight_and_turn" / "HC030A" / "straight" / "HC030A05.c3d"
    return person, gait_data / "young_static" / "HC030A" / "HC030A01.c3d"


@pytest.mark.parametrize("ending", ["csv", "mot"])
def test_moments_of_a_walk(tmp_path, called, files, ending):
    walk, static = files
    out = tmp_path / f"moments.{ending}"
    done = called("moments", walk, "--static", static, "--out", out, "--marker-set", "plug_in_gait")
    assert done.returncode == 0, done.stderr
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
    done = called("moments", walk, "--static", static, "--out", tmp_path / "a.csv", "--mass", 45800)
    assert done.returncode == REFUSED
    assert says(done.stderr, "5", "300 kg", "45800 kg")
    assert not (tmp_path / "a.csv").exists()


def test_who_stands_on_one_plate_with_both_feet_has_no_moments(tmp_path, called, files):
    _, static = files
    done = called("moments", static, "--static", static, "--out", tmp_path / "a.csv", "--marker-set", "plug_in_gait")
    assert done.returncode == REFUSED
    assert says(done.stderr, "HC030A01.c3d", "plate_1", "0.00 s: both")


def test_markers_and_forces_in_two_files_need_the_mass(tmp_path, called, gait_data):
    walk = gait_data.parent / "opensim_gait10dof" / "ExperimentalData"
    words = ("moments", walk / "subject01_walk.trc", walk / "subject01_walk_grf.mot", "--static",
             walk / "subject01_static.trc", "--out", tmp_path / "a.sto", "--marker-set", "gait2354")  # fmt: skip
    refused = called(*words)
    assert refused.returncode == REFUSED
    assert says(refused.stderr, "person's body mass [kg]; none")
    done = called(*words, "--mass", 72.6, "--sex", "m")
    assert done.returncode == 0, done.stderr
    written = read_trial(tmp_path / "a.sto").stream("moments")
    assert np.nanmin(written["ankle_angle_l_moment"]) == pytest.approx(-1.55, abs=0.2)
