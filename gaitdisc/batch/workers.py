"""Where participants are computed: in this process, in processes beside it, or on a cluster."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeVar

from gaitdisc.batch.worker_pools import Lost, computed_in_processes
from gaitdisc.errors import GaitdiscError
from gaitdisc.ingest.study import Participant
from gaitdisc.results import Refusal

StudyProgress = Callable[[str, float], None]
Unit = TypeVar("Unit")
Person = TypeVar("Person")
CONNECT_S = 20.0


class ClusterError(GaitdiscError):
    """A cluster cannot be reached or used."""


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


def computed_units(
    workers: Workers,
    compute: Callable[..., Unit],
    people: Sequence[Participant],
    progress: StudyProgress,
    lost: Callable[[Refusal], Unit],
) -> Iterator[Unit]:
    """Compute one unit a participant where it shall be done, in order.

    A process beside this one that is killed costs its own participant's time: that participant is tried once more, and
    if its process is killed again, refused.

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
    for person, unit in computed_side_by_side(workers, partial(_without_progress, compute), people):
        progress(person.id, 1.0)
        yield lost(Refusal(person.id, "", unit.reason)) if isinstance(unit, Lost) else unit


def _without_progress(compute: Callable[..., Unit], person: Participant) -> Unit:
    return compute(participant=person, progress=_nobody)


def _nobody(_fraction: float) -> None:
    """Progress within a participant does not cross the border of a process."""


def computed_side_by_side(
    workers: Workers, compute: Callable[[Person], Unit], people: Sequence[Person]
) -> Iterator[tuple[Person, Unit | Lost]]:
    """Compute one unit a person on other processes or machines, and give them back in order as they are ready.

    A worker that dies is replaced by another: its person is computed again.

    returns (person, unit): `Lost` in the place of a unit whose process on this machine was killed each time
    """
    if not workers.cluster:
        yield from computed_in_processes(workers.jobs, compute, people)
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
            "a cluster needs the extra 'cluster' (dask.distributed)",
            "it is not installed here",
            "Install gaitdisc[cluster], or leave --cluster out.",
        ) from error
    from joblib import parallel_config

    try:
        client = Client(address, timeout=CONNECT_S)
    except (OSError, ValueError) as error:
        raise ClusterError(
            "a cluster needs a Dask scheduler that answers",
            f"{address}: {str(error)[:200] or type(error).__name__}",
            "Start one with `dask scheduler`, correct the address, or leave --cluster out.",
        ) from error
    try:
        with parallel_config(backend="dask"):
            yield
    finally:
        client.close()
