"""OpenSim's gait10dof: its segments, its inertia, and a knee that slides as it bends."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

import gaitdisc as gd
from gaitdisc.kinematics.pose import Pose
from gaitdisc.kinetics.newton_euler import RigidBody

PARTS_OF = {"thigh": ("femur",), "shank": ("tibia",), "foot": ("talus", "calcn", "toes")}


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
        pelvis = about_z(tilt)
        origin = np.stack([motion["pelvis_tx"], motion["pelvis_ty"], np.full(len(tilt), 0.02)], axis=1)
        found = {"pelvis": Pose(origin, pelvis)}
        for side in "rl":
            hip = origin + pelvis @ self.offset(f"hip_{side}")
            thigh = pelvis @ about_z(angle[f"hip_flexion_{side}"])
            bent = -angle[f"knee_angle_{side}"]
            knee = hip + np.einsum("fij,fj->fi", thigh, self.slide(bent))
            shank = thigh @ about_z(bent)
            ankle = knee + shank @ self.offset(f"ankle_{side}")
            foot = shank @ about_z(angle[f"ankle_angle_{side}"])
            found |= {f"thigh_{side}": Pose(hip, thigh), f"shank_{side}": Pose(knee, shank)}
            found[f"foot_{side}"] = Pose(ankle, foot)
        return found


def about_z(angle: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rotations about the axis of flexion, (frame, 3, 3)."""
    return Rotation.from_euler("z", angle[:, None]).as_matrix()
