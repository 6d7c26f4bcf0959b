"""What names of files and folders say: person, group, session, condition, standing, and which files are one walk."""

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
# words of laboratories for ways of walking, the plain ones last: any of the others says more
WALK_WORDS = (
    "straight", "turn", "turning", "fast", "slow", "comfortable", "preferred", "selfselected", "barefoot", "shod",
    "shoes", "insole", "running", "run", "jogging", "stairs", "upstairs", "downstairs", "ramp", "uphill", "downhill",
    "incline", "decline", "backward", "backwards", "dualtask", "dual", "loaded", "cane", "crutch", "crutches",
    "overground", "treadmill",
)  # fmt: skip
PLAIN = "walking"  # what these say, and nothing else
PLAIN_WORDS = (PLAIN, "walk", "gait")
STATIC_WORDS = ("static", "stat", "standing", "stand", "calibration", "calib", "cal", "tpose", "anatomical")
FUNCTIONAL_WORDS = ("functional", "circumduction", "stararc", "star", "hjc")
NO_WALK_WORDS = ("rom", "mvc", "mvic", "jump", "squat", "sitting", "noise")
GROUP_WORDS = (
    "controls", "patients", "healthy", "typical", "td", "cp", "stroke", "parkinson", "amputees", "adults", "children",
)  # fmt: skip
SESSION_WORDS = ("pre", "before", "preop", "intake", "post", "after", "postop", "followup", "followup2", "retention")
_NUMBERED_SESSION = re.compile(r"(visit|session|sess|ses|day|week|month)[-_ ]?(\d{1,3})", re.IGNORECASE)
_DATE = re.compile(r"(?<!\d)((?:19|20)\d{2})[-_.]?(\d{2})[-_.]?(\d{2})(?!\d)")
# words for what a file of a walk holds, not which walk it is
_KIND_WORDS = {
    "ik", "id", "grf", "grfs", "emg", "trc", "markers", "marker", "coordinates", "kinematics", "kinetics", "forces",
    "electromyography", "envelope", "inverse", "dynamics", "results", "mot", "sto", "c3d", "experimentaldata",
    "inversekinematics", "inversedynamics", "analog", "force",
}  # fmt: skip
_NEUTRAL_FOLDERS = {"raw", "data", "trials", "recordings"}
_PERSON = re.compile(r"(?:s|p|sub|subj|subject|participant|pt)[-_]?\d{1,4}", re.IGNORECASE)
# a short code and a number: anything longer, or without a number, may be a name
PSEUDONYM = re.compile(r"(?:sub|subj|subject|participant|pt|[a-z]{1,4})?[-_]?\d{1,4}", re.IGNORECASE)
_STARTS = ("noexo", "withoutexo", "nonexo", "nodevice")


def words_in(name: str) -> list[str]:
    """Words of a name in lower case, numbers at their ends taken off.

    >>> words_in("c3d_Trimmed_running_exotendon3")
    ['c3d', 'trimmed', 'running', 'exotendon']
    """
    parts = re.split(r"[^A-Za-z0-9]+|(?<=[a-z])(?=[A-Z])", name)
    return [re.sub(r"\d+$", "", part).lower() or part for part in parts if part]


def condition_word(path: Path) -> tuple[str, str]:
    """Word of a relative path that names the condition, and which; the file's own name counts before its folders.

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

    >>> walk_key(Path("IK_gait.mot")), walk_key(Path("gait_emg.sto")), walk_key(Path("coordinates.sto"))
    ('gait', 'gait', '')
    """
    parts = [part for part in re.split(r"[^A-Za-z0-9]+", path.stem) if part]
    return "_".join(part for part in parts if part.lower() not in _KIND_WORDS)


def walk_place(path: Path) -> tuple[str, ...]:
    """Folders of a file without those that only name the kind: files of one walk may lie in `IK` and in `GRF`.

    >>> walk_place(Path("P01/IK/walk1.mot")) == walk_place(Path("P01/GRF/walk1.mot")) == ("P01",)
    True
    """
    return tuple(folder for folder in path.parent.parts if folder.lower() not in _KIND_WORDS)


def person_word(path: Path) -> str:
    """Word of a path that names the person: the first folder that names nothing else, or a part such as `S01`.

    >>> person_word(Path("welk002/manual_ik.mot")), person_word(Path("S03_exo.mot")), person_word(Path("exo/walk.mot"))
    ('welk002', 'S03', '')
    >>> person_word(Path("controls/Anna/pre/Straight/trial01.c3d"))
    'Anna'
    """
    return (*_own_folders(path), _person_in(path.stem))[0]


def _person_in(name: str) -> str:
    return next((part for part in re.split(r"[^A-Za-z0-9]+", name) if _PERSON.fullmatch(part)), "")


def group_word(path: Path) -> str:
    """Words of a path that name a group: folders such as `controls` above those of persons; or empty.

    >>> group_word(Path("children/td/P01/walk.c3d")), group_word(Path("P01/walk.c3d"))
    ('children td', '')
    """
    folders = path.parent.parts[:-1] if _own_folders(path) else path.parent.parts
    return " ".join(folder.lower() for folder in folders if folder.lower() in GROUP_WORDS)


def session_word(path: Path) -> tuple[str, str]:
    """Word of a path that names the session, and what it is put in order by; the word of a date is empty.

    A word counts before any date, and the date of an inner folder before that of an outer one, which may be of birth.

    returns word: such as `pre` or `visit 2`; empty for a date and where no word names one
    returns order: later sessions have a greater one; empty where no word names one

    >>> session_word(Path("P01/post/walk.c3d")), session_word(Path("P01/2024-03-01/walk.c3d"))
    (('post', 'a04'), ('', 'd20240301'))
    """
    for name in (*path.parent.parts, path.stem):
        for word in (name.lower(), *words_in(name)):
            if word in SESSION_WORDS:
                return word, f"a{SESSION_WORDS.index(word):02d}"
        for part in (name, *re.split(r"[^A-Za-z0-9]+", name)):
            numbered = _NUMBERED_SESSION.fullmatch(part)
            if numbered:
                return f"{numbered[1].lower()} {int(numbered[2])}", f"b{numbered[1].lower()}{int(numbered[2]):03d}"
    dates = (_DATE.search(name) for name in (*reversed(path.parent.parts), path.stem))
    return "", next(("d" + "".join(date.groups()) for date in dates if date), "")


def kind_of_trial(path: Path) -> str:
    """What somebody does instead of walking, by the names: stands, circles the legs, something else; or empty.

    >>> kind_of_trial(Path("P01/Static/a.c3d")), kind_of_trial(Path("P01/hip_ROM1.c3d")), kind_of_trial(Path("a.c3d"))
    ('static', 'other', '')
    >>> kind_of_trial(Path("P01/star_arc_right.c3d"))
    'functional'
    """
    words = {word for name in (path.stem, *path.parent.parts) for word in (name.lower(), *words_in(name))}
    if words & set(STATIC_WORDS):
        return "static"
    if words & set(FUNCTIONAL_WORDS):
        return "functional"
    return "other" if words & set(NO_WALK_WORDS) else ""


def walk_word(path: Path) -> str:
    """Word of a path for how somebody walks, where it is no word for with or without a device; or empty.

    >>> walk_word(Path("HC002D/Straight/HC002D06.c3d")), walk_word(Path("P01/walk_fast2.c3d"))
    ('straight', 'fast')
    >>> walk_word(Path("P01/Marble floor/01.c3d")), walk_word(Path("P01/walk01.c3d")), walk_word(Path("P01/01.c3d"))
    ('marble floor', 'walking', '')
    """
    names = (path.stem, *reversed(path.parent.parts))
    words = [word for name in names for word in words_in(name)]
    own = _own_folders(path)
    styles = [word for word in words if word in WALK_WORDS] or [folder.lower() for folder in own[:0:-1]]
    return styles[0] if styles else PLAIN if set(words) & set(PLAIN_WORDS) else ""


def _own_folders(path: Path) -> list[str]:
    """Folders that name neither group, session, condition nor kind: the first is a person's."""
    own = []
    for place, folder in enumerate(path.parent.parts):
        alone = Path(folder, "x")
        lower = folder.lower()
        beneath = place + 1 < len(path.parent.parts) or _person_in(path.stem)
        if lower in GROUP_WORDS and beneath and not own:
            continue
        if lower in _NEUTRAL_FOLDERS or lower in _KIND_WORDS or kind_of_trial(alone):
            continue
        if condition_word(alone)[1] or any(word in (*WALK_WORDS, *PLAIN_WORDS) for word in words_in(folder)):
            continue
        undated = _DATE.sub("", folder).strip("-_. ")  # `P01_2024-03-01` and `P01_2024-06-01` are one person
        if undated and (undated != folder or not session_word(alone)[1]):
            own.append(undated)
    return own
