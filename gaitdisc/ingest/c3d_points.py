"""Points of a C3D file: markers in metres, what a model put among them, and poses of segments."""

import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gaitdisc.channel import Channel, vocabulary
from gaitdisc.errors import ReadError, UnitError
from gaitdisc.ingest.c3d_labels import LabelMap, find_equal_labels, make_unique, without_prefix
from gaitdisc.ingest.c3d_parameters import BLOCK, C3DHeader, C3DParameters, decoded
from gaitdisc.ingest.columns import name_channel
from gaitdisc.ingest.stated_units import METRES_AT_MOST, MILLIMETRES_AT_LEAST, distance_from_origin, refuse_other_unit
from gaitdisc.recording import Finding, Recording, Source
from gaitdisc.recording.arrays import Values
from gaitdisc.units import convert, inner_unit, parse_unit

Part = tuple[Values, tuple[Channel, ...]]
Streams = dict[str, Part]
AXES = "xyz"
NUMBERS = 17  # 4 x 4, first index fastest, and how sure it is; negative where the pose is not known
CELLS = tuple(f"r{row}{column}" for row in "123" for column in "123")
# list of POINT that names model outputs -> what they measure, their stream, the parameter of their unit, its usual text
MODEL_OUTPUTS = {
    "ANGLES": ("angle", "kinematics", "ANGLE_UNITS", "deg"),
    "FORCES": ("force", "moments", "FORCE_UNITS", "N"),
    "MOMENTS": ("moment", "moments", "MOMENT_UNITS", "N mm"),
    "POWERS": ("power", "moments", "POWER_UNITS", "W"),
    "SCALARS": ("signal", "kinematics", "SCALAR_UNITS", "mm"),
}


def point_names(parameters: C3DParameters, count: int) -> list[str]:
    """Names of a frame's points, all different, without people's names; a file may list more labels or fewer."""
    labels = [without_prefix(label) for label in parameters.texts("POINT", "LABELS")[:count]]
    return make_unique([*labels, *[""] * (count - len(labels))], "point")


def length_unit(parameters: C3DParameters, places: Values) -> tuple[str, list[Finding]]:
    """Unit of markers as stated, or by places (frame, coordinate) of some thousand frames where nothing is stated."""
    far, file = distance_from_origin(places), parameters.file
    if text := parameters.text("POINT", "UNITS"):
        unit = parse_unit(text)
        if unit is None or inner_unit(unit) != "m":
            raise UnitError("POINT:UNITS must be a unit of length", f"{file} says {text!r}", "Write mm or m.")
        refuse_other_unit(unit, far, file, "POINT:UNITS")
        return unit, []
    if not far > 0:
        return "m", []
    if METRES_AT_MOST < far < MILLIMETRES_AT_LEAST:
        raise UnitError(
            "markers must have a unit",
            f"{file} states none; a distance of {far:.4g} from the origin is too large for m and too small for mm",
            "Set POINT:UNITS in the file, for example to mm.",
        )
    unit = "m" if far <= METRES_AT_MOST else "mm"
    what = f"POINT:UNITS is empty; markers lie up to {far:.4g} from the origin and are read as {unit}"
    return unit, [Finding("warning", "unit", file, what, "all lengths if this is wrong; set POINT:UNITS")]


def point_streams(rows: Values, parameters: C3DParameters, labels: LabelMap) -> tuple[Streams, str, list[Finding]]:
    """Streams `markers`, `kinematics` and `moments` of the points that the file has, in m, deg, N, N m and W.

    rows (frame, 3 * point): in the file's units, NaN where a point was not seen
    """
    names, file = point_names(parameters, rows.shape[1] // 3), parameters.file
    kinds = _kinds(names, parameters)
    plain, suffixed = _without_suffix(names, kinds, file)
    listed = map(without_prefix, parameters.texts("POINT", "LABELS")[: len(names)])
    findings = [*find_equal_labels(listed, file), *suffixed]
    places = [point for point, name in enumerate(names) if name not in kinds]
    markers = rows[:, _columns(places)]
    triples = markers.reshape(len(markers), markers.shape[1] // 3, 3)
    unseen = np.all(triples == 0, axis=2)  # some software writes (0, 0, 0) for a marker that it did not see
    triples[unseen] = np.nan
    if unseen.any():
        what = f"marker positions at exactly (0, 0, 0), treated as missing: {int(unseen.sum())}"
        findings.append(Finding("note", "zero places", file, what, ""))
    unit, doubts = length_unit(parameters, markers)
    streams: Streams = {}
    if places:
        renamed = [(labels.name(names[point]) or names[point]) for point in places]
        channels = tuple(Channel(f"{name}.{axis}", "marker", "m") for name in renamed for axis in AXES)
        streams["markers"] = (np.asarray(convert(markers, unit, "m"), float), channels)
    for group, (_, stream, *_) in MODEL_OUTPUTS.items():
        points = [point for point, name in enumerate(names) if kinds.get(name) == group]
        if points:
            named = {names[at]: plain[at] for at in points}
            part, more = _model_part(rows[:, _columns(points)], named, group, parameters, labels)
            add_part(streams, stream, part)
            findings += more
    return streams, unit, findings + doubts


def add_part(streams: Streams, key: str, part: Part) -> None:
    """Put columns into a stream, after those that it has."""
    values, channels = part
    if key in streams:
        before, earlier = streams[key]
        values, channels = np.hstack([before, values]), (*earlier, *channels)
    streams[key] = (values, channels)


def _kinds(names: list[str], parameters: C3DParameters) -> dict[str, str]:
    """List of the group POINT that each output of a model is on."""
    kinds: dict[str, str] = {}
    for group in MODEL_OUTPUTS:
        for label in parameters.texts("POINT", group):
            kinds.setdefault(without_prefix(label), group)
    by_quantity = {quantity: group for group, (quantity, *_) in MODEL_OUTPUTS.items()}
    for name in names:
        # Files that lost their lists still call a knee angle by its name; as a marker it would be scaled to metres.
        known = vocabulary().named(f"{name}.x")
        if name not in kinds and known is not None and known.quantity in by_quantity:
            kinds[name] = by_quantity[known.quantity]
    return kinds


def _without_suffix(names: list[str], kinds: Mapping[str, str], file: str) -> tuple[list[str], list[Finding]]:
    """Names of outputs without the word of a laboratory's one model (`LKneeAngles_M`), unless names would be alike."""
    bases = {name: name.rpartition("_")[0] for name in names if name in kinds and "_" in name}
    bases = {name: base for name, base in bases.items() if base and base not in names}
    known = [name for name, base in bases.items() if any(vocabulary().named(f"{base}.{axis}") for axis in AXES)]
    words = {name[len(bases[name]) :] for name in known}
    if len(words) != 1:
        return names, []
    (word,) = words
    what = f"{known[0]} is read as {bases[known[0]]}; number of model outputs that end in {word}: {len(known)}"
    plain = [bases[name] if name in bases and name.endswith(word) else name for name in names]
    return plain, [Finding("note", "model suffix", file, what, "nothing if these are Plug-in Gait outputs")]


def _model_part(
    rows: Values, named: Mapping[str, str], group: str, parameters: C3DParameters, labels: LabelMap
) -> tuple[Part, list[Finding]]:
    quantity, _, stated, usual = MODEL_OUTPUTS[group]
    text, file = parameters.text("POINT", stated), parameters.file
    unit = parse_unit(text) if text else usual
    findings = []
    inner = inner_unit(unit) if unit else "1"
    if unit is None or (quantity != "signal" and inner.removesuffix("/kg") != inner_unit(usual)):
        what = f"POINT:{stated} is {text!r}, which is not a unit of {group.lower()}; "
        what += "the numbers are kept without a unit"
        findings.append(Finding("warning", "unit", file, what, f"the {group.lower()}; correct the parameter"))
        unit, inner = "1", "1"
    values = np.asarray(convert(rows, unit, inner), float)
    quantity = quantity if inner != "1" else "signal"
    channels = []
    for name_in_file, plain in named.items():
        for axis in AXES:
            label = f"{plain}.{axis}"
            mapped = labels.name(f"{name_in_file}.{axis}")
            known = name_channel(mapped) if mapped else vocabulary().named(label)
            name = known.name if known is not None else label
            sided = re.match(r"([LR])[A-Z]", plain)
            side = known.side if known is not None else sided[1].lower() if sided else ""
            channels.append(Channel(name, quantity, inner, side))
    most = float(np.max(np.abs(values), initial=0.0, where=np.isfinite(values)))
    if group == "ANGLES" and unit == "deg" and 0 < most < 3.2:
        what = f"no angle exceeds {most:.3g} deg, so the angles may be in radians"
        findings.append(Finding("warning", "unit", file, what, "all angles if this is true; correct POINT:ANGLE_UNITS"))
    return (values, tuple(channels)), findings


def _columns(points: list[int]) -> slice | NDArray[np.intp]:
    """Columns of points; a slice, which copies nothing, where they stand side by side."""
    if points and points == list(range(points[0], points[-1] + 1)):
        return slice(3 * points[0], 3 * points[-1] + 3)
    return (3 * np.array(points, dtype=np.intp)[:, None] + np.arange(3)).ravel()


def file_segments(path: Path, header: C3DHeader, parameters: C3DParameters, source: Source) -> dict[str, Recording]:
    """Stream `segments`, if any: origin [m] and axes of each, `<segment>.x` to `.z` and `<segment>.r11` to `.r33`.

    Axes are as the file has them, the columns of `r`, in the laboratory's frame.

    Source: ROTATION data type, c-motion.com: USED, RATIO, DATA_START, LABELS; 17 floats for each segment and frame.
    """
    used = parameters.count("ROTATION", "USED") or 0
    start = parameters.count("ROTATION", "DATA_START") or 0
    if not used or not start:
        return {}
    ratio = parameters.count("ROTATION", "RATIO") or 1
    frames = (parameters.count("POINT", "FRAMES") or header.frames) * ratio
    size = 4 * NUMBERS * used * frames
    first = (start - 1) * BLOCK
    if first + size > header.size or not frames:
        raise ReadError(
            f"{header.file} must contain the {frames} frames of {used} segments that ROTATION states",
            f"only {max(header.size - first, 0)} of {size} bytes are there from block {start} on",
            "Export the trial again. This copy is incomplete.",
        )
    raw = np.memmap(path, np.uint8, "r", first, (size,)).tobytes()
    cells = decoded(raw, 4, header.processor).astype(float).reshape(frames, used, NUMBERS)
    poses = cells[:, :, :16].reshape(frames, used, 4, 4).swapaxes(2, 3)
    poses[cells[:, :, 16] < 0] = np.nan
    names = [without_prefix(label) for label in parameters.texts("ROTATION", "LABELS")[:used]]
    names += [f"segment_{number}" for number in range(len(names) + 1, used + 1)]
    rate_hz = parameters.number("ROTATION", "RATE") or ratio * (parameters.number("POINT", "RATE") or header.rate_hz)
    unit, _ = length_unit(parameters, poses[:, :, :3, 3].reshape(frames, -1))
    columns, channels = [], []
    for place, name in enumerate(re.sub(r"(?i)_4x4$", "", name) for name in names):
        columns += [convert(poses[:, place, :3, 3], unit, "m"), poses[:, place, :3, :3].reshape(frames, 9)]
        channels += [Channel(f"{name}.{axis}", "translation", "m") for axis in AXES]
        channels += [Channel(f"{name}.{cell}", "signal", "1") for cell in CELLS]
    time = np.arange(frames) / rate_hz
    return {"segments": Recording(time, np.hstack(columns), tuple(channels), source=source)}
