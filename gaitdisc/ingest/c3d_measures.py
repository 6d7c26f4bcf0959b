"""Mass, lengths and widths of the person as the parameters of a C3D file hold them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from gaitdisc.ingest.c3d_kinetics import body_mass
from gaitdisc.ingest.c3d_parameters import C3DParameters, read_c3d_header, read_c3d_parameters
from gaitdisc.recording.body_measures import LENGTHS_M, BodyMeasures

GROUPS = ("PROCESSING", "SUBJECTS", "SUBJECT")
OF_THE_BODY = {
    "height_m": ("HEIGHT", "BODYHEIGHT"),
    "inter_asis_m": ("INTERASISDISTANCE", "ASISDISTANCE"),
    "marker_diameter_m": ("MARKERDIAMETER",),
}
OF_A_SIDE = {
    "leg_length_m": ("LEGLENGTH",),
    "knee_width_m": ("KNEEWIDTH",),
    "ankle_width_m": ("ANKLEWIDTH",),
}
FACTORS = (1e-3, 1.0, 1e-2)  # mm, as Nexus writes; m; cm: the first that makes it a length of a person


def read_body_measures(path: Path | str) -> BodyMeasures:
    """Measures of the person in PROCESSING, SUBJECTS or SUBJECT; none where absent, zero, or not in mm, m or cm."""
    path = Path(path)
    return body_measures_of(read_c3d_parameters(path, read_c3d_header(path)), path.name)


def body_measures_in(path: Path) -> BodyMeasures:
    """Measures of the person in a file, if it is a C3D file; no other kind has any."""
    return read_body_measures(path) if path.suffix.lower() == ".c3d" else BodyMeasures()


def body_measures_of(parameters: C3DParameters, file: str) -> BodyMeasures:
    """Measures of the person that stand in parameters.

    >>> import numpy as np
    >>> some = C3DParameters({("PROCESSING", "LKNEEWIDTH"): np.array([102.0])})
    >>> dict(body_measures_of(some, "a.c3d").knee_width_m)
    {'l': 0.102}
    """
    whole = {name: _length(parameters, name, keys) for name, keys in OF_THE_BODY.items()}
    sided = {}
    for name, keys in OF_A_SIDE.items():
        lengths = {side: _length(parameters, name, [f"{side.upper()}{key}" for key in keys]) for side in "lr"}
        sided[name] = {side: length for side, length in lengths.items() if length is not None}
    return BodyMeasures(body_mass(parameters), **whole, **sided, source=file)


def _length(parameters: C3DParameters, name: str, keys: Sequence[str]) -> float | None:
    low, high = LENGTHS_M[name]
    for group in GROUPS:
        for key in keys:
            number = parameters.number(group, key)
            for factor in FACTORS:
                if number is not None and low <= number * factor <= high:
                    return round(number * factor, 9)
    return None
