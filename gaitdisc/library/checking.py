"""Whether a recording is fit for use."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from gaitdisc.processing.inspection import inspected_file

if TYPE_CHECKING:
    from gaitdisc.processing.inspection import Inspection


def check(path: Path | str) -> Inspection:
    """Look at a recording without changing or writing anything.

    Parameters
    ----------
    path : path
        A file of a walk.

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
    return inspected_file(Path(path))
