"""Walks of one participant as models are fitted to them: with angles from markers where the study requests these."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from gaitdisc.errors import ChannelError
from gaitdisc.ingest.study import Participant, PlannedTrial, Study
from gaitdisc.processing.process import processed
from gaitdisc.processing.standing import Read, Standing, standing_of
from gaitdisc.processing.walk import Walk
from gaitdisc.recording import Trial


@dataclass(frozen=True, eq=False)
class ReadWalk:
    """A trial before it is filtered."""

    trial: Trial  # with the angles that its study requests, and moments where they could be computed
    body_weight_n: float | None = None  # of the person [N]; None where neither the study nor a file states a mass
    # why no angles were computed of the trial's markers; empty where it has angles, or no markers
    without_angles: str = ""

    def processed(self, study: Study) -> Walk:
        """Filtered walk, cut into strides, under the settings of a study."""
        if self.without_angles:
            raise ChannelError(
                "models need joint angles, of the files or computed from markers and a static trial",
                f"{self.trial.name} has markers and no angles: {self.without_angles}",
                'Add the trial in which the person stands with condition = "static", or the file with the angles.',
            )
        return processed(self.trial, study, self.body_weight_n)


@dataclass(eq=False)
class StudyWalks:
    """The walks of one participant; the static trial of a session is read once, at its first walk."""

    study: Study
    participant: Participant
    read: Read
    _standing: dict[str, Standing] = field(default_factory=dict, init=False)

    def read_walk(self, planned: PlannedTrial) -> ReadWalk:
        """Trial of the study, with angles and moments from its markers where the study requests them."""
        trial = self.read(planned)
        session = planned.session or ""
        if session not in self._standing:
            self._standing[session] = standing_of(self.study, self.participant, session, self.read)
        standing = self._standing[session]
        computed = standing.computed(planned, trial).trial
        findings = standing.findings(computed, "kinematics" in computed.streams)
        ready = replace(computed, findings=(*computed.findings, *findings))
        why = ""
        if "kinematics" not in ready.streams and "markers" in ready.streams:
            why = next((one.what for one in ready.findings if one.kind == "no angles"), standing.unread)
            if self.study.kinematics and self.study.kinematics.angles == "file":
                why = 'those of the file are wanted, angles = "file" in [kinematics]'
        return ReadWalk(ready, standing.body_weight_n(planned), why)

    def walk(self, planned: PlannedTrial) -> Walk:
        """Filtered walk, cut into strides, under the settings of the study."""
        return self.read_walk(planned).processed(self.study)
