"""What the study of tracked walks plants is what is left then, and nothing else."""

from pathlib import Path

import numpy as np
import pytest

DATA = Path(__file__).parents[3] / "shared/data/opensim_gait10dof"
pytest.importorskip("opensim", reason="OpenSim is not installed: gaitdisc[opensim]")
pytestmark = [pytest.mark.slow, pytest.mark.skipif(not DATA.is_dir(), reason="the recorded walk is not here")]


@pytest.fixture(scope="module")
def walk():
    import tracked_walks

    from gaitdisc.engines.tracked_files import Tracked

    loads = tuple(DATA / f"ExperimentalData/subject01_walk_grf.{end}" for end in ("xml", "mot"))
    forces = DATA / "CMC/results_no_spring/walk_subject_Actuation_force.sto"
    actuators = DATA / "gait10dof_Reserve_Actuators.xml"
    tracked = Tracked(DATA / "CMC/subject01_metabolics.osim", loads, forces, actuators)
    return tracked_walks.tracked_pass(tracked, DATA / "IK/subject01_walk_IK.mot")


def test_each_case_leaves_at_one_joint_what_is_planted(walk):
    import tracked_walks

    found = list(tracked_walks.cases(walk, quick=True))
    assert [one[0] for one in found] == ["nothing", "spring", "late", "scaled"]  # half of this walk is too short
    ankle = [one.name for one in walk.engine.coordinates].index("ankle_angle_r")
    planted = {hidden: case.left - walk.left for hidden, _, _, case in found}
    assert all(np.abs(np.delete(one, ankle, axis=1)).max() < 1e-9 for one in planted.values())
    assert np.abs(planted["nothing"]).max() == 0
    angle = walk.motion.q[:, ankle]
    assert np.allclose(planted["spring"][:, ankle], -300 * np.maximum(0, angle - np.median(angle)))
    muscles = walk.groups["ankle_angle_r_lowering_muscles"]
    assert np.allclose(planted["scaled"][:, ankle], -0.25 * muscles)
    assert np.abs(planted["late"][:, ankle]).max() > 5


def test_noise_of_angles_leaves_its_size_in_the_angles(walk):
    import tracked_walks

    moved = tracked_walks.shaken(walk, 0.3, 1).motion.q - walk.motion.q
    assert np.degrees(moved[:, 3:].std(axis=0)) == pytest.approx(0.3, rel=0.5)  # some ten periods of 6 Hz
    assert not np.allclose(tracked_walks.shaken(walk, 0.3, 2).motion.q - walk.motion.q, moved)
