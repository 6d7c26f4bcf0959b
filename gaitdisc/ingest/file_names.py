"""What names of files and folders tell: the condition of a walk, the person, and which files belong to one walk."""

from __future__ import annotations

import itertools
import re
from pathlib import Path

NOMINAL_WORDS = (
    "natural",
    "nominal",
    "normal",
    "baseline",
    "control",
    "noexo",
    "nodevice",
    "noassist",
    "unassisted",
    "without",
    "zero",
    "off",
)
DEVICE_WORDS = (
    "exotendon",
    "exoskeleton",
    "exo",
    "device",
    "spring",
    "assist",
    "assisted",
    "powered",
    "brace",
    "orthosis",
    "afo",
    "augmented",
)
# words that tell what a file of a walk holds, not which walk it is
_KIND_WORDS = {
    "ik", "id", "grf", "grfs", "emg", "trc", "markers", "marker", "coordinates", "kinematics", "kinetics", "forces",
    "electromyography", "envelope", "inverse", "dynamics", "results", "mot", "sto", "c3d",
}  # fmt: skip
_PERSON = re.compile(r"(?:s|p|sub|subj|subject|participant|pt)[-_]?\d{1,4}", re.IGNORECASE)
# a short code and a number: anything longer, or without a number, may be a name
PSEUDONYM = re.compile(r"(?:sub|subj|subject|participant|pt|[a-z]{1,4})?[-_]?\d{1,4}", re.IGNORECASE)
_STARTS = ("noexo", "withoutexo", "nonexo", "nodevice")


def words_in(name: str) -> list[str]:
    """Words of a name in lower case, numbers at their ends taken off.

    Parameters
    ----------
    name : str
        Name of a file or folder without its ending.

    Examples
    --------
    >>> words_in("c3d_Trimmed_running_exotendon3")
    ['c3d', 'trimmed', 'running', 'exotendon']
    """
    parts = re.split(r"[^A-Za-z0-9]+|(?<=[a-z])(?=[A-Z])", name)
    return [re.sub(r"\d+$", "", part).lower() or part for part in parts if part]


def condition_word(path: Path) -> tuple[str, str]:
    """Word of a path that tells the condition, and which of the two it is.

    Parameters
    ----------
    path : Path
        Relative to the folder that is searched; the file's own name counts before its folders.

    Returns
    -------
    word : str
        Empty where no word tells.
    which : str
        `nominal`, `device` or empty.

    Examples
    --------
    >>> condition_word(Path("P01/walk_no_exo.mot")), condition_word(Path("exo/walk2.mot"))
    (('noexo', 'nominal'), ('exo', 'device'))
    """
    for name in (path.stem, *reversed(path.parent.parts)):
        words = words_in(name)
        joined = [a + b for a, b in itertools.pairwise(words) if a in ("no", "without", "non", "un")]
        for word in (*joined, *words):
            start = next((start for start in _STARTS if word.startswith(start)), word)
            if start in (*NOMINAL_WORDS, *_STARTS):
                return start, "nominal"
        for word in words:
            if word in DEVICE_WORDS:
                return word, "device"
    return "", ""


def walk_key(path: Path) -> str:
    """What is left of a file's name when the words for its kind are taken away: files of one walk share it.

    Parameters
    ----------
    path : Path
        File.

    Examples
    --------
    >>> walk_key(Path("IK_gait.mot")), walk_key(Path("gait_emg.sto")), walk_key(Path("coordinates.sto"))
    ('gait', 'gait', '')
    """
    parts = [part for part in re.split(r"[^A-Za-z0-9]+", path.stem) if part]
    return "_".join(part for part in parts if part.lower() not in _KIND_WORDS)


def person_word(path: Path) -> str:
    """Word of a path that tells the person: the first folder, or a part of the name such as `S01`; or empty.

    Parameters
    ----------
    path : Path
        Relative to the folder that is searched.

    Examples
    --------
    >>> person_word(Path("welk002/manual_ik.mot")), person_word(Path("S03_exo.mot")), person_word(Path("exo/walk.mot"))
    ('welk002', 'S03', '')
    """
    for folder in path.parent.parts:
        if not condition_word(Path(folder, "x"))[1] and folder.lower() not in ("raw", "data", "trials"):
            return folder
    return next((part for part in re.split(r"[^A-Za-z0-9]+", path.stem) if _PERSON.fullmatch(part)), "")
