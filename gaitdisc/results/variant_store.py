"""Saving and loading of variants: `RUN/<question>/`, and in it `people/<person>/` of each participant."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

from gaitdisc.results.provenance import Refusal
from gaitdisc.results.unit_folder import NO_KEY, Keyed, load_unit, save_unit, with_words
from gaitdisc.results.variants import VARIANT_COLUMNS, VARIANT_TEST_COLUMNS, VariantRun, Variants


def save_variants(variants: Variants, folder: Path, key: str) -> None:
    """Save the variants of one participant.

    key: what they were computed from: a hash of files and settings
    """
    data = {
        "key": key,
        "participant": variants.participant,
        "question": variants.question,
        "left_away": [{"variant": name, "reason": reason} for name, reason in variants.left_away.items()],
    }
    save_unit(folder, "variants.json", data, {"variants.csv": variants.table}, {})


def load_variants(folder: Path) -> Keyed[Variants]:
    """Load the variants of one participant, and the key they were computed from."""
    data, tables, _ = load_unit(folder, "variants.json", {"variants.csv": VARIANT_COLUMNS})
    left_away = {str(row["variant"]): str(row["reason"]) for row in data["left_away"]}
    found = Variants(data["participant"], data["question"], tables["variants.csv"], left_away)
    return Keyed(found, data["key"])


def save_variant_run(run: VariantRun, folder: Path) -> None:
    """Save what was found over the participants, beside theirs, which were saved as they were computed."""
    data = {
        "title": run.title,
        "exo": run.exo,
        "question": run.question,
        "people": [each.participant for each in run.people],
        "refusals": [asdict(refusal) for refusal in run.refusals],
        "held_out_s": list(run.held_out_s),
    }
    save_unit(folder, "variant_run.json", data, {"tests.csv": run.tests}, {})


def save_whole_variant_run(run: VariantRun, folder: Path) -> None:
    """Save what was found over the participants, and the variants of each, as they are in memory."""
    for each in run.people:
        save_variants(each, folder / "people" / each.participant, NO_KEY)
    save_variant_run(run, folder)


def load_variant_run(folder: Path) -> VariantRun:
    """Load what was found over the participants."""
    data, tables, _ = load_unit(folder, "variant_run.json", {"tests.csv": VARIANT_TEST_COLUMNS})
    return VariantRun(
        data["title"],
        data["exo"],
        data["question"],
        tuple(load_variants(folder / "people" / name).result for name in data["people"]),
        with_words(tables["tests.csv"], "left_out"),
        tuple(Refusal(**refusal) for refusal in data["refusals"]),
        (data["held_out_s"][0], data["held_out_s"][1]),
    )
