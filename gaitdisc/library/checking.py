"""Whether a recording is fit for use."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from gaitdisc.library.walks import Walk, trial_of
from gaitdisc.processing.inspection import inspected_file, inspected_trial

if TYPE_CHECKING:
    from gaitdisc.processing.inspection import Inspection


def check(walk: Walk) -> Inspection:
    """Look at a recording without changing or writing anything.

    Parameters
    ----------
    walk : path, Trial, DataFrame or Recording
        A file of a walk, or what was read of it.

    Returns
    -------
    Inspection
        `light` is `green`, `amber` (channels or samples are spoiled) or `red` (the file cannot be used, `refusal` says
        why); `findings` holds everything that was seen, the severest first.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> gd.check("walk.c3d").light  # doctest: +SKIP
    'green'
    """
    if isinstance(walk, Path | str):
        return inspected_file(Path(walk))
    trial = trial_of(walk)
    return inspected_trial(trial, trial.name)
