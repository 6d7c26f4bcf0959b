"""Who names what is hidden: the answer that one way of asking gave about one case."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass

import pandas as pd

ANSWERS = ("named", "tied", "among others", "wrong name", "curve", "nothing", "refused")
TOOLS = ("discover", "sindy", "dmd", "gp", "nn")


@dataclass(frozen=True)
class Naming:
    """An answer about what a model lacks."""

    case: str  # what was recorded; what the known model lacks, empty where nothing is hidden
    hidden: str  # what was recorded; what the known model lacks, empty where nothing is hidden
    tool: str
    noise: float
    seed: int
    # one of `ANSWERS`: the hidden effect and nothing else, it and another that the data cannot distinguish (whichever
    # stands first), more than it, something else, a curve without a name, that nothing is missing, or a refusal
    answer: str
    said: str
    amount: float = float("nan")  # the effect's number over its true one; NaN where the hidden effect was not named
    # median over channels of how much less RMSE the forecast has than that of the known model, both from the noise-free
    # true state, an oracle [%]; NaN where it diverged or was not run
    accuracy: float = float("nan")
    diverged_s: float | None = None  # when the forecast left every bound [s since its start]
    seconds: float = float("nan")

    def __post_init__(self) -> None:
        """Refuse an answer that the table does not know."""
        if self.answer not in ANSWERS or self.tool not in TOOLS:
            raise ValueError(f"{self.answer!r} of {self.tool!r} is none of {ANSWERS} of {TOOLS}")

    @property
    def right(self) -> bool:
        """Whether it says what is hidden, or rightly that nothing is."""
        return self.answer == ("named" if self.hidden else "nothing")


def namings_table(namings: Sequence[Naming]) -> pd.DataFrame:
    """Return all answers, one row each."""
    return pd.DataFrame([asdict(naming) | {"right": naming.right} for naming in namings])
