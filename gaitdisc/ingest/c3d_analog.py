"""Analog channels of a C3D file: EMG recognised and named, everything else kept as signals."""

import re
from dataclasses import dataclass, replace
from functools import cached_property

from gaitdisc.channel import Channel, vocabulary
from gaitdisc.errors import UnitError
from gaitdisc.ingest.c3d_labels import LabelMap, list_people_names, make_unique, without_people
from gaitdisc.ingest.c3d_parameters import C3DParameters
from gaitdisc.ingest.c3d_points import Streams
from gaitdisc.ingest.columns import find_stream, name_channel, split_unit
from gaitdisc.recording import Finding
from gaitdisc.recording.arrays import Values
from gaitdisc.units import convert, inner_unit, parse_unit
from gaitdisc.words import counted

# What devices put before the name that the laboratory typed: `Voltage.L Rect`, `EMG: R TA`.
_NO_NAME = ("voltage", "analog", "raw", "signal", "emg")
_DEVICE = re.compile(r"^(?:(?:voltage|analog|raw|emg|signal|electric potential)[\s.:_-]+)+(?=\S)", re.IGNORECASE)


@dataclass(frozen=True)
class AnalogLabel:
    """What the file calls one analog channel."""

    number: int  # place among the analog channels, from 1
    label: str
    description: str
    unit: str

    @property
    def plain(self) -> str:
        """Label without the words of the device."""
        return _DEVICE.sub("", self.label)

    @cached_property
    def muscle(self) -> Channel | None:
        """EMG channel of the vocabulary that label or description mean, or None."""
        for text in (self.label, self.plain, self.description, _DEVICE.sub("", self.description)):
            known = vocabulary().named(text)
            if known is not None and known.quantity == "emg":
                return known
        return None

    @property
    def is_emg(self) -> bool:
        """Whether the channel is EMG: by its muscle or the word, where its unit is a voltage or none that is known."""
        unit = parse_unit(self.unit)
        if unit is not None and inner_unit(unit) != "V":
            return False
        return self.muscle is not None or "emg" in f"{self.label} {self.description}".lower()


def analog_labels(parameters: C3DParameters, count: int) -> list[AnalogLabel]:
    """What the file calls its analog channels; it may list more labels than there are channels, or fewer."""
    people = list_people_names(parameters)
    texts = [[*parameters.texts("ANALOG", name)[:count], *[""] * count] for name in ("LABELS", "DESCRIPTIONS", "UNITS")]
    return [
        AnalogLabel(place + 1, without_people(label, people), without_people(description, people), unit.strip())
        for place, (label, description, unit) in enumerate(zip(*(text[:count] for text in texts), strict=True))
    ]


def emg_names(channels: list[AnalogLabel]) -> list[str]:
    """Names of EMG channels, all different.

    A muscle of the vocabulary gives its name. Otherwise the label does if no other channel has it; labels that are
    alike or cut give way to the numbers in the description (`Voltage [5,1]`: `emg_5_1`), and those to the place among
    the analog channels.
    """
    labels = [re.sub(r"[^a-z0-9]+", "_", channel.plain.lower()).strip("_") for channel in channels]
    labels = ["" if label in _NO_NAME else re.sub(r"^emg_?", "", label) for label in labels]
    bracketed = [re.search(r"\[([\d\s,]+)\]", channel.description) for channel in channels]
    brackets = ["_".join(re.findall(r"\d+", match[1])) if match else "" for match in bracketed]
    names = []
    for channel, label, bracket in zip(channels, labels, brackets, strict=True):
        if channel.muscle is not None:
            names.append(channel.muscle.name)
        elif label and labels.count(label) == 1:
            names.append(f"emg_{label}")
        elif bracket and brackets.count(bracket) == 1:
            names.append(f"emg_{bracket}")
        else:
            names.append(f"emg_{channel.number}")
    return make_unique(names, "emg")


def analog_streams(
    rows: Values, parameters: C3DParameters, plate_channels: set[int], labels: LabelMap
) -> tuple[Streams, list[Finding]]:
    """Streams `emg`, `signals`, mapped `forces` of rows (sample, channel) in the file's units, without plates."""
    analog = analog_labels(parameters, rows.shape[1])
    mapped = {c.number: labels.name(f"#{c.number}", c.label, c.plain, c.description) for c in analog}
    free = [signal for signal in analog if mapped[signal.number] is None and signal.number - 1 not in plate_channels]
    emg = [signal for signal in free if signal.is_emg]
    others = [signal for signal in free if not signal.is_emg]
    chosen: list[tuple[str, AnalogLabel, Channel, str]] = []
    for signal in analog:
        name = mapped[signal.number]
        if name is not None:
            channel, unit = _map_channel(name, signal, parameters.file)
            stream = find_stream(channel)
            chosen.append((stream if stream in ("emg", "forces") else "signals", signal, channel, unit))
    for signal, name in zip(emg, emg_names(emg), strict=True):
        unit = parse_unit(signal.unit) or "1"
        side = signal.muscle.side if signal.muscle is not None else ""
        chosen.append(("emg", signal, Channel(name, "emg", inner_unit(unit), side), unit))
    for signal, name in zip(others, make_unique([signal.label for signal in others], "analog"), strict=True):
        unit = parse_unit(signal.unit) or "1"
        chosen.append(("signals", signal, Channel(name, "signal", inner_unit(unit)), unit))
    streams: Streams = {}
    for stream in ("emg", "signals", "forces"):
        group = [entry for entry in chosen if entry[0] == stream]
        if group:
            columns = [signal.number - 1 for _, signal, _, _ in group]
            span = range(columns[0], columns[-1] + 1)  # a slice copies nothing
            values = rows[:, slice(span.start, span.stop) if columns == list(span) else columns]
            for column, (_, _, channel, unit) in enumerate(group):
                if unit != channel.unit:
                    values[:, column] = convert(values[:, column], unit, channel.unit)
            streams[stream] = (values, tuple(channel for _, _, channel, _ in group))
    return streams, _doubts(emg, others, parameters.file)


def _map_channel(text: str, signal: AnalogLabel, file: str) -> tuple[Channel, str]:
    name, stated = split_unit(text)
    known = vocabulary().named(name)
    channel = known if known is not None else name_channel(name)
    unit = parse_unit(stated if stated is not None else signal.unit)
    if unit is None and channel.quantity == "signal":
        return channel, channel.unit
    if unit is None:
        raise UnitError(
            f"analog channel #{signal.number} is mapped to {name!r} and must have a unit",
            f"{file} states {(stated if stated is not None else signal.unit)!r}",
            f"Write the unit in the study's [channels]: '{name} [{channel.unit}]'.",
        )
    if channel.quantity == "signal" or (channel.quantity == "emg" and unit == "1"):
        channel = replace(channel, unit=inner_unit(unit))
    if inner_unit(unit) != channel.unit:
        raise UnitError(
            f"analog channel #{signal.number}, mapped to {channel.name!r}, must be convertible to {channel.unit}",
            f"{file} states {unit}",
            "Map another channel, or write the true unit in the study's [channels]: 'name [unit]'.",
        )
    return channel, unit


def _doubts(emg: list[AnalogLabel], others: list[AnalogLabel], file: str) -> list[Finding]:
    findings = []
    unknown = [signal for signal in (*emg, *others) if parse_unit(signal.unit) is None]
    if unknown:
        what = f"{counted(len(unknown), 'analog channel')} without a known unit ({_list_labels(unknown)}), unchanged"
        findings.append(Finding("note", "unit", file, what, "the amplitudes of these channels; correct ANALOG:UNITS"))
    muscles = [signal.muscle.name for signal in emg if signal.muscle is not None]
    doubled = sorted({name for name in muscles if muscles.count(name) > 1})
    if doubled:
        what = f"several EMG channels have the same name ({', '.join(doubled)}); they are numbered"
        findings.append(Finding("warning", "equal muscles", file, what, "these muscles; name them in [channels]"))
    nameless = [signal for signal in emg if signal.muscle is None]
    if nameless:
        what = f"{counted(len(nameless), 'EMG channel')} without the name of a known muscle ({_list_labels(nameless)})"
        findings.append(Finding("note", "nameless EMG", file, what, "nothing; name them in [channels] as '#<n>'"))
    voltages = [signal for signal in others if (parse_unit(signal.unit) or "") in ("V", "mV", "uV")]
    if voltages:
        what = f"{counted(len(voltages), 'voltage')} not recognised as EMG, read as signals ({_list_labels(voltages)})"
        findings.append(Finding("note", "voltages", file, what, "nothing unless they are EMG; map them in [channels]"))
    return findings


def _list_labels(channels: list[AnalogLabel]) -> str:
    shown = ", ".join(f"#{signal.number} {signal.label}".strip() for signal in channels[:4])
    return shown + (", ..." if len(channels) > 4 else "")
