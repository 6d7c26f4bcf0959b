"""Work on a question beside the study with its progress shown, then its page."""

from __future__ import annotations

import time
from pathlib import Path

import typer

from gaitdisc.commands.run_report import end, say_renewed, worked


def vary(place: Path, out: Path | None, question: str, workers: tuple[int, str], quiet: bool) -> None:
    """Answer a question of a study and write its page."""
    from gaitdisc.batch.vary_study import vary_study
    from gaitdisc.batch.workers import Workers
    from gaitdisc.ingest.study_file import load_study
    from gaitdisc.own_files import claim_file
    from gaitdisc.report.variants import variant_sentences, write_variants
    from gaitdisc.results.run_store import claim_run

    study = load_study(place)
    folder, started, side_by_side = out or study.folder / "run", time.perf_counter(), Workers(*workers)
    claim_run(folder)
    claim_file(folder / question / "report.html")
    people = [person.id for person in study.participants]
    done = worked(lambda progress: vary_study(study, folder, question, side_by_side, progress), people, quiet)
    say_renewed(done.renewed)
    page = write_variants(done, folder / question)
    for sentence in variant_sentences(done):
        typer.echo(sentence)
    end(done.refusals, len(done.people), page, time.perf_counter() - started)
