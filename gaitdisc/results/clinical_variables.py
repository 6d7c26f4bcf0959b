"""Variables of a clinical page: words, units, signs and places; and when muscles are active in normal walking."""

from __future__ import annotations

from dataclasses import dataclass

KINEMATICS, MOMENTS, POWERS, FORCES = "kinematics", "moments", "powers", "forces"
# The nine curves of the movement analysis profile (Baker et al. 2009), those of the pelvis first.
PROFILE = (
    "pelvis_tilt", "pelvis_obliquity", "pelvis_rotation", "hip_flexion", "hip_adduction", "hip_rotation",
    "knee_flexion", "ankle_dorsiflexion", "foot_progression",
)  # fmt: skip
PELVIS = PROFILE[:3]
# [% of the cycle]; healthy adults at their own speed, about, after Perry J, Burnfield JM 2010, Gait Analysis: Normal
# and Pathological Function, 2nd ed.; children and other speeds differ.
NORMAL: dict[str, tuple[tuple[int, int], ...]] = {
    "gmax": ((0, 24), (95, 100)),
    "gmed": ((0, 29), (95, 100)),
    "tfl": ((0, 45),),
    "rf": ((56, 64),),
    "vas": ((0, 18), (86, 100)),
    "vasmed": ((0, 15), (90, 100)),
    "vaslat": ((0, 20), (86, 100)),
    "ham": ((0, 8), (80, 100)),
    "bf": ((0, 8), (82, 100)),
    "st": ((0, 4), (75, 100)),
    "sol": ((7, 52),),
    "gas": ((9, 50),),
    "gasmed": ((9, 50),),
    "gaslat": ((9, 50),),
    "ta": ((0, 12), (56, 100)),
    "tp": ((0, 55),),
    "per": ((15, 51),),
    "perl": ((15, 51),),
    "perb": ((15, 51),),
}


@dataclass(frozen=True)
class ClinicalVariable:
    """One curve of a leg."""

    name: str
    words: str
    kind: str
    stem: str  # channel it is taken from; `{side}` stands for the leg
    signs: tuple[float, float]  # of the left and of the right leg, by which the channel's values are multiplied
    unit: str
    up: str  # what a positive and a negative value mean
    down: str  # what a positive and a negative value mean
    row: int  # place in the sheet of its kind
    column: int  # place in the sheet of its kind

    def channel(self, side: str) -> str:
        """Name of the channel for a leg."""
        return self.stem.format(side=side)

    def sign(self, side: str) -> float:
        """Sign of the channel for a leg."""
        return self.signs["lr".index(side)]


def _angle(name: str, words: str, stem: str, up: str, down: str, place: tuple[int, int]) -> ClinicalVariable:
    return ClinicalVariable(name, words, KINEMATICS, f"{stem}_{{side}}", (1.0, 1.0), "deg", up, down, *place)


def _pelvis(name: str, words: str, signs: tuple[float, float], up: str, down: str, row: int) -> ClinicalVariable:
    stem = {"pelvis_obliquity": "pelvis_list"}.get(name, name)
    return ClinicalVariable(name, words, KINEMATICS, stem, signs, "deg", up, down, row, 0)


def _moment(name: str, words: str, stem: str, up: str, down: str, place: tuple[int, int]) -> ClinicalVariable:
    stem = f"{stem}_{{side}}_moment"
    return ClinicalVariable(name, words, MOMENTS, stem, (1.0, 1.0), "N m/kg", up, down, *place)


def _power(joint: str, column: int) -> ClinicalVariable:
    stem, up, down = f"{joint}_power_{{side}}", "generated", "absorbed"
    return ClinicalVariable(f"{joint}_power", f"{joint} power", POWERS, stem, (1.0, 1.0), "W/kg", up, down, 2, column)


def _force(name: str, words: str, axis: str, up: str, down: str, row: int) -> ClinicalVariable:
    return ClinicalVariable(name, words, FORCES, f"ground_force_{{side}}_{axis}", (1.0, 1.0), "%", up, down, row, 3)


VARIABLES = (
    _pelvis("pelvis_tilt", "pelvic tilt", (-1.0, -1.0), "forwards", "backwards", 0),
    _pelvis("pelvis_obliquity", "pelvic obliquity", (1.0, -1.0), "own side up", "own side down", 1),
    _pelvis("pelvis_rotation", "pelvic rotation", (-1.0, 1.0), "own side forwards", "own side backwards", 2),
    _angle("hip_flexion", "hip flexion", "hip_flexion", "flexion", "extension", (0, 1)),
    _angle("hip_adduction", "hip adduction", "hip_adduction", "adduction", "abduction", (1, 1)),
    _angle("hip_rotation", "hip rotation", "hip_rotation", "internal", "external", (2, 1)),
    _angle("knee_flexion", "knee flexion", "knee_angle", "flexion", "extension", (0, 2)),
    _angle("knee_adduction", "knee adduction", "knee_adduction", "adduction (varus)", "abduction (valgus)", (1, 2)),
    _angle("knee_rotation", "knee rotation", "knee_rotation", "internal", "external", (2, 2)),
    _angle("ankle_dorsiflexion", "ankle dorsiflexion", "ankle_angle", "dorsiflexion", "plantarflexion", (0, 3)),
    _angle("ankle_inversion", "ankle inversion", "ankle_inversion", "inversion", "eversion", (1, 3)),
    _angle("ankle_rotation", "ankle rotation", "ankle_rotation", "internal", "external", (2, 3)),
    _angle("foot_progression", "foot progression", "foot_progression_angle", "toes in", "toes out", (2, 4)),
    _moment("hip_moment", "hip moment", "hip_flexion", "flexion", "extension", (0, 0)),
    _moment("knee_moment", "knee moment", "knee_angle", "flexion", "extension", (0, 1)),
    _moment("ankle_moment", "ankle moment", "ankle_angle", "dorsiflexion", "plantarflexion", (0, 2)),
    _moment("hip_frontal_moment", "hip frontal moment", "hip_adduction", "adduction", "abduction", (1, 0)),
    _moment("knee_frontal_moment", "knee frontal moment", "knee_adduction", "adduction", "abduction", (1, 1)),
    _moment("ankle_frontal_moment", "ankle frontal moment", "ankle_inversion", "inversion", "eversion", (1, 2)),
    _power("hip", 0),
    _power("knee", 1),
    _power("ankle", 2),
    _force("vertical_force", "vertical force, of body weight", "vy", "upwards", "", 0),
    _force("fore_aft_force", "fore-aft force, of body weight", "vx", "forwards", "backwards", 1),
)
BY_NAME = {one.name: one for one in VARIABLES}
