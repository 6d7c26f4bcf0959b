"""Processes side by side, each alone in its pool: one that is killed takes nobody's work with it but its own."""

from __future__ import annotations

import os
import re
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from joblib.externals.loky import ProcessPoolExecutor

Unit = TypeVar("Unit")
Person = TypeVar("Person")
TRIES = 2
IDLE_S = 60.0  # after which a process without work ends, also when whoever started it was killed
ONE_THREAD = dict.fromkeys(
    (
        "OMP_NUM_THREADS",
        "OPENBLAS_NUM_THREADS",
        "MKL_NUM_THREADS",
        "BLIS_NUM_THREADS",
        "VECLIB_MAXIMUM_THREADS",
        "NUMBA_NUM_THREADS",
        "NUMEXPR_NUM_THREADS",
    ),
    "1",
)


@dataclass(frozen=True)
class Lost:
    """In the place of a unit: whoever computed it was killed, each time it was tried."""

    reason: str  # what happened and what to do, as a sentence


def computed_in_processes(
    jobs: int, compute: Callable[[Person], Unit], people: Sequence[Person]
) -> Iterator[tuple[Person, Unit | Lost]]:
    """Compute one unit a person in processes of one thread each, and give them back in order as they are ready.

    A process that is killed, or that runs out of memory, is replaced, and its person is tried once more.

    returns (person, unit): `Lost` in the place of a unit that could not be computed
    """
    from joblib.externals.loky.process_executor import TerminatedWorkerError

    waiting, tries = list(range(len(people)))[::-1], Counter[int]()
    free = [_pool() for _ in range(min(jobs, len(people)))]
    working: dict[Future[Unit], tuple[int, ProcessPoolExecutor]] = {}
    done: dict[int, Unit | Lost] = {}
    given = 0
    try:
        while given < len(people):
            while free and waiting:
                number, pool = waiting.pop(), free.pop()
                future, pool = _begun(pool, compute, people[number])
                working[future] = number, pool
            for future in wait(working, return_when=FIRST_COMPLETED).done:
                number, pool = working.pop(future)
                try:
                    done[number] = future.result()
                except (TerminatedWorkerError, MemoryError) as error:
                    pool.shutdown(wait=False, kill_workers=True)
                    pool = _pool()
                    tries[number] += 1
                    if tries[number] < TRIES:
                        waiting.append(number)
                    else:
                        done[number] = Lost(_reason(error, jobs))
                free.append(pool)
            while given in done:
                yield people[given], done.pop(given)
                given += 1
    finally:
        for pool in (*free, *(pool for _, pool in working.values())):
            pool.shutdown(wait=False, kill_workers=True)


def _pool() -> ProcessPoolExecutor:
    from joblib.externals.loky import ProcessPoolExecutor

    return ProcessPoolExecutor(max_workers=1, timeout=IDLE_S, env=ONE_THREAD)


def _begun(
    pool: ProcessPoolExecutor, compute: Callable[[Person], Unit], person: Person
) -> tuple[Future[Any], ProcessPoolExecutor]:
    """Work that has begun, and the pool that does it: another one where the process was killed while it had no work."""
    try:
        return pool.submit(compute, person), pool
    except BrokenProcessPool:
        pool.shutdown(wait=False, kill_workers=True)
        pool = _pool()
        return pool.submit(compute, person), pool


def _reason(error: BaseException, jobs: int) -> str:
    signals = re.search(r"\{(\w+)", str(error))
    what = "ran out of memory" if isinstance(error, MemoryError) else f"was killed ({signals[1] if signals else '?'})"
    fewer = f"run it with --jobs {jobs - 1}, or on" if jobs > 1 else "use"
    return (
        f"a participant needs a process that lives until its unit is computed; {TRIES} times it {what}, as where "
        f"memory runs out (this machine has {_memory()}). What others have is kept; {fewer} a machine with more memory."
    )


def _memory() -> str:
    try:
        return f"{os.sysconf('SC_PAGE_SIZE') * os.sysconf('SC_PHYS_PAGES') / 2**30:.0f} GiB"
    except (AttributeError, OSError, ValueError):
        return "an unknown amount"
