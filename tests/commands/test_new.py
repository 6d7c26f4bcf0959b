from pathlib import Path

import pytest
from texts import says

from gaitdisc.commands.options import REFUSED

DATA = Path(__file__).parents[3] / "shared/data/opensim_gait10dof"


def test_a_study_is_not_overwritten(study, recordings, called):
    done = called("new", study, "--from", recordings)
    assert done.returncode == REFUSED
    assert says(" ".join(done.stderr.split()), "study.toml", "changed", "new")


def test_the_mapping_of_a_walk_needs_its_ground_forces_and_a_model_of_opensim(tmp_path, called):
    model = tmp_path / "leg.osim"
    model.write_text("<OpenSimDocument/>")
    done = called("new", tmp_path / "walk.toml", "--from", model, "--forces", "forces.sto")
    assert done.returncode == REFUSED and "Add --external-loads grf.xml" in done.stderr
    done = called("new", tmp_path / "walk.toml", "--from", tmp_path / "leg.xml", "--external-loads", "grf.xml")
    assert done.returncode == REFUSED and "leg.xml is none" in done.stderr
    done = called("new", tmp_path / "walk", "--from", model, "--external-loads", "grf.xml")
    assert done.returncode == REFUSED and "Call it leg.toml" in done.stderr


@pytest.mark.slow
@pytest.mark.skipif(not DATA.is_dir(), reason="the recorded walk is not here")
def test_the_mapping_of_a_walk_is_written_and_searched(tmp_path, called):
    pytest.importorskip("opensim", reason="OpenSim is not installed: gaitdisc[opensim]")
    results = DATA / "CMC/results_no_spring"
    files = {
        "--from": DATA / "CMC/subject01_metabolics.osim",
        "--external-loads": DATA / "ExperimentalData/subject01_walk_grf.xml",
        "--forces": results / "walk_subject_Actuation_force.sto",
        "--actuators": DATA / "gait10dof_Reserve_Actuators.xml",
    }
    done = called("new", tmp_path / "walk.toml", *(word for pair in files.items() for word in pair))
    assert done.returncode == 0 and says(done.stdout, "72.6 kg, 10 free"), done.stderr
    out = ("--out", tmp_path / "found", "-q", "--no-report")
    done = called("discover", tmp_path / "walk.toml", results / "walk_subject_Kinematics_q.sto", *out)
    assert done.returncode == 0 and says(done.stdout, "nothing", "missing", "these data could"), done.stderr
