"""Look at recordings without changing or writing anything: the traffic light of `gaitdisc check`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from gaitdisc.errors import GaitdiscError, StrideError
from gaitdisc.ingest.c3d import C3DReader
from gaitdisc.ingest.reading import read_planned_trial, read_trial
from gaitdisc.ingest.study import UNKNOWN, Study
from gaitdisc.processing.contact_choice import chosen_contacts
from gaitdisc.processing.process import processed, quality_findings, stride_findings
from gaitdisc.recording import Finding, Strides, Trial
from gaitdisc.signals.contacts import order_findings
from gaitdisc.signals.strides import cut_strides
from gaitdisc.signals.walking import verify_walking

SHOWN = 4  # channels of one line
SAID = ("contact offset",)  # kinds of notes that are always printed: percent stride was moved, or is known to be early


@dataclass(frozen=True)
class Inspection:
    """What was seen of one trial.

    Parameters
    ----------
    name : str
        File or files.
    participant, condition : str
        As the study has them; empty for a file alone.
    streams : mapping of str to str
        Stream to channels, rate and length in words.
    strides : mapping of str to (int, int)
        Side to strides kept and dropped.
    findings : tuple of Finding
        Everything, the severest first.
    refusal : str
        Why the trial cannot be used, or empty.
    """

    name: str
    participant: str = ""
    condition: str = ""
    streams: Mapping[str, str] = field(default_factory=dict)
    strides: Mapping[str, tuple[int, int]] = field(default_factory=dict)
    findings: tuple[Finding, ...] = ()
    refusal: str = ""

    @property
    def light(self) -> str:
        """`red` where the trial is refused, `amber` where channels or samples are spoiled, else `green`."""
        if self.refusal:
            return "red"
        return "amber" if any(finding.severity != "note" for finding in self.findings) else "green"

    def grouped(self, notes: bool = False) -> list[str]:
        """Findings in a line for each kind: which channels, and the words of the first of them.

        Parameters
        ----------
        notes : bool
            Notes as well as warnings; those about moved contacts are always there.
        """
        kinds: dict[tuple[str, str], list[Finding]] = {}
        for finding in self.findings:
            if notes or finding.severity != "note" or finding.kind in SAID:
                kinds.setdefault((finding.severity, finding.kind), []).append(finding)
        return [_line_of(severity, kind, same) for (severity, kind), same in kinds.items()]


def inspected_study(study: Study) -> Iterator[Inspection]:
    """Read and process every trial of a study, those of unknown conditions too.

    Parameters
    ----------
    study : Study
        Settings and files.

    Yields
    ------
    Inspection
        One a trial, in the study's order, then one for each participant who lacks a condition.
    """
    with C3DReader() as reader:
        for participant in study.participants:
            for planned in participant.trials:
                name = ", ".join(Path(file).name for file in planned.files)
                try:
                    trial = read_planned_trial(study, participant, planned, reader)
                except GaitdiscError as error:
                    yield Inspection(name, participant.id, planned.condition, refusal=str(error))
                    continue
                used = planned.condition != UNKNOWN
                yield _of_study(trial, study, name) if used else _looked_at(trial, name)
    both = f"{study.conditions.nominal!r} and {study.conditions.device!r}"
    for lacking in study.one_condition_only():
        reason = f"trials of both conditions, {both}, are needed; {lacking} lacks one. Add it, or leave {lacking} out."
        yield Inspection("", lacking, refusal=reason)


def inspected_file(path: Path, reader: C3DReader | None = None) -> Inspection:
    """Read one file and say what it holds and what is wrong with it.

    Parameters
    ----------
    path : Path
        A recording.
    reader : C3DReader, optional
        A running reader process to use again.
    """
    try:
        trial = read_trial(path, reader=reader)
    except GaitdiscError as error:
        return Inspection(path.name, refusal=str(error))
    return _looked_at(trial, path.name)


def _of_study(trial: Trial, study: Study, name: str) -> Inspection:
    try:
        walk = processed(trial, study)
    except GaitdiscError as error:
        seen = _looked_at(trial, name)
        return Inspection(name, trial.subject, trial.condition, seen.streams, seen.strides, seen.findings, str(error))
    return Inspection(
        name, trial.subject, trial.condition, _streams(trial), _counted(walk.strides), _sorted(walk.findings)
    )


def _looked_at(trial: Trial, name: str) -> Inspection:
    findings = [*trial.findings, *quality_findings(trial)]
    strides: dict[str, Strides] = {}
    refusal = ""
    try:
        choice = chosen_contacts(trial)
        findings += choice.findings
        for side, contacts in sorted(choice.contacts.items()):
            strides[side] = cut_strides(contacts)
        findings += order_findings(choice.contacts["r"], choice.contacts["l"], trial.name)
        if "kinematics" in trial.streams:
            findings += stride_findings(trial.stream("kinematics"), strides["r"])
            if choice.detector == "angles":
                verify_walking(trial.stream("kinematics"), strides["r"])
    except StrideError as error:
        if "kinematics" in trial.streams:
            refusal = f"not used as walking: {error}"
        else:
            findings.append(Finding("note", "no strides", trial.name, str(error), ""))
    return Inspection(
        name, trial.subject, trial.condition, _streams(trial), _counted(strides), _sorted(findings), refusal
    )


def _streams(trial: Trial) -> dict[str, str]:
    return {key: f"{len(r.channels)} at {r.rate_hz:g} Hz, {r.duration_s:.1f} s" for key, r in trial.streams.items()}


def _counted(strides: Mapping[str, Strides]) -> dict[str, tuple[int, int]]:
    return {side: (len(cut), len(cut.dropped)) for side, cut in strides.items()}


def _line_of(severity: str, kind: str, same: list[Finding]) -> str:
    first = same[0]
    if len(same) == 1:
        return first.line()
    channels = list(dict.fromkeys(finding.channel for finding in same if finding.channel))
    named = ", ".join(channels[:SHOWN]) + (f" and {len(channels) - SHOWN} more" if len(channels) > SHOWN else "")
    where = ", ".join(part for part in (first.file, named) if part)
    spoils = f"; spoils {first.spoils}" if first.spoils else ""
    told = f"{first.channel}: {first.what}" if first.channel else first.what
    return f"{severity}: {where}: {kind}, {len(same)} times, the first {told}{spoils}"


def _sorted(findings: list[Finding] | tuple[Finding, ...]) -> tuple[Finding, ...]:
    return tuple(sorted(findings, key=lambda finding: finding.rank))
