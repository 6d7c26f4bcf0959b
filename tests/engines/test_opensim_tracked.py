"""A walk tracked by OpenSim: moments that are left, arms of actuators, short forward runs."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from gaitdisc.engines.motion import Motion
from gaitdisc.engines.tracked_files import read_tracked_motion
from gaitdisc.engines.tracked_mapping import Tracked

DATA = Path(__file__).parents[3] / "shared/data/opensim_gait10dof"
RESULTS = DATA / "CMC/results_no_spring"
pytestmark = [
    pytest.mark.slow,
    pytest.mark.usefixtures("needs_opensim"),
    pytest.mark.skipif(not DATA.is_dir(), reason="the recorded walk is not here"),
]


@pytest.fixture(scope="module")
def walk():
    from gaitdisc.engines.opensim_tracked import OpensimTracked

    loads = tuple(DATA / f"ExperimentalData/subject01_walk_grf.{end}" for end in ("xml", "mot"))
    files = [RESULTS / f"walk_subject_{name}.sto" for name in ("Actuation_force", "Kinematics_u", "Kinematics_dudt")]
    actuators = DATA / "gait10dof_Reserve_Actuators.xml"
    tracked = Tracked(DATA / "CMC/subject01_metabolics.osim", loads, files[0], actuators, *files[1:])
    engine = OpensimTracked(tracked)
    motion = read_tracked_motion(
        tracked, RESULTS / "walk_subject_Kinematics_q.sto", engine.coordinates, engine.actuators
    )
    return engine, motion


def test_muscles_and_residuals_of_computed_muscle_control_explain_the_motion(walk):
    engine, motion = walk
    some = slice(None, None, 10)
    few = replace(motion, time=motion.time[some], q=motion.q[some], v=motion.v[some], a=motion.a[some])
    demanded = engine.demanded(few)
    arms = engine.arms(few.time, few.q, motion.actuators)
    left = demanded - np.einsum("sa,sac->sc", motion.forces[some], arms)
    assert np.abs(demanded).max() > 50 and np.abs(left).max() < 0.1  # the files have five digits
    (net,) = engine.arms(few.time[:1], few.q[:1], ("ankle_angle_r_moment", "pelvis_ty_force"))
    assert [engine.coordinates[k].called for k in np.argmax(net, axis=1)] == ["ankle_angle_r", "pelvis_ty"]
    assert len(engine.base) == 3 and engine.coordinates[engine.vertical].called == "pelvis_ty"
    assert engine.mass_kg == pytest.approx(72.6, abs=0.05) and len(engine.paths) == 18


def test_a_force_by_hand_moves_its_coordinate(walk):
    engine, motion = walk
    at = Motion(motion.q[:1], motion.v[:1], np.zeros((1, 0)))
    push = np.zeros_like(at.q)
    push[0, 5] = 1.0
    assert (engine.accelerations(at, {}, push) - engine.accelerations(at, {}))[0, 5] > 0
