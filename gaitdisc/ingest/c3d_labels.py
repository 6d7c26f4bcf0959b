"""Labels of a C3D file, of channels and of events: without people's names, each one unlike the others."""

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from gaitdisc.channel import fold_label, hint_nearest
from gaitdisc.errors import ChannelError
from gaitdisc.ingest.c3d_parameters import C3DParameters
from gaitdisc.recording import Finding
from gaitdisc.recording.trial import Event

INITIAL_CONTACT, FOOT_OFF = "initial contact", "foot off"
_CONTACT = {"foot strike", "heel strike", "initial contact", "foot contact", "foot down", "strike", "hs", "ic", "fs"}
_OFF = {"foot off", "toe off", "to", "fo", "off"}


def without_people(label: str, people: Iterable[str]) -> str:
    """Label without the names of people, as the prefix `Name:` or as a word in it."""
    plain = label
    for person in people:
        plain = re.sub(rf"(?<![A-Za-z0-9]){re.escape(person)}(?![A-Za-z0-9])", "", plain, flags=re.IGNORECASE)
    return re.sub(r"\s+", " ", plain).strip(" :" if plain != label else None)


def without_prefix(label: str) -> str:
    """Label of a point without the prefix that names whose it is, `Ann:LASI`."""
    return label.rpartition(":")[2].strip()


def list_people_names(parameters: C3DParameters) -> tuple[str, ...]:
    """Names that the file gives its subjects, so that they can be removed wherever they stand."""
    places = (("SUBJECTS", "NAMES"), ("SUBJECTS", "LABEL_PREFIXES"), ("SUBJECT", "NAME"), ("EVENT", "SUBJECTS"))
    names = [text.strip(" :") for place in places for text in parameters.texts(*place)]
    names += [label.rpartition(":")[0] for label in parameters.texts("POINT", "LABELS")]
    return tuple(sorted((name for name in dict.fromkeys(names) if len(name) > 1), key=len, reverse=True))


def make_unique(labels: Sequence[str], word: str) -> list[str]:
    """Labels of which no two are equal: those that are get their number, those that are empty a word and theirs.

    >>> make_unique(["a", "", "b", "a"], "point")
    ['a_1', 'point_2', 'b', 'a_4']
    """
    counts = Counter(labels)
    names = [
        f"{label or word}_{number}" if counts[label] > 1 or not label else label
        for number, label in enumerate(labels, 1)
    ]
    taken: set[str] = set()
    for place in range(len(names)):
        while names[place] in taken:  # `a_1` may stand in the file beside two `a`
            names[place] += "_"
        taken.add(names[place])
    return names


def find_equal_labels(labels: Iterable[str], file: str) -> list[Finding]:
    """Say which labels several points have, which `make_unique` numbers."""
    doubled = sorted(label for label, count in Counter(labels).items() if label and count > 1)
    what = f"labels shared by several points were numbered ({len(doubled)} in all): {', '.join(doubled[:3])}"
    finding = Finding("warning", "equal labels", file, what, "these points; give each point its own label")
    return [finding] if doubled else []


class LabelMap:
    """The study's map from labels of the file to names of channels.

    A key is a label or a description as the file writes it (case, blanks and punctuation do not count), `#5` for the
    fifth analog channel, `RKneeAngles.x` for one component of a model output, `LCAL` for a marker. A value is the name
    of a channel, or `name [unit]` where the file does not state the unit.

    >>> LabelMap({"#5": "emg_sol_r", "Sensor 1": "emg_ta_r"}).name("#1", "sensor 1")
    'emg_ta_r'
    """

    def __init__(self, channels: Mapping[str, str] | None = None) -> None:
        self._names = dict(channels or {})
        self._used: Counter[str] = Counter()

    def name(self, *labels: str) -> str | None:
        """Name that the study gives a channel of these labels, the most particular first; None where it gives none."""
        for label in labels:
            for key, name in self._names.items():
                same = (
                    key == label
                    if "#" in (key[:1], label[:1])
                    else bool(label) and fold_label(key) == fold_label(label)
                )
                if same:
                    self._used[key] += 1
                    if self._used[key] > 1:
                        raise ChannelError(
                            f"{key!r} of the study's [channels] must be the label of only one channel",
                            f"{self._used[key]} channels of the file have this label",
                            "Use '#<number>' instead: the analog channel's number, counted from 1.",
                        )
                    return name
        return None

    def unused(self, labels: Iterable[str], file: str) -> list[Finding]:
        """Findings for the keys that no channel of the file goes by."""
        labels = tuple(labels)
        findings = []
        for key in self._names:
            if not self._used[key]:
                hint = hint_nearest(key, labels)
                what = f"the study maps {key!r} to {self._names[key]!r}, but the file does not have this label{hint}"
                spoils = "results that need this channel"
                findings.append(Finding("warning", "label not found", file, what, spoils))
        return findings


def event_kind(label: str, context: str) -> tuple[str, str]:
    """What an event is (`Foot Strike`, `Right Foot Off`, or Qualisys' `LHS`, `RTO`) and on which side."""
    side = {"l": "l", "r": "r"}.get(context.strip().lower()[:1], "")
    word = re.sub(r"[\s_.-]+", " ", label.strip().lower())
    match = re.fullmatch(r"(left|right|l|r) ?(.+)", word)
    if match and match[2] in _CONTACT | _OFF:
        side, word = side or match[1][0], match[2]
    if word in _CONTACT:
        return INITIAL_CONTACT, side
    if word in _OFF:
        return FOOT_OFF, side
    return label.strip(), side


def file_events(
    parameters: C3DParameters, frames: int, rate_hz: float, first_frame: int
) -> tuple[tuple[Event, ...], list[Finding]]:
    """Events of a file on the recordings' clock, on which the first frame is at 0 s.

    EVENT:TIMES are minutes and seconds on the clock of the trial before it was cropped, on which frame 1 is at 0 s and
    the first frame kept is TRIAL:ACTUAL_START_FIELD. Some software writes them on the clock of the cropped file
    instead: where all events lie outside of the file on the first clock and inside on the second, that one is taken.

    first_frame: as the header has it
    returns events: in order of time; those outside of the file are left out with a finding
    """
    times = parameters.numbers("EVENT", "TIMES")
    labels = parameters.texts("EVENT", "LABELS")
    count = parameters.count("EVENT", "USED")
    count = min(times.shape[1] if times.ndim == 2 and len(times) == 2 else 0, len(labels), count or 0)
    if not count:
        return (), []
    seconds = 60 * times[0, :count] + times[1, :count]
    first_frame = parameters.field("ACTUAL_START_FIELD") or max(first_frame, 1)
    lost, end = (first_frame - 1) / rate_hz, (frames - 1) / rate_hz
    margin = 0.5 / rate_hz
    findings, file = [], parameters.file
    on_file = seconds - lost
    if not np.any(_within(on_file, end, margin)) and np.all(_within(seconds, end, margin)):
        on_file = seconds
        what = f"event times refer to the cropped file, which begins with frame {first_frame}"
        findings.append(Finding("warning", "event clock", file, what, "the events of the file if this is wrong"))
    inside = _within(on_file, end, margin)
    if not np.all(inside):
        what = f"events outside the {frames} frames of the file are ignored: {int(np.sum(~inside))} of {count}"
        findings.append(Finding("note", "events outside", file, what, ""))
    contexts = (*parameters.texts("EVENT", "CONTEXTS"), *[""] * count)
    people = list_people_names(parameters)
    events = [
        Event(*event_kind(without_people(labels[place], people), contexts[place]), float(on_file[place]))
        for place in range(count)
        if inside[place]
    ]
    return tuple(sorted(events, key=lambda event: event.time)), findings


def _within(times: np.ndarray, end: float, margin: float) -> np.ndarray:
    return (times >= -margin) & (times <= end + margin)
