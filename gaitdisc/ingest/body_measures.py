"""Mass, lengths and widths of the person, as the parameters of a C3D file state them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from gaitdisc.ingest.c3d_parameters import C3DParameters, read_c3d_header, read_c3d_parameters
from gaitdisc.recording.trial import LENGTHS_M, MASS_KG, BodyMeasures

GROUPS = ("PROCESSING", "SUBJECTS", "SUBJECT")
OF_THE_BODY = {
    "height_m": ("HEIGHT", "BODYHEIGHT"),
    "inter_asis_m": ("INTERASISDISTANCE", "ASISDISTANCE"),
    "marker_diameter_m": ("MARKERDIAMETER",),
}
OF_A_SIDE = {"leg_length_m": ("LEGLENGTH",), "knee_width_m": ("KNEEWIDTH",), "ankle_width_m": ("ANKLEWIDTH",)}
FACTORS = (1e-3, 1.0, 1e-2)  # mm, as Nexus writes; m; cm: the first that makes it a length of a person


def body_mass(parameters: C3DParameters) -> float | None:
    """Body mass that the file states [kg], or None."""
    for group, name in (("PROCESSING", "BODYMASS"), ("SUBJECTS", "BODYMASS"), ("SUBJECT", "WEIGHT")):
        mass = parameters.number(group, name)
        if mass is not None and MASS_KG.hold(mass):
            return mass
    return None


def read_body_measures(path: Path | str) -> BodyMeasures:
    """Measures of the person in a file; none in another than a C3D, or where absent, zero, or not in mm, m or cm."""
    if Path(path).suffix.lower() != ".c3d":
        return BodyMeasures()
    return find_body_measures(read_c3d_parameters(path, read_c3d_header(path)))


def find_body_measures(parameters: C3DParameters) -> BodyMeasures:
    """Measures in PROCESSING, SUBJECTS or SUBJECT."""
    whole = {name: _length(parameters, name, keys) for name, keys in OF_THE_BODY.items()}
    sided = {}
    for name, keys in OF_A_SIDE.items():
        lengths = {side: _length(parameters, name, [f"{side.upper()}{key}" for key in keys]) for side in "lr"}
        sided[name] = {side: length for side, length in lengths.items() if length is not None}
    return BodyMeasures(body_mass(parameters), **whole, **sided, source=parameters.file)


def _length(parameters: C3DParameters, name: str, keys: Sequence[str]) -> float | None:
    for group in GROUPS:
        for key in keys:
            number = parameters.number(group, key)
            for factor in FACTORS:
                if number is not None and LENGTHS_M[name].hold(number * factor):
                    return round(number * factor, 9)
    return None
