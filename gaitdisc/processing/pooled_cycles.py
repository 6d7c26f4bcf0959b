"""What is kept after processing: of a person's cycles pooled over trials, and of one walk."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from operator import itemgetter

import numpy as np
import pandas as pd

from gaitdisc.channel import Channel
from gaitdisc.errors import ShapeError
from gaitdisc.recording import PERCENT, Finding
from gaitdisc.recording.arrays import Values, read_only
from gaitdisc.saved.kind import CSV, Kind, Saved, pick_arrays
from gaitdisc.saved.provenance import Refusal
from gaitdisc.saved.unit_folder import lies_on_disk, may_lie_on_disk, unit_name

CYCLE_COLUMNS = (
    "trial", "side", "start_s", "foot_off_s", "opposite_off_s", "opposite_contact_s", "end_s", "start_by", "end_by",
    "foot_off_by", "kinetic", "kept", "reason", "stride_s", "step_s", "cadence_per_min", "stance_percent",
    "swing_percent", "single_support_percent", "double_support_percent", "stride_m", "step_m", "width_m",
    "speed_m_per_s",
)  # fmt: skip
SPATIOTEMPORAL = CYCLE_COLUMNS[CYCLE_COLUMNS.index("stride_s") :]
RAW = "raw_emg_"  # arrays, by side
STRIDE_COLUMNS = ("side", "start_s", "end_s", "kept", "reason")


@may_lie_on_disk("curves", "raw_emg")
@dataclass(frozen=True, eq=False)
class PooledCycles(Saved, file="cycles.json"):
    """Cycles of one person in one session under one condition.

    Parameters
    ----------
    subject, group, session, condition : str
        Pseudonym, and the study's names of group, session and condition; empty if the study has none.
    trials : int
        Number of trials with at least one cycle, kept or not.
    detectors : mapping of str to int
        Detector of the contacts -> number of trials.
    contact_offset_s, foot_off_offset_s : float, optional
        Shift of contacts and foot offs from markers or angles [s]; positive: later. It is the median difference from a
        plate or the file's events, over the steps that both contain. None without a shift.
    offset_steps : int
        Number of contacts from which `contact_offset_s` was computed.
    over_ground : bool
        Whether the pelvis moves through the laboratory; False on a treadmill.
    channels : tuple of Channel
        Channels of `curves`.
    curves : ndarray (cycle, phase, channel) [channel's unit]
        Every kept cycle on 101 points, in the order of the kept rows of `cycles`; NaN where a channel has no value,
        such as the moments of a foot that is not on a plate.
    cycles : DataFrame
        One row per cycle, kept or left out: `CYCLE_COLUMNS`.
    findings : tuple of Finding
        All findings of the reader and the quality checks.
    refusals : tuple of Refusal
        Trials that are left out entirely.
    files : mapping of str to str
        File name -> SHA-256.
    leg_m : float, optional
        Leg length, measured or estimated from the stature [m]; None if both are unknown.
    age_years : int, optional
        Age in whole years.
    raw_emg : mapping of str to ndarray (sample, channel) [channel's unit], optional
        Side -> raw EMG of the cycle whose envelopes lie nearest to their means, from contact to contact, with the leg's
        EMG channels in the order of `channels`. Empty if the files contain envelopes.

    Raises
    ------
    ShapeError
        If the curves do not have 101 points, one column per channel, and one row per kept cycle.
    """

    subject: str
    group: str
    session: str
    condition: str
    trials: int
    detectors: Mapping[str, int]
    contact_offset_s: float | None
    foot_off_offset_s: float | None
    offset_steps: int
    over_ground: bool
    channels: tuple[Channel, ...]
    curves: Values
    cycles: pd.DataFrame
    findings: tuple[Finding, ...]
    refusals: tuple[Refusal, ...]
    files: Mapping[str, str]
    leg_m: float | None = None
    age_years: int | None = None
    raw_emg: Mapping[str, Values] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if lies_on_disk(self, "curves"):
            return
        wanted = (int(self.cycles["kept"].sum()), len(PERCENT), len(self.channels))
        if np.shape(self.curves) != wanted:
            raise ShapeError(
                f"curves of pooled cycles must have shape {wanted}: cycles, points, channels",
                f"the shape is {np.shape(self.curves)} for {self.name}",
                "Normalise the kept cycles with Strides.normalised.",
            )
        object.__setattr__(self, "curves", read_only(self.curves))

    @property
    def name(self) -> str:
        """Person, session and condition."""
        return " ".join(part for part in (self.subject, self.session, self.condition) if part)

    @property
    def where(self) -> str:
        """Session and condition."""
        return " ".join(part for part in (self.session, self.condition) if part)

    @cached_property
    def kept(self) -> pd.DataFrame:
        """Rows of the cycles that are kept, in the order of `curves`."""
        return self.cycles[self.cycles["kept"].astype(bool)].reset_index(drop=True)

    @property
    def left_out(self) -> pd.DataFrame:
        """Rows of the cycles that are left out, each with its reason."""
        return self.cycles[~self.cycles["kept"].astype(bool)].reset_index(drop=True)

    def counted(self, side: str) -> int:
        """Number of kept cycles of one foot.

        Parameters
        ----------
        side : str
            `r` or `l`.
        """
        return int((self.kept["side"] == side).sum())

    def to_frame(self) -> pd.DataFrame:
        """One row per cycle: times, events, and the reason if the cycle is left out."""
        return self.cycles

    def __repr__(self) -> str:
        n_kept, n_cut = len(self.kept), len(self.cycles)
        return f"PooledCycles({self.subject}, {self.where}: {n_kept} of {n_cut} cycles kept, {self.trials} trials)"

    def mean_curves(self) -> pd.DataFrame:
        """Mean and standard deviation of every channel on 101 points, over the kept cycles of the channel's side.

        Channels without a side occur twice, once for the cycles of each foot.

        Returns
        -------
        DataFrame
            Columns channel, unit, side (of the cycles), percent, n (cycles with a value), mean, sd (NaN for one cycle).
        """
        curves, feet = self.curves, self.kept["side"].to_numpy()
        means = []
        for column, channel in enumerate(self.channels):
            for side in (channel.side,) if channel.side else ("l", "r"):
                of_foot = curves[feet == side, :, column]
                if np.isfinite(of_foot).any():
                    means.append(mean_curve(of_foot, channel=channel.name, unit=channel.unit, side=side))
        return stack_means(means, "side")


def stack_means(means: Sequence[Mapping[str, np.ndarray]], word: str) -> pd.DataFrame:
    """Table of mean curves that are of a side or walk, the column of that word; of none the columns."""
    columns = ("channel", "unit", word, "percent", "n", "mean", "sd")  # joined before the table: half of its time
    return pd.DataFrame({name: np.concatenate([curve[name] for curve in means] or [[]]) for name in columns})


def mean_curve(curves: Values, **words: str) -> dict[str, np.ndarray]:
    """Mean and deviation of the known curves (cycle, phase) on 101 points, behind a column of each of these words."""
    present = np.isfinite(curves)
    count = present.sum(axis=0)
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = np.where(present, curves, 0.0).sum(axis=0) / count
        square = np.where(present, (curves - mean) ** 2, 0.0).sum(axis=0)
        spread = np.where(count > 1, np.sqrt(square / (count - 1)), np.nan)
    columns = {name: np.full(len(PERCENT), word) for name, word in words.items()}
    return {**columns, "percent": PERCENT, "n": count, "mean": mean, "sd": spread}


def choose_typical(curves: Values, kept: pd.DataFrame, channels: Sequence[Channel], side: str) -> int | None:
    """Row of the leg's cycle whose envelopes differ least from their means; None where no cycle has all of them.

    curves (cycle, phase, channel) [channel's unit]

    >>> both = (Channel("emg_ta_l", "emg", "V", "l"),) * 2
    >>> curves = np.array([1.0, 2.0, 9.0])[:, None, None] * np.ones((3, 101, 2))
    >>> choose_typical(curves, pd.DataFrame({"side": ["l", "l", "l"]}), both, "l")
    1
    """
    columns = [k for k, channel in enumerate(channels) if (channel.quantity, channel.side) == ("emg", side)]
    envelopes = curves[:, :, columns]
    rows = np.flatnonzero((kept["side"] == side).to_numpy() & np.isfinite(envelopes).all(axis=(1, 2)))
    if not len(rows) or not columns:
        return None
    mean = envelopes[rows].mean(axis=0)
    apart = (envelopes[rows] - mean) / np.maximum(mean.max(axis=0), 1e-12)
    return int(rows[np.argmin((apart**2).sum(axis=(1, 2)))])


def cycles_name(subject: str, session: str, condition: str) -> str:
    """Folder name of pooled cycles, another one for every person, session and condition.

    >>> cycles_name("P01", "", "turn"), cycles_name("P01", "after", "turn")
    ('P01-turn', 'P01-after___turn-c681ddd0')
    """
    return unit_name(subject, f"{session} / {condition}" if session else condition)


CYCLES = Kind(
    PooledCycles,
    "cycles.json",
    ("subject", "group", "session", "condition", "trials", "detectors", "contact_offset_s", "foot_off_offset_s",
     "offset_steps", "over_ground", "channels", "findings", "refusals", "files", "leg_m", "age_years"),
    {"cycles": CSV("cycles.csv", CYCLE_COLUMNS)},
    {"curves": itemgetter("curves"), "raw_emg": lambda arrays: pick_arrays(arrays, RAW)},
    lambda cycles: {"curves": cycles.curves, **{f"{RAW}{side}": raw for side, raw in cycles.raw_emg.items()}},
    flags=("kinetic", "kept"),
    blank=("reason", "foot_off_by"),
    unit=lambda cycles: cycles_name(cycles.subject, cycles.session, cycles.condition),
    page="gaitdisc.processing.page:write_lone_cycles",
    page_folder="report",
)  # fmt: skip


@may_lie_on_disk("curves")
@dataclass(frozen=True, eq=False)
class WalkSummary:
    """One walk of one person, small enough to keep."""

    subject: str  # pseudonym
    condition: str  # the study's word
    duration_s: float  # of the processed recording
    rate_hz: float  # of the processed recording
    detector: str
    channels: tuple[Channel, ...]
    # (stride, phase, channel) [channel's unit], every kept stride on 101 points; of a walk that was loaded it is read
    # each time it is looked at
    curves: Values
    strides: pd.DataFrame  # one row a stride, kept or dropped: side, start_s, end_s, kept, reason
    findings: tuple[Finding, ...]  # everything the reader and the quality checks saw
    files: Mapping[str, str]

    def __post_init__(self) -> None:
        if lies_on_disk(self, "curves"):
            return
        wanted = (len(PERCENT), len(self.channels))
        if np.ndim(self.curves) != 3 or self.curves.shape[1:] != wanted:
            raise ShapeError(
                f"curves of a walk must have shape (stride, {wanted[0]}, {wanted[1]})",
                f"the shape is {np.shape(self.curves)} for {self.subject} {self.condition}",
                "Normalise the strides with Strides.normalised.",
            )
        object.__setattr__(self, "curves", read_only(self.curves))

    @property
    def where(self) -> str:
        """Say where among the walks of a person it stands: its condition."""
        return self.condition

    @property
    def worst(self) -> str:
        """Return the severest finding: `refused`, `warning`, `note`, or `clean` where there is none."""
        return min(self.findings, key=lambda finding: finding.rank).severity if self.findings else "clean"

    def counted(self, kept: bool = True) -> dict[str, int]:
        """Number of strides of each side."""
        chosen = self.strides[self.strides["kept"] == kept]
        return {str(side): int(count) for side, count in chosen["side"].value_counts().sort_index().items()}


def pooled_walk(pooled: PooledCycles, follow: str) -> WalkSummary:
    """Kept cycles of many short trials as the strides of one walk; channels without a side are those of `follow`."""
    feet = pooled.kept["side"].to_numpy()
    curves = np.full((max(pooled.counted("l"), pooled.counted("r")), len(PERCENT), len(pooled.channels)), np.nan)
    for column, channel in enumerate(pooled.channels):
        of_foot = pooled.curves[feet == (channel.side or follow), :, column]
        curves[: len(of_foot), :, column] = of_foot
    return WalkSummary(
        pooled.subject,
        pooled.condition,
        duration_s=float(pooled.kept["stride_s"].sum()),
        rate_hz=float("nan"),
        detector=next(iter(pooled.detectors), ""),
        channels=pooled.channels,
        curves=curves,
        strides=pooled.cycles[list(STRIDE_COLUMNS)],
        findings=pooled.findings,
        files=pooled.files,
    )


WALK = Kind(
    WalkSummary,
    "walk.json",
    ("subject", "condition", "duration_s", "rate_hz", "detector", "channels", "findings", "files"),
    {"strides": CSV("strides.csv", STRIDE_COLUMNS)},
    {"curves": itemgetter("curves")},
    lambda walk: {"curves": walk.curves},
    blank=("reason",),
    unit=lambda walk: unit_name(walk.subject, walk.condition),
)
