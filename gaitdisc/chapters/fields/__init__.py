"""Fields over time from a few sensors: their files, sensors that stand or travel, modes, errors.

Kinds of models, their windows and splits are those of `gaitdisc.sensing`.
"""

from gaitdisc.sensing.reconstructor import KINDS, fit_reconstructor
from gaitdisc.sensing.splits import RANDOM
from gaitdisc.sensing.windows import Lags

__all__ = ["KINDS", "RANDOM", "Lags", "fit_reconstructor"]
