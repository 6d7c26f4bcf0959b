"""One cell of chapter 3's grid: a system, a method, an approach and a noise, and how well the augmented model does."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

METHODS = ("sindy", "esindy", "wsindy", "dmd", "exactdmd", "bopdmd", "gp", "gpm", "nn")
RECONSTRUCTION, ORACLE, FORECAST = PARTS = ("reconstruction", "oracle forecast", "forecast")
PART_WORDS = {
    RECONSTRUCTION: "reconstruction",
    ORACLE: "forecast, oracle start",
    FORECAST: "forecast, estimated start",
}


@dataclass(frozen=True, eq=False)
class PartAccuracy:
    """Known and augmented model against the truth over one part of a record."""

    time: NDArray[np.float64]  # (sample,) [s], since the part's start
    truth: NDArray[np.float64]  # (sample, channel), Noise-free; NaN from where a model diverged
    known: NDArray[np.float64]  # (sample, channel), Noise-free; NaN from where a model diverged
    augmented: NDArray[np.float64]  # (sample, channel), Noise-free; NaN from where a model diverged
    diverged_s: float | None  # when the augmented model left every bound [s since the part's start]
    begins_s: float = 0.0  # when the part begins in its record [s]

    def rmse(self, model: str, until_s: float | None = None) -> NDArray[np.float64]:
        """Root mean square error, (channel,) [channel's unit]; NaN if the model diverged before."""
        last = len(self.time) if until_s is None else int(np.searchsorted(self.time, until_s + 1e-9, side="right"))
        return np.sqrt(np.mean((getattr(self, model)[:last] - self.truth[:last]) ** 2, axis=0))

    def accuracy(self, clipped: bool = False, until_s: float | None = None) -> NDArray[np.float64]:
        """100 (1 - RMSE augmented / RMSE known), (channel,) [%]; NaN if the augmented model diverged."""
        known, augmented = self.rmse("known", until_s), self.rmse("augmented", until_s)
        with np.errstate(all="ignore"):
            found = 100 * (1 - augmented / np.where(known > 0, known, np.nan))
        return np.clip(found, -100, 100) if clipped else found

    def change(self, horizons_s: Sequence[float]) -> NDArray[np.float64]:
        """Median over channels of the percent change in RMSE within each horizon (Fig. 3.9), (horizon,) [%]."""
        return np.array([np.median(self.accuracy(until_s=each)) for each in horizons_s])

    def valid_s(self, model: str, tolerance: float = 0.4) -> float:
        """Time until the error first exceeds a share of the truth's standard deviation [s]."""
        error = (getattr(self, model) - self.truth) / self.truth.std(axis=0)
        beyond = ~(np.sqrt(np.mean(error**2, axis=1)) <= tolerance)
        return float(self.time[int(np.argmax(beyond))] if beyond.any() else self.time[-1])

    def first_jump_s(self, channel: int = 0) -> float:
        """Time at which the truth first changes its sign, where an attractor's lobe is left [s]."""
        turned = np.sign(self.truth[:, channel]) != np.sign(self.truth[0, channel])
        return float(self.time[int(np.argmax(turned))] if turned.any() else self.time[-1])


@dataclass(frozen=True, eq=False)
class DiscrepancyCell:
    """What one method made of one error signal."""

    system: str
    method: str
    approach: str
    variant: str
    noise: float  # share of each channel's standard deviation, or its unit in the published variant
    seed: int
    channels: tuple[str, ...]
    # `reconstruction`: the training part, from the true first state. `oracle forecast`: from the noise-free true state
    # at the end of the training part, which no user has. `forecast`: from that state as it is estimated from the noisy
    # measurement. Empty where nothing was fitted
    parts: dict[str, PartAccuracy]
    fit_s: float  # [s], of a core, to fit, and to estimate the start and run the augmented model over all parts
    run_s: float  # [s], of a core, to fit, and to estimate the start and run the augmented model over all parts
    terms: str = ""  # what was found, for a method that says so
    refused: str = ""
    units: tuple[str, ...] = ()  # of the states, of which the channels are the first; empty where they have none

    @property
    def samples(self) -> int:
        """Length of the training part; 0 where nothing was fitted."""
        return len(self.parts["reconstruction"].time) if "reconstruction" in self.parts else 0

    @property
    def dt_s(self) -> float:
        """Step between samples [s]; NaN where nothing was fitted."""
        if "reconstruction" not in self.parts:
            return float("nan")
        return round(float(np.diff(self.parts["reconstruction"].time[:2])[0]), 9)


def cells_table(cells: Sequence[DiscrepancyCell]) -> pd.DataFrame:
    """Return the numbers of all cells, one row a cell, part and channel."""
    rows = []
    for cell in cells:
        head = {
            "system": cell.system, "method": cell.method, "approach": cell.approach, "variant": cell.variant,
            "noise": cell.noise, "seed": cell.seed, "dt_s": cell.dt_s, "samples": cell.samples,
        }  # fmt: skip
        tail = {"fit_s": cell.fit_s, "run_s": cell.run_s, "terms": cell.terms, "refused": cell.refused}
        if not cell.parts:
            rows.append(head | tail)
        for part, found in cell.parts.items():
            known, augmented = found.rmse("known"), found.rmse("augmented")
            accuracy, clipped = found.accuracy(), found.accuracy(clipped=True)
            for k, channel in enumerate(cell.channels):
                rows.append(
                    head
                    | {"part": part, "channel": channel, "rmse_known": known[k], "rmse_augmented": augmented[k]}
                    | {"accuracy": accuracy[k], "clipped": clipped[k], "diverged_s": found.diverged_s}
                    | {"valid_s": found.valid_s("augmented"), "valid_known_s": found.valid_s("known")}
                    | tail
                )
    return pd.DataFrame(rows)
