"""Channels and their vocabulary, read from `data_schema/channels.csv`."""

from __future__ import annotations

import csv
import difflib
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from pathlib import Path

from gaitdisc.errors import ChannelError, SchemaError, UnitError
from gaitdisc.units import list_units

QUANTITIES = ("angle", "translation", "marker", "moment", "force", "vertical_force",
              "pressure_centre", "power", "emg", "signal")  # fmt: skip


@dataclass(frozen=True)
class Channel:
    """One measured or simulated quantity.

    Parameters
    ----------
    name : str
        OpenSim's name (`ankle_angle_r`), `emg_<muscle>_<side>` for EMG, or `<marker>.x` for a marker coordinate.
    quantity : str
        One of `QUANTITIES`; `signal` is for all other quantities (a voltage, a synchronisation pulse).
    unit : str
        One of `gaitdisc.units.list_units()`, or its time derivative, such as `deg/s`.
    side : str
        `r`, `l`, or empty if the quantity has no side.

    Raises
    ------
    ChannelError
        If the name is empty, or the quantity or side is unknown.
    UnitError
        If the unit is not in the list of units.

    Examples
    --------
    >>> Channel("ankle_angle_r", "angle", "deg", "r").unit
    'deg'
    """

    name: str
    quantity: str
    unit: str
    side: str = ""

    def __post_init__(self) -> None:
        if not self.name:
            raise ChannelError("every channel must have a name", "one name is empty", "Name the column.")
        if self.quantity not in QUANTITIES:
            raise ChannelError(
                f"the quantity of channel {self.name!r} must be in the vocabulary",
                f"found {self.quantity!r}",
                f"Use one of: {', '.join(QUANTITIES)}.",
            )
        if self.side not in ("r", "l", ""):
            raise ChannelError(
                f"the side of channel {self.name!r} must be 'r', 'l' or ''",
                f"found {self.side!r}",
                "Correct the side in channels.csv or in the study's [channels].",
            )
        base = re.sub(r"/s\d?$", "", self.unit)
        if base not in list_units():
            raise UnitError(
                f"the unit of channel {self.name!r} must be in the list of units",
                f"found {self.unit!r}",
                f"Use one of: {', '.join(list_units())}.",
            )

    def renamed(self, name: str) -> Channel:
        """Return the same channel under another name.

        Parameters
        ----------
        name : str
            New name.
        """
        return replace(self, name=name)


@dataclass(frozen=True)
class Vocabulary:
    """The channels that the package knows, with the other names they go by."""

    channels: tuple[Channel, ...]
    positive: dict[str, str]  # channel name -> what a positive value means
    aliases: dict[str, str]

    @cached_property
    def by_name(self) -> dict[str, Channel]:
        """Channels by their own names, in the order of the vocabulary."""
        return {channel.name: channel for channel in self.channels}

    def named(self, label: str) -> Channel | None:
        """Channel that a label means, or None.

        label: as written in a file. Case, blanks and punctuation do not count, nor does the path and the trailing
            `/value` of OpenSim's full-path labels

        >>> vocabulary().named("/jointset/hip_r/hip_flexion_r/value").name
        'hip_flexion_r'
        >>> vocabulary().named("R Tib Ant").name
        'emg_ta_r'
        """
        name = self.aliases.get(fold_label(label)) or self.aliases.get(fold_label(path_label(label)))
        return self.by_name.get(name or "")


def nearest_word(word: str, among: Iterable[str]) -> str | None:
    """Word of a list most like another, or None where none is near.

    >>> nearest_word("particpants", ["participants", "filters"])
    'participants'
    """
    by_fold = {candidate.lower(): candidate for candidate in among}
    close = difflib.get_close_matches(word.lower(), by_fold, n=1, cutoff=0.6)
    return by_fold[close[0]] if close else None


def hint_nearest(word: str, among: Iterable[str]) -> str:
    """Return the end of a sentence that names the nearest word, or nothing."""
    return f", the nearest is {nearest!r}" if (nearest := nearest_word(word, among)) else ""


def did_you_mean(word: str, among: Iterable[str], otherwise: str = "") -> str:
    """Return the question whether the nearest word was meant, or another remedy where none is near."""
    return f"Did you mean {nearest!r}?" if (nearest := nearest_word(word, among)) else otherwise


def check_word(word: str, words: Iterable[str], what: str) -> None:
    """Refuse a word that is none of those that there are."""
    if word not in words:
        raise SchemaError(f"{what} must be one of {', '.join(words)}", f"found {word!r}", "Use one of these.")


def list_names(names: Sequence[str], most: int = 6, none: str = "nothing") -> str:
    """Say the first names of many, and how many more there are.

    >>> list_names(["a", "b", "c"], 2), list_names([])
    ('a, b and 1 more', 'nothing')
    """
    return (", ".join(names[:most]) or none) + (f" and {len(names) - most} more" if len(names) > most else "")


def fold_label(label: str) -> str:
    """Fold a label to lower case without blanks and punctuation.

    >>> fold_label("R Tib-Ant")
    'rtibant'
    """
    return re.sub(r"[^a-z0-9]", "", label.lower())


def path_label(label: str) -> str:
    """Last part of an OpenSim full-path label that names the coordinate; a plain label is returned as it is.

    >>> path_label("/jointset/hip_r/hip_flexion_r/value")
    'hip_flexion_r'
    """
    if not label.startswith("/"):
        return label
    parts = [part for part in label.split("/") if part]
    if len(parts) > 1 and parts[-1] in ("value", "speed", "accel"):
        return parts[-2] if parts[-1] == "value" else f"{parts[-2]}/{parts[-1]}"
    return parts[-1] if parts else label


def find_side(name: str) -> str:
    """Side that a name states: `r`, `l` or empty.

    >>> find_side("emg_sol_l"), find_side("hip_flexion_r_moment"), find_side("lumbar_bending")
    ('l', 'r', '')
    """
    match = re.search(r"_(r|l)(?=$|[_./])", name.lower())
    return match[1] if match else ""


def other_side(side: str) -> str:
    """The other leg: `l` for `r`, `r` for `l`."""
    return "l" if side == "r" else "r"


def schema_folder() -> Path:
    """Folder of the vocabulary and the JSON Schemas, in a checkout or in an installed wheel."""
    installed = Path(__file__).parent / "data_schema"
    return installed if installed.is_dir() else Path(__file__).parents[1] / "data_schema"


@cache
def vocabulary() -> Vocabulary:
    """Vocabulary of `data_schema/channels.csv`.

    >>> vocabulary().named("hip_flexion_r").unit
    'deg'
    """
    path = schema_folder() / "channels.csv"
    with path.open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    aliases: dict[str, str] = {}
    for row in rows:
        for label in [row["name"], *filter(None, row["aliases"].split("|"))]:
            owner = aliases.setdefault(fold_label(label), row["name"])
            if owner != row["name"]:
                raise ChannelError(
                    "an alias in channels.csv must belong to one channel only",
                    f"{label!r} is an alias of {owner!r} and of {row['name']!r}",
                    "Remove the alias from one channel.",
                )
    channels = tuple(Channel(r["name"], r["quantity"], r["unit"], r["side"]) for r in rows)
    return Vocabulary(channels, {r["name"]: r["positive"] for r in rows}, aliases)
