"""How many threads torch and the matrix products of numpy and numba use, for the length of a block."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import scipy.linalg.blas  # noqa: F401 numba multiplies with scipy's BLAS: what is to be limited must be loaded
import torch
from threadpoolctl import threadpool_limits


@contextmanager
def torch_threads(count: int) -> Iterator[None]:
    """Let torch use that many threads on the CPU, and as many as before when the block ends.

    >>> with torch_threads(1):
    ...     torch.get_num_threads()
    1
    """
    before = torch.get_num_threads()
    torch.set_num_threads(count)
    try:
        yield
    finally:
        torch.set_num_threads(before)


@contextmanager
def pinned_threads(count: int) -> Iterator[None]:
    """Let torch and every BLAS use that many threads on the CPU, and as many as before when the block ends.

    Matrices of 64 columns are slower on two threads than on one, and two trainings beside each other slower still.

    >>> from threadpoolctl import threadpool_info
    >>> with pinned_threads(1):
    ...     {pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"}
    {1}
    """
    with torch_threads(count), threadpool_limits(count, user_api="blas"):
        yield
