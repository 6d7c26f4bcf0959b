"""What a participant's models explain when one thing is changed: an input left away, a filter, a training length."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from gaitdisc.response.participants_result import TEST_COLUMNS, table_of_people
from gaitdisc.saved.kind import CSV, Kind, Saved, plain
from gaitdisc.saved.provenance import Refusal
from gaitdisc.saved.unit_folder import load_unit, save_unit, with_words

ALL = "all inputs"  # name of the variant that leaves none away
VARIANT_COLUMNS = ("variant", "variable", "model", "kind", "r2", "n")
VARIANT_TEST_COLUMNS = ("variant", "model", *TEST_COLUMNS)


@dataclass(frozen=True, eq=False)
class Variants:
    """R2 on held-out device walking of one participant, under every variant."""

    participant: str
    question: str  # of `QUESTIONS`: `modalities`, inputs left away; `sensitivity`, filters and training lengths
    # columns `VARIANT_COLUMNS`: variant (in words), variable, model, kind, r2, n (held-out samples)
    table: pd.DataFrame
    left_away: Mapping[str, str]  # variant -> why there is no row of it


@dataclass(frozen=True, eq=False)
class VariantRun(Saved, file="variant_run.json"):
    """The variants of a study, over its participants."""

    title: str
    exo: str  # the study's word for the device walk
    question: str
    people: tuple[Variants, ...]  # every participant whose models could be fitted
    tests: pd.DataFrame  # columns `VARIANT_TEST_COLUMNS`; empty for fewer than six participants
    refusals: tuple[Refusal, ...]
    held_out_s: tuple[float, float]  # shortest and longest held-out part [s]
    renewed: tuple[str, ...] = ()

    def to_frame(self) -> pd.DataFrame:
        """R2 of every participant, variant, variable, model and kind, one row each."""
        return table_of_people(self.people, "table", VARIANT_COLUMNS)

    r2_table = to_frame


VARIANTS = Kind(
    Variants,
    "variants.json",
    ("participant", "question", "left_away"),
    {"table": CSV("variants.csv", VARIANT_COLUMNS)},
    reasons="variant",
)


def save_variant_run(run: VariantRun, folder: Path) -> None:
    """Save what was found over the participants, beside theirs, which were saved as they were computed."""
    data = {name: plain(getattr(run, name)) for name in ("title", "exo", "question", "refusals", "held_out_s")}
    data["people"] = [person.participant for person in run.people]
    save_unit(folder, "variant_run.json", data, {"tests.csv": run.tests}, {})


def save_whole_variant_run(run: VariantRun, folder: Path) -> None:
    """Save what was found over the participants, and the variants of each, as they are in memory."""
    for person in run.people:
        VARIANTS.save(person, folder / "people" / person.participant)
    save_variant_run(run, folder)


def load_variant_run(folder: Path) -> VariantRun:
    """Load what was found over the participants."""
    data, tables, _ = load_unit(folder, "variant_run.json", {"tests.csv": VARIANT_TEST_COLUMNS})
    return VariantRun(
        **{name: data[name] for name in ("title", "exo", "question")},
        people=tuple(VARIANTS.load(folder / "people" / name) for name in data["people"]),
        tests=with_words(tables["tests.csv"], "left_out"),
        refusals=tuple(Refusal(**refusal) for refusal in data["refusals"]),
        held_out_s=tuple(data["held_out_s"]),
    )


VARIANT_RUN = Kind(
    VariantRun,
    "variant_run.json",
    write=save_whole_variant_run,
    read=load_variant_run,
    page="gaitdisc.response.variants_page:write_variants",
)
