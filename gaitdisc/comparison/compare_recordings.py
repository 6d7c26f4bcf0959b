"""Two recordings, or the two conditions of a study, from their files to their mismatch."""

import re
from dataclasses import replace
from pathlib import Path

from gaitdisc.comparison.compare import CLINICAL, compare_people, compare_walks
from gaitdisc.comparison.mismatch import Mismatch, Smallest
from gaitdisc.errors import SchemaError
from gaitdisc.ingest.public_words import PublicWords, package_words
from gaitdisc.ingest.reading import read_trial
from gaitdisc.ingest.study import Study
from gaitdisc.ingest.trial_sets import why_refused
from gaitdisc.processing.pooled_cycles import WalkSummary, pooled_walk
from gaitdisc.processing.processed_walks import pool_public, process_walks
from gaitdisc.processing.walk_pair import COMPARED, walk_pair
from gaitdisc.recording import Finding
from gaitdisc.signals.butterworth import KINEMATICS_HZ


def compare_files(
    first: Path,
    second: Path,
    channels: tuple[str, ...] = (),
    cutoff_hz: float = KINEMATICS_HZ,
    detector: str = "auto",
    smallest: Smallest = CLINICAL,
) -> Mismatch:
    """Mismatch of two recordings, second minus first; `cutoff_hz` [Hz]: -3 dB of one pass, angles and moments."""
    words = [
        [word for word in re.split(r"[\W_]+", path.stem) if word.isalpha() and word.lower() in package_words()]
        for path in (first, second)
    ]
    for end in (0, -1):  # without the words that both begin or end with
        while min(map(len, words)) > 1 and words[0][end] == words[1][end]:
            for path_words in words:
                del path_words[end]
    stems = ["_".join(path_words) for path_words in words]
    names = stems if all(stems) and stems[0] != stems[1] else ["first walk", "second walk"]
    public = PublicWords(frozenset(channels), dict(zip((first.name, second.name), names, strict=True)))
    trials = []
    for path, name in zip((first, second), names, strict=True):
        trial = replace(public, files={path.name: name}).trial(replace(read_trial(path), name=name))
        trials.append(public.keep_known_channels(trial, COMPARED))
    walks = walk_pair(trials[0], trials[1], cutoff_hz, detector)
    if walks[0].files and set(walks[0].files.values()) == set(walks[1].files.values()):
        raise SchemaError(
            "a comparison needs two different recordings",
            f"{first.name} and {second.name} are identical files",
            "Name a simulated and a measured walk, or two conditions.",
        )
    mismatch = compare_walks(walks[0], walks[1], channels, smallest=smallest)
    mismatch = replace(mismatch, findings=tuple(map(public.finding, mismatch.findings)))
    return _with_settings(mismatch, {"cutoff_hz": cutoff_hz, "detector": walks[0].detector})


def compare_study(
    study: Study, participant: str = "", channels: tuple[str, ...] = (), smallest: Smallest = CLINICAL
) -> Mismatch:
    """Mismatch of the nominal and the device walk: of one participant's strides, or over participants.

    study: with both conditions; its filters and its detector are used
    returns: device minus nominal. Participants who lack a walk, or of whom one was refused, are named in the findings
    """
    settings = study.public_settings({"filters", "strides", "conditions"})
    if participant:
        walks = _pick_walks(study, participant)
        if isinstance(walks, str):
            raise SchemaError(
                f"both walks of {participant} must be usable for a comparison",
                walks.rstrip("."),
                "Correct the walk, or choose another participant.",
            )
        return _with_settings(compare_walks(walks[0], walks[1], channels, smallest=smallest), settings)
    pairs, left_out = [], []
    for person in study.participants:
        walks = _pick_walks(study, person.id)
        if isinstance(walks, str):
            left_out.append(Finding("refused", "left out", person.id, walks, "this participant, who is not compared"))
        else:
            pairs.append(walks)
    nominal, device = ([pair[k] for pair in pairs] for k in (0, 1))
    mismatch = compare_people(nominal, device, channels, smallest=smallest)
    return _with_settings(replace(mismatch, findings=(*left_out, *mismatch.findings)), settings)


def _pick_walks(study: Study, participant: str) -> tuple[WalkSummary, WalkSummary] | str:
    """Nominal and device walk, or why there are none."""
    person = study.participant(participant)
    nominal, device = study.conditions.both
    if lacking := why_refused(study, person):
        return lacking
    walks, refusals = process_walks(study, person)
    if not refusals:
        return walks[nominal].summary(), walks[device].summary()
    pooled, _ = pool_public(study, person)  # walks of a few strides each
    sets = {(cycles.session, cycles.condition): cycles for cycles in pooled if len(cycles.kept)}
    session = next((word for word, _ in sets if (word, nominal) in sets and (word, device) in sets), None)
    if session is None:
        return "; ".join(f"{refusal.condition}: {refusal.reason}".removeprefix(": ") for refusal in refusals)
    before, after = (pooled_walk(sets[session, word], study.strides.side) for word in (nominal, device))
    return before, after


def _with_settings(mismatch: Mismatch, settings: dict[str, object]) -> Mismatch:
    made = mismatch.provenance
    return replace(mismatch, provenance=replace(made, settings={**made.settings, **settings}))
