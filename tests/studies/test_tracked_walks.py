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

    from gaitdisc.engines.tracked_mapping import Tracked

    loads = tuple(DATA / f"ExperimentalData/subject01_walk_grf.{end}" for end in ("xml", "mot"))
    forces = DATA / "CMC/results_no_spring/walk_subject_Actuation_force.sto"
    actuators = DATA / "gait10dof_Reserve_Actuators.xml"
    tracked = Tracked(DATA / "CMC/subject01_metabolics.osim", loads, forces, actuators)
    return tracked_walks.compute_pass(tracked, DATA / "IK/subject01_walk_IK.mot")


def test_each_case_leaves_at_one_joint_what_is_planted(walk):
    import tracked_walks

    found = list(tracked_walks.cases(walk, np.random.default_rng(1), quick=True))
    assert [one[0] for one in found] == ["spring", "late", "scaled"]
    ankle = [one.name for one in walk.engine.coordinates].index("ankle_angle_r")
    planted = {hidden: case.left - walk.left for hidden, _, _, case in found}
    truth = {hidden: number for hidden, _, number, _ in found}
    assert all(np.abs(np.delete(one, ankle, axis=1)).max() < 1e-9 for one in planted.values())
    angle = walk.motion.q[:, ankle]
    assert 180 <= truth["spring"] <= 420 and 0.024 <= truth["late"] <= 0.056 and 0.65 <= truth["scaled"] <= 0.85
    assert np.allclose(planted["spring"][:, ankle], -truth["spring"] * np.maximum(0, angle - np.median(angle)))
    muscles = walk.groups["ankle_angle_r_lowering_muscles"]
    assert np.allclose(planted["scaled"][:, ankle], (truth["scaled"] - 1) * muscles)
    assert np.abs(planted["late"][:, ankle]).max() > 5


def test_a_row_says_what_is_named_and_what_stands_beside(walk):
    import tracked_walks

    table = tracked_walks.run(walk, range(1, 2), range(1, 2), 0.0, quick=True)
    assert table["hidden"].tolist() == ["nothing", "spring", "late", "scaled"]
    (spring,) = table[table["hidden"] == "spring"].itertuples()
    assert spring.named == "one_sided_spring at ankle_angle_r_moment" and spring.right
    assert spring.after_nm < 0.3 * spring.left_nm
    counts = tracked_walks.summary(table.assign(walk="w"))
    assert counts["n"].sum() == 4 and counts["right"].sum() == table["right"].sum()
    assert (table["pelvis_residual"].nunique(), table["pelvis_residual"].iloc[0] > 1) == (1, True)
