"""What may stand in a result that is passed on: words of this package, of its vocabulary and of the study; no others.

Any name of a file, label or header may say who a person is. So every word of a sentence that is not known to be public
becomes `…`, and a file is called by its participant, condition and number. The study file is the key to the names.
"""

from __future__ import annotations

import csv
import errno
import os
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from gaitdisc.channel import schema_folder
from gaitdisc.errors import GaitdiscError
from gaitdisc.ingest.columns import split_unit
from gaitdisc.recording import Finding, Recording, Trial

if TYPE_CHECKING:
    from gaitdisc.ingest.study import Participant, PlannedTrial, Study

Result = TypeVar("Result")
HIDDEN = "…"
WHERE = f"({HIDDEN} stands for a label of the recording; `gaitdisc check` shows it.)"
_TEXT = re.compile(r"\"\"\".*?\"\"\"|(?<![\"'])#[^\n]*", re.DOTALL)  # docstrings and comments, which cite people
_LITERAL = re.compile(r"\"([^\"\n]*)\"|'([^'\n]*)'")
_WORD = re.compile(r"\w+")
_NUMBER = re.compile(r"\d+(e\d+)?[a-zA-Z]{0,2}")


@dataclass(frozen=True)
class PublicWords:
    """Words that may be written, and what files are called instead of their names."""

    words: frozenset[str] = frozenset()
    files: Mapping[str, str] = field(default_factory=dict)  # name of a file -> what it is called

    def said(self, text: str) -> str:
        """Sentence without a word of the recordings.

        >>> PublicWords().said("column 'Erika' has no unit")
        "column '…' has no unit (… stands for a label of the recording; `gaitdisc check` shows it.)"
        >>> PublicWords(files={"Erika.mot": "the recording"}).said("Erika.mot has no unit")
        'the recording has no unit'
        """
        public = self._called(text)
        return f"{public} {WHERE}" if HIDDEN in public and HIDDEN not in text else public

    def finding(self, finding: Finding) -> Finding:
        """Finding without a word of the recordings."""
        return replace(
            finding,
            file=self._called(self.files.get(finding.file, finding.file)),
            channel=self._called(finding.channel),
            what=self.said(finding.what),
            spoils=self._called(finding.spoils),
        )

    def error(self, error: GaitdiscError) -> GaitdiscError:
        """Error of the same kind without a word of the recordings."""
        texts = [self._called(part) for part in (error.needed, error.found, error.remedy)]
        if any(HIDDEN in part for part in texts):
            texts[2] = f"{texts[2]} {WHERE}"
        return type(error)(*texts)

    def trial(self, trial: Trial) -> Trial:
        """Trial whose files are called by what they may be called, and whose findings hold public words."""
        streams = {key: self._recording(recording) for key, recording in trial.streams.items()}
        return replace(trial, streams=streams, findings=tuple(map(self.finding, trial.findings)))

    def of(self, work: Callable[[], Result]) -> Result:
        """Result of some work, whose error is said in public words."""
        try:
            return work()
        except GaitdiscError as error:
            raise self.error(error) from error

    def keep_known_channels(self, trial: Trial, streams: Iterable[str]) -> Trial:
        """Trial without the channels whose labels are no public words, and a finding that says how many there are."""
        streams_left, left_out = dict(trial.streams), 0
        for key in set(streams) & set(streams_left):
            names = [name for name in streams_left[key].names if self._called(name) == name]
            left_out += len(streams_left[key].names) - len(names)
            streams_left[key] = streams_left[key].selected(names)
        if not left_out:
            return trial
        what = f"channels left out because their labels are not in the vocabulary: {left_out}"
        spoils = "these channels; map them in the study's [channels], or rename them"
        streams_left = {key: recording for key, recording in streams_left.items() if recording.names}
        finding = Finding("note", "left out", trial.name, what, spoils)
        return replace(trial, streams=streams_left, findings=(*trial.findings, finding))

    def _recording(self, recording: Recording) -> Recording:
        source = recording.source
        files = " + ".join(self.files.get(name, HIDDEN) if name else "" for name in source.file.split(" + "))
        return replace(recording, source=replace(source, file=files))

    def _called(self, text: str) -> str:
        """Files by what they are called, and each word that is not public hidden."""
        names = (re.escape(name) for name in sorted(self.files, key=len, reverse=True) if name)
        pattern = "|".join((*(rf"(?<!\w){name}(?!\w)" for name in names), _WORD.pattern))
        hidden = re.sub(pattern, lambda match: self.files.get(match[0]) or self._or_hidden(match[0]), text)
        return re.sub(rf"{HIDDEN}(?:[\s._/\\:-]*{HIDDEN})+", HIDDEN, hidden)

    def _or_hidden(self, word: str) -> str:
        return word if self._public(word) or all(map(self._public, word.split("_"))) else HIDDEN

    def _public(self, word: str) -> bool:
        return word in self.words or word in package_words() or bool(_NUMBER.fullmatch(word)) or not word


def list_words(study: Study, participant: Participant, named: Iterable[str] = ()) -> PublicWords:
    """Public words of one participant's recordings, of the study and of channels that the user named."""
    texts = [study.title, *study.sessions, *study.conditions.words, participant.group, participant.excluded, *named]
    texts += [person.id for person in study.participants]
    texts += [trial.leave_out for trial in participant.trials]
    texts += [trial.condition for person in study.participants for trial in person.trials]
    texts += [*study.models.angles, *study.models.emg, *study.models.outputs]
    texts += [split_unit(name)[0] for name in study.channels.values()]
    words = frozenset(word for text in texts for word in _WORD.findall(text))
    files = {name: public for trial in participant.trials for name, public in _files(participant, trial).items()}
    return PublicWords(words, files)


def of_trial(words: PublicWords, participant: Participant, planned: PlannedTrial) -> PublicWords:
    """Public words of one trial: its own files go before others of the same name in another folder."""
    return replace(words, files={**words.files, **_files(participant, planned)})


def with_public_labels(recording: Recording) -> tuple[Recording, int]:
    """Recording whose channels of other names are numbered, a marker's three alike, and how many these are."""
    public, called = PublicWords(), dict[str, str]()
    names = []
    for channel in recording.channels:
        name, dot, axis = channel.name.rpartition(".") if channel.quantity == "marker" else (channel.name, "", "")
        if public.said(name) != name:
            name = called.setdefault(name, f"{channel.quantity}_{len(called) + 1}")
        names.append(f"{name}{dot}{axis}")
    renamed = tuple(replace(channel, name=name) for channel, name in zip(recording.channels, names, strict=True))
    return replace(recording, channels=renamed), len(called)


@cache
def package_words() -> frozenset[str]:
    """Words of this package's sentences, of its vocabulary, and of the system's own errors."""
    literals: list[str] = [os.strerror(number) for number in errno.errorcode]
    for path in Path(__file__).parents[1].rglob("*.py"):
        code = _TEXT.sub("", path.read_text(encoding="utf-8"))
        literals += (double or single for double, single in _LITERAL.findall(code))
    with (schema_folder() / "channels.csv").open(newline="", encoding="utf-8") as file:
        literals += (row[column] for row in csv.DictReader(file) for column in ("name", "quantity", "unit", "aliases"))
    for path in (schema_folder() / "marker_sets").glob("*.toml"):
        # labels, landmarks and title, without the people it cites
        lines = _TEXT.sub("", path.read_text(encoding="utf-8")).splitlines()
        cited = {word for line in lines if line.startswith("citation") for word in _WORD.findall(line)}
        texts = {double or single for line in lines for double, single in _LITERAL.findall(line)}
        both = {text.replace("{S}", side).replace("{s}", side.lower()) for text in texts for side in "LR"}
        literals += [path.stem.replace("_", " "), *({word for text in both for word in _WORD.findall(text)} - cited)]
    return frozenset(word for text in literals for word in _WORD.findall(text))


def _files(participant: Participant, planned: PlannedTrial) -> dict[str, str]:
    """What the files of a trial are called; a name without its ending counts where it can be no word of a sentence."""
    called: dict[str, str] = {}
    for number, file in enumerate(planned.files, 1):
        public, path = f"{participant.trial_name(planned)}, file {number}", Path(file)
        called |= {path.stem: public} if len(path.stem) > 3 and re.search(r"\d", path.stem) else {}
        called |= {path.name: public}
    return called
