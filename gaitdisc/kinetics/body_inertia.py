"""Inertia of the segments of a leg, from a person's mass and sex and the lengths of the segments."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from gaitdisc.channel import schema_folder
from gaitdisc.errors import SchemaError, ShapeError, UnitError
from gaitdisc.kinematics.pose import Pose
from gaitdisc.kinetics.newton_euler import RigidBody
from gaitdisc.recording.arrays import Values, finite_values
from gaitdisc.recording.trial import MASS_KG
from gaitdisc.spreadsheet import read_csv

if TYPE_CHECKING:
    import pandas as pd

LEG: tuple[str, ...] = ("foot", "shank", "thigh")
_SPREAD_OF_LENGTH = 0.1  # a bone whose length varies by more than a tenth is none


@dataclass(frozen=True)
class Person:
    """What of a person the inertia of the segments depends on.

    >>> Person(0.7)
    Traceback (most recent call last):
    ...
    gaitdisc.errors.UnitError: the body mass must be between 5 and 300 kg; it is 0.7 kg. Give it in kg.
    """

    mass_kg: float | None
    sex: str = ""  # `f`, `m`, or empty where it is unknown: then the means of both columns of the table are taken
    weighed_n: float | None = None  # of who stood on the plates, which forces are held against; mass x 9.81 without it

    def __post_init__(self) -> None:
        if self.mass_kg is None or not np.isfinite(self.mass_kg):
            raise UnitError(
                "for moments and powers per kg, the person's body mass [kg] must be known",
                "neither the study nor the file states one",
                "Write the mass in the study's participants, or in PROCESSING:BODYMASS of the C3D file.",
            )
        if not MASS_KG.hold(self.mass_kg):
            raise UnitError(
                f"the body mass must be between {MASS_KG.least:g} and {MASS_KG.most:g} kg",
                f"it is {self.mass_kg:g} kg",
                "Give it in kg.",
            )
        if self.sex not in ("f", "m", ""):
            raise SchemaError(
                "sex must be 'f' or 'm', or '' for the mean of both", f"it is {self.sex!r}", "Write f, m or nothing."
            )

    @property
    def kg(self) -> float:
        """Body mass [kg]."""
        assert self.mass_kg is not None  # checked when made
        return self.mass_kg


@cache
def inertia_table(sex: str) -> pd.DataFrame:
    """Segments of one sex, as `data_schema/segment_inertia.csv` has them.

    mass [% of body mass]: of one segment, of which a body has `whole`
    x, y, z [% of the segment's length]: centre of mass of the right side, from the proximal joint's centre
    xx, yy, zz, xy, xz, yz [% of the segment's length]: radii of gyration of the right side; a negative product of
        inertia has a negative number
    Source: Dumas, Chèze & Verriest (2007), J. Biomech. 40, 543-553, and its corrigendum, 40, 1651-1652, as other
        programs print them: docs/kinetics.md says which numbers differ there.

    >>> float(inertia_table("m").mass["thigh"])
    12.3
    """
    table = read_csv(schema_folder() / "segment_inertia.csv").set_index("segment")
    return table[table["sex"] == sex]


def leg_inertia(person: Person, side: str, lengths_m: Mapping[str, float], toe: Values) -> dict[str, RigidBody]:
    """Inertia of foot, shank and thigh of side `r` or `l`; the left leg is the right one's mirror image.

    toe (3,) [m]: over the head of the second metatarsal, or midway between the first and the fifth, from the centre of
        the ankle in the foot's frame; Dumas' foot ends there
    """
    lengths = {**lengths_m, "foot": float(np.linalg.norm(toe))}
    means = {}
    for segment in LEG:
        low, high = (0.05, 0.35) if segment == "foot" else (0.1, 0.8)
        if not low <= lengths[segment] <= high:
            raise UnitError(
                f"the {segment} must be {low:g} to {high:g} m long",
                f"{segment}_{side} is {lengths[segment]:.4g} m",
                "Check the markers' unit and the joint centres.",
            )
        rows = [inertia_table(sex).T[segment] for sex in person.sex or "fm"]
        bodies = [_body(row, person.kg, lengths[segment], side) for row in rows]
        mass = float(np.mean([body.mass_kg for body in bodies]))
        centre = np.mean([body.centre for body in bodies], axis=0)
        means[segment] = RigidBody(mass, centre, np.mean([body.tensor for body in bodies], axis=0))
    return means


def segment_lengths(poses: Mapping[str, Pose], side: str) -> dict[str, float]:
    """Shank and thigh [m] between proximal joint centres of `thigh_r`, `shank_r`, `foot_r`, medians over frames."""
    lengths = {}
    for segment, beyond in (("shank", "foot"), ("thigh", "shank")):
        ends = [poses.get(f"{name}_{side}") for name in (segment, beyond)]
        if ends[0] is None or ends[1] is None:
            raise ShapeError(
                f"for the length of {segment}_{side}, there must be poses of {segment}_{side} and {beyond}_{side}",
                f"there are {', '.join(poses) or 'none'}",
                "Provide the markers of the entire leg.",
            )
        length = finite_values(np.linalg.norm(ends[0].origin - ends[1].origin, axis=1))
        if not len(length):
            raise ShapeError(
                f"a frame must have both joint centres of {segment}_{side}, for its length",
                "no frame has both",
                "Fill the gaps in the markers of this leg.",
            )
        low, middle, high = np.quantile(length, [0.05, 0.5, 0.95])
        if high - low > _SPREAD_OF_LENGTH * middle:
            raise ShapeError(
                f"{segment}_{side} must have a constant length between its joint centres",
                f"the length ranges from {low:.3f} to {high:.3f} m",
                "Check the markers of this leg. Two may be exchanged.",
            )
        lengths[segment] = float(middle)
    return lengths


def _body(row: pd.Series, mass_kg: float, length_m: float, side: str) -> RigidBody:
    mirror = np.diag([1.0, 1.0, 1.0 if side == "r" else -1.0])
    xx, yy, zz, xy, xz, yz = (np.sign(r) * (r / 100 * length_m) ** 2 for r in row["xx":"yz"])
    mass = row["mass"] / 100 * mass_kg
    tensor = mass * np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return RigidBody(mass, mirror @ np.array(row["x":"z"], float) / 100 * length_m, mirror @ tensor @ mirror)
