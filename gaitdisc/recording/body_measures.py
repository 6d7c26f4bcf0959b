"""What was measured on the person with scales, tape and calliper."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from gaitdisc.errors import UnitError
from gaitdisc.recording.arrays import frozen

LENGTHS_M = {
    "height_m": (0.4, 2.5),
    "inter_asis_m": (0.08, 0.45),
    "marker_diameter_m": (0.002, 0.04),
    "leg_length_m": (0.2, 1.4),
    "knee_width_m": (0.03, 0.25),
    "ankle_width_m": (0.02, 0.15),
}
MASS_KG = (5.0, 300.0)
LEG_OF_STATURE = 0.530  # greater trochanter over ground, Winter (2009), figure 4.1


@dataclass(frozen=True)
class BodyMeasures:
    """Mass and lengths of a person; None or absent where nobody measured.

    >>> BodyMeasures(mass_kg=60.3, knee_width_m={"l": 0.124, "r": 0.121}).knee_width_m["l"]
    0.124
    """

    mass_kg: float | None = None  # body mass [kg]
    height_m: float | None = None  # stature [m]
    inter_asis_m: float | None = None  # distance between the anterior superior iliac spines [m]
    marker_diameter_m: float | None = None  # of the markers that were used [m]
    # side (`l`, `r`) to leg length from spine to medial malleolus, width of the knee between its condyles, width of the
    # ankle between its malleoli [m]
    leg_length_m: Mapping[str, float] = field(default_factory=dict)
    knee_width_m: Mapping[str, float] = field(default_factory=dict)
    ankle_width_m: Mapping[str, float] = field(default_factory=dict)
    source: str = "given"  # where they are from: a file's name, or `given`

    @property
    def leg_m(self) -> float | None:
        """Mean leg length [m], by stature where nobody measured a leg; None without either.

        >>> round(BodyMeasures(height_m=1.7).leg_m, 3), BodyMeasures().leg_m
        (0.901, None)
        """
        lengths = list(self.leg_length_m.values())
        if lengths:
            return sum(lengths) / len(lengths)
        return None if self.height_m is None else LEG_OF_STATURE * self.height_m

    def __post_init__(self) -> None:
        """Refuse what no person measures, once."""
        _check("mass_kg", self.mass_kg, MASS_KG, "kg")
        for name, limits in LENGTHS_M.items():
            value = getattr(self, name)
            if isinstance(value, Mapping):
                for side, length in value.items():
                    _check(f"{name} of side {side!r}", length, limits, "m")
                object.__setattr__(self, name, frozen(value))
            else:
                _check(name, value, limits, "m")


def _check(name: str, value: float | None, limits: tuple[float, float], unit: str) -> None:
    if value is not None and not limits[0] <= value <= limits[1]:
        raise UnitError(
            f"a person's {name} is between {limits[0]:g} and {limits[1]:g} {unit}",
            f"found {value:g} {unit}",
            f"Give it in {unit}.",
        )
