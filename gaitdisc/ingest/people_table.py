"""Who was measured: a table with mass, sex, stature, age; and what names of files say: person, session, condition."""

import csv
import itertools
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from gaitdisc.errors import GaitdiscError
from gaitdisc.ingest.columns import split_unit
from gaitdisc.ingest.raw_file import read_raw
from gaitdisc.recording.trial import AGE_YEARS, LENGTHS_M, MASS_KG, Limits
from gaitdisc.spreadsheet import unquote

TABLES = ("participants", "subjects", "patients", "people", "persons", "demographics", "anthropometry", "manifest")
LARGEST_BYTES = 2**22
# what a column holds -> names of its label, the first that a table has; `_in_` comes before a unit of another quantity
_LABELS = {
    "id": "participantid subjectid patientid personid id participant subject patient person pseudonym code",
    "mass": "masskg mass bodymass bodymasskg weight weightkg bodyweight bodyweightkg",
    "sex": "sex gender",
    "height": "heightm height heightcm heightmm stature staturem staturecm staturemm bodyheight",
    "age": "age ageyears ageyear ageyr ageyrs agey age_in_years age_in_y age_in_yr",
}
Sex = Literal["", "f", "m"]
_MISSING = ("", "n/a", "na", "nan", "none", "null", "-", "unknown")
_SEX: dict[str, Sex] = {
    **dict.fromkeys(("f", "female", "woman", "girl", "w"), "f"),
    **dict.fromkeys(("m", "male", "man", "boy"), "m"),
}
_METRES = {"m": 1.0, "cm": 1e-2, "mm": 1e-3}
PLAIN = "walking"  # what the plain words say, and nothing else
# what a word in the name of a file or folder shows -> the words, without the numbers at their ends
_SHOWN_BY = {
    "nominal": "natural nominal normal baseline control noexo nodevice noassist unassisted without zero off",
    "device": "exotendon exoskeleton exo device spring assist assisted powered brace orthosis afo augmented",
    "way of walking": "straight turn turning fast slow comfortable preferred selfselected barefoot shod shoes insole "
    "running run jogging stairs upstairs downstairs ramp uphill downhill incline decline backward backwards dualtask "
    "dual loaded cane crutch crutches overground treadmill",
    "plain": f"{PLAIN} walk gait",
    "static": "static stat standing stand calibration calib cal tpose anatomical",
    "functional": "functional circumduction stararc star hjc",
    "other": "rom mvc mvic jump squat sitting noise",
    "group": "controls patients healthy typical td cp stroke parkinson amputees adults children",
    "session": "pre before preop intake post after postop followup followup2 retention",  # in their order
    # what a file of a walk holds, not which walk it is
    "content": "ik id events grf grfs emg trc markers marker coordinates kinematics kinetics forces electromyography "
    "envelope inverse dynamics results mot sto c3d experimentaldata inversekinematics inversedynamics analog force",
    "nothing": "raw data trials recordings",
}
WORDS = {shown: tuple(words.split()) for shown, words in _SHOWN_BY.items()}
_NUMBERED_SESSION = re.compile(r"(visit|session|sess|ses|day|week|month)[-_ ]?(\d{1,3})", re.IGNORECASE)
_DATE = re.compile(r"(?<!\d)((?:19|20)\d{2})[-_.]?(\d{2})[-_.]?(\d{2})(?!\d)")
_PERSON = re.compile(r"(?:s|p|sub|subj|subject|participant|pt)[-_]?\d{1,4}", re.IGNORECASE)
# a short code and a number: anything longer, or without a number, may be a name
PSEUDONYM = re.compile(r"(?:sub|subj|subject|participant|pt|[a-z]{1,4})?[-_]?\d{1,4}", re.IGNORECASE)
_STARTS = ("noexo", "withoutexo", "nonexo", "nodevice")


@dataclass(frozen=True)
class Measured:
    """What a table says of a person; None or empty where it says nothing."""

    mass_kg: float | None = None  # body mass [kg]
    height_m: float | None = None  # stature [m]
    sex: Sex = ""
    age_years: int | None = None  # whole years; a date of birth is never read


def is_people_table(path: Path) -> bool:
    """Whether a file's name is that of a table of people: `participants.tsv`, `manifest.csv` and the like."""
    return path.suffix.lower() in (".csv", ".tsv") and path.stem.lower() in TABLES


def read_people(folder: Path, files: Iterable[Path], notes: list[str]) -> dict[str, Measured]:
    """Mass, sex, stature, age by a person's folded word, from tables of people; what was taken is added to `notes`."""
    people: dict[str, Measured] = {}
    for file in sorted(files):
        try:
            read = _read(read_raw(folder / file, LARGEST_BYTES).lines(), file.as_posix(), notes)
        except (GaitdiscError, csv.Error) as error:
            notes.append(f"left out: {file.as_posix()}: {error}")
            continue
        for word, measures in read.items():
            before = people.setdefault(word, measures)
            if before != measures:
                notes.append(f"{file.as_posix()}: not used for {word!r}, because another table states other values")
    return people


def person_key(word: str) -> str:
    """Word by which a row of a table and a folder of recordings are the same person.

    >>> person_key("sub-01"), person_key("S_07 ")
    ('01', 's07')
    """
    return re.sub(r"[^a-z0-9]", "", re.sub(r"^(sub|subject|participant)[-_ ]", "", word.strip().lower()))


def _read(lines: Sequence[str], file: str, notes: list[str]) -> dict[str, Measured]:
    rows = list(csv.reader(lines, delimiter=max("\t;,", key=lines[0].count)))
    labels = [unquote(label.strip()) for label in rows[0]]
    folded = []
    for label in labels:
        name, unit = split_unit(re.sub(r"\(([^()]*)\)\s*$", r"[\1]", label))
        known = re.sub(r"[^a-z0-9]", "", name.lower())
        folded.append(known if unit is None or unit in ("kg", *_METRES, "m/f", "f/m") else f"{known}_in_{unit}")
    at = {key: next((folded.index(name) for name in names.split() if name in folded), None)
          for key, names in _LABELS.items()}  # fmt: skip
    if at["id"] is None or all(place is None for key, place in at.items() if key != "id"):
        notes.append(
            f"{file} is not used: a table of people must have a column of names (such as participant_id) and a column "
            f"mass_kg, sex, height_m or age; its columns are {', '.join(labels[:8])}"
        )
        return {}
    stature = labels[at["height"]] if at["height"] is not None else ""
    people: dict[str, list[Measured]] = {}
    for number, row in enumerate(rows[1:], 2):
        cells = {key: row[i].strip() if i is not None and i < len(row) else "" for key, i in at.items()}
        if cells["id"]:
            added: list[str] = []
            people.setdefault(person_key(unquote(cells["id"])), []).append(_read_measures(cells, stature, added))
            notes += [f"{file}, line {number}: {words}" for words in added]
    agreed = {}  # what all rows of a person say; where two differ nothing is taken
    for word, measures in people.items():
        values: dict[str, Any] = {}
        for name, empty in vars(Measured()).items():
            stated = list(dict.fromkeys(getattr(row, name) for row in measures if getattr(row, name) != empty))
            values[name] = stated[0] if len(stated) == 1 else empty
            if len(stated) > 1:
                notes.append(f"{file}: rows differ in {name} of {word!r} ({stated[0]}, {stated[1]}); no value is used")
        agreed[word] = Measured(**values)
    return agreed


def _read_measures(cells: Mapping[str, str], stature_label: str, notes: list[str]) -> Measured:
    """What a row says of a person; a stature in the unit of its label, else in the one in which it is a person's."""
    stated = re.search(r"(?:^|[^a-z])(m|cm|mm)\W*$", stature_label.lower())
    unit, factors = (f" {stated[1]}", [_METRES[stated[1]]]) if stated else (" m, cm or mm", list(_METRES.values()))
    age = _within(cells["age"], "age", AGE_YEARS, notes)
    mass = _within(cells["mass"], "body mass", MASS_KG, notes)
    height = _within(cells["height"], "stature", LENGTHS_M["height_m"], notes, factors, unit)
    sex = _SEX.get(cells["sex"].lower(), "")
    if not sex and cells["sex"].lower() not in _MISSING:
        notes.append(f"sex {cells['sex']!r} is neither f nor m; the mean of women and men is used")
    return Measured(mass, None if height is None else round(height, 4), sex, None if age is None else int(age))


def _within(
    text: str, what: str, limits: Limits, notes: list[str], factors: Sequence[float] = (1.0,), written: str = ""
) -> float | None:
    """Number of a cell times the first factor that brings it within the limits; None, and a note, of another."""
    if text.lower() in _MISSING:
        return None
    try:
        value = float(text.replace(",", "."))
    except ValueError:
        value = math.nan
    for factor in factors:
        if limits.hold(value * factor):
            return value * factor
    if not math.isfinite(value):
        notes.append(f"{what} {text!r} is not a number and is not used")
    else:
        article = "an" if what[0] in "ae" else "a"
        possible = f"{limits.least:g} and {limits.most:g} {limits.unit}"
        notes.append(f"{article} {what} of {value:g}{written} is not between {possible} and is not used")
    return None


def words_in(name: str) -> list[str]:
    """Words of a name in lower case, numbers at their ends taken off.

    >>> words_in("c3d_Trimmed_running_exotendon3")
    ['c3d', 'trimmed', 'running', 'exotendon']
    """
    words = re.split(r"[^A-Za-z0-9]+|(?<=[a-z])(?=[A-Z])", name)
    return [re.sub(r"\d+$", "", part).lower() or part for part in words if part]


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
            if start in (*WORDS["nominal"], *_STARTS):
                return start, "nominal"
        for word in words:
            if word in WORDS["device"]:
                return word, "device"
    return "", ""


def walk_key(path: Path) -> str:
    """What is left of a file's name when the words for its kind are taken away: files of one walk share it."""
    words = re.split(r"[^A-Za-z0-9]+", path.stem)
    return "_".join(part for part in words if part and part.lower() not in WORDS["content"])


def walk_place(path: Path) -> tuple[str, ...]:
    """Folders of a file without those that only name the kind: files of one walk may lie in `IK` and in `GRF`."""
    return tuple(folder for folder in path.parent.parts if folder.lower() not in WORDS["content"])


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
    """Words of a path that name a group: folders such as `controls` above those of persons; or empty."""
    folders = path.parent.parts[:-1] if _own_folders(path) else path.parent.parts
    return " ".join(folder.lower() for folder in folders if folder.lower() in WORDS["group"])


def session_word(path: Path) -> tuple[str, str]:
    """Word of a path that names the session, and what it is put in order by; the word of a date is empty.

    A word counts before any date, and the date of an inner folder before that of an outer one, which may be of birth.
    Where neither names a session both are empty.

    >>> session_word(Path("P01/post/walk.c3d")), session_word(Path("P01/2024-03-01/walk.c3d"))
    (('post', 'a04'), ('', 'd20240301'))
    """
    for name in (*path.parent.parts, path.stem):
        for word in (name.lower(), *words_in(name)):
            if word in WORDS["session"]:
                return word, f"a{WORDS['session'].index(word):02d}"
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
    return next((kind for kind in ("static", "functional", "other") if words & set(WORDS[kind])), "")


def walk_word(path: Path) -> str:
    """Word of a path for how somebody walks, where it is no word for with or without a device; or empty.

    >>> walk_word(Path("HC002D/Straight/HC002D06.c3d")), walk_word(Path("P01/walk_fast2.c3d"))
    ('straight', 'fast')
    >>> walk_word(Path("P01/Marble floor/01.c3d")), walk_word(Path("P01/walk01.c3d")), walk_word(Path("P01/01.c3d"))
    ('marble floor', 'walking', '')
    """
    words = [word for name in (path.stem, *reversed(path.parent.parts)) for word in words_in(name)]
    folders = (folder.lower() for folder in _own_folders(path)[:0:-1])
    ways = (word for word in words if word in WORDS["way of walking"])
    plain = PLAIN if set(words) & set(WORDS["plain"]) else ""
    return next(ways, next(folders, plain))


def _own_folders(path: Path) -> list[str]:
    """Folders that name neither group, session, condition nor kind: the first is a person's."""
    folders = []
    for place, folder in enumerate(path.parent.parts):
        alone = Path(folder, "x")
        beneath = place + 1 < len(path.parent.parts) or _person_in(path.stem)
        if folder.lower() in WORDS["group"] and beneath and not folders:
            continue
        if folder.lower() in (*WORDS["nothing"], *WORDS["content"]) or kind_of_trial(alone) or condition_word(alone)[1]:
            continue
        if any(word in (*WORDS["way of walking"], *WORDS["plain"]) for word in words_in(folder)):
            continue
        undated = _DATE.sub("", folder).strip("-_. ")  # `P01_2024-03-01` and `P01_2024-06-01` are one person
        if undated and (undated != folder or not session_word(alone)[1]):
            folders.append(undated)
    return folders
