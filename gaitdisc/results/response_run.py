"""The result of a study of responses: every participant, every refusal, and what it rests on."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from gaitdisc.notebook import html_of
from gaitdisc.results.kind import Kind
from gaitdisc.results.over_participants import OVER, TESTS, OverParticipants, PairTests
from gaitdisc.results.participant_response import QUANTITY, RESPONSE, DataQuantity, ParticipantResponse
from gaitdisc.results.pooled_cycles import CYCLES, WALK, PooledCycles, WalkSummary
from gaitdisc.results.study_run import StudyRun, load_run_as, save_whole_run
from gaitdisc.results.variants import QUESTIONS


@dataclass(frozen=True, eq=False, repr=False)
class ResponseRun(StudyRun):
    """All that a report needs; nothing is fitted again to draw it.

    Parameters
    ----------
    title : str
        Title of the study.
    nominal, exo : str
        The study's words for the two conditions; `exo` is empty where no device is compared.
    refusals : tuple of Refusal
        Everybody and everything left out.
    provenance : Provenance
        Settings, seed, files, versions.
    units : mapping of str to tuple
        What was kept, by the file of its kind: `walks`, `responses`, `tests`, `quantities`, `over`, `cycles`.
    unfitted : tuple of Refusal
        Participants whose cycles are pooled and to whom no models are fitted, and why, in a study with a device.
    renewed : tuple of str
        Files of an earlier run that were found changed or unreadable, and were computed again; said once, not saved.
    """

    @property
    def walks(self) -> tuple[WalkSummary, ...]:
        """Every walk that could be processed."""
        return self.of(WALK)

    @property
    def responses(self) -> tuple[ParticipantResponse, ...]:
        """Every participant whose models could be fitted."""
        return self.of(RESPONSE)

    @property
    def tests(self) -> PairTests | None:
        """The models compared in pairs over the participants; None in runs of before there were tests."""
        return next(iter(self.of(TESTS)), None)

    @property
    def quantities(self) -> tuple[DataQuantity, ...]:
        """What less data would have given, where `gaitdisc ablate` was run."""
        return self.of(QUANTITY)

    @property
    def over(self) -> OverParticipants | None:
        """Training lengths, residuals and baselines compared over participants, and sub-groups; None in older runs."""
        return next(iter(self.of(OVER)), None)

    @property
    def cycles(self) -> tuple[PooledCycles, ...]:
        """Where cycles are pooled over trials: each participant, session and condition."""
        return self.of(CYCLES)

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


def load_run(folder: Path) -> ResponseRun:
    """Load a run with all its units."""
    return load_run_as(ResponseRun, folder)


RUN = Kind(
    ResponseRun,
    "run.json",
    write=save_whole_run,
    read=load_run,
    page="gaitdisc.report.response_page:write_report",
    page_folder="report",
    beside=QUESTIONS,
)
