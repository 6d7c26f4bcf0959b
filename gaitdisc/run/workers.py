"""Where participants are computed: in this process, in processes beside it, or on a cluster."""

from __future__ import annotations

import os
import re
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, TypeVar

from gaitdisc.errors import GaitdiscError
from gaitdisc.ingest.study import Participant
from gaitdisc.saved.provenance import Refusal

if TYPE_CHECKING:
    from joblib.externals.loky import ProcessPoolExecutor

StudyProgress = Callable[[str, float], None]
Unit = TypeVar("Unit")
Person = TypeVar("Person")
CONNECT_S = 20.0
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


class ClusterError(GaitdiscError):
    """A cluster of computers cannot be reached or used."""


@dataclass(frozen=True)
class Lost:
    """In the place of a unit: whoever computed it was killed, each time it was tried."""

    reason: str  # what happened and what to do, as a sentence


@dataclass(frozen=True)
class Workers:
    """Where to compute."""

    jobs: int = 1  # processes side by side, each with one thread; 1 works in this process
    # address of a Dask scheduler, `tcp://host:8786`; empty for this machine. Its workers need the package, the same
    # version, and the study's folders at the same paths
    cluster: str = ""

    @property
    def here(self) -> bool:
        """Whether everything is done in this process, where progress within a participant can be reported."""
        return self.jobs == 1 and not self.cluster


def compute_units(
    workers: Workers,
    compute: Callable[..., Unit],
    people: Sequence[Participant],
    progress: StudyProgress,
    lost: Callable[[Refusal], Unit],
) -> Iterator[Unit]:
    """Compute one unit a participant where it shall be done, in order.

    compute: takes `participant` and `progress`, which is called with the fraction done; can be sent to another process
    progress: called with a participant's pseudonym and the fraction done; progress within a participant is reported
        only where everything is done in this process
    lost: makes the unit of a participant whose process was killed each time; takes the refusal
    """
    if workers.here:
        for person in people:
            yield compute(participant=person, progress=partial(progress, person.id))
            progress(person.id, 1.0)
        return
    for person, unit in compute_side_by_side(workers, partial(_without_progress, compute), people):
        progress(person.id, 1.0)
        yield lost(Refusal(person.id, "", unit.reason)) if isinstance(unit, Lost) else unit


def _without_progress(compute: Callable[..., Unit], person: Participant) -> Unit:
    """A unit; progress within a participant does not cross the border of a process."""
    return compute(participant=person, progress=lambda _: None)


def compute_side_by_side(
    workers: Workers, compute: Callable[[Person], Unit], people: Sequence[Person]
) -> Iterator[tuple[Person, Unit | Lost]]:
    """Compute one unit a person on other processes or machines, and give them back in order as they are ready.

    returns (person, unit): `Lost` in the place of a unit whose process on this machine was killed each time
    """
    if not workers.cluster:
        yield from compute_in_processes(workers.jobs, compute, people)
        return
    from joblib import Parallel, delayed

    with _cluster(workers.cluster):
        results: Any = Parallel(n_jobs=-1, return_as="generator")(delayed(compute)(person) for person in people)
        yield from zip(people, results, strict=True)


@contextmanager
def _cluster(address: str) -> Iterator[None]:
    try:
        from distributed import Client
    except ImportError as error:
        raise ClusterError(
            "a cluster requires the extra 'cluster' (dask.distributed)",
            "it is not installed",
            "Install gaitdisc[cluster], or omit --cluster.",
        ) from error
    from joblib import parallel_config

    try:
        client = Client(address, timeout=CONNECT_S)
    except (OSError, ValueError) as error:
        raise ClusterError(
            "a Dask scheduler must respond at the address of --cluster",
            f"{address}: {str(error)[:200] or type(error).__name__}",
            "Start a scheduler with `dask scheduler`, correct the address, or omit --cluster.",
        ) from error
    try:
        with parallel_config(backend="dask"):
            yield
    finally:
        client.close()


def compute_in_processes(
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
    n_yielded = 0
    try:
        while n_yielded < len(people):
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
            while n_yielded in done:
                yield people[n_yielded], done.pop(n_yielded)
                n_yielded += 1
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
    fewer = f"Run the command with --jobs {jobs - 1}, or on" if jobs > 1 else "Use"
    memory = "an unknown amount"
    with suppress(AttributeError, OSError, ValueError):
        memory = f"{os.sysconf('SC_PAGE_SIZE') * os.sysconf('SC_PHYS_PAGES') / 2**30:.0f} GiB"
    return (
        f"The process of a participant {what} {TRIES} times, probably because this machine has too little memory "
        f"({memory}). Results of the other participants are kept. {fewer} a machine with more memory."
    )
