"""Segments of OpenSim's gait10dof as its own joint angles move them: kinetics alone, without markers."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from gait10dof import Gait10dof
from numpy.typing import NDArray

import gaitdisc as gd
from gaitdisc.kinematics.calibration import calibrate_body
from gaitdisc.kinematics.marker_set import marker_set
from gaitdisc.kinematics.motion import motion
from gaitdisc.kinetics.body_inertia import LEG, Person
from gaitdisc.kinetics.joint_moments import KineticsSettings
from gaitdisc.kinetics.newton_euler import compute_wrench, joint_wrenches, segment_motion
from gaitdisc.kinetics.plate_steps import foot_paths
from gaitdisc.kinetics.platform import Wrench, platforms
from gaitdisc.kinetics.trial_kinetics import trial_kinetics

HEELS, TOES = {"r": "R.Heel", "l": "L.Heel"}, {"r": "R.Toe.Tip", "l": "L.Toe.Tip"}
JOINTS = {"ankle_angle": "foot", "knee_angle": "shank", "hip_flexion": "thigh"}
EDGE = 25  # frames at which the filters of two programs differ
OPENSIM_ORDER = 3  # of its low-pass, forwards and backwards


def generalised_forces(model: Gait10dof, motion: gd.Recording, ground: gd.Trial) -> dict[str, NDArray[np.float64]]:
    """Inverse dynamics with the model's own segments, as OpenSim counts it [N m]; knee flexion positive.

    The knee of this model slides as it bends, so the force in the joint does work at its angle too.
    """
    smooth = gd.lowpass(motion, 6.0, order=OPENSIM_ORDER)
    poses, found = model.poses(smooth), {}
    moving = {name: segment_motion(pose, smooth.rate_hz) for name, pose in poses.items()}
    for platform in platforms(ground):
        side = platform.side
        both = np.hstack([platform.wrench.force, platform.wrench.moment])
        there = np.stack([np.interp(smooth.time, platform.time, column) for column in both.T], axis=1)
        needed = [compute_wrench(moving[f"{part}_{side}"], model.rigid(part, side), platform.up) for part in LEG]
        carried = joint_wrenches(needed, Wrench(there[:, :3], there[:, 3:]))
        for (name, segment), wrench in zip(JOINTS.items(), carried, strict=True):
            moment = wrench.about(poses[f"{segment}_{side}"].origin)[:, 2]
            if name == "knee_angle":
                bent = -np.radians(smooth[f"knee_angle_{side}"])
                rate = (model.slide(bent + 1e-4) - model.slide(bent - 1e-4)) / 2e-4  # [m/rad]
                slide = np.einsum("fij,fj->fi", poses[f"thigh_{side}"].rotation, rate)
                moment = -moment - np.einsum("fx,fx->f", wrench.force, slide)
            found[f"{name}_{side}_moment"] = moment
    return found


def against_opensim(folder: Path) -> list[tuple[str, ...]]:
    """Rows of a table: each joint's rms and largest difference, with the model's segments and with those of markers."""
    model, walk = Gait10dof(folder / "subject01.osim"), folder / "ExperimentalData"
    solved = gd.read([folder / "ID" / "Results" / "subject01_walk_ID.sto", folder / "IK" / "subject01_walk_IK.mot"])
    ground = gd.read(walk / "subject01_walk_grf.mot")
    own = generalised_forces(model, solved.stream("kinematics"), ground)
    trial = gd.read([walk / "subject01_walk.trc", walk / "subject01_walk_grf.mot"])
    static = gd.read(walk / "subject01_static.trc").stream("markers")
    feet = foot_paths(trial.stream("markers"), HEELS, TOES)
    theirs, sources = solved.stream("moments"), {"the model": own}
    for joints in ("free", "held", "planar"):
        body = calibrate_body(static, replace(marker_set("gait2354"), joints=joints))
        poses = motion(trial.stream("markers"), body).poses
        made = trial_kinetics(trial, poses, feet, Person(model.mass_kg), KineticsSettings()).moments
        moments = [name for name in made.names if name in theirs.names]
        there = {name: np.interp(theirs.time, made.time, made[name]) * model.mass_kg for name in moments}
        sources[f"markers, joints {joints}"] = there
    rows = []
    for name in JOINTS:
        for source, ours in sources.items():
            inner = slice(EDGE, -EDGE)
            apart = [(ours[full] - theirs[full])[inner] for full in (f"{name}_{side}_moment" for side in "rl")]
            size = [float(np.sqrt(np.nanmean(one**2))) for one in apart]
            largest = max(float(np.nanmax(np.abs(one))) for one in apart)
            per_kg = " ".join(f"{one / model.mass_kg:.4f}" for one in size)
            rows.append((name, source, f"{size[0]:.2f} {size[1]:.2f}", f"{largest:.2f}", per_kg))
    return rows
