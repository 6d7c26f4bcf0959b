"""The files of a walk with recorded forces: checked against each other and the model, and on one time base."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gaitdisc.channel import Channel, did_you_mean
from gaitdisc.engines.motion import Coordinate, TrackedMotion, Values
from gaitdisc.engines.opensim_tracked import OpensimTracked
from gaitdisc.engines.tracked_mapping import Tracked, find_loads, read_xml
from gaitdisc.errors import ChannelError, ReadError, SamplingError, SchemaError, UnitError
from gaitdisc.ingest.cells import Form, parse_cells
from gaitdisc.ingest.raw_file import read_raw
from gaitdisc.ingest.storage import parse_header, read_storage
from gaitdisc.recording import Recording
from gaitdisc.signals.butterworth import low_pass
from gaitdisc.signals.derivatives import derivative

SHORTEST_S = 0.5
EDGE_PERIODS = 1.0  # of the low-pass, left out at both ends of the angles where rates come from them
PASSIVE = ("LimitForce", "CoordinateForce", "BushingForce", "Ligament", "SpringForce", "GeneralizedForce")  # of classes
MOST_RAD, MOST_M = 4 * np.pi, 50.0


def draft_tracked(
    model: Path, loads: Path | None, forces: Path | None = None, actuators: Path | None = None
) -> tuple[Tracked, OpensimTracked, tuple[str, ...]]:
    """What a walk is tracked with, and the columns of its forces, once all have been found to belong together."""
    if model.suffix.lower() != ".osim":
        raise SchemaError(
            "a walk can be tracked only with an OpenSim model",
            f"found {model.name}",
            "Give an .osim model, or leave out --external-loads, --forces and --actuators.",
        )
    if loads is None:
        raise SchemaError(
            "a tracked walk must have recorded ground forces",
            f"{'--forces' if forces else '--actuators'} is given without --external-loads",
            "Add --external-loads grf.xml, the external-loads file of the inverse dynamics.",
        )
    for path in (model, loads, forces, actuators):
        if path is not None and not path.is_file():
            raise SchemaError("every file of a tracked walk must exist", f"there is no file {path}", "Check the path.")
    tracked = Tracked(model, find_loads(loads), forces, actuators)
    check_loads(tracked)
    engine = OpensimTracked(tracked)
    return tracked, engine, actuator_forces(tracked, engine.actuators)[0]


def check_loads(tracked: Tracked) -> None:
    """Refuse forces on a body that the model lacks, and columns that their file lacks."""
    loads, data = tracked.loads
    bodies = [body.get("name", "") for body in read_xml(tracked.model).iter("Body")]
    labels = parse_header(read_raw(data).lines(), data.name).labels
    for force in read_xml(loads).iter("ExternalForce"):
        body = (force.findtext("applied_to_body") or "").strip()
        if body.rpartition("/")[2] not in bodies:
            raise SchemaError(
                "a recorded force must act on a body of the model",
                f"{loads.name}: force {force.get('name')!r} acts on {body!r}, a body that {tracked.model.name} lacks",
                did_you_mean(body, bodies, f"Correct <applied_to_body>: {', '.join(bodies)}."),
            )
        for word in ("force_identifier", "point_identifier", "torque_identifier"):
            prefix = (force.findtext(word) or "").strip()
            lacking = [f"{prefix}{axis}" for axis in "xyz" if prefix and f"{prefix}{axis}" not in labels]
            if lacking:
                raise ChannelError(
                    f"each force of {loads.name} must have its columns in {data.name}",
                    f"for force {force.get('name')!r} there is no column {lacking[0]!r}",
                    f"Correct <{word}>, or export this column.",
                )


def _table(path: Path) -> tuple[list[str], Values]:
    """Labels and numbers of a storage file, as they stand there."""
    raw = read_raw(path)
    lines = raw.lines()
    header = parse_header(lines, raw.name)
    body, form = lines[header.body_line - 1 :], Form(raw.name, header.separator)
    return list(header.labels), parse_cells(body, header.labels, header.body_line, form).values


def read_tracked_motion(
    tracked: Tracked, kinematics: Path, coordinates: tuple[Coordinate, ...], known: tuple[str, ...]
) -> TrackedMotion:
    """Read the motion and the forces of actuators where all files have both.

    Rates come from their files, or from the angles after a low-pass.
    """
    if kinematics.suffix.lower() not in (".mot", ".sto"):
        raise ReadError(
            "a tracked walk must give the angles of the model's coordinates (.mot, .sto)",
            f"{kinematics.name} is a file of another kind",
            "Run OpenSim's inverse kinematics on the markers first, with this model, and give its .mot.",
        )
    time, q = _coordinates(kinematics, coordinates, "")
    for k, coordinate in enumerate(coordinates):
        largest, limit = float(np.nanmax(np.abs(q[:, k]))), MOST_RAD if coordinate.unit == "rad" else MOST_M
        if largest > limit:
            raise SchemaError(
                f"coordinate {coordinate.called!r} must stay within {limit:.3g} {coordinate.unit}",
                f"{kinematics.name} has {largest:.4g} {coordinate.unit}, which may be "
                f"{'degrees' if coordinate.unit == 'rad' else 'millimetres'}",
                "Write inDegrees=yes in the header of the file." if coordinate.unit == "rad" else "Export metres.",
            )
    turning = [k for k, coordinate in enumerate(coordinates) if coordinate.unit == "rad"]
    moved = np.ptp(q[:, turning], axis=0) if turning else np.ones(1)
    if moved.max() < np.radians(2.0):
        raise SchemaError(
            "at least one joint of a walk must turn by more than 2 deg",
            f"{kinematics.name}: the largest range is {np.degrees(moved.max()):.2g} deg, so the angles may be "
            "in radians",
            "Write inDegrees=no in the header of the file.",
        )
    named = [(file, word) for file, word in ((tracked.speeds, "/speed"), (tracked.accelerations, "/accel")) if file]
    rates = [_coordinates(file, coordinates, word) for file, word in named if len(named) == 2]
    names, forces = actuator_forces(tracked, known)
    spans = {kinematics: time, **{file: at for (file, _), (at, _) in zip(named, rates, strict=False)}}
    spans[tracked.loads[1]] = _table(tracked.loads[1])[1][:, 0]
    if tracked.forces is not None:
        spans[tracked.forces] = forces[:, 0]
    inside = _select_shared(spans, time, tracked)

    def on_time(times: Values, values: Values) -> Values:
        return np.column_stack([np.interp(time, times, column) for column in values.T])

    if rates:
        v, a = [on_time(*rate) for rate in rates]
    else:
        channels = tuple(Channel(coordinate.called, "signal", coordinate.unit) for coordinate in coordinates)
        smooth = low_pass(Recording(time, q, channels), tracked.lowpass_hz)
        q, edge = np.array(smooth.values), int(EDGE_PERIODS * smooth.rate_hz / tracked.lowpass_hz)
        q[:edge], q[len(q) - edge :] = np.nan, np.nan
        v, a = derivative(q, smooth.rate_hz, 1), derivative(q, smooth.rate_hz, 2)
    pulls = on_time(forces[:, 0], forces[:, 1:]) if names else np.zeros((len(time), 0))
    inside &= np.isfinite(q).all(axis=1) & np.isfinite(v).all(axis=1) & np.isfinite(a).all(axis=1)
    kept = np.arange(inside.argmax(), len(inside) - inside[::-1].argmax())
    forces, span = pulls[kept], (float(time[0]), float(time[-1]))
    return TrackedMotion(
        time[kept], q[kept], v[kept], a[kept], actuators=names, forces=forces, differentiated=not rates, span=span
    )


def _coordinates(path: Path, coordinates: tuple[Coordinate, ...], word: str) -> tuple[Values, Values]:
    """Times and free coordinates (sample, coordinate) of a file, in radians and metres."""
    streams = list(read_storage(path).streams.values())
    turning, columns = {coordinate.called for coordinate in coordinates if coordinate.unit == "rad"}, {}
    for stream in streams:
        for k, channel in enumerate(stream.channels):
            name, unit = channel.name.removesuffix(word), channel.unit
            if name in turning and not unit.startswith("deg"):  # a name that only this model has
                degrees = parse_header(read_raw(path).lines(), path.name).degrees
                if degrees is None:
                    raise UnitError(
                        f"{path.name} must state whether its angles are in degrees",
                        "its header has no line inDegrees",
                        "Write inDegrees=yes or inDegrees=no in the header, before endheader.",
                    )
                unit = "deg" if degrees else "rad"
            columns[name] = stream.values[:, k] * (np.pi / 180 if unit.startswith("deg") else 1.0)
    for coordinate in coordinates:
        if coordinate.called not in columns:
            meant = did_you_mean(coordinate.called, columns)
            raise ChannelError(
                "every free coordinate of the model must be measured",
                f"{path.name} has no column {coordinate.called!r}",
                f"{f'{meant} Rename' if meant else 'Add'} this column, or lock the coordinate in the model.",
            )
    return streams[0].time, np.column_stack([columns[coordinate.called] for coordinate in coordinates])


def actuator_forces(tracked: Tracked, known: tuple[str, ...]) -> tuple[tuple[str, ...], Values]:
    """Return the columns of a forces' file, and its numbers with time first; what the loads give is passed over.

    Each is an actuator, or the net moment of a coordinate by its name in OpenSim's inverse dynamics.
    """
    path = tracked.forces
    if path is None:
        return (), np.zeros((0, 1))
    labels, values = _table(path)
    names = [label.rpartition("/")[2] for label in labels]
    recorded = [
        f"{(force.findtext('applied_to_body') or '').strip().rpartition('/')[2]}_{force.get('name')}_"
        for force in read_xml(tracked.loads[0]).iter("ExternalForce")
    ]
    model = read_xml(tracked.model)
    passive = [part.get("name", "") for part in model.iterfind(".//ForceSet/objects/*") if part.tag.endswith(PASSIVE)]
    net = {f"{element.get('name')}_{word}" for element in model.iter("Coordinate") for word in ("moment", "force")}
    again = tuple(name for name in (*recorded, *passive) if name)  # the model or the loads' file gives these anyway
    kept = [0, *(k for k, name in enumerate(names) if k and (name in net or not name.startswith(again)))]
    for name in (names[k] for k in kept[1:]):
        if name not in known and name not in net:
            raise ChannelError(
                "every column of the forces file must be an actuator of the model",
                f"{path.name} has {name!r}, which is no actuator",
                f"{did_you_mean(name, known)} If it is a reserve or residual actuator, ".lstrip()
                + "name the file that defines it in [tracked] as actuators.",
            )
    lacking = [name for name in known if name not in names]
    if lacking and not net.issuperset(names[k] for k in kept[1:]):  # net moments hold those of all muscles
        raise ChannelError(
            "the forces file must have a column for every actuator of the model",
            f"{path.name} lacks {lacking[0]!r}" + (f" and {len(lacking) - 1} more" if len(lacking) > 1 else ""),
            "Export all forces: the force of an unlisted muscle would be reported as missing.",
        )
    values = values[:, kept]
    if not np.isfinite(values).all():
        row, column = (int(indices[0]) for indices in np.nonzero(~np.isfinite(values)))
        raise ReadError(
            "forces must not have gaps", f"{path.name}: row {row + 1} of {names[kept[column]]!r} is empty", "Fill it."
        )
    return tuple(names[k] for k in kept[1:]), values


def _select_shared(spans: dict[Path, Values], time: Values, tracked: Tracked) -> NDArray[np.bool_]:
    """Samples of a time base that all files cover and that are to be tracked."""
    first = max(spans, key=lambda file: spans[file][0])
    last = min(spans, key=lambda file: spans[file][-1])
    begin, end = float(spans[first][0]), float(spans[last][-1])
    if end - begin < SHORTEST_S:
        raise SamplingError(
            f"motion and forces must overlap by at least {SHORTEST_S:g} s",
            f"{first.name} begins at {begin:.4g} s, {last.name} ends at {end:.4g} s",
            "Use one clock for both, or export the same part of the trial.",
        )
    inside = (time >= max(begin - 1e-9, tracked.start_s)) & (time <= min(end + 1e-9, tracked.end_s))
    if not inside.any() or np.ptp(time[inside]) < SHORTEST_S:
        raise SamplingError(
            f"a walk must last at least {SHORTEST_S:g} s",
            f"the walk of {tracked.model.name} is tracked from {tracked.start_s:g} to {tracked.end_s:g} s, where the "
            f"number of samples is {inside.sum()}",
            "Correct start_s and end_s in [tracked].",
        )
    return inside
