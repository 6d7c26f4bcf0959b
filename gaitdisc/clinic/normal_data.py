"""Normal data that other programs keep (`.gcd` of Vicon, `.xlsx` of Polygon) as the table of a published reference."""

import io
import re
import zipfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gaitdisc.clinic.clinical_reference import COLUMNS, FEWEST_POINTS
from gaitdisc.errors import SchemaError
from gaitdisc.ingest.raw_file import read_raw
from gaitdisc.processing.leg_curves import BY_NAME, MOMENTS

ENDINGS = (".gcd", ".xlsx")
LARGEST_BYTES = 2**24  # unpacked part of a workbook
PER_KG = 20.0  # [N m/kg or W/kg] beyond it moments are in N mm/kg and powers in mW/kg
# clinical variable -> names in .gcd and in .xlsx, where (1) to (3) are Plug-in Gait's x, y and z
NAMES = {
    "pelvis_tilt": ("PelvicTilt", "PelvisAngles (1)"),
    "pelvis_obliquity": ("PelvicObliquity", "PelvisAngles (2)"),
    "pelvis_rotation": ("PelvicRotation", "PelvisAngles (3)"),
    "hip_flexion": ("HipFlexExt", "HipAngles (1)"),
    "hip_adduction": ("HipAbAdduct", "HipAngles (2)"),
    "hip_rotation": ("HipRotation", "HipAngles (3)"),
    "knee_flexion": ("KneeFlexExt", "KneeAngles (1)"),
    "knee_adduction": ("KneeValgVar", "KneeAngles (2)"),
    "knee_rotation": ("KneeRotation", "KneeAngles (3)"),
    "ankle_dorsiflexion": ("DorsiPlanFlex", "AnkleAngles (1)"),
    "ankle_rotation": ("FootRotation", "AnkleAngles (3)"),
    "foot_progression": ("FootProgression", "FootProgressAngles (3)"),
    "hip_moment": ("HipFlexExtMoment", "HipMoment (1)"),
    "hip_frontal_moment": ("HipAbAdductMoment", "HipMoment (2)"),
    "knee_moment": ("KneeFlexExtMoment", "KneeMoment (1)"),
    "knee_frontal_moment": ("KneeValgVarMoment", "KneeMoment (2)"),
    "ankle_moment": ("DorsiPlanFlexMoment", "AnkleMoment (1)"),
    "hip_power": ("HipPower", "HipPower"),
    "knee_power": ("KneePower", "KneePower"),
    "ankle_power": ("AnklePower", "AnklePower"),
}
Curves = Mapping[str, NDArray[np.float64]]


def read_normal_data(path: Path, people: int) -> pd.DataFrame:
    """Table of a published reference from means and deviations of so many people.

    Angles have the signs of the page already; Plug-in Gait's moments are positive where the page's are negative.
    """
    raw = read_raw(path)
    of_gcd = path.suffix.lower() == ".gcd"
    curves = _read_gcd(raw.lines()) if of_gcd else _read_xlsx(raw.content, raw.name)
    tables = []
    for variable, names in NAMES.items():
        curve = curves.get(names[0 if of_gcd else 1])
        if curve is None or len(curve) < FEWEST_POINTS or not curve[:, 1].any():
            continue
        kind = BY_NAME[variable]
        if kind.unit != "deg" and np.abs(curve).max() > PER_KG:
            curve = curve / 1e3
        mean = curve[:, 0] * (-1.0 if kind.kind == MOMENTS else 1.0)
        rows = {"group": "all", "speed_low": np.nan, "speed_high": np.nan, "people": people, "variable": variable}
        percent = np.linspace(0, 100, len(curve)).round(4)
        tables.append(pd.DataFrame({**rows, "percent": percent, "mean": mean, "sd": curve[:, 1]}))
    if not tables:
        raise SchemaError(
            f"{raw.name} must contain normal curves, such as {NAMES['knee_flexion'][0 if of_gcd else 1]!r}",
            f"it has {', '.join(list(curves)[:6]) or 'none'}",
            "Export the normal data again.",
        )
    return pd.concat(tables, ignore_index=True)[list(COLUMNS)]


def _read_gcd(lines: list[str]) -> Curves:
    """Variables of a .gcd: a line `!Name`, then mean and deviation in each line."""
    curves: dict[str, list[list[float]]] = {}
    rows: list[list[float]] = []
    for line in lines:
        cells = line.split()
        if line.startswith("!") and len(line.strip()) > 1:
            rows = curves.setdefault(cells[0][1:], [])
        elif len(cells) == 2 and all(re.fullmatch(r"[-+]?\d*\.?\d+(?:[eE][-+]?\d+)?", cell) for cell in cells):
            rows.append([float(cell) for cell in cells])
    return {name: np.array(rows) for name, rows in curves.items()}


def _read_xlsx(content: bytes, file: str) -> Curves:
    """Variables of a workbook: two columns of one name, least and largest, that is mean less and more one deviation."""
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as book:
            size = sum(part.file_size for part in book.infolist())
        if size > LARGEST_BYTES:
            raise ValueError(f"unpacked, it has {size >> 20} MiB; at most {LARGEST_BYTES >> 20} MiB are read")
        sheets = pd.read_excel(io.BytesIO(content), sheet_name=None, header=None)
    except ImportError as error:
        remedy = "Install it: pip install 'gaitdisc[xlsx]'."
        raise SchemaError("a workbook requires the package openpyxl", "it is not installed", remedy) from error
    except (zipfile.BadZipFile, KeyError, ValueError, TypeError, AttributeError) as error:
        remedy = "Save it as .xlsx again."
        raise SchemaError(f"{file} must be a workbook with a sheet 'Normal'", str(error)[:120], remedy) from error
    sheet = sheets.get("Normal", next(iter(sheets.values())))
    columns: dict[str, list[NDArray[np.float64]]] = {}
    for _, column in sheet.items():
        name, numbers = str(column.iloc[0]).strip(), pd.to_numeric(column.iloc[3:], errors="coerce")
        columns.setdefault(name, []).append(numbers.dropna().to_numpy(float))  # below the name stand two other lines
    pairs = {name: pair for name, pair in columns.items() if len(pair) == 2 and len(pair[0]) == len(pair[1])}
    return {name: np.column_stack([np.mean(pair, axis=0), np.ptp(pair, axis=0) / 2]) for name, pair in pairs.items()}
