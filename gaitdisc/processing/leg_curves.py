"""Cycles of one leg as a clinic reads them; the clinical variables: words, units, signs, when muscles are active."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from gaitdisc.processing.pooled_cycles import SPATIOTEMPORAL, PooledCycles
from gaitdisc.recording import PERCENT
from gaitdisc.recording.arrays import Values, mean_where_known

FEET = ("l", "r")
TURNED_DEG = 20.0  # by which the pelvis turns in the laboratory from contact to contact where somebody walks a curve
LIGHTEST_N = 50.0  # mean force of both feet; below it nobody stands on the belts
KNOWN_UNTIL = 91  # points of a moment or power; its end may be empty after the next foot meets an unknown plate
ALONG_THE_PATH = ("pelvis_rotation", "foot_progression")  # angles about a straight line of walking
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
    **dict.fromkeys(("gas", "gasmed", "gaslat"), ((9, 50),)),
    "ta": ((0, 12), (56, 100)),
    "tp": ((0, 55),),
    **dict.fromkeys(("per", "perl", "perb"), ((15, 51),)),
}


@dataclass(frozen=True, eq=False)
class LegCurves:
    """Kept cycles of one leg."""

    side: str
    count: int
    stance_percent: float  # mean foot off [% of the cycle]; NaN where none is known
    # each (cycle, phase), clinical variable -> curves on 101 points, in the variable's unit and sign; complete, but for
    # the end of a moment or power
    cycles: Mapping[str, Values]
    # each (cycle,), spatiotemporal value -> of the cycles in which it is known
    values: Mapping[str, Values]
    # mean turn of the pelvis from contact to contact; beyond TURNED_DEG angles about the line of walking are left
    turned_deg: float = 0.0

    def mean(self, name: str) -> Values:
        """Mean curve of a variable; NaN where no cycle has a value."""
        return mean_where_known(self.cycles[name])


def make_legs(pooled: PooledCycles) -> dict[str, LegCurves]:
    """Both legs of a person, session and condition; a leg without a kept cycle is not there."""
    places = {channel.name: column for column, channel in enumerate(pooled.channels)}
    units = {channel.name: channel.unit for channel in pooled.channels}
    kept, curves = pooled.kept, pooled.curves
    weight = _percent_per_newton(pooled)
    legs = {}
    for side in FEET:
        rows = (kept["side"] == side).to_numpy()
        if not rows.any():
            continue
        cycles = {}
        for variable in VARIABLES:
            channel = variable.channel(side)
            newtons = variable.kind == FORCES and units.get(channel) == "N"
            factor = weight if newtons else 1.0
            if factor is not None and (newtons or units.get(channel) == variable.unit):
                leg_curves = curves[rows, :, places[channel]] * factor
                must = KNOWN_UNTIL if variable.kind in (MOMENTS, POWERS) else len(PERCENT)
                complete = leg_curves[np.isfinite(leg_curves[:, :must]).all(axis=1)]
                if len(complete):
                    cycles[variable.name] = variable.sign(side) * complete
        turned = 0.0
        if "pelvis_rotation" in cycles:
            turned = float(np.abs(np.ptp(cycles["pelvis_rotation"][:, [0, -1]], axis=1)).mean())
        if turned > TURNED_DEG:
            cycles = {name: leg_curves for name, leg_curves in cycles.items() if name not in ALONG_THE_PATH}
        values = {value: kept.loc[rows, value].dropna().to_numpy(float) for value in SPATIOTEMPORAL}
        known = {value: numbers for value, numbers in values.items() if len(numbers)}
        stance = float(known["stance_percent"].mean()) if "stance_percent" in known else float("nan")
        legs[side] = LegCurves(side, int(rows.sum()), stance, cycles, known, turned)
    return legs


def _percent_per_newton(pooled: PooledCycles) -> float | None:
    """Percent of body weight a newton is, of belts under each foot: over whole strides both carry the weight."""
    feet, names = pooled.kept["side"].to_numpy(), [channel.name for channel in pooled.channels]
    carried = 0.0
    for side in FEET:
        name = f"ground_force_{side}_vy"
        if name not in names or pooled.channels[names.index(name)].unit != "N" or not (feet == side).any():
            return None
        carried += float(mean_where_known(pooled.curves[feet == side, :, names.index(name)].ravel()))
    return 100.0 / carried if carried > LIGHTEST_N else None


CHANNELS = {  # kind -> channel of a leg by the variable's stem, and unit
    KINEMATICS: ("{stem}_{side}", "deg"),
    MOMENTS: ("{stem}_{side}_moment", "N m/kg"),
    POWERS: ("{stem}_power_{side}", "W/kg"),
    FORCES: ("ground_force_{side}_{stem}", "%"),
}
# of the left and of the right leg; channels of the pelvis are the same for both
PELVIS_SIGNS = {"pelvis_tilt": (-1.0, -1.0), "pelvis_obliquity": (1.0, -1.0), "pelvis_rotation": (-1.0, 1.0)}


@dataclass(frozen=True)
class ClinicalVariable:
    """One curve of a leg."""

    kind: str
    name: str
    words: str
    stem: str  # of the channel it is taken from
    up: str  # what a positive value means
    down: str  # what a negative value means

    @property
    def unit(self) -> str:
        """Unit of its channel."""
        return CHANNELS[self.kind][1]

    def channel(self, side: str) -> str:
        """Name of the channel for a leg."""
        return self.stem if self.name in PELVIS_SIGNS else CHANNELS[self.kind][0].format(stem=self.stem, side=side)

    def sign(self, side: str) -> float:
        """Sign of the channel for a leg, by which its values are multiplied."""
        return PELVIS_SIGNS.get(self.name, (1.0, 1.0))["lr".index(side)]


# in the order of a sheet, three in a row
_ROWS = (
    (KINEMATICS, "pelvis_tilt", "pelvic tilt", "pelvis_tilt", "forwards", "backwards"),
    (KINEMATICS, "pelvis_obliquity", "pelvic obliquity", "pelvis_list", "own side up", "own side down"),
    (KINEMATICS, "pelvis_rotation", "pelvic rotation", "pelvis_rotation", "own side forwards", "own side backwards"),
    (KINEMATICS, "hip_flexion", "hip flexion", "hip_flexion", "flexion", "extension"),
    (KINEMATICS, "hip_adduction", "hip adduction", "hip_adduction", "adduction", "abduction"),
    (KINEMATICS, "hip_rotation", "hip rotation", "hip_rotation", "internal", "external"),
    (KINEMATICS, "knee_flexion", "knee flexion", "knee_angle", "flexion", "extension"),
    (KINEMATICS, "ankle_dorsiflexion", "ankle dorsiflexion", "ankle_angle", "dorsiflexion", "plantarflexion"),
    (KINEMATICS, "foot_progression", "foot progression", "foot_progression_angle", "toes in", "toes out"),
    (KINEMATICS, "knee_adduction", "knee adduction", "knee_adduction", "adduction (varus)", "abduction (valgus)"),
    (KINEMATICS, "knee_rotation", "knee rotation", "knee_rotation", "internal", "external"),
    (KINEMATICS, "ankle_inversion", "ankle inversion", "ankle_inversion", "inversion", "eversion"),
    (KINEMATICS, "ankle_rotation", "ankle rotation", "ankle_rotation", "internal", "external"),
    (MOMENTS, "hip_moment", "hip moment", "hip_flexion", "flexion", "extension"),
    (MOMENTS, "knee_moment", "knee moment", "knee_angle", "flexion", "extension"),
    (MOMENTS, "ankle_moment", "ankle moment", "ankle_angle", "dorsiflexion", "plantarflexion"),
    (POWERS, "hip_power", "hip power", "hip", "generated", "absorbed"),
    (POWERS, "knee_power", "knee power", "knee", "generated", "absorbed"),
    (POWERS, "ankle_power", "ankle power", "ankle", "generated", "absorbed"),
    (MOMENTS, "hip_frontal_moment", "hip frontal moment", "hip_adduction", "adduction", "abduction"),
    (MOMENTS, "knee_frontal_moment", "knee frontal moment", "knee_adduction", "adduction", "abduction"),
    (MOMENTS, "ankle_frontal_moment", "ankle frontal moment", "ankle_inversion", "inversion", "eversion"),
    (FORCES, "vertical_force", "vertical force / body weight", "vy", "upwards", ""),
    (FORCES, "fore_aft_force", "fore-aft force / body weight", "vx", "forwards", "backwards"),
)
VARIABLES = tuple(ClinicalVariable(*row) for row in _ROWS)
BY_NAME = {variable.name: variable for variable in VARIABLES}
