"""The factors by which a C3D file's numbers are multiplied: one that is 0 or no number leaves nothing of them."""

from __future__ import annotations

import numpy as np

from gaitdisc.errors import ReadError
from gaitdisc.ingest.c3d_header import C3DHeader
from gaitdisc.ingest.c3d_parameters import C3DParameters
from gaitdisc.recording import Finding

_REMEDY = "Export the trial again, or set it in the software that wrote it; numbers without their scale are no measure."


def check_common_scales(header: C3DHeader, parameters: C3DParameters) -> None:
    """Refuse a file whose scale of all points or of all analog channels cannot be used."""
    stated = [("the header's scale of points", float(header.scale))] if header.points else []
    for group, name, used in (("POINT", "SCALE", header.points), ("ANALOG", "GEN_SCALE", header.analog_values)):
        numbers = parameters.numbers(group, name).ravel()
        if used and numbers.size:
            stated.append((f"{group}:{name}", float(numbers[0])))
    for name, scale in stated:
        if not np.isfinite(scale) or scale == 0:
            found = f"{name} of {header.file} is {scale:g}"
            raise ReadError("a C3D file needs finite scales other than 0", found, _REMEDY)


def unscaled_channels(parameters: C3DParameters, channels: int, file: str) -> tuple[frozenset[int], list[Finding]]:
    """Analog channels whose own scale or offset cannot be used: their numbers are missing, the others stand."""
    labels = [*parameters.texts("ANALOG", "LABELS"), *[""] * channels]
    bad: dict[int, str] = {}
    for name in ("SCALE", "OFFSET"):
        for place, number in enumerate(parameters.numbers("ANALOG", name).ravel()[:channels]):
            if not np.isfinite(number) or (name == "SCALE" and number == 0):
                bad.setdefault(place, f"ANALOG:{name} of channel #{place + 1} {labels[place]} is {number:g}")
    if not bad:
        return frozenset(), []
    several = f", and {len(bad) - 4} channels more" if len(bad) > 4 else ""
    what = f"{'; '.join(list(bad.values())[:4])}{several}; taken as missing"
    return frozenset(bad), [Finding("warning", "scale", file, what, "these channels; export the trial again")]
