"""A record beside its model: what it does not show, another unit or sign, and samples in which a limit acts.

states (trial, sample, state): smoothed: coordinates, then speeds
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gaitdisc.engines.ball_joints import STEEPEST
from gaitdisc.engines.engine import Engine
from gaitdisc.engines.motion import Coordinate, Values
from gaitdisc.errors import ChannelError, SchemaError
from gaitdisc.recording import Finding
from gaitdisc.simulation.expression import names, parse
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.simulation import Simulation

SPUN = 8 * np.pi  # [rad], four turns: what turns freely may go round a few times
MISFIT = 0.6  # share of the accelerations' squares that the model as it stands misses, above which others are tried
EASED = 0.5  # share of the misfit that is left at most where one more column has another convention, and
FITS = 0.35  # where all of them have, for the record to be refused
BEYOND_DOUBT = 0.02  # share that is enough whatever else the model lacks
POINTS = 400  # at which accelerations are compared
TINY = 1e-12


class _Convention(NamedTuple):
    """Another unit or sign of a column."""

    factor: float  # that makes the model's unit of it
    is_so: str
    mend: str


_UNIT = 'Write in the mapping: [observations.{column}] unit = "%s", expression = "%s{name}".'
_TURNED = _Convention(
    -1.0, "has the opposite sign", 'Write in the mapping: [observations.{column}] expression = "-({expression})".'
)
CONVENTIONS = {
    "rad": (
        _TURNED,
        _Convention(np.pi / 180, "is in degrees", _UNIT % ("deg", "57.2957795*")),
        _Convention(180 / np.pi, "is in radians", _UNIT % ("rad", "")),
    ),
    "m": (_TURNED, _Convention(1e-3, "is in millimetres", _UNIT % ("mm", "1000*"))),
}


def refuse_unmeasured(mapping: Simulation, engine: Engine, measured: Measured) -> None:
    """Refuse a record that does not show every free coordinate."""
    seen = {
        name for channel, text in mapping.observations if channel in measured.channels for name in names(parse(text))
    }
    for coordinate in engine.coordinates:
        if coordinate.name not in seen:
            raise ChannelError(
                "every free coordinate of the model must be measured",
                f"no column shows {coordinate.called!r} (the observations show {', '.join(sorted(seen)) or 'none'})",
                "Name its column under [observations], or lock the coordinate in the model.",
            )


def refuse_other_units(mapping: Simulation, engine: Engine, measured: Measured, states: Values) -> None:
    """Refuse angles that can be no radians: degrees that nobody said are degrees; a wheel may turn on and on."""
    largest, as_read = np.nanmax(np.abs(states), axis=(0, 1)), np.ones(len(engine.coordinates))
    far = [k for k, q in enumerate(engine.coordinates) if q.unit == "rad" and largest[k] > _limit(q)]
    steep = [k + 1 for k in getattr(engine, "balls", ()) if largest[k + 1] > STEEPEST]
    if steep:
        coordinate = engine.coordinates[steep[0]]
        raise SchemaError(
            f"the angle {coordinate.called!r} must stay within {STEEPEST:g} rad: at a right angle two axes coincide",
            f"column {_column(mapping, coordinate)!r} reaches {largest[steep[0]]:.4g} rad",
            "State degrees in the mapping if these are degrees. Otherwise turn the model's axes: x must point ahead.",
        )
    misfit, degrees = _Misfit(mapping, engine, measured, states), as_read.copy()
    degrees[far] = np.pi / 180
    for k in far:
        coordinate = engine.coordinates[k]
        if np.isfinite(coordinate.high) or misfit.with_factors(degrees) < misfit.with_factors(as_read):
            raise SchemaError(
                f"coordinate {coordinate.called!r} must stay within {_limit(coordinate):.3g} rad",
                f"column {_column(mapping, coordinate)!r} reaches {largest[k]:.4g} rad; it may be in degrees",
                f"State degrees in the mapping: gaitdisc new {engine.path.with_suffix('.toml').name} --from "
                f"{engine.path.name} --degrees.",
            )


def refuse_other_conventions(mapping: Simulation, engine: Engine, measured: Measured, states: Values) -> None:
    """Refuse a record that the model follows with other signs or units of some columns, and does not as it stands."""
    factors, misfit = np.ones(len(engine.coordinates)), _Misfit(mapping, engine, measured, states)
    as_read = now = misfit.with_factors(factors)
    corrections: list[tuple[list[Coordinate], _Convention]] = []
    while now > MISFIT and len(corrections) < len(factors):
        tried = [(misfit.with_factors(each), which, how, each) for which, how, each in misfit.others(factors)]
        best = min(tried, key=lambda attempt: attempt[0], default=None)
        if best is None or not best[0] < EASED * now:
            break
        now, which, how, factors = best
        corrections.append(([q for q, turned in zip(engine.coordinates, which, strict=True) if turned], how))
    if not corrections or not (now < FITS * as_read and (now < 1.0 or now < BEYOND_DOUBT * as_read)):
        return
    columns = [(_column(mapping, coordinate), how) for some, how in corrections for coordinate in some]
    (column, how), coordinate = columns[0], corrections[0][0][0]
    more = "".join(
        f", and so {'does' if how is _TURNED else 'is'} {name!r}" if other is how else f", and {name!r} {other.is_so}"
        for name, other in columns[1:]
    )
    raise SchemaError(
        "the columns must have the units and signs that the mapping states",
        f"column {column!r} {how.is_so}{more}: the accelerations of {engine.called} differ from the record by "
        f"{as_read**0.5:.3g} times their size, and with this correction by {now**0.5:.2g} times",
        f"{how.mend.format(column=column, expression=dict(mapping.observations)[column], name=coordinate.name)} "
        f"To write a mapping: gaitdisc new {engine.path.with_suffix('.toml').name} --from {engine.path.name}.",
    )


class _Misfit:
    """How far an engine's accelerations are from those of a record, whose columns may have other signs or units."""

    def __init__(self, mapping: Simulation, engine: Engine, measured: Measured, states: Values) -> None:
        self.engine, self.values, self.rate = engine, mapping.values(), measured.rate
        count, samples = len(engine.coordinates), measured.drive.samples
        moved = [np.ptp(trajectory[:n, :count], axis=0).sum() for trajectory, n in zip(states, samples, strict=True)]
        trial = int(np.argmax(moved))  # one is enough: a unit or a sign is the same in all
        along = states[trial, : samples[trial]]
        self.q, self.v = along[:, :count], along[:, count:]
        self.controls = measured.drive.inputs[trial, : samples[trial]]

    def with_factors(self, factors: Values) -> float:
        """Share of the accelerations' squares that is missed, mean over coordinates times factors (coordinate,)."""
        q, v = self.q * factors, self.v * factors
        points = np.linspace(0, len(q) - 1, min(POINTS, len(q))).round().astype(np.intp)
        recorded = np.gradient(v, 1 / self.rate, axis=0)[points]
        at = self.engine.along(q, v, self.controls, self.rate).at(points)
        missed = recorded - self.engine.accelerations(at, self.values)
        return float(np.mean(np.mean(missed**2, axis=0) / np.maximum(np.mean(recorded**2, axis=0), TINY)))

    def others(self, factors: Values) -> Iterator[tuple[NDArray[np.bool_], _Convention, Values]]:
        """Return each other convention of a coordinate, and the other sign of all: which, how, and factors with it."""
        every = np.ones(len(factors), bool)
        if len(factors) > 1 and (factors == 1.0).all():
            yield every, _TURNED, -factors
        for number, coordinate in enumerate(self.engine.coordinates):
            for how in CONVENTIONS[coordinate.unit]:
                inside = abs(how.factor) * np.abs(self.q[:, number]).max() <= _limit(coordinate)
                if factors[number] == 1.0 and inside:
                    which = np.arange(len(factors)) == number
                    yield which, how, np.where(which, how.factor, factors)


def _limit(coordinate: Coordinate) -> float:
    """Largest size of a coordinate that a record can have [rad, m]."""
    return SPUN if not np.isfinite(coordinate.high) else 1.5 * max(abs(coordinate.low), abs(coordinate.high))


def _column(mapping: Simulation, coordinate: Coordinate) -> str:
    return next((name for name, text in mapping.observations if coordinate.name in text), coordinate.name)


def report_limits(engine: Engine, states: Values, measured: Measured) -> Iterator[Finding]:
    """Say in which samples a limit or a contact of the model acts: its own runs pass through these."""
    inside = np.arange(states.shape[1]) < measured.samples[:, None]
    for coordinate, q in zip(engine.coordinates, states[inside].T, strict=False):
        if share := 100 * np.mean((q <= coordinate.low) | (q >= coordinate.high)):
            limits = f"{coordinate.low:.3g} to {coordinate.high:.3g} {coordinate.unit}"
            what = f"{coordinate.called} is at its limit ({limits}) in {share:.2g} % of the samples"
            yield Finding("note", "limit", "model", f"{what}: there the model itself limits the movement", "")
    if touched := getattr(engine, "contacts", 0):
        what = f"bodies touch (at most {touched} contacts): the expansion of the model is not valid during a contact"
        yield Finding("warning", "contact", "model", what, "results that depend on runs through a contact")


def report_saturation(engine: Engine, measured: Measured) -> Iterator[Finding]:
    """Say in which samples a control is beyond its range, the model's own or one that was found."""
    driven = measured.drive.inputs[np.arange(measured.drive.inputs.shape[1]) < measured.samples[:, None]]
    for control, u, (low, high) in zip(engine.controls, driven.T, engine.control_ranges, strict=False):
        if share := 100 * np.mean((u < low) | (u > high)):
            what = f"{control.name} is beyond its range ({low:.3g} to {high:.3g}) in {share:.2g} % of the samples"
            yield Finding("note", "saturated", "model", f"{what}: the engine clips it there", "")


def list_warnings(*engines: Engine) -> tuple[Finding, ...]:
    """What MuJoCo warned of: it is said here, and in no file of the user's folder."""
    warnings = dict.fromkeys(what for engine in engines for what in getattr(engine, "warnings", ()))
    return tuple(
        Finding("warning", "engine", "model", f"{engines[0].called} warns: {what}", "results of runs with this warning")
        for what in warnings
    )
