"""Windows of sensors now and a while ago beside the states; which a model is fitted to, chosen by, tested on."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.channel import check_word
from gaitdisc.errors import SamplingError, SchemaError, ShapeError
from gaitdisc.recording import Recording, Samples
from gaitdisc.recording.arrays import Values

TRAINING, CHECK, TEST, APART = 0, 1, 2, -1
SHARES = (0.7, 0.1, 0.2)
BLOCKS = (TRAINING, TRAINING, TEST, TRAINING, TRAINING, CHECK, TRAINING, TEST, TRAINING, TRAINING)
PERSON_OUT = "leave one person out"
SEAM_S = 0.3  # zero-lag filters look ahead and back over a border
RANDOM = "random (leaks)"
RULES = {
    "temporal": "first 70 % of each trial training, next 10 % validation, last 20 % test; no window crosses a border",
    "blocked": "ten blocks of each trial: seven training, one validation, two test; no window crosses a border",
    RANDOM: "windows drawn at random, with neighbours of test windows in the training part: the error is too small",
}


@dataclass(frozen=True)
class Lags:
    """How far back a window reaches, and how densely."""

    count: int = 25  # readings of each sensor in a window, the present one included
    spacing: int = 4  # samples from one reading to the next; 6 Hz kinematics at 100 Hz lose nothing at 4
    # samples from the last reading to the state that is reconstructed: 0 is the present, more of them a forecast
    ahead: int = 0

    def __post_init__(self) -> None:
        """Refuse a window without a reading."""
        if self.count < 1 or self.spacing < 1 or self.ahead < 0:
            raise ShapeError(
                "a window must have at least one sample, samples at least one time step apart, and a state that is not "
                "in the past",
                f"count is {self.count}, spacing {self.spacing}, ahead {self.ahead}",
                "Correct the lags.",
            )

    @property
    def reach(self) -> int:
        """Samples from the first reading of a window to its last."""
        return (self.count - 1) * self.spacing


def cut_windows(
    recording: Recording, sensors: Sequence[str], states: Sequence[str], lags: Lags, phi: Values, missing: bool = False
) -> Samples:
    """Every window of one recording; none reaches beyond its start, nor over a missing value unless that is allowed.

    sensors, states: channels that are read, and channels that are to be reconstructed
    phi (time,) [% stride]: percent stride of every sample of the recording
    missing: whether windows are kept whose readings are missing in part (NaN); the states must be there
    returns: x (window, reading * sensor), oldest reading first, sensors side by side; y, time and phi those of the
        state that is reconstructed, at the last reading or `lags.ahead` samples later. Windows that lack a value are
        left out

    >>> from gaitdisc.channel import Channel
    >>> pair = (Channel("a", "signal", "V"), Channel("b", "signal", "V"))
    >>> r = Recording(np.arange(4) / 10, np.column_stack([np.arange(4), 10 * np.arange(4)]), pair)
    >>> made = cut_windows(r, ["a"], ["b"], Lags(2, 1), np.zeros(4))
    >>> made.x.tolist(), made.y.ravel().tolist(), made.inputs
    ([[0.0, 1.0], [1.0, 2.0], [2.0, 3.0]], [10.0, 20.0, 30.0], ('a 0.10 s ago', 'a'))
    """
    read, y = recording.selected(sensors).values, recording.selected(states).values
    if len(read) <= lags.reach + lags.ahead:
        forth = f" and {lags.ahead / recording.rate_hz:.2f} s ahead" if lags.ahead else ""
        raise SamplingError(
            f"a recording must be longer than a window: {lags.reach / recording.rate_hz:.2f} s back{forth}",
            f"{recording.source.file or 'the recording'} lasts {recording.duration_s:.2f} s",
            "Use fewer lags, or a longer trial.",
        )
    last = np.arange(lags.reach, len(read) - lags.ahead)
    rows = last[:, None] + (np.arange(lags.count) - lags.count + 1) * lags.spacing
    x = read[rows].reshape(len(last), -1)
    known = np.isfinite(x)
    usable = (known.any(axis=1) if missing else known.all(axis=1)) & np.isfinite(y[last + lags.ahead]).all(axis=1)
    names = tuple(
        sensor if ago == 0 else f"{sensor} {ago * lags.spacing / recording.rate_hz:.2f} s ago"
        for ago in range(lags.count - 1, -1, -1)
        for sensor in sensors
    )
    at = last[usable] + lags.ahead
    return Samples(
        x[usable], y[at], names, tuple(states), recording.time[at], np.asarray(phi)[at], subject=recording.subject
    )


def present(samples: Samples, sensors: Sequence[str]) -> Samples:
    """Keep the present reading of each window: what a model without history sees."""
    return replace(samples, x=samples.x[:, -len(sensors) :], inputs=tuple(sensors))


def stacked(samples: Sequence[Samples]) -> Samples:
    """Put windows of several trials one below the other; each window still belongs to one trial."""
    filled = [trial for trial in samples if len(trial)] or samples
    first, subjects = filled[0], {s.subject for s in filled}
    joined = {name: np.concatenate([getattr(s, name) for s in filled]) for name in ("x", "y", "time", "phi")}
    return replace(first, **joined, subject=first.subject if len(subjects) == 1 else f"{len(subjects)} people")


def thin_windows(samples: Samples, most: int) -> Samples:
    """Keep every k-th window, as few as needed to have no more than so many: neighbours say nearly the same."""
    return samples.rows(slice(None, None, max(1, -(-len(samples) // most))))


@dataclass(frozen=True, eq=False)
class Parts:
    """Windows of the three parts, trial by trial."""

    training: tuple[Samples, ...]  # one a trial that has windows in that part
    check: tuple[Samples, ...]  # one a trial that has windows in that part
    test: tuple[Samples, ...]  # one a trial that has windows in that part
    rule: str  # how they were parted, a word of `RULES` or a sentence

    def __post_init__(self) -> None:
        """Refuse a split that leaves a part empty."""
        for name in ("training", "check", "test"):
            if not any(len(trial) for trial in getattr(self, name)):
                raise SamplingError(
                    f"the split {self.rule!r} must leave windows in all three parts",
                    f"none remains for {name.replace('check', 'validation')}: the trials are too short "
                    "for windows and for gaps between the parts",
                    "Use a shorter history, or longer trials.",
                )

    def fitted(self) -> Samples:
        """Windows that models are fitted to."""
        return stacked(self.training)

    def checked(self) -> Samples:
        """Windows that models are chosen by."""
        return stacked(self.check)

    def tested(self) -> Samples:
        """Windows that models are tested on."""
        return stacked(self.test)


def split_within(trials: Sequence[Samples], rule: str, reach_s: float, seed: int = 0) -> Parts:
    """Part the windows of every trial by one rule.

    From the last window of one part to the first of the next lie at least `reach_s` plus 0.3 s, so that no two windows
    of different parts share a reading, and the filter carries nothing over. The random rule alone leaves no gap.

    reach_s: from the first reading of a window to its last [s]

    >>> t = np.arange(6000) / 100
    >>> parts = split_within([Samples(t[:, None], t[:, None], ("a",), ("b",), t, t)], "temporal", 1.0)
    >>> parts.fitted().time[[0, -1]].round(1).tolist(), parts.checked().time[[0, -1]].round(1).tolist()
    ([0.0, 42.0], [43.3, 48.0])
    """
    check_word(rule, RULES, "the split rule")
    rng = np.random.default_rng(seed)
    labels = [_labels(trial, rule, reach_s, rng) for trial in trials]
    training, check, test = (_chosen(trials, labels, part) for part in (TRAINING, CHECK, TEST))
    return Parts(training, check, test, rule)


def split_by_subject(people: Sequence[Sequence[Samples]], tested: int) -> Parts:
    """Leave one person out of at least three; models are chosen by the next one in the list, fitted to all others."""
    if len(people) < 3:
        raise SamplingError(
            "a population model must have at least three people: for training, validation and testing",
            f"the number of people is {len(people)}",
            "Add participants, or fit each participant separately.",
        )
    checked = (tested + 1) % len(people)
    fitted = [trial for k, trials in enumerate(people) if k not in (tested, checked) for trial in trials]
    return Parts(tuple(fitted), tuple(people[checked]), tuple(people[tested]), PERSON_OUT)


def split_by_trial(trials: Sequence[Samples], tested: Sequence[int], reach_s: float) -> Parts:
    """Leave whole trials out; the last 15 % of each other one are checked, `reach_s` [s] being a window's length."""
    others = [trial for k, trial in enumerate(trials) if k not in tested]
    labels = [_apart(trial.time, np.where(_share(trial.time) < 0.85, TRAINING, CHECK), reach_s) for trial in others]
    test = tuple(trials[k] for k in tested)
    return Parts(_chosen(others, labels, TRAINING), _chosen(others, labels, CHECK), test, "leave trials out")


def _labels(samples: Samples, rule: str, reach_s: float, rng: np.random.Generator) -> NDArray[np.int_]:
    if rule == RANDOM:
        return rng.choice(3, size=len(samples), p=SHARES)
    share = _share(samples.time)
    if rule == "temporal":
        raw = np.digitize(share, np.cumsum(SHARES[:2]))
    else:
        raw = np.array(BLOCKS)[np.minimum((share * len(BLOCKS)).astype(int), len(BLOCKS) - 1)]
    return _apart(samples.time, raw, reach_s)


def _share(time: Values) -> Values:
    """Place of each time between the first and the last, 0 to below 1."""
    return (time - time[0]) / max(time[-1] - time[0], 1e-9) * (1 - 1e-9) if len(time) else time


def _apart(time: Values, raw: NDArray[np.int_], reach_s: float) -> NDArray[np.int_]:
    """Set windows apart whose readings, or the filter's reach before them, lie in another part."""
    borders = time[1:][np.diff(raw) != 0]
    labels = raw.copy()
    for border in borders:
        labels[(time >= border - 1e-9) & (time < border + reach_s + SEAM_S - 1e-9)] = APART
    return labels


def _chosen(trials: Sequence[Samples], labels: Sequence[NDArray[np.int_]], part: int) -> tuple[Samples, ...]:
    return tuple(trial.rows(label == part) for trial, label in zip(trials, labels, strict=True))


WAYS = {
    "none": "windows with a missing sample are excluded",
    "mean": "missing samples are replaced by the sensor's mean in the training part",
    "last": "missing samples are replaced by the sensor's last known sample",
}
MOST_MISSING = 0.6  # of a window's readings, in training
RUNS = (1, 3, 10)  # readings that go missing in a row, on average


def missing_runs(share: Values, run: Values, length: int, seed: int = 0) -> NDArray[np.bool_]:
    """Draw which readings are missing, column by column: a Markov chain of two states.

    share (column,): readings of the column that are missing, between 0 and below 1
    run (column,): readings that are missing in a row, on average; at least 1, at which each is drawn alone if the
        share allows
    returns (length, column)

    >>> lost = missing_runs(np.array([0.0, 0.3]), np.array([5.0, 5.0]), 20_000)
    >>> lost.mean(axis=0).round(1).tolist()
    [0.0, 0.3]
    """
    rng = np.random.default_rng(seed)
    run = np.maximum(run, 1 / (1 - share))  # shorter runs cannot make up the share
    begin, stay = share / (run * (1 - share)), 1 - 1 / run
    lost = np.empty((length, len(share)), bool)
    now = rng.random(len(share)) < share
    for row in range(length):
        lost[row] = now
        now = rng.random(len(share)) < np.where(now, stay, begin)
    return lost


def with_missing(recording: Recording, sensors: Sequence[str], share: float, run_s: float, seed: int = 0) -> Recording:
    """Take a share (0 to below 1) of each sensor's readings away, in drop-outs of mean `run_s` [s]; 0: one by one."""
    shares, runs = np.full(len(sensors), share), np.full(len(sensors), max(1.0, run_s * recording.rate_hz))
    values = recording.values.copy()
    columns = [recording.index(name) for name in sensors]
    lost = missing_runs(shares, runs, len(values), seed)
    values[:, columns] = np.where(lost, np.nan, values[:, columns])
    return recording.with_values(values)


def fill_readings(recording: Recording, sensors: Sequence[str], way: str, means: Values) -> Recording:
    """Fill missing readings by a word of `WAYS`, from training means (sensor,); `last` too, before a first reading."""
    refuse_unknown_way(way)
    values = recording.values.copy()
    for name, mean in zip(sensors, means, strict=True):
        column = recording.index(name)
        known = np.isfinite(values[:, column])
        if way == "mean":
            values[~known, column] = mean
        elif way == "last":
            latest = np.maximum.accumulate(np.where(known, np.arange(len(known)), -1))
            values[:, column] = np.where(latest < 0, mean, values[latest, column])
    return recording.with_values(values)


def refuse_unknown_way(way: str) -> None:
    """Refuse what is no way to deal with missing readings."""
    if way not in WAYS:
        raise SchemaError(
            "the treatment of missing samples must be none, mean or last", f"found {way!r}", "Use one of these."
        )


def hidden(samples: Samples, sensors: int, seed: int = 0) -> Samples:
    """Hide readings of every second window, for training: a model learns to do without them.

    Each sensor of such a window loses a share of its readings that is drawn between 0 and 0.6, singly or in runs.

    returns: the same windows, NaN where a reading is hidden; the states are all there
    """
    rng = np.random.default_rng(seed)
    chosen = np.arange(1, len(samples), 2)
    readings = samples.x.shape[1] // sensors
    columns = len(chosen) * sensors
    lost = missing_runs(rng.uniform(0, MOST_MISSING, columns), rng.choice(RUNS, columns).astype(float), readings, seed)
    x = samples.x.copy()
    x[chosen] = np.where(
        lost.reshape(readings, len(chosen), sensors).swapaxes(0, 1).reshape(len(chosen), -1), np.nan, x[chosen]
    )
    return replace(samples, x=x)
