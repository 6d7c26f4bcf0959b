"""A participant's Nominal model as a simulation, and the device walk as what was measured: `discover` from a study."""

from __future__ import annotations

import numpy as np

from gaitdisc.errors import SchemaError, StrideError
from gaitdisc.ingest.study import Study
from gaitdisc.processing.process import Walk
from gaitdisc.processing.processed_walks import process_walks
from gaitdisc.recording.arrays import Values
from gaitdisc.simulation.even_time import TrialColumns
from gaitdisc.simulation.measured import Measured, check_measured
from gaitdisc.simulation.parts import Input, Parameter, Port, State
from gaitdisc.simulation.simulation import Simulation

HARMONICS = 8
STRIDES = 4  # of one trial
FEWEST_TRIALS = 4


def nominal_and_trials(
    study: Study, participant: str, joint: str = "ankle_angle", strides: int = STRIDES
) -> tuple[Simulation, Measured]:
    """Nominal model of one joint of a participant, and the device walk cut into trials of some strides.

    The model is the Nominal model of chapter 4 in a form that can be read: the joint's acceleration is linear in its
    angle and its rate and periodic in percent stride, fitted to the Nominal walk by least squares. What differs on the
    device is therefore an acceleration, not a moment: without moments in the study no inertia is known, and what the
    person changes on purpose cannot be distinguished from what the device does.

    study: with both walks; its filters and its detector are used
    joint: angle, without its side; the side is that of the study's strides
    returns simulation: states theta [rad] and omega [rad/s], input phase, port `acceleration` [rad/s^2]
    """
    walks, refusals = process_walks(study, study.participant(participant))
    if refusals:
        raise SchemaError(
            f"both walks of {participant} are required",
            "; ".join(f"{one.condition}: {one.reason}" for one in refusals),
            "Correct the walk, or choose another participant.",
        )
    nominal, device = (walks[word] for word in study.conditions.both)
    name = f"{joint}_{study.strides.side}"
    return nominal_model(nominal, name), stride_trials(device, name, strides)


def nominal_model(walk: Walk, name: str) -> Simulation:
    """Joint acceleration of a walk, linear in angle and rate and periodic in percent stride."""
    angle, rate, speedup, phase = _motion(walk, name)
    known = np.isfinite(np.column_stack([angle, rate, speedup, phase])).all(axis=1)
    turn = 2 * np.pi * np.outer(phase[known], np.arange(1, HARMONICS + 1))
    library = np.column_stack([-angle[known], -rate[known], np.ones(known.sum()), np.sin(turn), np.cos(turn)])
    stiffness, damping, mean, *waves = (float(one) for one in np.linalg.lstsq(library, speedup[known], rcond=None)[0])
    pieces = [f"{mean:.6g}"]
    for order in range(HARMONICS):
        about = f"{2 * np.pi * (order + 1):.9g}*phase"
        pieces.append(f"{waves[order]:.6g}*sin({about}) + {waves[HARMONICS + order]:.6g}*cos({about})")
    return Simulation(
        title=f"{name} of {walk.trial.subject} as in the {walk.trial.condition} walk",
        states=(State("theta", "rad", meaning=name), State("omega", "rad/s")),
        inputs=(Input("phase", "1", meaning="percent stride / 100"),),
        parameters=(Parameter("stiffness", stiffness, "1/s^2"), Parameter("damping", damping, "1/s")),
        ports=(Port("acceleration", "rad/s^2", meaning="moment of the device and of the person's adaptation"),),
        definitions=(("habit", " + ".join(pieces)),),
        equations=(("theta", "omega"), ("omega", "habit - stiffness*theta - damping*omega + acceleration")),
        observations=(("theta", "theta"),),
    )


def stride_trials(walk: Walk, name: str, strides: int = STRIDES) -> Measured:
    """Cut a walk into trials of so many strides in a row."""
    angle, _, _, phase = _motion(walk, name)
    time = np.asarray(walk.state.time)
    own = walk.strides[walk.side]
    trials: list[TrialColumns] = []
    first = 0
    while first + strides <= len(own):
        inside = (time >= own.start[first]) & (time < own.end[first + strides - 1])
        whole = np.isfinite(phase[inside]).all() and np.isfinite(angle[inside]).all()
        if whole:
            label = str(len(trials) + 1)
            trials.append(TrialColumns(label, time[inside], phase[inside, None], angle[inside, None]))
        first += strides if whole else 1
    if len(trials) < FEWEST_TRIALS:
        raise StrideError(
            f"`discover` needs {FEWEST_TRIALS * strides} strides, with {strides} in a row in each trial",
            f"{walk.trial.name} has {len(own)}, and {len(trials)} series of {strides} in a row",
            "Record longer, or use fewer strides in a trial.",
        )
    return check_measured(trials, ("phase",), ("theta",), walk.trial.name)


def _motion(walk: Walk, name: str) -> tuple[Values, ...]:
    """Angle, rate, acceleration [rad, s] and share of the stride, sample by sample."""
    column = walk.state.names.index(name)
    trajectory = walk.trajectory
    motion = (np.radians(each[:, column]) for each in (trajectory.x, trajectory.xdot, trajectory.xddot))
    return (*motion, np.asarray(trajectory.phi) / 100)
