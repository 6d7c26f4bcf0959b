"""Trials of segments without markers: joint angles from the poses that the file holds."""

from __future__ import annotations

from dataclasses import replace

from gaitdisc.errors import GaitdiscError
from gaitdisc.kinematics.segment_angles import segment_angles
from gaitdisc.recording import Finding, Trial


def with_segment_angles(trial: Trial) -> Trial:
    """Trial with joint angles where it has poses of segments and no angles; why there are none is a finding."""
    if "segments" not in trial.streams or "kinematics" in trial.streams:
        return trial
    try:
        angles, findings = segment_angles(trial.stream("segments"))
    except GaitdiscError as error:
        said = Finding("warning", "no angles", trial.name, str(error).rstrip("."), "angles from segments")
        return replace(trial, findings=(*trial.findings, said))
    named = replace(angles, subject=trial.subject, condition=trial.condition)
    return replace(trial, streams={**trial.streams, "kinematics": named}, findings=(*trial.findings, *findings))
