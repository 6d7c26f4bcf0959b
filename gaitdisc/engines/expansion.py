"""A model of an engine as a simulation that runs at once: its accelerations expanded along the measured motion.

At every sample of the record the engine gives the accelerations and their slopes by each coordinate, speed, control and
parameter; what a force on a coordinate changes is exact, as forces enter linearly, and so is a parameter that is such a
force. Runs that stay near the record then need no call of the engine: what is left out is of second order in their
distance from the smoothed record.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter

from gaitdisc.engines.engine import Engine
from gaitdisc.engines.mapping import REPLACED
from gaitdisc.engines.motion import Motion, Values
from gaitdisc.simulation.compiled_simulation import Drive
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.parts import Input
from gaitdisc.simulation.simulation import Simulation

NUDGE = 1e-4  # of a state's or a parameter's size
LONGEST = 64  # characters of a name
SLOWEST, FASTEST = 10.0, 300.0  # [1/s] at which a fibre settles at least, and a speed at most
JUMP = 5  # points
SLOPES_HZ = 50.0  # at which slopes of a model with muscles are computed: they change as slowly as the motion
INEXACT = 0.02  # of a channel's spread, as white noise: a half percent in which some 20 samples err together
MOST_MIXED = 400  # columns of what a parameter changes with a coordinate: with more a search takes minutes
STILL = 1e-9  # of a column's size, below which it is one number


def expand(
    simulation: Simulation,
    engine: Engine,
    measured: Measured,
    states: Values,
    values: Mapping[str, float] | None = None,
) -> tuple[Simulation, Measured]:
    """Simulation that is expanded along a record, and the record with what the engine computed along it.

    simulation: as the mapping file has it: the names, the observations, the ports
    states (trial, sample, state): smoothed: coordinates, then speeds
    values: parameters around which to expand; the simulation's own where absent
    """
    parameters, drive = simulation.values() | dict(values or {}), measured.drive
    motions = [compute_motion(engine, drive, states, trial) for trial in range(len(states))]
    fields = ("q", "v", "u") if motions[0].z is None else ("q", "v", "u", "z")
    at = Motion(*(np.concatenate([getattr(motion, name) for motion in motions]) for name in fields))
    paths = [np.gradient(motion.v, 1 / drive.rate, axis=0) for motion in motions]
    stride = 1 if at.z is None else max(round(drive.rate / SLOPES_HZ), 1)
    ends, columns = np.cumsum(drive.samples), _Columns(engine)
    points = [np.unique(np.r_[end - n : end : stride, end - 1]) for end, n in zip(ends, drive.samples, strict=True)]
    _expand(columns, simulation, _Along(at, np.concatenate(paths), np.concatenate(points)), parameters)
    inputs = (*simulation.inputs, *(Input(name, "", "computed along the record", True) for name in columns.values))
    trials = np.split(np.column_stack([at.u, *columns.values.values()]), ends[:-1])
    lines = tuple((state.name, columns.equations[state.name]) for state in simulation.states)
    linear = replace(simulation, inputs=inputs, equations=lines, definitions=(), model="", layout="", source=None)
    linear = linear if at.z is None else replace(linear, inexact=INEXACT)
    for name, expression in simulation.definitions:
        linear = linear.with_input(name.removeprefix(REPLACED), expression)
    return linear, replace(measured, drive=Drive.of(trials, drive.rate, drive.time0))


def compute_motion(engine: Engine, drive: Drive, states: Values, trial: int) -> Motion:
    """Motion of a trial with what the engine computes along smoothed states (trial, sample, state)."""
    samples = drive.samples[trial]
    q, v = np.split(states[trial, :samples], 2, axis=1)
    return engine.along(q, v, drive.inputs[trial, :samples], drive.rate)


class _Columns:
    """Equations that are built up, and the columns that stand in them."""

    def __init__(self, engine: Engine) -> None:
        self.engine = engine
        self.values: dict[str, Values] = {}
        self.slowed: Values | None = None  # (point, coordinate, coordinate)
        self._terms: dict[str, dict[str, list[str]]] = {coordinate.speed: {} for coordinate in engine.coordinates}

    @property
    def equations(self) -> dict[str, str]:
        """Time derivative of each state."""
        rates = {coordinate.name: coordinate.speed for coordinate in self.engine.coordinates}
        for speed, sums in self._terms.items():
            parts = (f"({' + '.join(terms)}){away}" for away, terms in sums.items())
            rates[speed] = " + ".join(parts) or "0"
        return rates

    def add(self, name: str, column: Values, factor: str = "", away: str = "") -> None:
        """Add a column (point, coordinate) times a factor to every acceleration; one that rests is a number.

        name: what follows the speed's name in that of the column
        away: by how much a parameter differs: a factor of the sum of all columns that have it
        """
        if self.slowed is not None:
            column = np.einsum("pij,pj->pi", self.slowed, column)
        size = max(float(np.abs(column).max()), 1e-12)
        for number, coordinate in enumerate(self.engine.coordinates):
            entries, word = column[:, number], f"{coordinate.speed}_{name}"
            if len(word) > LONGEST:
                word = f"computed_{len(self.values)}"
            if np.ptp(entries) > STILL * size:
                self.values[word] = entries
            elif abs(entries[0]) > STILL * size:
                word = repr(float(entries.mean()))
            else:
                continue
            self._terms[coordinate.speed].setdefault(away, []).append(f"{word}*{factor}" if factor else word)


@dataclass(frozen=True)
class _Along:
    """The motion of a record, and those of its points at which slopes are computed."""

    at: Motion
    accelerations: Values  # of that motion (point, coordinate)
    points: NDArray[np.intp]

    @property
    def few(self) -> Motion:
        """The motion at these points."""
        return self.at.at(self.points)

    def without_jumps(self, slope: Values) -> Values:
        """Slopes without those of a few points: a muscle's path jumps where it comes off a surface."""
        return slope if self.at.z is None else median_filter(slope, (JUMP, 1), mode="nearest")

    def spread(self, slope: Values) -> Values:
        """Slopes at every point, linear between those at which they were computed."""
        every = np.arange(len(self.at.q))
        if len(every) == len(self.points):
            return slope
        return np.column_stack([np.interp(every, self.points, column) for column in slope.T])


def _expand(columns: _Columns, simulation: Simulation, along: _Along, values: Mapping[str, float]) -> None:
    """Accelerations to first order in states and controls; forces, and parameters that act as such, exactly."""
    at, (engine, limits) = along.at, columns.engine.without_force_limits(values)  # what they take away is a force
    base = engine.accelerations(at, values)
    few, rest = base[along.points], base.copy()
    slopes = _slopes(engine, along, values)
    damping = -np.stack([slopes[coordinate.speed] for coordinate in engine.coordinates], axis=2)
    if np.linalg.norm(damping, axis=(1, 2)).max() > FASTEST:
        columns.slowed, heavier = _slow_speeds(damping)
        rest += np.einsum("pij,pj->pi", heavier, along.accelerations)
    for (name, slope), variable in zip(slopes.items(), np.hstack([at.q, at.v, at.u]).T, strict=True):
        columns.add(f"by_{name}", slope, name)
        rest -= slope * variable[:, None]
    columns.add("rate", rest)
    ports = {port.name for port in simulation.ports}
    for number, coordinate in enumerate(engine.coordinates):
        force, acting = np.zeros_like(few), [coordinate.port] if coordinate.port in ports else []
        force[:, number] = 1.0
        for name in simulation.values():
            alike = engine.as_force(name)
            if alike and alike[0] == number:
                acting.append(f"({alike[1]})*({name} - {values[name]!r})")
        acting += [taken for limited, taken in limits if limited == number]
        if acting:
            changed = along.spread(engine.accelerations(along.few, values, force) - few)
            columns.add(f"by_{coordinate.port}", changed, acting[0] if len(acting) == 1 else f"({' + '.join(acting)})")
    # a mass changes what the limited force does
    here = columns.engine.accelerations(along.few, values) if limits else few
    _expand_parameters(columns, simulation, along, here, values)


def _slopes(engine: Engine, along: _Along, values: Mapping[str, float]) -> dict[str, Values]:
    """Slopes of the accelerations by each coordinate, speed and control at every point.

    Differences are to both sides: a muscle's stiffness is a small rest of that of its tendon less that of its fibre.
    """
    few, count = along.few, len(engine.coordinates)
    slopes: dict[str, Values] = {}
    for name, _, ahead, behind, size in _nudge(engine, few, "qvuz"):
        slopes[name] = along.without_jumps((engine.rates(ahead, values) - engine.rates(behind, values)) / (2 * size))
    fibres = [slopes.pop(name) for name in _fibres(few)]
    moves = _following(engine, {name: slope[:, count:] for name, slope in slopes.items()}, fibres)
    for name, slope in slopes.items():
        by_fibres = sum(fibre[:, :count] * moves[name][:, [k]] for k, fibre in enumerate(fibres))
        slopes[name] = along.spread(slope[:, :count] + by_fibres)
    return slopes


def _fibres(at: Motion) -> list[str]:
    return [] if at.z is None else [f"fibre_{number}" for number in range(at.z.shape[1])]


def _following(engine: Engine, speeds: Mapping[str, Values], fibres: list[Values]) -> dict[str, Values]:
    """How far each fibre (point, fibre) moves with a coordinate, speed or control to which it has settled.

    A fibre settles within milliseconds: its length is that at which its speed is the one with which that length moves.
    """
    count, moves = len(engine.coordinates), {}
    back = [np.minimum(fibre[:, count + number], -SLOWEST) for number, fibre in enumerate(fibres)]
    settling = np.stack(back, axis=1) if back else np.empty((1, 0))
    for coordinate in engine.coordinates:
        moves[coordinate.name] = -speeds[coordinate.name] / settling
        moves[coordinate.speed] = (moves[coordinate.name] - speeds[coordinate.speed]) / settling
    return moves | {control.name: -speeds[control.name] / settling for control in engine.controls}


def _slow_speeds(damping: Values) -> tuple[Values, Values]:
    """Factor of accelerations by which no speed settles faster than a run can follow, and its inverse less one.

    A light body that muscles hold (a foot), or a damped joint, would settle within a millisecond; it is made as heavy
    as it may be without a change of slow motion, as it acts on the deviation from the recorded motion alone.
    """
    rates, ways = np.linalg.eig(damping)
    heavy, inverse = np.maximum(np.real(rates) / FASTEST, 1.0), np.linalg.inv(ways)
    factor, more = (np.real(ways @ (each[..., None] * inverse)) for each in (1.0 / heavy, heavy - 1.0))
    return factor, more


def _expand_parameters(
    columns: _Columns, simulation: Simulation, along: _Along, here: Values, values: Mapping[str, float]
) -> None:
    """What each parameter changes, to first order in it; without muscles also how that changes with the coordinates.

    here (point, coordinate): accelerations where slopes are computed
    """
    engine, at = columns.engine, along.few
    names = [name for name in simulation.values() if engine.as_force(name) is None]
    mixed = at.z is None and 0 < len(names) * len(engine.coordinates) ** 2 <= MOST_MIXED
    beside = list(_nudge(engine, at, "q")) if mixed else []
    unchanged = [engine.accelerations(ahead, values) for _, _, ahead, _, _ in beside]
    for name in names:
        size = NUDGE * max(abs(values[name]), 1e-2)
        far = {**values, name: values[name] + size}
        slope = along.without_jumps((engine.accelerations(at, far) - here) / size)
        away, rest = f"*({name} - {values[name]!r})", slope
        for (other, value, ahead, _, step), before in zip(beside, unchanged, strict=True):
            both = ((engine.accelerations(ahead, far) - before) / size - slope) / step
            columns.add(f"by_{name}_and_{other}", along.spread(both), other, away)
            rest = rest - both * value[:, None]
        columns.add(f"by_{name}", along.spread(rest), "", away)


def _nudge(engine: Engine, at: Motion, fields: str) -> Iterator[tuple[str, Values, Motion, Motion, float]]:
    """Yield each coordinate, speed, control and fibre with the motion a little to either side."""
    names = {"q": [q.name for q in engine.coordinates], "v": [q.speed for q in engine.coordinates]}
    names |= {"u": [control.name for control in engine.controls], "z": _fibres(at)}
    for field in fields:
        whole = getattr(at, field)
        for column, name in enumerate(names[field]):
            size = NUDGE * max(float(np.abs(whole[:, column]).max()), 1e-2)
            step = np.zeros(whole.shape[1])
            step[column] = size
            ahead, behind = (replace(at, **{field: moved}) for moved in (whole + step, whole - step))
            yield name, whole[:, column], ahead, behind, size
