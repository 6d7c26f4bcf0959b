"""OpenSim storage files (`.mot`, `.sto`): coordinates, ground forces, joint moments and EMG, read and written.

Headers are modern or of the old SIMM style, or both at once.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from gaitdisc.channel import (
    QUANTITIES,
    Channel,
    find_side,
    fold_label,
    hint_nearest,
    list_names,
    path_label,
    vocabulary,
)
from gaitdisc.errors import ReadError
from gaitdisc.ingest.cells import Form, check_counts, even_time, parse_cells
from gaitdisc.ingest.columns import (
    IGNORE,
    RATE_WORDS,
    Column,
    check_written_names,
    column_in_unit,
    name_channel,
    read_label,
    sort_trial,
    split_unit,
)
from gaitdisc.ingest.raw_file import read_raw
from gaitdisc.ingest.stated_units import find_copied_unit, plausible_unit
from gaitdisc.recording import Finding, Recording, Trial
from gaitdisc.recording.arrays import Values
from gaitdisc.whole_file import write_whole

_YES_NO = {"yes": True, "y": True, "true": True, "1": True, "no": False, "n": False, "false": False, "0": False}
_ROWS, _COLUMNS = ("nrows", "datarows"), ("ncolumns", "datacolumns")
_OWN_COLUMN = re.compile(r"column\s+(\d+)\s*=\s*(\w+)\s*\[([^\]]*)\]\s*(r|l|)\s*", re.IGNORECASE)
_GROUND = re.compile(r"(?:.*_)?(?:ground|grf|fp_?\d)\w*?_([vpm]?)([xyz])", re.IGNORECASE)
_GROUND_WORD = re.compile(r"force|torque|moment", re.IGNORECASE)
_RATES = {  # kinematics_u and _dudt are what OpenSim's analyses write
    **dict.fromkeys(("speeds", "velocities", "kinematics_u"), "/s"),
    **dict.fromkeys(("accelerations", "kinematics_dudt"), "/s2"),
}
# What OpenSim's analyses write of muscles under the names of the muscles, which elsewhere are those of EMG
_OF_ACTUATORS = {"actuation_force": "N", "actuation_power": "W", "forcereporter": "N"}


def read_storage(path: Path | str, channels: Mapping[str, str] | None = None) -> Trial:
    """Trial of one OpenSim storage file.

    Both header styles are read, and both at once. What the header states about degrees is obeyed and checked against
    how far hips and knees move; translations are in m whatever it states. Wrong counts in a header are reported where
    the rows agree among themselves; more than 1 % fewer rows than it claims are refused, since the file was cut.

    Source: OpenSim documentation, "Storage (.sto) Files" and "Motion (.mot) Files".
    """
    raw = read_raw(path)
    lines = raw.lines()
    header = parse_header(lines, raw.name)
    columns = storage_columns(header, raw.name, channels)
    form = Form(raw.name, header.separator)
    cells = parse_cells(lines[header.body_line - 1 :], header.labels, header.body_line, form)
    claims = ("rows", header.rows, len(cells.values)), ("columns", header.columns, len(header.labels))
    findings = [*check_counts(cells, lines, raw.name, *claims), *naming_findings(columns, raw.name)]
    if lines[-1].strip() and len(cells.lines) >= 3:  # a number cut: no line end, shorter than all of one width
        before = {len(str(lines[number - 1]).rstrip()) for number in cells.lines[:-1].tolist()}
        width = max(before)
        if len(before) == 1 and len(lines[-1]) < width:
            raise ReadError(
                f"{raw.name}: every line must have {width} characters",
                f"line {cells.lines[-1]} (the last line) has {len(lines[-1])}",
                "The file is incomplete. Copy or export it again.",
            )
    time = even_time(cells.values[:, 0], cells.printed_digit(0), raw.name, cells.lines)
    columns, more = _in_true_unit(columns, header.degrees, time, cells.values[:, 1:], raw.name)
    reader = raw.name.rpartition(".")[2].lower()
    return sort_trial(raw.source(reader), time, cells.values[:, 1:], columns, [*findings, *more])


def write_storage(recording: Recording, path: Path | str) -> Path:
    """Write a recording as an OpenSim storage file with `inDegrees`, whole or not at all.

    What a channel's name does not determine stands in lines such as `column 3=emg [V] r`, which OpenSim passes over;
    marks of suspect samples, subject and condition are not written.
    """
    path = Path(path)
    check_written_names(recording.names, path.name)
    angles = any(channel.quantity in ("angle", "translation") for channel in recording.channels)
    header = [
        "Coordinates" if angles else "gaitdisc",
        "version=1",
        f"nRows={len(recording.time)}",
        f"nColumns={len(recording.channels) + 1}",
        "inDegrees=yes",
        *(
            f"column {number}={channel.quantity} [{channel.unit}] {channel.side}".rstrip()
            for number, channel in enumerate(recording.channels, 1)
            if vocabulary().by_name.get(channel.name) != channel or channel.quantity == "emg"
        ),
        "endheader",
        "\t".join(["time", *recording.names]),
    ]
    rows = ("\t".join(map(repr, row)) for row in np.column_stack([recording.time, recording.values]).tolist())
    return write_whole(path, "\n".join([*header, *rows]) + "\n")


def _in_true_unit(
    columns: list[Column], degrees: bool | None, time: Values, values: Values, file: str
) -> tuple[list[Column], list[Finding]]:
    """Columns of angles (and of their rates) in the unit that the file really has."""
    turning = [i for i, c in enumerate(columns) if c.unit.startswith("deg") and "[" not in c.label]
    angles = [i for i in turning if columns[i].channel.quantity == "angle"]
    if not turning:
        return columns, []
    stated = None if degrees is None else "deg" if degrees else "rad"
    findings = []
    unit = stated or "rad"  # speeds alone: OpenSim keeps states in radians
    if angles:
        names = [columns[i].channel.name for i in angles]
        unit, finding = plausible_unit(time, values[:, angles], names, stated, file)
        findings += [finding] if finding else []
    columns = [replace(c, unit=c.unit.replace("deg", unit)) if i in turning else c for i, c in enumerate(columns)]
    in_degrees = {columns[i].channel.name: columns[i].convert(values[:, i]) for i in angles}
    copies = []
    for i in angles:
        copied = find_copied_unit(columns[i].channel.name, values[:, i], in_degrees)
        if copied and copied != unit:
            columns[i] = replace(columns[i], unit=copied)
            copies.append(columns[i].channel.name)
    if copies:
        what = f"the values of {', '.join(copies)} were converted from {'deg' if unit == 'rad' else 'rad'} to {unit}"
        findings.append(Finding("note", "mixed units", file, f"{what}, the unit of the other angles", ""))
    return columns, findings


@dataclass(frozen=True)
class StorageHeader:
    """What stands above the numbers."""

    title: str  # first line: `Coordinates`, `Inverse Dynamics Generalized Forces`, or any name
    labels: tuple[str, ...]
    body_line: int  # line in which the numbers start, counted from 1
    degrees: bool | None = None  # what `inDegrees` states; None where it is absent
    rows: tuple[int, ...] = ()  # counts that the header claims; two where both styles stand in it
    columns: tuple[int, ...] = ()  # counts that the header claims, alike
    # dict of int to (str, str, str), column -> quantity, unit and side, in files that `write_storage` wrote
    own: Mapping[int, tuple[str, str, str]] = field(default_factory=dict)
    separator: str = "\t"  # what stands between cells: a tab, or a blank for any run of blanks


def parse_header(lines: Sequence[str], file: str) -> StorageHeader:
    """Header of a storage file."""
    end = next((i for i, line in enumerate(lines) if line.strip().lower() == "endheader"), None)
    if end is None:
        raise ReadError(
            f"{file} must be an OpenSim storage file, whose header ends with the line 'endheader'",
            f"none of its {len(lines)} lines is 'endheader'"
            + hint_nearest("endheader", [line.strip() for line in lines[:60] if len(line) < 30]),
            "Export it again from OpenSim, or rename it to .csv if it is a plain table.",
        )
    keys = list(_keys(lines[:end], file))
    at = next((i for i in range(end + 1, len(lines)) if lines[i].strip()), None)
    labels_line = lines[at].strip() if at is not None else ""
    separator = "\t" if "\t" in labels_line else " "
    labels = [label.strip() for label in (labels_line.split("\t") if separator == "\t" else labels_line.split())]
    if at is None or not labels or labels[0].lower() != "time":
        raise ReadError(
            f"{file} must have a line of labels after 'endheader', and the first label must be 'time'",
            f"line {(at or end) + 1} begins with {(labels[0][:40] if labels else '')!r}",
            "Export it again, or write the labels there.",
        )
    names = [split_unit(label)[0] for label in labels]
    if len(labels) < 2 or not all(names):
        blank = f"label {names.index('') + 1} is blank" if "" in names else "time is the only column"
        needed = f"{file}: there must be a column after time, and every column must have a label"
        raise ReadError(needed, f"line {at + 1}: {blank}", "Export it with every label.")
    matches = (_OWN_COLUMN.fullmatch(line.strip()) for line in lines[:end])
    return StorageHeader(
        title=next((line.strip() for line in lines[:end] if line.strip()), ""),
        labels=tuple(labels),
        body_line=at + 2,
        degrees=next((bool(value) for key, value in keys if key == "indegrees"), None),
        rows=tuple(int(value) for key, value in keys if key in _ROWS),
        columns=tuple(int(value) for key, value in keys if key in _COLUMNS),
        own={int(m[1]): (m[2], m[3], m[4].lower()) for m in matches if m},
        separator=separator,
    )


def _keys(lines: Sequence[str], file: str):
    for number, line in enumerate(lines, 1):
        key, sign, value = line.partition("=")
        if not sign:
            key, _, value = line.strip().partition(" ")  # SIMM: `datarows 4610`
        key, value = key.strip().lower(), value.strip()
        if key in (*_ROWS, *_COLUMNS) and (sign or value):
            if not re.fullmatch(r"\d{1,12}", value):
                raise ReadError(
                    f"{file}: line {number} must have a whole number after {key!r}",
                    f"found {value[:40]!r}",
                    "Write the count, or remove the line.",
                )
            yield key, int(value)
        elif key == "indegrees" and sign and value:
            if value.lower() not in _YES_NO:
                raise ReadError(
                    f"{file}: line {number} must be inDegrees=yes or inDegrees=no",
                    f"found {value[:40]!r}",
                    "Write yes if the angles are in degrees, no if they are in radians.",
                )
            yield key, _YES_NO[value.lower()]


def storage_columns(header: StorageHeader, file: str, channels: Mapping[str, str] | None = None) -> list[Column]:
    """Columns of a storage file, without time.

    The study's map comes first, then what the file itself states, then the vocabulary, then the habits of OpenSim:
    `*_moment` in N m, `*_force` in N, `/speed` per second, EMG without a unit. Angles are marked `deg` here; whether
    the file holds radians follows from the numbers.
    """
    words = fold_label(header.title) + " " + fold_label(file)
    known = [vocabulary().named(split_unit(label)[0]) for label in header.labels[1:]]
    muscles = sum(channel is not None and channel.quantity == "emg" for channel in known)
    of_emg = "emg" in words or "electromyo" in words or muscles > len(known) / 2
    columns = []
    for number, label in enumerate(header.labels[1:], 1):
        name, unit, is_mapped = read_label(label, channels)
        if is_mapped:
            column = _map_column(label, name, unit, header.title, file)
        elif number in header.own:
            quantity, own_unit, side = header.own[number]
            # the label is the name to the letter here, brackets and all: the header states the unit
            channel = Channel(label, quantity, own_unit, side) if quantity in QUANTITIES else name_channel(label)
            column = column_in_unit(label, channel, own_unit, file)
        else:
            column = _vocabulary_column(label, name, header.title, of_emg)
            column = column_in_unit(label, column.channel, unit, file) if unit else column
        columns.append(column)
    return columns


def naming_findings(columns: Sequence[Column], file: str) -> list[Finding]:
    """Say what was guessed about the columns of a file."""
    by_guess: dict[str, list[str]] = {}
    for column in columns:
        if column.guessed:
            by_guess.setdefault(column.guessed, []).append(column.label)
    findings = []
    for guess, labels in by_guess.items():
        what = f"{list_names(labels)}: {guess}"
        findings.append(Finding("note", "guessed", file, what, "the channels if this is wrong; map them in [channels]"))
    sides = {column.channel.side for column in columns if column.label.lower().startswith("ground_force_v")}
    if sides == {"r"} and any(column.label.startswith("1_ground_force_v") for column in columns):
        what = "ground_force_ is read as the right foot and 1_ground_force_ as the left foot, as in OpenSim's examples"
        findings.append(Finding("note", "guessed", file, what, "the sides if this is wrong; map them in [channels]"))
    forces = [column for column in columns if "ground_force" in column.label.lower() and column.channel.name != IGNORE]
    if sideless := [force.label for force in forces if not force.channel.side]:
        what = f"{list_names(sideless)}: no foot is named, so these forces are not used"
        such_as = f'"{sideless[0]}" = "ground_force_r_{sideless[0][-2:]} [N]"'
        remedy = f"contacts and forces; name the foot in [channels], such as {such_as}"
        findings.append(Finding("warning", "plate without a foot", file, what, remedy))
    return findings


def _map_column(label: str, name: str, unit: str | None, title: str, file: str) -> Column:
    """Column as the study's `[channels]` has it."""
    channel = name_channel(name)
    if name == IGNORE:
        return Column(label, channel, "1")
    if channel.quantity == "emg" and unit is None:
        return Column(label, replace(channel, unit="1"), "1")
    if channel.quantity != "signal" or unit:
        return column_in_unit(label, channel, unit or channel.unit, file)
    return replace(_guess(label, name, title), guessed="[channels] gives the name but no unit, so the unit is guessed")


def _vocabulary_column(label: str, plain: str, title: str, of_emg: bool) -> Column:
    last = path_label(plain)
    stem, _, kind = last.partition("/")
    rate = next((unit for unit, word in RATE_WORDS.items() if word == kind), _RATES.get(title.lower(), ""))
    channel = vocabulary().named(stem if kind else plain)
    if channel and rate and channel.quantity in ("angle", "translation"):
        name = f"{channel.name}/{RATE_WORDS[rate]}"
        return Column(label, Channel(name, "signal", channel.unit + rate, channel.side), channel.unit + rate)
    if channel and channel.quantity == "emg":
        unit = _OF_ACTUATORS.get(title.lower())
        if unit:
            return Column(label, Channel(plain, "signal", unit, channel.side), unit, f"{title} of a muscle, not EMG")
        return Column(label, replace(channel, unit="1"), "1")
    if channel:
        return Column(label, channel, channel.unit)
    if of_emg:  # whose side or muscle the vocabulary cannot determine
        name = plain if plain.startswith("emg_") else f"emg_{plain}"
        muscle, guess = Channel(name, "emg", "1", find_side(plain)), "read as EMG of an unknown muscle"
        of_right = vocabulary().named(f"{plain}_r")
        if of_right and of_right.quantity == "emg":
            muscle, guess = Channel(of_right.name.removesuffix("_r"), "emg", "1"), "the label does not name the side"
        return Column(label, muscle, "1", guess)
    return _guess(label, plain if plain.startswith("/forceset") else last, title)


def _guess(label: str, name: str, title: str) -> Column:
    side = find_side(name)
    if name.endswith(("_moment", "_force")):
        guess = "read in N m, as the generalised force of a coupled rotation, although OpenSim calls it a force"
        channel = name_channel(name)
        return Column(label, channel, channel.unit, guess if name.endswith("_beta_force") else "")
    ground = _GROUND.fullmatch(name)
    if ground and (ground[1] or _GROUND_WORD.search(name)):
        # by its last letters: v a force, p a place, m a moment; by the word where none stands there
        kind, axis = ground[1].lower(), ground[2].lower()
        guess = "read as a ground reaction because of its name" + ("" if side else ", of unknown side")
        quantity, unit = "moment", "N m"
        if kind == "p":
            quantity, unit = "pressure_centre", "m"
        elif kind == "v" or (not kind and _GROUND_WORD.findall(name.lower())[-1] == "force"):
            quantity, unit = "vertical_force" if axis == "y" else "force", "N"
        elif "ground" not in name.lower():
            name = f"ground_{name}"
        return Column(label, Channel(name, quantity, unit, side), unit, guess)
    if title.lower() == "coordinates":
        if re.search(r"_t[xyz]$", name):
            return Column(label, Channel(name, "translation", "m", side), "m", "read as a translation in m")
        return Column(label, Channel(name, "angle", "deg", side), "deg", "unknown coordinate, read as an angle")
    return Column(label, Channel(name, "signal", "1", side), "1", "unknown name, read as a signal without a unit")
