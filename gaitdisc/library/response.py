"""The response of one person to a device: models of walking without it, and what they miss of walking with it."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace

from gaitdisc.errors import ChannelError, SamplingError
from gaitdisc.ingest.study import Conditions, Participant, Study
from gaitdisc.ingest.study_settings import ANGLES, OUTPUTS, HeldOut, Models
from gaitdisc.library.walks import Walk, make_trial
from gaitdisc.processing.pooled_cycles import WALK
from gaitdisc.processing.process import make_filter_null, processed
from gaitdisc.recording import Trial
from gaitdisc.recording.recording import several
from gaitdisc.response.fit_response import fit_response as fitted
from gaitdisc.response.participant_response import RESPONSE, ResponseRun
from gaitdisc.run.run_study import response_settings
from gaitdisc.saved.provenance import provenance_now

WITHOUT, WITH = "nominal", "exo"


def fit_response(
    nominal: Walk,
    exo: Walk,
    outputs: Sequence[str] | str = OUTPUTS,
    angles: Sequence[str] | str | None = None,
    emg: Sequence[str] | str = (),
    held_out_share: float = 0.125,
    seed: int = 0,
) -> ResponseRun:
    """Fit Nominal, Exo, Discrepancy and Augmented models of one person to two walks.

    Both walks are filtered, cut into strides and differentiated; models are fitted to the first part of each walk and
    tested on the last part, which is held out. Each network is compared with ridge regressions and with filtered noise.

    Parameters
    ----------
    nominal, exo : Trial, path, DataFrame or Recording
        The walk without and the walk with the device, with joint angles; a minute or more each.
    outputs : sequence of str, or str
        Angles whose second derivative is predicted.
    angles : sequence of str, or str, optional
        Angles among the inputs; by default the hip, knee and ankle angles that both walks have.
    emg : sequence of str, or str
        EMG channels among the inputs.
    held_out_share : float
        Share of each walk that is held out (its last part).
    seed : int
        Seed of all random numbers.

    Returns
    -------
    ResponseRun
        Result of one participant; `to_frame()` is the table of R2, and `gaitdisc.plot.r2` draws it. `gaitdisc run` does
        the same for all participants of a study.

    Raises
    ------
    ChannelError
        If an angle or muscle is missing or unusable.
    StrideError
        If a recording is not a walk, its sides are exchanged, or its gait changes towards the end.
    SamplingError
        If a walk is too short.

    References
    ----------
    Ebers 2023, Eqs. 4.1-4.5 and section 4.2.3.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> run = gd.fit_response("nominal.c3d", "exo.c3d", emg=["emg_sol_r"])  # doctest: +SKIP
    >>> run.to_frame()  # doctest: +SKIP
    """
    trials = {word: replace(make_trial(walk), condition=word) for word, walk in ((WITHOUT, nominal), (WITH, exo))}
    if not 0 < held_out_share < 1:
        raise SamplingError("held_out_share must be between 0 and 1", f"it is {held_out_share!r}", "Use 0.1 for 10 %.")
    inputs = _angles(trials, several(outputs), None if angles is None else several(angles))
    models = Models(angles=inputs, emg=several(emg), outputs=several(outputs), seed=seed)
    person = trials[WITH].subject or trials[WITHOUT].subject or "P01"
    conditions, held_out = Conditions(nominal=WITHOUT, device=WITH), HeldOut(share=held_out_share)
    study = Study(conditions=conditions, models=models, held_out=held_out, participants=(Participant(id=person),))
    walks = {word: processed(trial, study) for word, trial in trials.items()}
    settings, null = response_settings(study), make_filter_null(walks[WITH], study.filters)
    response = fitted(walks[WITHOUT].trajectory, walks[WITH].trajectory, settings, null, banded=True)
    summaries = tuple(replace(walk.summary(), subject=person) for walk in walks.values())
    files = {name: sha256 for walk in summaries for name, sha256 in walk.files.items()}
    made = {**study.public_settings(), "fits": asdict(settings)}
    origin = provenance_now(made, seed, files, "chapter 4: response to a device")
    units = {WALK.file: summaries, RESPONSE.file: (replace(response, participant=person),)}
    return ResponseRun(f"Response of {person}", WITHOUT, WITH, (), origin, units)


def _angles(trials: Mapping[str, Trial], outputs: Sequence[str], stated: Sequence[str] | None) -> tuple[str, ...]:
    """Angles among the inputs: those given, or the usual ones that both walks have."""
    both = [set(trial.stream("kinematics").names) for trial in trials.values()]
    chosen = tuple(stated) if stated is not None else tuple(name for name in ANGLES if name in both[0] & both[1])
    absent = [name for name in outputs if name not in chosen]
    if absent:
        raise ChannelError(
            "each output must be an angle that both walks have",
            f"{absent[0]!r} is not among the angles ({', '.join(chosen) or 'none'})",
            "Remove this output, or name it in angles.",
        )
    return chosen
