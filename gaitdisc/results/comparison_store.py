"""Saving and loading of what was compared over participants: the folders `tests/` and `over/` of a run."""

from __future__ import annotations

from pathlib import Path

from gaitdisc.results.over_participants import FAMILY_COLUMNS, TABLES, TEST_COLUMNS, OverParticipants, PairTests
from gaitdisc.results.unit_folder import load_unit, save_unit, with_words


def save_tests(tests: PairTests, folder: Path) -> None:
    """Save the paired tests of the models."""
    data = {
        "participants": tests.participants,
        "alpha": tests.alpha,
        "level": tests.level,
        "too_few": tests.too_few,
    }
    save_unit(folder, "tests.json", data, {"tests.csv": tests.tests, "families.csv": tests.families}, {})


def load_tests(folder: Path) -> PairTests:
    """Load the paired tests of the models."""
    data, tables, _ = load_unit(folder, "tests.json", {"tests.csv": TEST_COLUMNS, "families.csv": FAMILY_COLUMNS})
    return PairTests(
        data["participants"],
        data["alpha"],
        data["level"],
        data["too_few"],
        with_words(tables["tests.csv"], "left_out"),
        tables["families.csv"],
    )


def save_over(over: OverParticipants, folder: Path) -> None:
    """Save the other comparisons over participants."""
    data = {"lengths_said": over.lengths_said, "responders_said": over.responders_said}
    save_unit(folder, "over.json", data, {f"{name}.csv": table for name, table in over.tables().items()}, {})


def load_over(folder: Path) -> OverParticipants:
    """Load the other comparisons over participants."""
    data, files, _ = load_unit(folder, "over.json", {f"{name}.csv": columns for name, columns in TABLES.items()})
    tables = {name: with_words(files[f"{name}.csv"], "left_out") for name in TABLES}
    return OverParticipants(**tables, lengths_said=data["lengths_said"], responders_said=data["responders_said"])
