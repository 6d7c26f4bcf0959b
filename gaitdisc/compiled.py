"""Numbers by compiled code: numba, its results kept beside the package, in the user's cache, or nowhere."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from numba import njit
from numba.core.caching import FunctionCache


class _LenientCache(FunctionCache):
    """Compiled code is kept to save time: where it cannot be kept or is damaged, it is compiled again."""

    def save_overload(self, sig: Any, data: Any) -> None:
        try:
            super().save_overload(sig, data)
        except OSError as error:
            warnings.warn(f"compiled code is not kept: the system says: {error.strerror or error}", stacklevel=2)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        try:
            return super().load_overload(sig, target_context)
        except Exception:  # whatever a damaged file of pickled code may raise
            with suppress(OSError):
                self.flush()
            return None


def compiled(function: Callable[..., Any] | None = None, **options: Any) -> Any:
    """Compile a function with numba, and keep what was compiled where there is a folder to keep it in.

    The folder is NUMBA_CACHE_DIR, that of the package, or the user's cache. A package that is installed where nobody
    may write, for a user without a home, and a full disk, cost the time to compile once a process and nothing else.

    Parameters
    ----------
    function : callable, optional
        What to compile; without it, a decorator is given back.

    Examples
    --------
    >>> @compiled
    ... def doubled(x):
    ...     return 2 * x
    >>> doubled(2.0)
    4.0
    """
    if function is None:
        return lambda given: compiled(given, **options)
    dispatcher: Any = njit(**options)(function)
    with suppress(RuntimeError):  # numba knows no folder that it could write
        dispatcher._cache = _LenientCache(function)  # as `Dispatcher.enable_caching` does
    return dispatcher
