"""The mapping of a walk with recorded forces goes to its file and back."""

from dataclasses import replace
from pathlib import Path

import pytest

from gaitdisc.engines.tracked_files import drafted_tracked
from gaitdisc.engines.tracked_mapping import read_tracked, write_tracked_mapping
from gaitdisc.errors import GaitdiscError

DATA = Path(__file__).parents[3] / "shared/data/opensim_gait10dof"
LOADS = DATA / "ExperimentalData/subject01_walk_grf.xml"


@pytest.mark.skipif(not DATA.is_dir(), reason="the recorded walk is not here")
def test_a_mapping_goes_to_its_file_and_back(tmp_path):
    pytest.importorskip("opensim", reason="OpenSim is not installed: gaitdisc[opensim]")
    forces = DATA / "CMC/results_no_spring/walk_subject_Actuation_force.sto"
    model, reserves = DATA / "CMC/subject01_metabolics.osim", DATA / "gait10dof_Reserve_Actuators.xml"
    tracked, engine = drafted_tracked(model, LOADS, forces, reserves)
    assert len(engine.coordinates) == 10 and engine.mass_kg == pytest.approx(72.6, abs=0.1)
    given = replace(tracked, noise_deg=0.5, start_s=0.7)
    write_tracked_mapping(given, tmp_path / "walk.toml")
    read = read_tracked(tmp_path / "walk.toml")
    assert read is not None and [one.resolve() for one in read.files] == [one.resolve() for one in given.files]
    assert (read.noise_deg, read.start_s, read.end_s) == (0.5, 0.7, float("inf"))
    with pytest.raises(GaitdiscError, match=r"none.*.tracked. as actuators"):
        drafted_tracked(model, LOADS, forces)  # its reserves are in no file that is named
