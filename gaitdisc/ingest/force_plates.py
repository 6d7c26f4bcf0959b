"""Force plates of a C3D file: forces, moments and centres of pressure in the laboratory's axes."""

import itertools
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gaitdisc.channel import Channel
from gaitdisc.ingest.c3d_parameters import C3DParameters
from gaitdisc.ingest.c3d_points import AXES, Streams
from gaitdisc.recording import Finding, Surface
from gaitdisc.recording.arrays import Values
from gaitdisc.units import convert, inner_unit, parse_unit

LEAST_LOAD_N = 20.0  # below it a foot counts as off a plate, and a centre of pressure is noise divided by noise
CLEAR_LOAD_N = 100.0  # what a drifting plate does not show, and a foot does
STRAY = 0.05  # share of the loaded samples that may lie beside a plate
BESIDE_M = 0.05  # a centre of pressure farther outside of the plate than this is wrong
_CHANNELS_OF_TYPE = {1: 6, 2: 6, 3: 8, 4: 6}


@dataclass(frozen=True, eq=False)
class ForcePlate:
    """Where a plate lies and how its channels make a force."""

    number: int
    # 1: force, centre of pressure and free moment; 2: force and moment; 3: eight forces of four pillars; 4: as 2,
    # through a calibration matrix
    kind: int
    columns: tuple[int, ...]
    # (4, 3) [m], in the laboratory's axes; the first lies towards the plate's +x and +y, the second towards -x and +y
    corners: Values
    # (3,) [m], from the origin of the sensors to the centre of the surface, in the plate's axes; type 3: half the
    # distances between the pillars, and the depth of the sensors
    origin: Values
    calibration: Values  # (6, 6) or (0, 0), type 4 only; gives N and N times the file's unit of length

    @property
    def surface(self) -> Surface:
        """What a foot can step on, under the first part of its channels' names."""
        return Surface(f"plate_{self.number}", self.corners)

    @property
    def axes(self) -> Values:
        """The plate's axes as columns, (3, 3), in the laboratory's axes; NaN where the corners span no surface."""
        first, second, third, fourth = self.corners
        x = first + fourth - second - third
        z = np.cross(x, first + second - third - fourth)
        with np.errstate(all="ignore"):
            x, z = x / np.linalg.norm(x), z / np.linalg.norm(z)
        return np.asarray(np.column_stack([x, np.cross(z, x), z]), float)

    @property
    def vertical(self) -> int:
        """Which of the laboratory's axes, 0 to 2, is nearest to the plate's normal."""
        return int(np.argmax(np.abs(self.axes[:, 2])))

    def wrench(self, values: Values, units: tuple[str, ...]) -> tuple[Values, Values]:
        """Force [N], moment about the surface's centre [N m], each (sample, 3) in the plate's axes, of its channels."""
        if self.kind == 4:
            values = values @ self.calibration.T
        columns = [convert(values[:, i], unit, inner_unit(unit)) for i, unit in enumerate(units)]
        values = np.asarray(np.column_stack(columns), float)
        if self.kind == 3:  # Kistler: pillar 1 stands at (+a, +b), 2 at (-a, +b), as the corners do
            x12, x34, y14, y23, z1, z2, z3, z4 = values.T
            a, b = np.abs(self.origin[:2])
            force = np.column_stack([x12 + x34, y14 + y23, z1 + z2 + z3 + z4])
            turning = b * (x34 - x12) + a * (y14 - y23)
            moment = np.column_stack([b * (z1 + z2 - z3 - z4), a * (z2 + z3 - z1 - z4), turning])
            return force, moment + np.cross(force, np.array([0.0, 0.0, self.origin[2]]))
        force = values[:, :3]
        if self.kind == 1:
            point = np.column_stack([values[:, 3:5], np.zeros(len(values))])
            free = np.column_stack([np.zeros((len(values), 2)), values[:, 5]])
            return force, np.cross(point, force) + free
        return force, values[:, 3:6] + np.cross(force, self.origin)


def centre_of_pressure(force: Values, moment: Values) -> Values:
    """Centre of pressure (sample, 3) [m] of force [N] and moment [N m] in the plate's axes; NaN below 20 N.

    >>> centre_of_pressure(np.array([[0, 0, -500.0], [0, 0, -1.0]]), np.array([[50.0, 25, 0], [1, 1, 0]]))
    array([[ 0.05, -0.1 ,  0.  ],
           [  nan,   nan,   nan]])
    """
    loaded = np.abs(force[:, 2]) > LEAST_LOAD_N
    pressure = np.full_like(force, np.nan)
    normal = force[loaded, 2]
    pressure[loaded] = np.column_stack([-moment[loaded, 1] / normal, moment[loaded, 0] / normal, np.zeros(len(normal))])
    return pressure


def force_plates(
    parameters: C3DParameters, channels: int, length_unit: str, unscaled: frozenset[int] = frozenset()
) -> tuple[list[ForcePlate], list[Finding]]:
    """Plates that the group FORCE_PLATFORM describes, and why others cannot be used.

    unscaled: columns of analog channels without a scale that can be used
    Source: The C3D file format, c3d.org, FORCE_PLATFORM. Laboratories write ORIGIN with either sign for types 2 to 4;
        as the surface lies on the side that feet come from, which is the plate's -z, a positive third coordinate is
        turned around.
    """
    used = parameters.count("FORCE_PLATFORM", "USED") or 0
    kinds = parameters.numbers("FORCE_PLATFORM", "TYPE").ravel()
    columns = _last_axis(parameters.numbers("FORCE_PLATFORM", "CHANNEL"), 1)
    corners = _last_axis(parameters.numbers("FORCE_PLATFORM", "CORNERS"), 2)
    origins = _last_axis(parameters.numbers("FORCE_PLATFORM", "ORIGIN"), 1)
    matrices = _last_axis(parameters.numbers("FORCE_PLATFORM", "CAL_MATRIX"), 2)
    plates, findings, file = [], [], parameters.file
    for place in range(min(used, 64)):
        kind = int(kinds[place]) if place < len(kinds) and np.isfinite(kinds[place]) else 0
        count = _CHANNELS_OF_TYPE.get(kind, 0)
        numbers = columns[place][:count] if place < len(columns) else np.empty(0)
        why = ""
        if not count:
            why = f"is of type {kind}, but only types 1 to 4 are known"
        elif len(numbers) < count or not np.all((numbers >= 1) & (numbers <= channels)):
            why = f"names channels {', '.join(format(n, 'g') for n in numbers)}, but the file has {channels} channels"
        elif any(int(n) - 1 in unscaled for n in numbers):
            why = "has a channel without a scale"
        elif (
            place >= len(corners) or corners[place].shape != (3, 4) or place >= len(origins) or origins[place].size != 3
        ):
            why = "has no corners or no origin"
        elif kind == 4 and (place >= len(matrices) or matrices[place].shape != (6, 6)):
            why = "is of type 4 and has no calibration matrix"
        elif kind == 4 and not np.isfinite(matrices[place]).all():
            why = "has a calibration matrix that is not finite"
        if not why:
            origin = np.asarray(convert(origins[place], length_unit, "m"), float)
            if kind != 1 and origin[2] > 0:
                origin = -origin
            matrix = matrices[place] if kind == 4 else np.empty((0, 0))
            at = np.asarray(convert(corners[place].T, length_unit, "m"), float)
            plate = ForcePlate(place + 1, kind, tuple(int(n) - 1 for n in numbers), at, origin, matrix)
            why = "" if np.isfinite(origin).all() else "has an origin that is not finite"
            why = why if np.isfinite(plate.axes).all() else "has corners that span no surface"
            if not why:
                plates.append(plate)
        if why:
            what = f"force plate {place + 1} {why}; its channels are read as signals, not as forces"
            findings.append(Finding("warning", "force plate", file, what, "the plate's forces; correct FORCE_PLATFORM"))
    return plates, findings or _report_undescribed(parameters, used, max(len(kinds), len(columns), len(corners)))


def _report_undescribed(parameters: C3DParameters, used: int, described: int) -> list[Finding]:
    """Say where a file holds more plates than FORCE_PLATFORM:USED counts: one wrong bit drops all of their forces."""
    named = zip(parameters.texts("ANALOG", "LABELS"), parameters.texts("ANALOG", "UNITS"), strict=False)
    forces = [label for label, unit in named if unit.strip() == "N" and re.search(r"(?i)f[-_. ]?[xyz]", label)]
    if used < described:
        what = f"FORCE_PLATFORM:USED is {used}, but the group describes {described} plates"
    elif forces and not used:
        what = f"no force plate is described, but there are channels in N: {len(forces)} ({forces[0].strip()!r}, ...)"
    else:
        return []
    spoils = "the excluded ground forces; correct FORCE_PLATFORM"
    return [Finding("warning", "force plate", parameters.file, what, spoils)]


def plate_streams(
    rows: Values, plates: list[ForcePlate], parameters: C3DParameters, length_unit: str
) -> tuple[Streams, set[int], list[Finding]]:
    """Stream `forces` of the plates: ground on foot, vertical positive up.

    `plate_<n>_fx`, `_fy`, `_fz` [N] are the force of the ground on the foot along the laboratory's axes; the one along
    the axis nearest to the plate's normal is the vertical force, positive upwards. `plate_<n>_mx`, `_my`, `_mz` [N m]
    are its moment about the centre of the plate's surface, `plate_<n>_px`, `_py`, `_pz` [m] the centre of pressure on
    the surface, NaN below 20 N. A foot cannot pull at a plate: where a loaded plate says it does, the file gives the
    force of the foot on the ground and is turned around; a plate that nobody stepped on follows the others.

    rows (sample, channel): analog channels in the file's units
    """
    findings: list[Finding] = []
    wrenches, measured, file = [], [], parameters.file
    for plate in plates:
        units, doubts = _units(plate, parameters, length_unit)
        findings += doubts
        if not units:
            continue
        values, doubts = _zero(rows[:, list(plate.columns)], units, plate, parameters)
        findings += doubts
        placed, doubts = _with_origin(plate, values, units, file)
        findings += doubts
        measured.append((placed, values, units))
        wrenches.append((placed, *placed.wrench(values, units)))
    findings += _report_exchanged(measured, file)
    up = []  # +1 where a loaded plate pushes up along the laboratory's vertical, -1 where it would pull, 0 unloaded
    for plate, force, _ in wrenches:
        vertical = force @ plate.axes[plate.vertical]
        clear = vertical[np.abs(vertical) > CLEAR_LOAD_N]
        up.append(float(np.sign(np.sum(clear * np.abs(clear)))))
    most = float(np.sign(sum(up)))
    blocks, channels = [], []
    for (plate, force, moment), sense in zip(wrenches, up, strict=True):
        sign = sense or most or 1.0
        pressure = centre_of_pressure(force, moment)
        axes = plate.axes.T
        blocks.append(np.hstack([sign * force @ axes, sign * moment @ axes, plate.surface.centre + pressure @ axes]))
        forces = ["vertical_force" if place == plate.vertical else "force" for place in range(3)]
        kinds = (("f", forces, "N"), ("m", ["moment"] * 3, "N m"), ("p", ["pressure_centre"] * 3, "m"))
        channels += [
            Channel(f"plate_{plate.number}_{letter}{axis}", quantity, unit)
            for letter, quantities, unit in kinds
            for axis, quantity in zip(AXES, quantities, strict=True)
        ]
    turned = [plate.number for (plate, _, _), sense in zip(wrenches, up, strict=True) if (sense or most) < 0]
    if turned:
        what = f"plate {', '.join(map(str, turned))}: the sign of the force of the foot on the ground was reversed"
        findings.append(Finding("note", "force sign", file, what, ""))
    if up and not any(up):
        what = f"no plate was loaded with more than {CLEAR_LOAD_N:g} N, so the sign of the forces could not be checked"
        findings.append(Finding("note", "force sign", file, what, "nothing, because nobody stepped on a plate"))
    streams: Streams = {"forces": (np.hstack(blocks), tuple(channels))} if blocks else {}
    return streams, {column for plate, _, _ in wrenches for column in plate.columns}, findings


def plate_loads(streams: Streams, samples_per_frame: int) -> Values:
    """Size of each plate's force at the frames of the points, (frame, plate) [N]."""
    if "forces" not in streams:
        return np.empty((0, 0))
    values, channels = streams["forces"]
    plates = dict.fromkeys(c.name.rpartition("_")[0] for c in channels)
    first = [next(i for i, c in enumerate(channels) if c.name == f"{plate}_fx") for plate in plates]
    at_frames = values[::samples_per_frame]
    return np.column_stack([np.linalg.norm(at_frames[:, i : i + 3], axis=1) for i in first])


def _last_axis(numbers: Values, inner: int) -> list[Values]:
    """One array a plate; a file with one plate may leave the last dimension out."""
    if numbers.ndim == inner:
        return [numbers] if numbers.size else []
    return [numbers[..., place] for place in range(numbers.shape[-1])] if numbers.ndim == inner + 1 else []


def _units(plate: ForcePlate, parameters: C3DParameters, length_unit: str) -> tuple[tuple[str, ...], list[Finding]]:
    moment = {"m": "N m", "cm": "N cm", "mm": "N mm"}[length_unit]
    usual = {1: ("N",) * 3 + (length_unit,) * 2 + (moment,), 3: ("N",) * 8}.get(plate.kind, ("N",) * 3 + (moment,) * 3)
    if plate.kind == 4:
        return usual, []
    texts = [*parameters.texts("ANALOG", "UNITS"), *[""] * (max(plate.columns) + 1)]
    units, file = [], parameters.file
    for column, expected in zip(plate.columns, usual, strict=True):
        text = texts[column].strip()
        unit = parse_unit(text) if text else expected
        if unit is None or inner_unit(unit) != inner_unit(expected):
            what = f"force plate {plate.number} has channel #{column + 1} in {text!r} instead of {expected}; "
            what += "the plate is not used"
            return (), [Finding("warning", "force plate", file, what, "the plate's forces; correct ANALOG:UNITS")]
        units.append(unit)
    if not any(texts[column].strip() for column in plate.columns):
        what = f"force plate {plate.number} states no units; {usual[0]} and {usual[-1]} are assumed"
        return tuple(units), [Finding("warning", "unit", file, what, "the forces if this is wrong; set ANALOG:UNITS")]
    return tuple(units), []


def _zero(
    values: Values, units: tuple[str, ...], plate: ForcePlate, parameters: C3DParameters
) -> tuple[Values, list[Finding]]:
    """Channels of a plate without their mean over FORCE_PLATFORM:ZERO, unless the plate was loaded then."""
    span = parameters.numbers("FORCE_PLATFORM", "ZERO").ravel()[:2]
    if len(span) < 2 or not 1 <= span[0] < span[1] <= len(values):
        return values, []
    first, last = int(span[0]) - 1, int(span[1])
    offset = values[first:last].mean(axis=0)
    load = float(np.abs(plate.wrench(offset[None], units)[0][0, 2]))
    if load > CLEAR_LOAD_N:
        what = f"force plate {plate.number} carries {load:.0f} N in samples {first + 1} to {last} (FORCE_PLATFORM:ZERO)"
        spoils = "the offset of the plate, which is therefore not removed"
        return values, [Finding("note", "plate zero", parameters.file, what, spoils)]
    return values - offset, []


def _with_origin(
    plate: ForcePlate, values: Values, units: tuple[str, ...], file: str
) -> tuple[ForcePlate, list[Finding]]:
    """Plate with its origin turned around if only then the centre of pressure lies on it."""
    beside = _beside(plate, values, units)
    if beside < STRAY:
        return plate, []
    turned = replace(plate, origin=-plate.origin)
    if plate.kind in (2, 4) and _beside(turned, values, units) < STRAY:
        what = f"force plate {plate.number}: ORIGIN points from the surface to the sensors; its sign was reversed"
        return turned, [Finding("note", "plate origin", file, what, "nothing: the corrected force acts on the plate")]
    what = f"force plate {plate.number}: the centre of pressure lies outside the plate in {100 * beside:.0f} % of the "
    what += "loaded samples"
    return plate, [Finding("warning", "centre of pressure", file, what, "joint moments; check zero, ORIGIN and units")]


def _report_exchanged(measured: Sequence[tuple[ForcePlate, Values, tuple[str, ...]]], file: str) -> list[Finding]:
    """Say which two plates bear each other's channels: with these exchanged each has its centre of pressure on it."""
    findings = []
    for (plate, values, units), (other, other_values, other_units) in itertools.combinations(measured, 2):
        astray = min(_beside(plate, values, units), _beside(other, other_values, other_units))
        if plate.kind != other.kind or astray < STRAY:
            continue
        if max(_beside_either(plate, other_values, other_units), _beside_either(other, values, units)) < STRAY:
            what = (
                f"the channels of force plates {plate.number} and {other.number} are swapped: the centre of pressure "
                f"is outside each plate in {100 * astray:.0f} % of the loaded samples, but on it after an exchange"
            )
            spoils = "the assignment of feet to plates, moments and powers; correct FORCE_PLATFORM:CHANNEL"
            findings.append(Finding("warning", "swapped plates", file, what, spoils))
    return findings


def _beside_either(plate: ForcePlate, values: Values, units: tuple[str, ...]) -> float:
    """As `_beside`, whichever way the origin points."""
    turned = replace(plate, origin=-plate.origin)
    return min(_beside(candidate, values, units) for candidate in (plate, turned))


def _beside(plate: ForcePlate, values: Values, units: tuple[str, ...]) -> float:
    """Share of the loaded samples whose centre of pressure lies beside the plate."""
    pressure = centre_of_pressure(*plate.wrench(values, units))
    half = np.abs((plate.corners - plate.surface.centre) @ plate.axes)[:, :2].max(axis=0)
    loaded = np.isfinite(pressure[:, 0])
    outside = np.any(np.abs(pressure[loaded, :2]) > half + BESIDE_M, axis=1)
    return float(outside.mean()) if outside.size else 0.0
