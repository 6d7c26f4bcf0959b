"""Segments of OpenSim's gait10dof as its own joint angles move them: kinetics alone, without markers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

import gaitdisc as gd
from gaitdisc.kinematics.calibration import calibrated
from gaitdisc.kinematics.marker_set_file import marker_set
from gaitdisc.kinematics.motion import motion
from gaitdisc.kinematics.pose import Pose
from gaitdisc.kinetics.body_inertia import Person
from gaitdisc.kinetics.joint_moments import KineticsSettings
from gaitdisc.kinetics.newton_euler import RigidBody, joint_wrenches
from gaitdisc.kinetics.plate_steps import foot_paths
from gaitdisc.kinetics.platform import platforms
from gaitdisc.kinetics.segment_motion import segment_motion
from gaitdisc.kinetics.trial_kinetics import trial_kinetics
from gaitdisc.kinetics.wrench import Wrench

FEET = {"r": ("R.Heel", "R.Toe.Tip"), "l": ("L.Heel", "L.Toe.Tip")}
JOINTS = {"ankle_angle": "foot", "knee_angle": "shank", "hip_flexion": "thigh"}
EDGE = 25  # frames at which the filters of two programs differ
OPENSIM_ORDER = 3  # of its low-pass, forwards and backwards
PARTS_OF = {"thigh": ("femur",), "shank": ("tibia",), "foot": ("talus", "calcn", "toes")}
Angles = Mapping[str, NDArray[np.float64]]


class Gait10dof:
    """The planar model: its segments, its inertia, and a knee that slides as it bends."""

    def __init__(self, path: Path) -> None:
        self.root = ElementTree.parse(path).getroot()
        self.bodies = {body.get("name"): body for body in self.root.iter("Body")}

    @property
    def mass_kg(self) -> float:
        """Of all bodies [kg]."""
        return sum(float(body.findtext("mass", "0")) for body in self.bodies.values())

    def offset(self, joint: str) -> NDArray[np.float64]:
        """Where a joint lies in the body above it [m]."""
        found = next(one for one in self.root.iter() if one.get("name") == joint and one.tag.endswith("Joint"))
        frame = found.find("frames/PhysicalOffsetFrame")
        assert frame is not None
        return np.array(frame.findtext("translation", "").split(), float)

    def slide(self, knee: NDArray[np.float64]) -> NDArray[np.float64]:
        """Where the shank's origin lies in the thigh at a knee angle [rad, flexion negative], (frame, 3) [m]."""
        joint = next(one for one in self.root.iter("CustomJoint") if one.get("name") == "knee_r")
        axes = [one for one in joint.iter("TransformAxis") if str(one.get("name")).startswith("translation")]
        path = np.zeros((len(knee), 3))
        for axis in axes[:2]:
            x, y = (np.array(axis.findtext(f".//SimmSpline/{key}", "").split(), float) for key in "xy")
            scale = float(axis.findtext(".//scale", "1"))
            path += np.outer(scale * CubicSpline(x, y)(knee), np.array(axis.findtext("axis", "").split(), float))
        return path

    def rigid(self, segment: str, side: str) -> RigidBody:
        """Inertia of a segment: the foot is talus, calcaneus and toes together, about the ankle."""
        at, parts = np.zeros(3), []
        for name in PARTS_OF[segment]:
            if name in ("calcn", "toes"):
                at = at + self.offset(f"{'subtalar' if name == 'calcn' else 'mtp'}_{side}")
            body = self.bodies[f"{name}_{side}"]
            centre = at + np.array(body.findtext("mass_center", "").split(), float)
            xx, yy, zz, xy, xz, yz = (float(one) for one in body.findtext("inertia", "").split())
            tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
            parts.append((float(body.findtext("mass", "0")), centre, tensor))
        mass = sum(one[0] for one in parts)
        middle = np.sum([one[0] * one[1] for one in parts], axis=0) / mass
        tensor = np.zeros((3, 3))
        for one, centre, own in parts:
            arm = centre - middle
            tensor += own + one * (arm @ arm * np.eye(3) - np.outer(arm, arm))
        return RigidBody(mass, middle, tensor)

    def poses(self, motion: gd.Recording) -> dict[str, Pose]:
        """Segments at the joint angles of a recording that has flexion of the knee positive, as all do here."""
        angle = {name: np.radians(motion[name]) for name in motion.names if not name.startswith("pelvis_t")}
        tilt = np.radians(motion["pelvis_tilt"])
        pelvis = _about_z(tilt)
        origin = np.stack([motion["pelvis_tx"], motion["pelvis_ty"], np.full(len(tilt), 0.02)], axis=1)
        found = {"pelvis": Pose(origin, pelvis)}
        for side in "rl":
            hip = origin + pelvis @ self.offset(f"hip_{side}")
            thigh = pelvis @ _about_z(angle[f"hip_flexion_{side}"])
            bent = -angle[f"knee_angle_{side}"]
            knee = hip + np.einsum("fij,fj->fi", thigh, self.slide(bent))
            shank = thigh @ _about_z(bent)
            ankle = knee + shank @ self.offset(f"ankle_{side}")
            foot = shank @ _about_z(angle[f"ankle_angle_{side}"])
            found |= {f"thigh_{side}": Pose(hip, thigh), f"shank_{side}": Pose(knee, shank)}
            found[f"foot_{side}"] = Pose(ankle, foot)
        return found

    def slide_rate(self, knee: NDArray[np.float64]) -> NDArray[np.float64]:
        """How far the shank's origin slides in the thigh for each radian of extension, (frame, 3) [m/rad]."""
        return (self.slide(knee + 1e-4) - self.slide(knee - 1e-4)) / 2e-4


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
        chain = [(moving[f"{segment}_{side}"], model.rigid(segment, side)) for segment in ("foot", "shank", "thigh")]
        carried = joint_wrenches(chain, Wrench(there[:, :3], there[:, 3:]), platform.up)
        for (name, segment), wrench in zip(JOINTS.items(), carried, strict=True):
            moment = wrench.about(poses[f"{segment}_{side}"].origin)[:, 2]
            if name == "knee_angle":
                bent = -np.radians(smooth[f"knee_angle_{side}"])
                slide = np.einsum("fij,fj->fi", poses[f"thigh_{side}"].rotation, model.slide_rate(bent))
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
    feet = foot_paths(trial.stream("markers"), FEET)
    theirs, sources = solved.stream("moments"), {"the model": own}
    for joints in ("free", "held", "planar"):
        body = calibrated(static, replace(marker_set("gait2354"), joints=joints))
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


def _about_z(angle: NDArray[np.float64]) -> NDArray[np.float64]:
    return Rotation.from_euler("z", angle[:, None]).as_matrix()
