import os
import signal
import time
from pathlib import Path

import pytest
from texts import says

from gaitdisc.run.workers import ClusterError, Lost, Workers, compute_in_processes, compute_side_by_side, compute_units

WITHOUT_CLUSTER = "the extra 'cluster' is not installed"


def squared(number):
    return number * number


def named_after_half(*, participant, progress):
    progress(0.5)
    return participant.id


def dies_once(folder, number):
    """Kill the worker process at the first call for 3, as a power cut would."""
    sign = Path(folder) / "died"
    if number == 3 and not sign.exists():
        sign.write_text("")
        time.sleep(0.2)
        os._exit(1)
    return number * number


@pytest.fixture(scope="module")
def cluster():
    distributed = pytest.importorskip("distributed", reason=WITHOUT_CLUSTER)
    settings = {"distributed.scheduler.allowed-failures": 5, "distributed.worker.daemon": True}
    import dask

    with (
        dask.config.set(settings),
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as local,
    ):
        yield local.scheduler_address


def test_here_is_one_process():
    assert Workers().here
    assert not Workers(jobs=2).here
    assert not Workers(cluster="tcp://somewhere:8786").here


@pytest.mark.parametrize("jobs", [1, 2])
def test_units_come_in_order_and_everybody_is_reported(study, jobs):
    shares = []
    found = compute_units(
        Workers(jobs=jobs), named_after_half, study.participants, lambda who, share: shares.append((who, share)), str
    )
    assert list(found) == ["P01", "P02"]
    halves = [("P01", 0.5), ("P01", 1.0), ("P02", 0.5), ("P02", 1.0)]
    assert shares == (halves if jobs == 1 else halves[1::2])


def test_a_participant_whose_process_is_killed_is_refused(study, monkeypatch):
    """Two are killed below, and the words of their loss are those of the refusal."""
    given = lambda _, __, people: zip(people, ("P01", Lost("killed")), strict=True)  # noqa: E731
    monkeypatch.setattr("gaitdisc.run.workers.compute_in_processes", given)
    first, second = compute_units(Workers(jobs=2), None, study.participants, lambda *_: None, lambda lost: lost)
    assert first == "P01"
    assert (second.participant, second.condition, second.reason) == ("P02", "", "killed")


def test_a_cluster_computes_every_unit():
    distributed = pytest.importorskip("distributed", reason=WITHOUT_CLUSTER)
    with distributed.LocalCluster(n_workers=1, processes=False, dashboard_address=None) as here:
        found = list(compute_side_by_side(Workers(cluster=here.scheduler_address), squared, [3, 1, 2]))
    assert found == [(3, 9), (1, 1), (2, 4)]


@pytest.mark.slow
def test_a_worker_that_is_killed_in_the_middle_costs_nothing(cluster, tmp_path):
    from functools import partial

    found = list(compute_side_by_side(Workers(cluster=cluster), partial(dies_once, str(tmp_path)), [1, 2, 3, 4]))
    assert found == [(1, 1), (2, 4), (3, 9), (4, 16)]
    assert (tmp_path / "died").exists()


@pytest.mark.slow
def test_a_cluster_gives_the_same_tables(cluster, study, tmp_path):
    import pandas as pd  # here, for every process beside this one imports this module

    from gaitdisc.run.run_study import run_study

    here = run_study(study, tmp_path / "here")
    there = run_study(study, tmp_path / "there", Workers(cluster=cluster))
    pd.testing.assert_frame_equal(there.r2_table(), here.r2_table(), check_dtype=False)


def test_a_scheduler_that_does_not_answer(monkeypatch):
    pytest.importorskip("distributed", reason=WITHOUT_CLUSTER)
    monkeypatch.setattr("gaitdisc.run.workers.CONNECT_S", 0.5)
    with pytest.raises(ClusterError, match=r"tcp://127.0.0.1:9.*omit --cluster"):
        list(compute_side_by_side(Workers(cluster="tcp://127.0.0.1:9"), squared, [1]))


def squared_or_killed(number, folder="", victim=3, kills=0, wait_s=0.0):
    """Square; the process of the victim is killed so many times, in the middle of its work, as the kernel does."""
    place = Path(folder)
    signs = list(place.glob("killed*"))
    if number == victim and len(signs) < kills:
        (place / f"killed{len(signs)}").touch()
        os.kill(os.getpid(), signal.SIGKILL)
    (place / f"computed{number}-{time.monotonic_ns()}").touch()
    time.sleep(wait_s)
    return number * number


class Squared:
    def __init__(self, folder, **how):
        self.how = {"folder": str(folder), **how}

    def __call__(self, number):
        return squared_or_killed(number, **self.how)


def computed(folder):
    """How often each number was computed."""
    numbers = [int(path.name.removeprefix("computed").split("-")[0]) for path in folder.glob("computed*")]
    return {number: numbers.count(number) for number in numbers}


def test_units_come_in_order(tmp_path):
    assert list(compute_in_processes(2, Squared(tmp_path), [3, 1, 2])) == [(3, 9), (1, 1), (2, 4)]
    assert list(compute_in_processes(2, Squared(tmp_path), [])) == []


def test_a_process_that_is_killed_once_costs_nothing_but_its_own_time(tmp_path):
    found = list(compute_in_processes(2, Squared(tmp_path, kills=1, wait_s=0.3), [1, 2, 3, 4, 5]))
    assert found == [(1, 1), (2, 4), (3, 9), (4, 16), (5, 25)]
    assert (tmp_path / "killed0").exists()
    assert computed(tmp_path) == dict.fromkeys((1, 2, 3, 4, 5), 1), "somebody else was computed again"


@pytest.mark.parametrize("victim", [1, *(pytest.param(one, marks=pytest.mark.slow) for one in (3, 5))])
def test_a_process_that_is_killed_twice_is_lost_in_words_and_the_others_are_not(tmp_path, victim):
    found = dict(compute_in_processes(2, Squared(tmp_path, victim=victim, kills=9), [1, 2, 3, 4, 5]))
    lost = found.pop(victim)
    assert isinstance(lost, Lost)
    assert says(lost.reason, "(SIGKILL)", "2 times") and says(lost.reason, "--jobs 1", "more")
    assert found == {number: number**2 for number in (1, 2, 3, 4, 5) if number != victim}
    assert computed(tmp_path) == dict.fromkeys(found, 1)
    assert len(list(tmp_path.glob("killed*"))) == 2


def too_large(_):
    raise MemoryError


def test_memory_that_runs_out_is_as_a_kill():
    [(_, lost)] = compute_in_processes(1, too_large, [1])
    assert says(lost.reason, "2 times", "memory") and says(lost.reason, "Use a machine", "more")


def wrong(_):
    raise KeyError("a defect")


def test_a_defect_is_not_hidden():
    with pytest.raises(KeyError, match="a defect"):
        list(compute_in_processes(2, wrong, [1, 2]))


class Unreadable:
    """Can be sent to another process, and not be made again there."""

    def __reduce__(self):
        return too_large, ()  # which lacks an argument


def test_what_cannot_be_sent_is_no_kill():
    with pytest.raises(RuntimeError, match="un-serialize"):
        list(compute_in_processes(1, squared_or_killed, [Unreadable()]))


@pytest.mark.slow
def test_whoever_stops_listening_stops_the_processes(tmp_path):
    units = compute_in_processes(2, Squared(tmp_path, wait_s=1.0), list(range(10)))
    next(units)
    units.close()
    time.sleep(2.5)
    assert len(computed(tmp_path)) <= 4
