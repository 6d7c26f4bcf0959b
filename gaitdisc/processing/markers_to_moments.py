"""From markers, segments and forces of a trial to its joint angles, moments and powers, in the streams others read."""

import re
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import GaitdiscError
from gaitdisc.kinematics.calibration import Calibration
from gaitdisc.kinematics.exchanged_labels import Exchange
from gaitdisc.kinematics.markers import marker_labels
from gaitdisc.kinematics.motion import Motion, motion, segment_angles
from gaitdisc.kinetics.body_inertia import Person
from gaitdisc.kinetics.joint_moments import KineticsSettings
from gaitdisc.kinetics.plate_steps import FootPath, PlateStep
from gaitdisc.kinetics.trial_kinetics import trial_kinetics
from gaitdisc.processing.two_sources import MOVES_DEG, line_angles
from gaitdisc.recording import Finding, Recording, Trial

STAY = "step lengths and widths there; the angles of the file follow the correct labels and are used; "
STAY += "correct the labels"
BELOW = {  # angles that hang on a segment where a model is built from the pelvis down, all of them on the pelvis
    "thigh": r"(hip|knee|ankle|foot)_\w+_{0}|{1}(Hip|Knee|Ankle|AbsAnkle|FootProgress)Angles?\.[xyz]",
    "shank": r"(knee|ankle|foot)_\w+_{0}|{1}(Knee|Ankle|AbsAnkle|FootProgress)Angles?\.[xyz]",
    "foot": r"(ankle|foot)_\w+_{0}|{1}(Ankle|AbsAnkle|FootProgress)Angles?\.[xyz]",
}


@dataclass(frozen=True, eq=False)
class ComputedTrial:
    """A trial with what was computed from its markers, if anything was."""

    trial: Trial  # with angles and, where platforms allow it, moments
    steps: tuple[PlateStep, ...] | None = None  # on all platforms, clean or not; None without moments from markers
    from_markers: tuple[str, ...] = ()  # streams that were computed


def compute_trial(
    trial: Trial, calibration: Calibration, person: Person | None, settings: KineticsSettings | None = None
) -> ComputedTrial:
    """Trial with joint angles from its markers and, where platforms allow it, moments and powers.

    What a model in the file itself held under these streams gives way. A trial without forces, or without a step of
    one foot alone on a platform, has angles only and says why in its findings.
    """
    moved = motion(trial.stream("markers"), calibration)
    replaced = [key for key in ("kinematics", "moments") if key in trial.streams]
    streams = {key: recording for key, recording in trial.streams.items() if key not in replaced}
    named = {"subject": trial.subject, "condition": trial.condition}
    streams["markers"] = moved.markers
    streams["kinematics"] = replace(moved.angles, **named)
    file = moved.angles.source.file or trial.name
    typical = {name: float(np.nanmedian(r)) for name, r in moved.residual_m.items() if np.isfinite(r).any()}
    worst = max(typical, key=lambda name: typical[name])
    median_mm, largest_mm = 1000.0 * float(np.median([*typical.values()])), 1000.0 * typical[worst]
    what = f"the distance of the markers from their positions in the static trial is {median_mm:.1f} mm "
    what += f"(median of {len(typical)} segments); the largest distance is {largest_mm:.1f} mm ({worst})"
    findings = [*trial.findings, *moved.findings, Finding("note", "residual", file, what, "")]
    steps = None
    if replaced:
        what = f"{' and '.join(replaced)} of the file were replaced by those computed from its markers"
        findings.append(Finding("note", "own model", file, what, ""))
    if person is not None and "forces" in trial.streams:
        try:
            kinetics = trial_kinetics(trial, moved.poses, find_foot_paths(moved), person, settings)
        except GaitdiscError as error:
            findings.append(Finding("warning", "no moments", file, str(error).rstrip("."), "moments and powers"))
        else:
            streams["moments"], steps = kinetics.moments, kinetics.steps
            findings += kinetics.findings
    made = ("kinematics",) if steps is None else ("kinematics", "moments")
    return ComputedTrial(replace(trial, streams=streams, findings=tuple(findings)), steps, made)


def without_exchanged_markers(trial: Trial, calibration: Calibration) -> Trial:
    """Trial with the angles of its file, missing where markers of their segments bear another's label.

    Angles that follow the markers as they are with the labels put right were computed before these were exchanged.
    """
    moved, angles = motion(trial.stream("markers"), calibration), trial.stream("kinematics")
    values, findings = np.array(angles.values), [f for f in moved.findings if f.kind == "exchanged markers"]
    exchanged = moved.exchanged if len(angles.time) == len(moved.markers.time) else ()
    for at, exchange in enumerate(exchanged, len(findings) - len(exchanged)):  # the static trial's come before
        if _follows_right_labels(angles, trial.stream("markers"), exchange, calibration):
            findings[at] = replace(findings[at], spoils=STAY)
            continue
        parts = [(segment[:-2], segment[-1]) for segment in exchange.segments if segment != "pelvis"]
        hang = [BELOW[part].format(side, side.upper()) for part, side in parts]
        hang = [".*"] if "pelvis" in exchange.segments else hang
        lost = [c.quantity == "angle" and any(re.fullmatch(name, c.name) for name in hang) for c in angles.channels]
        values[np.outer(exchange.frames, lost)] = np.nan
    streams = {**trial.streams, "markers": moved.markers, "kinematics": angles.with_values(values, angles.suspect)}
    return replace(trial, streams=streams, findings=(*trial.findings, *findings))


def _follows_right_labels(angles: Recording, markers: Recording, exchange: Exchange, calibration: Calibration) -> bool:
    """Whether angles lie nearer to the lines between markers whose labels are put right than to those as they are."""
    names, values = calibration.marker_set.names(marker_labels(markers)), np.array(markers.values)
    first, second = ([markers.index(f"{names[name]}.{axis}") for axis in "xyz"] for name in exchange.pair)
    frames: NDArray[np.intp] = np.flatnonzero(exchange.frames)
    values[frames[:, None], first + second] = values[frames[:, None], second + first]
    as_is, right = line_angles(markers), line_angles(markers.with_values(values))
    apart = []
    for name in set(as_is) & set(angles.names):
        both = [angles[name] - lines[name] for lines in (as_is, right)]
        if not all(np.isfinite(difference[~exchange.frames]).any() for difference in both):
            continue  # exchanged throughout: no offset is known
        both = [np.abs(difference - np.nanmedian(difference[~exchange.frames]))[frames] for difference in both]
        apart.append(
            np.nan_to_num(np.where(np.abs(as_is[name] - right[name])[frames] > MOVES_DEG, both, 0.0)).sum(axis=1)
        )
    wrong, good = np.sum(apart, axis=0) if apart else (0.0, 0.0)
    return bool(good < wrong)


def with_segment_angles(trial: Trial) -> Trial:
    """Trial with joint angles where it has poses of segments and no angles; why there are none is a finding."""
    if "segments" not in trial.streams or "kinematics" in trial.streams:
        return trial
    try:
        angles, findings = segment_angles(trial.stream("segments"))
    except GaitdiscError as error:
        finding = Finding("warning", "no angles", trial.name, str(error).rstrip("."), "angles from segments")
        return replace(trial, findings=(*trial.findings, finding))
    named = replace(angles, subject=trial.subject, condition=trial.condition)
    return replace(trial, streams={**trial.streams, "kinematics": named}, findings=(*trial.findings, *findings))


def find_foot_paths(moved: Motion) -> dict[str, FootPath]:
    """Paths of heel and toes as the feet's segments carry them, with or without their markers in a frame."""
    paths = {}
    for side in "lr":
        foot, points = moved.poses[f"foot_{side}"], moved.calibration.points[f"foot_{side}"]
        places = (foot.to_laboratory(points[f"{part}_{side}"]) for part in ("heel", "toe"))
        paths[side] = FootPath(side, moved.angles.time, *places)
    return paths
