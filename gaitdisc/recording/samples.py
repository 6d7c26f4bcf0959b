"""Samples: the one thing that any model is fitted to."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ShapeError
from gaitdisc.recording.arrays import read_only


@dataclass(frozen=True, eq=False)
class Samples:
    """Inputs and outputs, sample by sample, in order of time.

    Parameters
    ----------
    x : ndarray (sample, input)
        Inputs.
    y : ndarray (sample, output)
        Outputs.
    inputs, outputs : tuple of str
        Their names.
    time : ndarray (sample,) [s]
        When each sample was taken; samples that were left away show as steps.
    phi : ndarray (sample,) [% stride]
        Percent stride of each sample.
    subject : str
        Pseudonym.

    Raises
    ------
    ShapeError
        If the arrays and names do not fit together.

    Examples
    --------
    >>> s = Samples(np.zeros((3, 2)), np.ones((3, 1)), ("a", "b"), ("c",), np.arange(3.0), np.zeros(3))
    >>> len(s)
    3
    """

    x: NDArray[np.float64]
    y: NDArray[np.float64]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    time: NDArray[np.float64]
    phi: NDArray[np.float64]
    subject: str = ""

    def __post_init__(self) -> None:
        """Check shapes once."""
        count = len(self.time)
        wanted = {
            "x": (count, len(self.inputs)),
            "y": (count, len(self.outputs)),
            "phi": (count,),
        }
        for name, shape in wanted.items():
            if np.shape(getattr(self, name)) != shape:
                raise ShapeError(
                    f"samples need {name} of shape {shape}",
                    f"found {np.shape(getattr(self, name))}",
                    "Give one row a sample and one name a column.",
                )
        for name in ("x", "y", "time", "phi"):
            object.__setattr__(self, name, read_only(getattr(self, name)))

    def __len__(self) -> int:
        return len(self.time)

    def rows(self, chosen: slice | NDArray[np.bool_] | NDArray[np.intp]) -> Samples:
        """Keep some samples.

        Parameters
        ----------
        chosen : slice or ndarray
            Samples to keep.
        """
        return replace(
            self,
            x=self.x[chosen],
            y=self.y[chosen],
            time=self.time[chosen],
            phi=self.phi[chosen],
        )

    def with_outputs(self, y: NDArray[np.float64]) -> Samples:
        """Return the same inputs with other outputs of the same names.

        Parameters
        ----------
        y : ndarray (sample, output)
            New outputs.
        """
        return replace(self, y=y)

    def last_block(self, share: float) -> tuple[Samples, Samples]:
        """Split off the last part, contiguous in time.

        Parameters
        ----------
        share : float
            Share of the samples in the last part, between 0 and 1.

        Returns
        -------
        before, last : Samples
        """
        cut = len(self) - round(share * len(self))
        return self.rows(slice(0, cut)), self.rows(slice(cut, None))
