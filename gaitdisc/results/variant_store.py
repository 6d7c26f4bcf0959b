"""Saving and loading of one participant's variants: `RUN/<question>/people/<person>/`."""

from __future__ import annotations

from pathlib import Path

from gaitdisc.results.unit_folder import load_unit, save_unit
from gaitdisc.results.variants import Variants


def save_variants(variants: Variants, folder: Path, key: str) -> None:
    """Save the variants of one participant.

    Parameters
    ----------
    variants : Variants
        What to keep.
    folder : Path
        Folder of this participant and question alone.
    key : str
        What they were computed from: a hash of files and settings.
    """
    data = {
        "key": key,
        "participant": variants.participant,
        "question": variants.question,
        "left_away": [{"variant": name, "reason": reason} for name, reason in variants.left_away.items()],
    }
    save_unit(folder, "variants.json", data, {"variants.csv": variants.table}, {})


def load_variants(folder: Path) -> tuple[Variants, str]:
    """Load the variants of one participant, and the key they were computed from.

    Parameters
    ----------
    folder : Path
        Folder that `save_variants` wrote.

    Raises
    ------
    SchemaError
        If a file is missing, damaged or of another format.
    """
    data, tables, _ = load_unit(folder, "variants.json")
    left_away = {str(row["variant"]): str(row["reason"]) for row in data["left_away"]}
    return Variants(data["participant"], data["question"], tables["variants.csv"], left_away), data["key"]
