"""What the columns of an OpenSim storage file measure: coordinates, ground forces, joint moments, EMG."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

from gaitdisc.channel import QUANTITIES, Channel, folded_label, path_label, side_of, vocabulary
from gaitdisc.ingest.columns import Column, column_in_unit, mapped_label, named_channel, split_unit
from gaitdisc.ingest.storage_header import StorageHeader
from gaitdisc.recording import Finding

_GROUND = re.compile(r"(?:.*_)?(?:ground|grf|fp_?\d)\w*?_([vpm]?)([xyz])", re.IGNORECASE)
_GROUND_WORD = re.compile(r"force|torque|moment", re.IGNORECASE)
_RATES = {
    "speeds": "/s",
    "velocities": "/s",
    "accelerations": "/s2",
    "kinematics_u": "/s",  # what OpenSim's analyses write
    "kinematics_dudt": "/s2",
}
# What OpenSim's analyses write of muscles under the names of the muscles, which elsewhere are those of EMG
_OF_ACTUATORS = {"actuation_force": "N", "actuation_power": "W", "forcereporter": "N"}
_RATE_WORD = {"/s": "speed", "/s2": "accel"}


def storage_columns(header: StorageHeader, file: str, channels: Mapping[str, str] | None = None) -> list[Column]:
    """Columns of a storage file, without time.

    The study's map comes first, then what the file itself states, then the vocabulary, then the habits of OpenSim:
    `*_moment` in N m, `*_force` in N, `/speed` per second, EMG without a unit. Angles are marked `deg` here; whether
    the file holds radians follows from the numbers.

    channels: the study's `[channels]`

    >>> header = StorageHeader("Coordinates", ("time", "/jointset/hip_r/hip_flexion_r/value"), 3)
    >>> storage_columns(header, "a.sto")[0].channel.name
    'hip_flexion_r'
    """
    of_emg = _holds_emg(header, file)
    return [
        _column(header, number, label, (file, of_emg), channels) for number, label in enumerate(header.labels) if number
    ]


def naming_findings(columns: Sequence[Column], file: str) -> list[Finding]:
    """Say what was guessed about the columns of a file.

    >>> naming_findings([Column("x", Channel("x", "signal", "1"), "1", "kept as a signal")], "a.sto")[0].what
    'x: kept as a signal'
    """
    by_guess: dict[str, list[str]] = {}
    for column in columns:
        if column.guessed:
            by_guess.setdefault(column.guessed, []).append(column.label)
    findings = []
    for guess, labels in by_guess.items():
        more = f" and {len(labels) - 6} more" if len(labels) > 6 else ""
        what = f"{', '.join(labels[:6])}{more}: {guess}"
        findings.append(Finding("note", "guessed", file, what, "these channels if wrong; map them in [channels]"))
    sides = {column.channel.side for column in columns if column.label.lower().startswith("ground_force_v")}
    if sides == {"r"} and any(column.label.startswith("1_ground_force_v") for column in columns):
        what = "ground_force_ is taken as the right foot, 1_ground_force_ as the left, as in OpenSim's own examples"
        findings.append(Finding("note", "guessed", file, what, "the sides if wrong; map them in [channels]"))
    return findings


def _column(
    header: StorageHeader, number: int, label: str, where: tuple[str, bool], channels: Mapping[str, str] | None
) -> Column:
    file, of_emg = where
    plain, unit = split_unit(label)
    said = mapped_label(label, channels) or mapped_label(plain, channels)
    if said:
        name, said_unit = split_unit(said)
        channel, unit = named_channel(name), said_unit or unit
        if channel.quantity == "emg" and unit is None:
            return Column(label, replace(channel, unit="1"), "1")
        if channel.quantity != "signal" or unit:
            return column_in_unit(label, channel, unit or channel.unit, file)
        return replace(_guessed(label, name, header.title), guessed="its name is in [channels], its unit is not")
    if number in header.own:
        quantity, own_unit, side = header.own[number]
        # the label is the name to the letter here, brackets and all: the header states the unit
        channel = Channel(label, quantity, own_unit, side) if quantity in QUANTITIES else named_channel(label)
        return column_in_unit(label, channel, own_unit, file)
    column = _known(label, plain, header.title, of_emg)
    return column_in_unit(label, column.channel, unit, file) if unit else column


def _known(label: str, plain: str, title: str, of_emg: bool) -> Column:
    last = path_label(plain)
    stem, _, kind = last.partition("/")
    rate = {"speed": "/s", "accel": "/s2"}.get(kind) or _RATES.get(title.lower(), "")
    channel = vocabulary().named(stem if kind else plain)
    if channel and rate and channel.quantity in ("angle", "translation"):
        name = f"{channel.name}/{_RATE_WORD[rate]}"
        return Column(label, Channel(name, "signal", channel.unit + rate, channel.side), channel.unit + rate)
    if channel and channel.quantity == "emg":
        unit = _OF_ACTUATORS.get(title.lower())
        if unit:
            return Column(label, Channel(plain, "signal", unit, channel.side), unit, f"{title} of a muscle, no EMG")
        return Column(label, replace(channel, unit="1"), "1")
    if channel:
        return Column(label, channel, channel.unit)
    if of_emg:
        return _muscle(label, plain)
    return _guessed(label, plain if plain.startswith("/forceset") else last, title)


def _muscle(label: str, plain: str) -> Column:
    """EMG whose side or muscle the vocabulary cannot determine."""
    of_right = vocabulary().named(f"{plain}_r")
    if of_right and of_right.quantity == "emg":
        channel = Channel(of_right.name.removesuffix("_r"), "emg", "1")
        return Column(label, channel, "1", "the label names no side")
    name = plain if plain.startswith("emg_") else f"emg_{plain}"
    return Column(label, Channel(name, "emg", "1", side_of(plain)), "1", "kept as EMG of an unknown muscle")


def _guessed(label: str, name: str, title: str) -> Column:
    side = side_of(name)
    if name.endswith(("_moment", "_force")):
        guess = "the generalised force of a copied rotation, taken in N m though OpenSim calls it a force"
        channel = named_channel(name)
        return Column(label, channel, channel.unit, guess if name.endswith("_beta_force") else "")
    ground = _GROUND.fullmatch(name)
    if ground and (ground[1] or _GROUND_WORD.search(name)):
        return _ground(label, name, ground)
    if title.lower() == "coordinates":
        if re.search(r"_t[xyz]$", name):
            return Column(label, Channel(name, "translation", "m", side), "m", "taken as a translation in m")
        return Column(label, Channel(name, "angle", "deg", side), "deg", "unknown coordinate, taken as an angle")
    return Column(label, Channel(name, "signal", "1", side), "1", "unknown name, kept as a signal without a unit")


def _ground(label: str, name: str, found: re.Match[str]) -> Column:
    """Ground reaction by its last letters: v a force, p a place, m a moment; by the word where none stands there."""
    kind, axis = found[1].lower(), found[2].lower()
    words = _GROUND_WORD.findall(name.lower())
    side = side_of(name)
    guess = "taken as ground reaction by its name" + ("" if side else ", side unknown")
    if kind == "p":
        return Column(label, Channel(name, "pressure_centre", "m", side), "m", guess)
    if kind == "v" or (not kind and words[-1] == "force"):
        quantity = "vertical_force" if axis == "y" else "force"
        return Column(label, Channel(name, quantity, "N", side), "N", guess)
    channel = Channel(name if "ground" in name.lower() else f"ground_{name}", "moment", "N m", side)
    return Column(label, channel, "N m", guess)


def _holds_emg(header: StorageHeader, file: str) -> bool:
    words = folded_label(header.title) + " " + folded_label(file)
    if "emg" in words or "electromyo" in words:
        return True
    known = [vocabulary().named(split_unit(label)[0]) for label in header.labels[1:]]
    return sum(channel is not None and channel.quantity == "emg" for channel in known) > len(known) / 2
