"""Numbers by compiled code: numba, its results kept beside the package, in the user's cache, or nowhere."""

import warnings
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

from numba import njit
from numba.core.caching import FunctionCache


class _LenientCache(FunctionCache):
    """Compiled code is kept to save time: where it cannot be kept or is damaged, it is compiled again."""

    def _index_key(self, sig: Any, codegen: Any) -> Any:
        """Numba looks at the function's own file alone; what it calls may lie in another, and is compiled into it."""
        stamps = []
        for function in _with_called(self._py_func, {}):  # file, and the time and size by which a changed one is known
            file = Path(function.__code__.co_filename)
            known = file.stat() if file.is_file() else None
            stamps.append((str(file), known.st_mtime_ns if known else 0, known.st_size if known else 0))
        return (*super()._index_key(sig, codegen), tuple(sorted(stamps)))

    def save_overload(self, sig: Any, data: Any) -> None:
        try:
            super().save_overload(sig, data)
        except OSError as error:
            warnings.warn(
                f"compiled code cannot be cached; the operating system reports: {error.strerror or error}", stacklevel=2
            )

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        try:
            return super().load_overload(sig, target_context)
        except Exception:  # whatever a damaged file of pickled code may raise
            with suppress(OSError):
                self.flush()
            return None


def _with_called(function: Any, functions: dict[Any, None]) -> dict[Any, None]:
    """A function and all compiled functions that it calls, each once."""
    if function is not None and function not in functions:
        functions[function] = None
        for name in function.__code__.co_names:
            _with_called(getattr(function.__globals__.get(name), "py_func", None), functions)
    return functions


def compiled(function: Callable[..., Any] | None = None, **options: Any) -> Any:
    """Compile a function with numba, and keep what was compiled where there is a folder to keep it in.

    The folder is NUMBA_CACHE_DIR, that of the package, or the user's cache. A package that is installed where nobody
    may write, for a user without a home, and a full disk, cost the time to compile once a process and nothing else.

    function: what to compile; without it, a decorator is given back

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
