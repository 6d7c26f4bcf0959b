"""Look at recordings without changing or writing anything: the traffic light of `gaitdisc check`."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from gaitdisc.channel import list_names
from gaitdisc.errors import GaitdiscError, StrideError
from gaitdisc.ingest.c3d import C3DReader
from gaitdisc.ingest.reading import read_planned_trial, read_trial
from gaitdisc.ingest.study import Participant, PlannedTrial, Study
from gaitdisc.ingest.trial_sets import is_calibration, is_walk, not_compared, trial_sets, why_refused
from gaitdisc.processing.contact_choice import choose_contacts
from gaitdisc.processing.markers_to_moments import with_segment_angles
from gaitdisc.processing.pooled import can_pool, pool_cycles
from gaitdisc.processing.process import StudyWalks, quality_findings, stride_findings
from gaitdisc.processing.side_checks import side_findings
from gaitdisc.processing.two_sources import without_contradicted
from gaitdisc.recording import Finding, Strides, Trial
from gaitdisc.signals.contacts import order_findings
from gaitdisc.signals.strides import cut_strides, verify_walking
from gaitdisc.words import as_html

SHOWN = 4  # channels of one line
SAID = ("contact offset",)  # kinds of notes that are always printed: percent stride was moved, or is known to be early


@dataclass(frozen=True)
class Inspection:
    """The findings of one trial.

    Parameters
    ----------
    name : str
        File or files.
    participant, condition : str
        Names in the study; empty for a single file.
    streams : mapping of str to str
        Name of each stream -> its channels, rate and length in words.
    strides : mapping of str to (int, int)
        Side -> number of strides kept and number dropped.
    findings : tuple of Finding
        All findings, the most severe first.
    refusal : str
        The reason why the trial cannot be used; empty if it can.
    """

    name: str
    participant: str = ""
    condition: str = ""
    streams: Mapping[str, str] = field(default_factory=dict)
    strides: Mapping[str, tuple[int, int]] = field(default_factory=dict)
    findings: tuple[Finding, ...] = ()
    refusal: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "findings", tuple(sorted(self.findings, key=lambda finding: finding.rank)))

    def __repr__(self) -> str:
        strides = "".join(f", {count} strides {side}" for side, (count, _) in self.strides.items())
        return f"Inspection({self.name!r}: {self.light}{strides}, {len(self.findings)} findings)"

    def _repr_html_(self) -> str:
        rows = [("light", self.light), ("refused", self.refusal), *self.streams.items()]
        rows += [(f"strides {side}", f"{kept}, {dropped} dropped") for side, (kept, dropped) in self.strides.items()]
        rows += [(finding.severity, finding.line()) for finding in self.findings]
        return as_html(f"Inspection of {self.name}", [row for row in rows if row[1]])

    @property
    def light(self) -> str:
        """`red` if the trial is refused, `amber` if channels or samples are affected, otherwise `green`."""
        if self.refusal:
            return "red"
        return "amber" if any(finding.severity != "note" for finding in self.findings) else "green"

    def grouped(self, notes: bool = False) -> list[str]:
        """Findings, one line per kind: the channels, and the text of the first finding of that kind.

        Parameters
        ----------
        notes : bool
            Whether notes are included; notes about shifted contacts are always included.
        """
        kinds: dict[tuple[str, str], list[Finding]] = {}
        for finding in self.findings:
            if notes or finding.severity != "note" or finding.kind in SAID:
                kinds.setdefault((finding.severity, finding.kind), []).append(finding)
        lines = []
        for (severity, kind), same in kinds.items():
            first, shown = same[0], same[0].line()
            if len(same) > 1:
                channels = list(dict.fromkeys(finding.channel for finding in same if finding.channel))
                where = ", ".join(part for part in (first.file, list_names(channels, SHOWN, "")) if part)
                spoils = f"; affects {first.spoils}" if first.spoils else ""
                example = f"{first.channel}: {first.what}" if first.channel else first.what
                shown = f"{severity}: {where}: {kind}, {len(same)} times, the first {example}{spoils}"
            lines.append(shown)
        return lines


def inspect_study(study: Study) -> Iterator[Inspection]:
    """Read and process every trial of a study as `gaitdisc run` would, in its order; then who is refused as a whole."""
    refused = []
    with C3DReader() as reader:
        for participant in study.participants:
            reason = why_refused(study, participant)
            inspections = _list_unused(study, participant, reader)
            if not_compared(study, participant) and not reason:
                inspections |= _pool(study, participant, reader)
            else:
                walks = _process(study, participant, reader)
                refusals = not reason and any(walk.refusal for walk in walks.values())
                inspections |= (_pool(study, participant, reader, instead=True) if refusals else {}) or walks
            yield from (inspections[place] for place in sorted(inspections))
            if reason and not participant.excluded:
                refused.append(Inspection("", participant.id, refusal=reason))
    yield from refused


def _process(study: Study, participant: Participant, reader: C3DReader) -> dict[int, Inspection]:
    """Trials that models are to be fitted to, each alone, by their place in the study."""
    inspections = {}
    walks = StudyWalks(study, participant, lambda planned: read_planned_trial(study, participant, planned, reader))
    for place, planned in enumerate(participant.trials):
        if not is_walk(study, planned):
            continue
        try:
            read = walks.read_walk(planned)
            try:
                walk = read.processed(study)
                inspections[place] = _findings(read.trial, _name(planned), walk.strides, walk.findings)
            except GaitdiscError as error:
                inspections[place] = replace(inspect_trial(read.trial, _name(planned)), refusal=str(error))
        except GaitdiscError as error:
            inspections[place] = Inspection(_name(planned), participant.id, planned.condition, refusal=str(error))
    return inspections


def _pool(study: Study, participant: Participant, reader: C3DReader, instead: bool = False) -> dict[int, Inspection]:
    """Pooled trials by place in the study, then what is refused whole; none that cannot stand in for a comparison."""
    streams: dict[str, dict[str, str]] = {}
    read_with: dict[str, tuple[Finding, ...]] = {}

    def read(planned: PlannedTrial) -> Trial:
        trial = read_planned_trial(study, participant, planned, reader)
        streams[trial.name] = _streams(trial)
        read_with[trial.name] = (*without_contradicted(trial).findings, *side_findings(trial, {}))
        return trial

    sets = trial_sets(study, participant)
    all_pooled = pool_cycles(study, participant, read)
    if instead and not can_pool(all_pooled):
        return {}
    places = {id(planned): place for place, planned in enumerate(participant.trials)}
    inspections: dict[int, Inspection] = {}
    for trial_set, pooled in zip(sets, all_pooled, strict=True):
        reasons = {refusal.condition: refusal.reason for refusal in pooled.refusals}
        for number, planned in enumerate(trial_set.trials, 1):
            name = participant.trial_name(planned)
            where = name.removeprefix(participant.id).strip()
            files = [Path(file).name for file in planned.files]
            findings = [f for f in pooled.findings if f.file in (name, pooled.where) or any(n in f.file for n in files)]
            if reason := reasons.pop(where, ""):  # why may be what the reader saw: a unit, a side
                findings += [finding for finding in read_with.get(name, ()) if finding not in findings]
            rows = pooled.cycles[pooled.cycles["trial"] == number]
            kept, lost = (rows[rows["kept"] == wanted]["side"].value_counts() for wanted in (True, False))
            counts = {side: (int(kept.get(side, 0)), int(lost.get(side, 0))) for side in sorted(set(rows["side"]))}
            inspections[places[id(planned)]] = Inspection(
                _name(planned), participant.id, where, streams.get(name, {}), counts, tuple(findings), refusal=reason
            )
        for reason in reasons.values():
            place = len(participant.trials) + len(inspections)
            inspections[place] = Inspection("", participant.id, pooled.where, refusal=reason)
    return inspections


def _list_unused(study: Study, participant: Participant, reader: C3DReader) -> dict[int, Inspection]:
    """Trials that are not used as walks, standing or of unknown condition, by their place in the study."""
    inspections = {}
    for place, planned in enumerate(participant.trials):
        if is_walk(study, planned):
            continue
        name = _name(planned)
        try:
            trial = read_planned_trial(study, participant, planned, reader)
        except GaitdiscError as error:
            inspections[place] = Inspection(name, participant.id, planned.condition, refusal=str(error))
            continue
        stands = is_calibration(study, planned)
        inspections[place] = _findings(trial, name, {}, trial.findings) if stands else inspect_trial(trial, name)
    return inspections


def _name(planned: PlannedTrial) -> str:
    return ", ".join(Path(file).name for file in planned.files)


def inspect_file(path: Path, reader: C3DReader | None = None) -> Inspection:
    """Read one file and say what it holds and what is wrong with it."""
    try:
        trial = read_trial(path, reader=reader)
    except GaitdiscError as error:
        return Inspection(path.name, refusal=str(error))
    return inspect_trial(trial, path.name)


def inspect_trial(trial: Trial, name: str) -> Inspection:
    """Say what a walk holds and what is wrong with it."""
    trial = with_segment_angles(without_contradicted(trial))
    findings = [*trial.findings, *quality_findings(trial)]
    strides: dict[str, Strides] = {}
    refusal = ""
    try:
        choice = choose_contacts(trial)
        findings += choice.findings
        strides = {side: cut_strides(contacts) for side, contacts in sorted(choice.contacts.items())}
        findings += order_findings(choice.contacts["r"], choice.contacts["l"], trial.name)
        findings += side_findings(trial, strides)
        if "kinematics" in trial.streams:
            findings += stride_findings(trial.stream("kinematics"), strides["r"])
            if choice.detector == "angles":
                verify_walking(trial.stream("kinematics"), strides["r"])
    except StrideError as error:
        if "kinematics" in trial.streams:
            refusal = f"not used as a walk: {error}"
        else:
            findings.append(Finding("note", "no strides", trial.name, str(error), ""))
    return _findings(trial, name, strides, findings, refusal)


def _streams(trial: Trial) -> dict[str, str]:
    spans = {k: f" at {r.rate_hz:g} Hz, {r.duration_s:.1f} s" for k, r in trial.streams.items() if len(r.time) > 1}
    return {key: f"{len(r.channels)}{spans.get(key, ', one frame')}" for key, r in trial.streams.items()}


def _findings(
    trial: Trial, name: str, strides: Mapping[str, Strides], findings: Sequence[Finding], refusal: str = ""
) -> Inspection:
    counts = {side: (len(cut), len(cut.dropped)) for side, cut in strides.items()}
    return Inspection(name, trial.subject, trial.condition, _streams(trial), counts, tuple(findings), refusal=refusal)
