"""What models are fitted to: samples, the scale of columns, and the trajectory they come from (Eqs. 4.1-4.4)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.channel import Channel
from gaitdisc.errors import SamplingError, ShapeError, TrainingError
from gaitdisc.recording.arrays import Values, freeze, mean_rate, read_only

RELATIVE_FLOOR = 1e-9  # a column that varies by less than this of its size is constant
ABSOLUTE_FLOOR = 1e-12  # deg, m, V and their rates: rounding, never a signal


@dataclass(frozen=True, eq=False)
class Scale:
    """Mean and standard deviation of every column, as the training part has them."""

    mean: Values  # (column,) [each column's unit], what is subtracted
    # (column,) [each column's unit], what is divided by; infinite for a constant column, which thereby becomes 0
    # wherever it is used, also where it is not constant any more
    sd: Values

    def __post_init__(self) -> None:
        freeze(self, "mean", "sd")

    @property
    def constant(self) -> NDArray[np.bool_]:
        """True for each column that did not vary, (column,)."""
        return ~np.isfinite(self.sd)

    def scaled(self, values: Values) -> Values:
        """Values (sample, column) without unit: zero mean and unit standard deviation where the scale comes from."""
        return (values - self.mean) / self.sd

    def unscaled(self, scaled: Values) -> Values:
        """Numbers without unit (sample, column) back in the columns' units; a constant column gets its constant."""
        return scaled * np.where(self.constant, 0.0, self.sd) + self.mean


def fit_scale(values: Values) -> Scale:
    """Scale of the columns of a training part.

    values (sample, column) [each column's unit]: finite, or NaN where a value is missing; a column that is missing
        throughout is constant

    >>> scale = fit_scale(np.array([[0.0, 7.0], [2.0, 7.0]]))
    >>> scale.mean, scale.sd, scale.constant
    (array([1., 7.]), array([ 1., inf]), array([False,  True]))
    """
    mean, sd = values.mean(axis=0), values.std(axis=0)
    for column in np.flatnonzero(np.isnan(mean)):
        known = values[~np.isnan(values[:, column]), column]
        mean[column], sd[column] = (known.mean(), known.std()) if len(known) else (0.0, 0.0)
    still = sd <= ABSOLUTE_FLOOR + RELATIVE_FLOOR * np.nanmax(np.abs(values), axis=0, initial=0.0)
    return Scale(mean, np.where(still, np.inf, sd))


@dataclass(frozen=True, eq=False)
class Samples:
    """Inputs and outputs of a model, one row per sample, in chronological order.

    Parameters
    ----------
    x : ndarray (sample, input)
        Inputs.
    y : ndarray (sample, output)
        Outputs.
    inputs, outputs : tuple of str
        Names of the inputs and of the outputs.
    time : ndarray (sample,) [s]
        Time of each sample; excluded samples appear as larger steps.
    phi : ndarray (sample,) [% stride]
        Percent stride of each sample.
    subject : str
        Pseudonym of the person.

    Raises
    ------
    ShapeError
        If the arrays and names do not match.

    Examples
    --------
    >>> s = Samples(np.zeros((3, 2)), np.ones((3, 1)), ("a", "b"), ("c",), np.arange(3.0), np.zeros(3))
    >>> len(s)
    3
    """

    x: Values
    y: Values
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    time: Values
    phi: Values
    subject: str = ""

    def __post_init__(self) -> None:
        count = len(self.time)
        wanted = {"x": (count, len(self.inputs)), "y": (count, len(self.outputs)), "phi": (count,)}
        for name, shape in wanted.items():
            if np.shape(getattr(self, name)) != shape:
                raise ShapeError(
                    f"{name} of the samples must have shape {shape}",
                    f"found {np.shape(getattr(self, name))}",
                    "Give one row per sample and one name per column.",
                )
        freeze(self, "x", "y", "time", "phi")

    def __len__(self) -> int:
        return len(self.time)

    def rows(self, chosen: slice | NDArray[np.bool_] | NDArray[np.intp]) -> Samples:
        """Keep some samples.

        Parameters
        ----------
        chosen : slice or ndarray
            Samples to keep.
        """
        return replace(self, x=self.x[chosen], y=self.y[chosen], time=self.time[chosen], phi=self.phi[chosen])

    def with_outputs(self, y: Values) -> Samples:
        """Return samples with the same inputs and output names, but new output values.

        Parameters
        ----------
        y : ndarray (sample, output)
            New outputs.
        """
        return replace(self, y=y)

    def last_block(self, share: float, seam_s: float = 0.0) -> tuple[Samples, Samples]:
        """Split off the last samples, which are contiguous in time.

        Parameters
        ----------
        share : float
            Share of the samples in the last part, between 0 and 1.
        seam_s : float
            Length excluded before the last part [s], because zero-lag filters use future samples.

        Returns
        -------
        before, last : Samples
        """
        cut = len(self) - round(share * len(self))
        before, last = self.rows(slice(0, cut)), self.rows(slice(cut, None))
        if seam_s > 0 and len(last):
            before = before.rows(before.time < last.time[0] - seam_s)
        return before, last

    def trainable(self, least: int, missing_inputs: bool = False) -> Samples:
        """Return the same samples, or raise an error if no model can be fitted to them.

        Parameters
        ----------
        least : int
            Minimum number of samples.
        missing_inputs : bool
            Whether the fit accepts inputs that are NaN.

        Raises
        ------
        TrainingError
            If there are too few samples, if a number is missing or infinite, or if an output does not vary.
        """
        who = self.subject or "the recording"
        if len(self) < least:
            raise TrainingError(
                f"a fit of {len(self.inputs)} inputs to {len(self.outputs)} outputs must have at least {least} samples",
                f"{who} has {len(self)} usable samples",
                "Record longer, or use fewer channels. The findings say which samples were excluded.",
            )
        for names, values in ((self.inputs, self.x), (self.outputs, self.y)):
            bad = np.isinf(values) if missing_inputs and values is self.x else ~np.isfinite(values)
            if bad.any():
                row, column = (int(k) for k in np.argwhere(bad)[0])
                raise TrainingError(
                    "all samples of a fit must be finite",
                    f"{who}: {int(bad[:, column].sum())} of {len(self)} samples of {names[column]} are missing or "
                    f"infinite (first: {self.time[row]:.3f} s)",
                    "Mark these samples as unusable; the fit then excludes them.",
                )
        still = fit_scale(self.y).constant
        if still.any():
            column = int(np.argmax(still))
            raise TrainingError(
                "the outputs of a fit must vary",
                f"{who}: {self.outputs[column]} is {self.y[0, column]:.6g} in all {len(self)} samples",
                "Remove this output, or check whether its sensor was connected.",
            )
        return self


@dataclass(frozen=True, eq=False)
class Trajectory:
    """State and derivatives on one even time base.

    >>> t, x = np.arange(4) / 100, np.zeros((4, 1))
    >>> knee = Channel("knee_angle_r", "angle", "deg", "r")
    >>> Trajectory(t, x, x, x, np.zeros(4), (knee,), np.ones((4, 1), bool)).names
    ('knee_angle_r',)
    """

    time: Values  # (time,) [s], even
    x: Values  # (time, channel) [unit], state
    xdot: Values  # (time, channel) [unit/s], its derivative
    xddot: Values  # (time, channel) [unit/s2], its second derivative
    phi: Values  # (time,) [% stride], 0 <= phi < 100, NaN outside of strides
    channels: tuple[Channel, ...]
    usable: NDArray[np.bool_]  # (time, channel), false where x, xdot or xddot is missing or not to be trusted
    subject: str = ""
    condition: str = ""

    def __post_init__(self) -> None:
        shape = (len(self.time), len(self.channels))
        for name in ("x", "xdot", "xddot", "usable"):
            actual = np.shape(getattr(self, name))
            if actual != shape:
                raise ShapeError(
                    f"{name} of a trajectory must have shape (time, channel) = {shape}",
                    f"found {actual}",
                    "Put time first, with one column per channel.",
                )
        if np.shape(self.phi) != shape[:1]:
            raise ShapeError(
                f"phi of a trajectory must have shape (time,) = {shape[:1]}",
                f"found {np.shape(self.phi)}",
                "Give one value in percent of the stride per sample.",
            )
        freeze(self, "time", "x", "xdot", "xddot", "phi")
        object.__setattr__(self, "usable", read_only(self.usable, bool))
        object.__setattr__(self, "channels", tuple(self.channels))

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the channels, in order."""
        return tuple(channel.name for channel in self.channels)

    @property
    def rate_hz(self) -> float:
        """Samples a second."""
        return float(round(mean_rate(self.time), 6))

    def columns(self, names: Sequence[str]) -> list[int]:
        """Return the columns of channels."""
        return [self.names.index(name) for name in names]

    def rows(self, chosen: slice | NDArray[np.bool_] | NDArray[np.intp]) -> Trajectory:
        """Trajectory of the chosen samples; usually a contiguous part."""
        arrays = {name: getattr(self, name)[chosen] for name in ("time", "x", "xdot", "xddot")}
        return replace(self, phi=self.phi[chosen], usable=self.usable[chosen], **arrays)

    def split(self, held_out_s: float, seam_s: float = 0.3) -> tuple[Trajectory, Trajectory]:
        """Split into a training part and the last part, held out.

        Zero-lag filters look ahead: what they carry over the seam is kept out of the training part, whose last
        `seam_s` are left away. The held-out part keeps its full length.

        held_out_s: length of the held-out part [s]; the dissertation holds out the last 30 s of 240 s (section 4.2.2)
        seam_s: length left away before the seam [s]
        """
        held = round(held_out_s * self.rate_hz)
        last = len(self.time) - held - round(seam_s * self.rate_hz)
        if held < 1 or last < 1:
            raise SamplingError(
                f"a trial must be longer than the {held_out_s:g} s to be held out and the {seam_s:g} s before them",
                f"{self.subject} {self.condition} lasts {len(self.time) / self.rate_hz:.2f} s",
                "Shorten [held_out] in the study, or remove it to hold out 12.5 %.",
            )
        return self.rows(slice(0, last)), self.rows(slice(len(self.time) - held, None))
