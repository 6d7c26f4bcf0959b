"""The result of a study of responses: every participant, every refusal, and what it rests on."""

from __future__ import annotations

from dataclasses import dataclass

import pandas as pd

from gaitdisc.notebook import html_of
from gaitdisc.results.over_participants import OverParticipants, PairTests
from gaitdisc.results.participant_response import DataQuantity, ParticipantResponse
from gaitdisc.results.pooled_cycles import PooledCycles
from gaitdisc.results.provenance import Provenance, Refusal
from gaitdisc.results.saved import Saved
from gaitdisc.results.walk_summary import WalkSummary


@dataclass(frozen=True, eq=False)
class ResponseRun(Saved, by="gaitdisc.results.run_store:save_whole_run"):
    """All that a report needs; nothing is fitted again to draw it.

    Parameters
    ----------
    title : str
        Title of the study.
    nominal, exo : str
        The study's words for the two conditions; `exo` is empty where no device is compared.
    walks : tuple of WalkSummary
        Every walk that could be processed.
    responses : tuple of ParticipantResponse
        Every participant whose models could be fitted.
    refusals : tuple of Refusal
        Everybody and everything left out.
    provenance : Provenance
        Settings, seed, files, versions.
    tests : PairTests, optional
        The models compared in pairs over the participants; None in runs of before there were tests.
    quantities : tuple of DataQuantity
        What less data would have given, where `gaitdisc ablate` was run.
    over : OverParticipants, optional
        Training lengths, residuals and baselines compared over participants, and sub-groups; None in older runs.
    renewed : tuple of str
        Files of an earlier run that were found changed or unreadable, and were computed again; said once, not saved.
    cycles : tuple of PooledCycles
        Where cycles are pooled over trials: each participant, session and condition.
    unfitted : tuple of Refusal
        Participants whose cycles are pooled and to whom no models are fitted, and why, in a study with a device.
    """

    title: str
    nominal: str
    exo: str
    walks: tuple[WalkSummary, ...]
    responses: tuple[ParticipantResponse, ...]
    refusals: tuple[Refusal, ...]
    provenance: Provenance
    tests: PairTests | None = None
    quantities: tuple[DataQuantity, ...] = ()
    over: OverParticipants | None = None
    renewed: tuple[str, ...] = ()
    cycles: tuple[PooledCycles, ...] = ()
    unfitted: tuple[Refusal, ...] = ()

    @property
    def reported(self) -> tuple[str, ...]:
        """Participants of whom something is reported: models, or cycles."""
        names = [response.participant for response in self.responses]
        return tuple(dict.fromkeys([*names, *(one.subject for one in self.cycles if len(one.kept))]))

    def r2_table(self) -> pd.DataFrame:
        """R2 of every participant, variable, model, kind and walk, one row each."""
        tables = [r.r2.assign(participant=r.participant) for r in self.responses]
        columns = ["participant", "variable", "model", "kind", "walk", "r2", "n"]
        return pd.concat(tables, ignore_index=True)[columns] if tables else pd.DataFrame(columns=pd.Index(columns))

    def findings_table(self) -> pd.DataFrame:
        """Every finding of every walk and of pooled trials, one row each, the severest first."""
        rows = [
            {
                "participant": walk.subject,
                "condition": walk.where if isinstance(walk, PooledCycles) else walk.condition,
                "severity": finding.severity,
                "kind": finding.kind,
                "file": finding.file,
                "channel": finding.channel,
                "what": finding.what,
                "spoils": finding.spoils,
                "spans_s": "; ".join(f"{start:.2f}-{end:.2f}" for start, end in finding.spans),
            }
            for walk, finding in sorted(
                ((walk, finding) for walk in (*self.walks, *self.cycles) for finding in walk.findings),
                key=lambda both: both[1].rank,
            )
        ]
        columns = ["participant", "condition", "severity", "kind", "file", "channel", "what", "spoils", "spans_s"]
        return pd.DataFrame(rows, columns=pd.Index(columns))

    def to_frame(self) -> pd.DataFrame:
        """R2 of every participant, variable, model, kind and walk, one row each."""
        return self.r2_table()

    def __repr__(self) -> str:
        counts = f"{len(self.responses)} responses, {len(self.cycles)} sets of cycles, {len(self.refusals)} refusals"
        return f"ResponseRun({self.title!r}, {counts})"

    def _repr_html_(self) -> str:
        rows = [("conditions", " and ".join(word for word in (self.nominal, self.exo) if word))]
        rows += [("participants", ", ".join(self.reported)), ("refusals", str(len(self.refusals)))]
        table = self.r2_table()
        table = table[(table["kind"] == "network") & (table["walk"] == "exo")]
        middle = table.groupby("model", sort=False)["r2"].median()
        rows += [(f"median R² of {model}", f"{value:.2f}") for model, value in middle.items()]
        return html_of(self.title or "Response run", rows)
