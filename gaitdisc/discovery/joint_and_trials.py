"""One joint of a device walk as a simulation and trials of some strides.

Muscles driven by EMG stand against the moment of inverse dynamics; without moments, the motion of both walks is all.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gaitdisc.discovery.candidate import Candidate
from gaitdisc.discovery.changed_moment import Change, Walk
from gaitdisc.errors import SchemaError, StrideError
from gaitdisc.processing.joint_record import JointRecord
from gaitdisc.processing.muscle_moment import JOINTS, Driven, MuscleMoment, drives, fit_moment, sign_at
from gaitdisc.recording.arrays import Values
from gaitdisc.simulation.even_time import TrialColumns
from gaitdisc.simulation.measured import Measured, check_measured
from gaitdisc.simulation.parts import Input, Parameter, Port, Sensor, State
from gaitdisc.simulation.simulation import Simulation

if TYPE_CHECKING:
    from gaitdisc.ingest.study import Study
    from gaitdisc.processing.process import Walk as ProcessedWalk

STRIDES, MOTION_STRIDES = 3, 4  # of one trial of the search: with moments, and of the motion alone
FEWEST_TRIALS = 4
FEWEST_STRIDES = FEWEST_TRIALS * STRIDES
KNOWN = 0.5  # of the samples of a trial must have a known load; swing alone, 0.4 of a stride, shows no load
BLOCKS = 4  # of the Nominal walk, each left out of the calibration once
RATE_HZ = 50.0  # enough for moments below 20 Hz
TRACKED = (800.0, 57.0, 1.0)  # of angle, rate and acceleration
DELAYS_S, STRENGTHS = np.arange(-0.08, 0.081, 0.01), np.arange(0.5, 1.51, 0.05)  # that a walk's muscles may have
ENGAGED, ENGAGED_STEP = (0.02, 0.9), np.radians(1.0)  # quantiles of the angle between which a spring may engage
STRENGTH = 0.06  # by which a muscle group may differ from the Nominal walk's before it is a finding
SEEN_RAD = 0.005  # noise of an angle, where it follows its own reference
HARMONICS = 8  # of the motion that a person has by habit
# joint -> what a clinician calls the groups that turn it towards its negative and its positive angle
GROUPS = {
    "ankle_angle": ("plantarflexors", "dorsiflexors"),
    "knee_angle": ("knee_extensors", "knee_flexors"),
    "hip_flexion": ("hip_extensors", "hip_flexors"),
}
EFFECTS = (
    "constant_load", "linear_stiffness", "one_sided_spring", "dead_zone_spring", "viscous_damping", "one_sided_damper",
    "coulomb_friction", "phase_locked_moment",
)  # fmt: skip


def nominal_moment(record: JointRecord) -> MuscleMoment:
    """Calibrate the moment model on the Nominal walk, blocks of strides left out in turn."""
    count = int(record.stride.max()) + 1
    blocks = np.where(record.stride >= 0, record.stride * BLOCKS // max(count, 1), -1)
    moment = np.where(np.isfinite(record.rate), record.moment, np.nan)
    return fit_moment(drives(record), moment, blocks)


def as_walk(record: JointRecord) -> Walk:
    """Return one walk for the fit of both together."""
    known = np.isfinite(record.moment) & np.isfinite(record.rate) & np.isfinite(record.phase)
    return Walk(drives(record), np.where(known, record.moment, np.nan), record.stride)


def changes(record: JointRecord) -> list[Change]:
    """List what a device, a muscle or a mass may change in a walk, by the names of the simulation and the catalogue."""
    word, once = f"{JOINTS[record.joint]}_moment", np.zeros(1)
    low, high = np.quantile(record.angle[record.stride >= 0], ENGAGED)
    angles = np.arange(low, high, ENGAGED_STEP)
    above, below = f"max(0, {JOINTS[record.joint]} ", "max(0, _"
    shapes = (
        ("constant_load", "load", once, "", lambda d, _: np.ones((len(d.angle), 1))),
        ("linear_stiffness", "stiffness", once, "", lambda d, _: np.column_stack([d.angle**0, -d.angle])),
        ("one_sided_spring", "stiffness", angles, above, lambda d, at: -np.maximum(0, d.angle - at)[:, None]),
        ("one_sided_spring", "stiffness", -angles, below, lambda d, at: np.maximum(0, -at - d.angle)[:, None]),
        ("viscous_damping", "damping", once, "", lambda d, _: -d.rate[:, None]),
        ("coulomb_friction", "friction", once, "", lambda d, _: -np.sign(d.rate)[:, None]),
    )
    changes = [Change(name, word, number, at, columns=by, piece=piece) for name, number, at, piece, by in shapes]

    def later(driven: Driven, delay_s: float) -> Driven:
        at = np.arange(len(driven.angle))
        late = np.column_stack([np.interp(at - delay_s * driven.rate_hz, at, emg) for emg in driven.envelopes.T])
        return replace(driven, envelopes=late)

    changes.append(Change("wrong_parameter", "emg_delay", "value", DELAYS_S, later))

    def stronger(driven: Driven, by: float, sign: int) -> Driven:
        return replace(driven, envelopes=driven.envelopes * np.where(driven.signs == sign, by, 1.0))

    signs = drives(record).signs
    for sign, group in zip((-1, 1), GROUPS[record.joint], strict=True):
        if (signs == sign).any():
            strength = f"{group}_strength", "value", STRENGTHS
            changes.append(Change("wrong_parameter", *strength, partial(stronger, sign=sign), neutral=1.0))
    if record.per_kg.size:  # what each kg more at the foot changes in a net moment that does not know it
        per_kg = -record.per_kg[:, None]
        changes.append(Change("wrong_parameter", "added_foot_mass", "value", once, columns=lambda _, __: per_kg))
    return changes


def joint_model(record: JointRecord, model: MuscleMoment) -> Simulation:
    """Return a device walk's joint as a simulation that the recorded motion and the Nominal model's moment drive."""
    word, (against, towards) = JOINTS[record.joint], GROUPS[record.joint]
    carried = record.per_kg.size > 0
    muscles = [(name.split("_")[1], sign_at(record.joint, name)) for name in record.muscles]
    muscles = [(name, against if sign < 0 else towards) for name, sign in muscles if sign]
    inputs = [
        Input("reference", "rad/s^2", "recorded motion, low-passed: acceleration + 57*rate + 800*angle"),
        *(Input(name, "1", "activation from the EMG, processed as in the Nominal walk") for name, _ in muscles),
        *(Input(f"{name}_gain", "N m", "moment at activation 1, as in the Nominal walk") for name, _ in muscles),
        Input("others", "N m", "moment of muscles without an electrode, as in the Nominal walk"),
        Input("phase", "1", "percent stride / 100"),
    ]
    groups = [acting for acting in (against, towards) if any(group == acting for _, group in muscles)]
    numbers = [Parameter("emg_delay", 0.0, "s", meaning="additional delay of EMG compared with the Nominal walk")]
    numbers += [
        Parameter(f"{group}_strength", 1.0, "1", 1 - STRENGTH, 1 + STRENGTH, "strength compared with the Nominal walk")
        for group in groups
    ]
    terms = [f"{group}_strength*{name}_gain*delay({name}, emg_delay)" for name, group in muscles]
    terms += ["others", f"{word}_moment"]
    if carried:
        inputs.append(Input("per_kg", "N m/kg", "change of the muscles' moment per kg added to the foot"))
        at_foot = "mass at the foot, in addition to that of the body"
        numbers.append(Parameter("added_foot_mass", 0.0, "kg", meaning=at_foot))
    total = " + ".join(terms) + (" - added_foot_mass*per_kg" if carried else "")
    return Simulation(
        title=f"{word} of {record.subject}: Nominal moment model and inverse dynamics",
        states=(
            State(word, "rad", meaning=f"{record.joint}_{record.side}"),
            State("rate", "rad/s"),
            State("net", "N m"),
        ),
        inputs=tuple(inputs),
        parameters=tuple(numbers),
        ports=(Port(f"{word}_moment", "N m", "a moment that no muscle produces"),),
        definitions=(("model", total),),
        equations=(
            (word, "rate"),
            ("rate", f"reference - {TRACKED[1]:g}*rate - {TRACKED[0]:g}*{word}"),
            ("net", f"{RATE_HZ:g}*(model - net)"),
        ),
        observations=((f"{word}_angle", word), ("net_moment", "net")),
        sensors=(Sensor(f"{word}_angle", "rad", sd=SEEN_RAD), Sensor("net_moment", "N m", sd=model.left_nm)),
    )


def cut_walk_trials(record: JointRecord, model: MuscleMoment, simulation: Simulation) -> Measured:
    """Cut the walk into trials of some strides in a row, with the model's moments as inputs."""
    driven = drives(record)
    step = max(round(driven.rate_hz / RATE_HZ), 1)
    names = [name.split("_")[1] for name in record.muscles if sign_at(record.joint, name)]
    columns = {
        "reference": TRACKED[0] * record.angle + TRACKED[1] * record.rate + TRACKED[2] * record.speedup,
        **dict(zip(names, driven.activation(model.form.delay_s, model.form.lag_s).T, strict=True)),
        **{f"{name}_gain": gain for name, gain in zip(names, model.gain(driven).T, strict=True)},
        "others": model.others(driven),
        "phase": record.phase,
        "per_kg": record.per_kg,
    }
    inputs = np.column_stack([columns[signal.name] for signal in simulation.inputs])
    known, at = np.isfinite(record.moment), np.arange(len(record.moment))
    late = lag_signal(np.interp(at, at[known], record.moment[known])[None], driven.rate_hz / RATE_HZ)[0]  # as its state
    seen = np.column_stack([record.seen, np.where(known, late, np.nan)])
    usable = np.isfinite(inputs).all(axis=1) & np.isfinite(record.seen)
    series: list[NDArray[np.intp]] = []
    strides = STRIDES + 1
    while len(series) * strides < FEWEST_STRIDES and strides > 1:  # short trials hold fewer strides in a row
        strides -= 1
        series = find_series(record.stride, usable, known, strides)
    if len(series) * strides < FEWEST_STRIDES:
        raise StrideError(
            f"the load on the foot must be known in {100 * KNOWN:.0f} % of the samples of {FEWEST_STRIDES} strides",
            f"it is known in {len(series)} of {record.stride.max() + 1} strides of {record.subject} {record.condition}",
            "Record longer, or more trials, and keep each foot on its own plate.",
        )
    thinned = [inside[::step] for inside in series]
    trials = [
        TrialColumns(str(number), record.time[rows], inputs[rows], seen[rows]) for number, rows in enumerate(thinned, 1)
    ]
    driving = [signal.name for signal in simulation.inputs]
    return check_measured(trials, driving, [name for name, _ in simulation.observations], record.subject)


def find_series(
    stride: NDArray[np.intp], usable: NDArray[np.bool_], known: NDArray[np.bool_], strides: int
) -> list[NDArray[np.intp]]:
    """Samples of each series of so many strides in a row, usable throughout and known in enough samples."""
    series: list[NDArray[np.intp]] = []
    first = 0
    while first + strides - 1 <= stride.max():
        inside = np.flatnonzero((stride >= first) & (stride < first + strides))
        complete = len(inside) > 1 and (np.diff(inside) == 1).all() and usable[inside].all()
        complete = complete and known[inside].mean() > KNOWN
        if complete:
            series.append(inside)
        first += strides if complete else 1
    return series


def lag_signal(signal: Values, samples: float) -> Values:
    """Signal (trial, sample) behind a first-order lag, linear between samples and at rest at first.

    >>> bool(np.isclose(lag_signal(np.arange(200.0)[None], 5.0)[0, -1], 194.0))
    True
    """
    from scipy.signal import lfilter

    decay = np.exp(-1 / samples)
    late = samples * (1 - decay)
    return signal[:, :1] + lfilter([1 - late, late - decay], [1, -decay], signal - signal[:, :1])


def weighed(candidate: Candidate) -> bool:
    """Whether an explanation is one that a device, a muscle or the recording of a joint can have.

    Inputs and the recorded angle only carry the motion and the EMG; late EMG and weak muscles are numbers of the
    simulation. What is wrong with the moment model's own shape is no effect of a device.
    """
    if candidate.kind == "observation":
        return candidate.place == "net_moment" and candidate.name in ("sensor_gain", "sensor_lag")
    return candidate.kind == "parameter" or candidate.name in EFFECTS


def nominal_and_trials(study: Study, participant: str, joint: str = "ankle_angle") -> tuple[Simulation, Measured]:
    """Nominal model of one joint of a participant, and the device walk cut into trials of some strides.

    The model is the Nominal model of chapter 4 in a form that can be read: the joint's acceleration is linear in its
    angle and its rate and periodic in percent stride, fitted to the Nominal walk by least squares. What differs on the
    device is therefore an acceleration, not a moment: without moments in the study no inertia is known, and what the
    person changes on purpose cannot be distinguished from what the device does.

    study: with both walks; its filters and its detector are used
    joint: angle, without its side; the side is that of the study's strides
    returns simulation: states theta [rad] and omega [rad/s], input phase, port `acceleration` [rad/s^2]
    """
    from gaitdisc.processing.processed_walks import process_walks

    walks, refusals = process_walks(study, study.participant(participant))
    if refusals:
        raise SchemaError(
            f"both walks of {participant} are required",
            "; ".join(f"{refusal.condition}: {refusal.reason}" for refusal in refusals),
            "Correct the walk, or choose another participant.",
        )
    nominal, device = (walks[word] for word in study.conditions.both)
    name = f"{joint}_{study.strides.side}"
    return nominal_model(nominal, name), stride_trials(device, name)


def nominal_model(walk: ProcessedWalk, name: str) -> Simulation:
    """Joint acceleration of a walk, linear in angle and rate and periodic in percent stride."""
    angle, rate, speedup, phase = _motion(walk, name)
    known = np.isfinite(np.column_stack([angle, rate, speedup, phase])).all(axis=1)
    turn = 2 * np.pi * np.outer(phase[known], np.arange(1, HARMONICS + 1))
    library = np.column_stack([-angle[known], -rate[known], np.ones(known.sum()), np.sin(turn), np.cos(turn)])
    stiffness, damping, mean, *waves = np.linalg.lstsq(library, speedup[known], rcond=None)[0].tolist()
    pieces = [f"{mean:.6g}"]
    for order in range(HARMONICS):
        about = f"{2 * np.pi * (order + 1):.9g}*phase"
        pieces.append(f"{waves[order]:.6g}*sin({about}) + {waves[HARMONICS + order]:.6g}*cos({about})")
    return Simulation(
        title=f"{name} of {walk.trial.subject} as in the {walk.trial.condition} walk",
        states=(State("theta", "rad", meaning=name), State("omega", "rad/s")),
        inputs=(Input("phase", "1", meaning="percent stride / 100"),),
        parameters=(Parameter("stiffness", stiffness, "1/s^2"), Parameter("damping", damping, "1/s")),
        ports=(Port("acceleration", "rad/s^2", meaning="effect of the device and of the person's adaptation"),),
        definitions=(("habit", " + ".join(pieces)),),
        equations=(("theta", "omega"), ("omega", "habit - stiffness*theta - damping*omega + acceleration")),
        observations=(("theta", "theta"),),
    )


def stride_trials(walk: ProcessedWalk, name: str) -> Measured:
    """Cut a walk into trials of some strides in a row."""
    angle, _, _, phase = _motion(walk, name)
    time, cycles = np.asarray(walk.state.time), walk.strides[walk.side]
    usable = np.isfinite(phase) & np.isfinite(angle)
    trials = [
        TrialColumns(str(number), time[inside], phase[inside, None], angle[inside, None])
        for number, inside in enumerate(find_series(cycles.number(time), usable, usable, MOTION_STRIDES), 1)
    ]
    if len(trials) < FEWEST_TRIALS:
        raise StrideError(
            f"a walk must have at least {FEWEST_TRIALS} separate series of {MOTION_STRIDES} consecutive strides",
            f"{walk.trial.name} has {len(cycles)} strides, which give {len(trials)} such series",
            "Record a longer walk.",
        )
    return check_measured(trials, ("phase",), ("theta",), walk.trial.name)


def _motion(walk: ProcessedWalk, name: str) -> tuple[Values, ...]:
    """Angle, rate, acceleration [rad, s] and share of the stride, sample by sample."""
    column = walk.state.names.index(name)
    trajectory = walk.trajectory
    motion = (np.radians(signal[:, column]) for signal in (trajectory.x, trajectory.xdot, trajectory.xddot))
    return (*motion, np.asarray(trajectory.phi) / 100)
