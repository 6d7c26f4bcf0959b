"""Drawing takes seconds a figure: many are drawn in processes side by side."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures.process import BrokenProcessPool
from typing import Any, TypeVar

Result = TypeVar("Result")
MOST_PROCESSES = 4  # that draw; each holds some 400 MB


def drawn_side_by_side(draw: Callable[..., Result], each: Sequence[tuple[Any, ...]], alone: int) -> list[Result]:
    """Draw for each of many, in processes where there are more than so many.

    draw: can be sent to another process, as its arguments and what it gives
    alone: up to so many are drawn here, one after the other

    >>> drawn_side_by_side(max, [(1, 2), (4, 3)], 2)
    [2, 4]
    """
    processes = min(os.cpu_count() or 1, MOST_PROCESSES, len(each))
    if len(each) <= alone or processes < 2:
        return [draw(*arguments) for arguments in each]
    from joblib import Parallel, delayed

    try:
        drawn: Any = Parallel(n_jobs=processes, backend="loky", inner_max_num_threads=1)(
            delayed(draw)(*arguments) for arguments in each
        )
    except BrokenProcessPool:  # killed, mostly for its memory: one after the other takes the least
        return [draw(*arguments) for arguments in each]
    return list(drawn)
