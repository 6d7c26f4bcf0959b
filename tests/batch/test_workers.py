import os
import signal
import time
from pathlib import Path

import pytest

from gaitdisc.batch.workers import ClusterError, Workers, computed_side_by_side, computed_units

distributed = pytest.importorskip("distributed", reason="the extra 'cluster' is not installed")


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


def test_processes_beside_this_one_keep_the_order():
    assert list(computed_side_by_side(Workers(jobs=2), squared, [3, 1, 2])) == [(3, 9), (1, 1), (2, 4)]


@pytest.mark.parametrize("jobs", [1, 2])
def test_units_come_in_order_and_everybody_is_reported(study, jobs):
    shares = []
    found = computed_units(
        Workers(jobs=jobs), named_after_half, study.participants, lambda who, share: shares.append((who, share)), str
    )
    assert list(found) == ["P01", "P02"]
    halves = [("P01", 0.5), ("P01", 1.0), ("P02", 0.5), ("P02", 1.0)]
    assert shares == (halves if jobs == 1 else halves[1::2])


def killed_for_the_second(*, participant, progress):
    if participant.id == "P02":
        os.kill(os.getpid(), signal.SIGKILL)
    return participant.id


def test_a_participant_whose_process_is_killed_is_refused(study):
    found = computed_units(
        Workers(jobs=2), killed_for_the_second, study.participants, lambda *_: None, lambda lost: lost
    )
    first, second = found
    assert first == "P01"
    assert (second.participant, second.condition) == ("P02", "")
    assert "2 times it was killed (SIGKILL)" in second.reason


def test_a_worker_that_is_killed_in_the_middle_costs_nothing(cluster, tmp_path):
    from functools import partial

    found = list(computed_side_by_side(Workers(cluster=cluster), partial(dies_once, str(tmp_path)), [1, 2, 3, 4]))
    assert found == [(1, 1), (2, 4), (3, 9), (4, 16)]
    assert (tmp_path / "died").exists()


@pytest.mark.slow
def test_a_cluster_gives_the_same_tables(cluster, study, tmp_path):
    import pandas as pd  # here, for every process beside this one imports this module

    from gaitdisc.batch.run_study import run_study

    here = run_study(study, tmp_path / "here")
    there = run_study(study, tmp_path / "there", Workers(cluster=cluster))
    pd.testing.assert_frame_equal(there.r2_table(), here.r2_table(), check_dtype=False)


def test_a_scheduler_that_does_not_answer(monkeypatch):
    monkeypatch.setattr("gaitdisc.batch.workers.CONNECT_S", 0.5)
    with pytest.raises(ClusterError, match=r"tcp://127.0.0.1:9.*leave --cluster out"):
        list(computed_side_by_side(Workers(cluster="tcp://127.0.0.1:9"), squared, [1]))
