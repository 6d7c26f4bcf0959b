"""Score every candidate at once: how far the misfit would fall if it were added, to first order.

Source: Rao 1948, Proc. Camb. Phil. Soc. 44, 50 (the score test: the fall of -2 log L from slopes at the present fit).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from gaitdisc.discovery.candidate import Candidate
from gaitdisc.discovery.first_states import follow
from gaitdisc.discovery.fitted import Fitted, without
from gaitdisc.discovery.grids import Rhythm, cells, delays
from gaitdisc.discovery.kept_work import keep, recall
from gaitdisc.discovery.linearised import Linearised, carry_change, linearise
from gaitdisc.discovery.places import Place
from gaitdisc.discovery.scored_model import Part, ScoredModel
from gaitdisc.recording.arrays import Values
from gaitdisc.simulation.compiled_simulation import Compiled
from gaitdisc.simulation.evaluating import Points, evaluate_many
from gaitdisc.simulation.parts import Parameter, State
from gaitdisc.simulation.running import compile_simulation

AT_ONCE = 96
MOST = 1000  # candidates that are scored on all segments; of more, some segments say which are worth it
KEPT, PART, FEWEST = 300, 0.15, 8  # candidates that are, share of the segments that say so, and how many at least
NUDGE = 1e-4
TRIED = "tried"  # begins the names of the numbers of what is scored


@dataclass(frozen=True)
class Score(Part):
    """A candidate with its best numbers to first order, and what they promise."""

    gain: float  # fall of the misfit (twice the log likelihood)


@dataclass(frozen=True)
class _Cell:
    """One point of a candidate's grid, and the columns that stand for it."""

    candidate: Candidate
    constants: dict[str, float]
    idle: dict[str, float]  # the slots that columns stand for, and where they change nothing
    whole: bool = False  # whether its column is all that its constants change, and no slope

    @property
    def pieces(self) -> tuple[str, ...]:
        """The pieces of a missing term, with the constants in them."""
        return self.candidate.pieces_at({slot: f"{value:.9g}" for slot, value in self.constants.items()})


@dataclass(frozen=True)
class Scorer:
    """A fitted simulation, linearised, against which candidates are scored."""

    model: ScoredModel
    places: tuple[Place, ...]
    rhythm: Rhythm

    def scores(self, candidates: tuple[Candidate, ...]) -> list[Score]:
        """Return the best score of each candidate, the greatest gain first; of a great many, those worth it alone."""
        if len(candidates) > MOST:
            count = len(self.model.shooting.segments)  # some of the segments, evenly from all
            some = np.unique(np.linspace(0, count - 1, min(max(round(PART * count), FEWEST), count)).astype(np.intp))
            few = replace(self.model.shooting, segments=self.model.shooting.segments.among(some))
            part = replace(self, model=replace(self.model, shooting=few, fit=self.model.fit.among(some)))
            candidates = tuple(score.candidate for score in part._scores(candidates)[:KEPT])
        known = recall(repr(len(candidates)), self.model.fit.values.tobytes(), self.model.fit.starts.tobytes())
        if known is not None:
            return [Score(candidates[number], values, gain) for number, values, gain in known]
        numbers = {id(candidate): number for number, candidate in enumerate(candidates)}
        scores = self._scores(candidates)
        keep([(numbers[id(score.candidate)], score.values, score.gain) for score in scores])
        return scores

    def _scores(self, candidates: tuple[Candidate, ...]) -> list[Score]:
        explained, best = _Explained.by(self.model.fit), dict[int, Score]()
        for some, columns in self._columns(candidates):
            for score in explained.gains(some, columns):
                known = best.setdefault(id(score.candidate), score)
                if score.gain > known.gain:
                    best[id(score.candidate)] = score
        return sorted(best.values(), key=lambda score: -score.gain)

    def leave_out_each(self, candidates: tuple[Candidate, ...]) -> Values:
        """Mean square that the best candidate leaves of all other trials, for each trial (trial,), to first order."""
        fit, trials = self.model.fit, self.model.shooting.segments.trial
        as_in_file = fit.values.copy()  # of how far numbers are from the file's no candidate takes anything away
        as_in_file[fit.prior.places] = fit.prior.value
        others = [np.flatnonzero(trials != trial) for trial in np.unique(trials)]
        explained = [_Explained.by(replace(fit.among(rest), values=as_in_file)) for rest in others]
        gained = np.zeros(len(others))
        for some, columns in self._columns(candidates):
            for place, rest in enumerate(others):
                gains = (score.gain for score in explained[place].gains(some, columns[rest]))
                gained[place] = max([gained[place], *gains])
        residual = fit.projected[0]
        return np.array([(residual[at] ** 2).mean() for at in others]) - gained / [residual[at].size for at in others]

    def _columns(self, candidates: tuple[Candidate, ...]) -> Iterator[tuple[list[_Cell], Values]]:
        """Yield cells and what each of their slots would change, whitened (segment, number, column)."""
        line = linearise(self.model, self.places)
        roles = sorted({candidate.role for candidate in candidates if candidate.constants})
        along = dict(zip(roles, np.moveaxis(self.along(roles), -1, 0), strict=True))
        for number, place in enumerate(self.places):
            here = [effect for effect in candidates if (effect.kind, effect.place) == (place.kind, place.name)]
            for candidate in here:
                if candidate.states:
                    some, push = self._with_own_states(candidate, along)
                    yield some, self._white(line.of_push(number, push))
            plain = [cell for candidate in here if not candidate.states for cell in self._cells(candidate, along)]
            for first in range(0, len(plain), AT_ONCE):
                some = plain[first : first + AT_ONCE]
                push = self.along([piece for cell in some for piece in cell.pieces])
                yield some, self._white(line.of_push(number, push))
        seen = dict(self.model.simulation.observations)
        for candidate in candidates:
            late = candidate.name == "sensor_lag" and "delay(" in seen[candidate.place]
            if candidate.verdict != "missing_physics" and not late:  # a signal that is late already: not once more
                yield self._signal_columns(line, candidate, along)

    def beginnings(self, candidate: Candidate) -> list[dict[str, float]]:
        """Constants of a candidate at which a search begins along the run."""
        return [cell.constants for cell in self._cells(candidate, {candidate.role: self.along([candidate.role])})]

    def _cells(self, candidate: Candidate, along: dict[str, Values]) -> list[_Cell]:
        constants = dict(candidate.constants or {})
        x = along[candidate.role].ravel() if constants else np.zeros(1)
        return [_Cell(candidate, cell, candidate.idle) for cell in cells(constants, x, self.rhythm)]

    def _with_own_states(self, candidate: Candidate, along: dict[str, Values]) -> tuple[list[_Cell], Values]:
        """Cells of a term with states of its own, and its pieces along the run (segment, sample, cell times piece)."""
        some, simulation = self._cells(candidate, along), self.model.simulation
        slots = {slot: candidate.named(TRIED)[slot] for slot in candidate.constants or {}}
        rates, pieces = candidate.states_at(slots), candidate.pieces_at(slots)
        alone = replace(  # without what moves the simulation: its states are known along the run
            simulation,
            states=(*simulation.states, *(State(name) for name in rates)),
            parameters=(*simulation.parameters, *(Parameter(name, 1.0) for name in slots.values())),
            ports=(),
            definitions=(*((port.name, "0") for port in simulation.ports), *simulation.definitions),
            equations=(*((state.name, "0") for state in simulation.states), *rates.items()),
            effects=(),
            observations=tuple((f"piece_{i}", piece) for i, piece in enumerate(pieces)),
            sensors=(),
        )
        machine = compile_simulation(alone)
        values, states = self._extend(machine, slots, [cell.constants for cell in some])
        push = np.moveaxis(self.model.shooting.unfiltered(machine, states, values), 0, -2)
        return some, push.reshape(*push.shape[:2], -1)

    def _extend(self, machine: Compiled, names: dict[str, str], tried: list[dict[str, float]]) -> tuple[Values, Values]:
        """Parameters (version, parameter) and states along the run (version, segment, sample, state) of each try."""
        values = np.repeat(machine.defaults[None], len(tried), axis=0)
        values[:, : len(self.model.fit.values)] = self.model.fit.values
        for version, slots in enumerate(tried):
            for slot, value in slots.items():
                values[version, machine.parameters.index(names[slot])] = value
        states = np.repeat(self.model.fit.states[None], len(tried), axis=0)
        if added := len(machine.states) - states.shape[-1]:
            runs = follow(self.model.shooting, machine.simulation, values)[..., -added:]
            states = np.concatenate([states, np.stack([self.model.shooting.segments.of(run) for run in runs])], axis=-1)
        return values, states

    def along(self, expressions: list[str]) -> Values:
        """Return expressions along the run (segment, sample, expression)."""
        segments, drive = self.model.shooting.segments, self.model.shooting.measured.drive
        out = np.zeros((len(segments), segments.length, len(expressions)))
        for trial in np.unique(segments.trial):
            mine = np.flatnonzero(segments.trial == trial)
            samples = segments.samples[mine].ravel()
            t = drive.time0[trial] + samples / drive.rate
            x = self.model.fit.states[mine].reshape(len(samples), -1)
            points = Points(t, x, drive.inputs[trial, samples], self.model.fit.values, rate=drive.rate)
            values = evaluate_many(self.model.simulation, expressions, points)
            out[mine] = np.moveaxis(values.reshape(len(expressions), len(mine), segments.length), 0, -1)
        return np.nan_to_num(out, nan=0.0, posinf=0.0, neginf=0.0)

    def _white(self, change: Values) -> Values:
        return self.model.shooting.whiten(carry_change(self.model, change))

    def _signal_columns(
        self, line: Linearised, candidate: Candidate, along: dict[str, Values]
    ) -> tuple[list[_Cell], Values]:
        """What a wrong number, input or sensor changes: in each step's landing, and in what is seen."""
        model, shooting = self.model, self.model.shooting
        (slot, none), limited = next(iter(candidate.idle.items())), bool(candidate.constants)
        if candidate.verdict == "wrong_parameter":
            none = float(model.fit.values[model.machine.parameters.index(candidate.place)])
        tried = [{slot: none + NUDGE * max(abs(none), 1e-2)}]
        if limited:
            tried = [cell.constants for cell in self._cells(candidate, along)]
        elif candidate.is_late:
            either_way = candidate.name == "input_delay"
            tried = [{slot: float(delay)} for delay in delays(self.rhythm, either_way)]
        whole = limited or candidate.is_late
        over = np.ones(len(tried)) if whole else np.array([tried[0][slot] - none])
        names = candidate.named(TRIED)
        machine = compile_simulation(candidate.in_fit(model.simulation, names, dict.fromkeys(names, 1.0)))
        values, states = self._extend(machine, names, tried)
        seen = shooting.observed(machine, states, values)  # what changes though no state does
        seen -= shooting.observed(model.machine, model.fit.states[None], model.fit.values[None])
        columns = shooting.whiten(np.moveaxis(seen / over[:, None, None, None], 0, -1))
        if candidate.verdict != "sensor_error":
            landed = shooting.landed(machine, states[:, :, :-1], values)[..., : line.landed.shape[-1]] - line.landed
            columns += self._white(line.of_change(np.moveaxis(landed / over[:, None, None, None], 0, -1)))
        return [_Cell(candidate, cell if whole else {}, {slot: none}, whole) for cell in tried], columns


@dataclass(frozen=True)
class _Explained:
    """What start states and the constants that are in already explain; candidates have to explain something else.

    After the measured numbers come the rows of the prior, in which no candidate changes anything.
    """

    starts: Values  # (segment, number, state), basis of the start states
    constants: Values  # (row, constant), basis of the constants
    left: Values  # (row,), what is left

    @classmethod
    def by(cls, fit: Fitted) -> _Explained:
        """What is explained in a fit."""
        residual, flat = fit.stacked
        size = np.linalg.norm(flat, axis=0)
        known = np.linalg.qr(flat[:, size > 0] / size[size > 0])[0]
        return cls(fit.start_basis, known, residual - known @ (known.T @ residual))

    def gains(self, some: list[_Cell], columns: Values) -> Iterator[Score]:
        """Yield the score of each cell that changes anything; it has as many columns as slots that these stand for."""
        slopes = without(self.starts, columns).reshape(-1, columns.shape[2])
        slopes = np.vstack([slopes, np.zeros((self.left.size - len(slopes), slopes.shape[1]))])
        slopes -= self.constants @ (self.constants.T @ slopes)
        normal, match = slopes.T @ slopes, slopes.T @ self.left
        size = np.maximum(np.sqrt(np.maximum(np.diag(normal), 0)), 1e-150)
        normal = normal / np.outer(size, size)
        first = 0
        for cell in some:
            mine = slice(first, first + len(cell.idle))
            first = mine.stop
            steps = np.linalg.lstsq(normal[mine, mine], match[mine] / size[mine], rcond=1e-10)[0] / size[mine]
            gain = float(steps @ match[mine])
            if size[mine].max() <= 1e-9 or (cell.whole and steps[0] <= 0):
                continue
            values = {slot: none + float(factor) for (slot, none), factor in zip(cell.idle.items(), steps, strict=True)}
            yield Score(cell.candidate, values | cell.constants, gain)
