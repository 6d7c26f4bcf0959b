import os
import signal
import time
from pathlib import Path

import pytest

from gaitdisc.batch.worker_pools import Lost, computed_in_processes


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
    assert list(computed_in_processes(2, Squared(tmp_path), [3, 1, 2])) == [(3, 9), (1, 1), (2, 4)]
    assert list(computed_in_processes(2, Squared(tmp_path), [])) == []


def test_a_process_that_is_killed_once_costs_nothing_but_its_own_time(tmp_path):
    found = list(computed_in_processes(2, Squared(tmp_path, kills=1, wait_s=0.3), [1, 2, 3, 4, 5]))
    assert found == [(1, 1), (2, 4), (3, 9), (4, 16), (5, 25)]
    assert (tmp_path / "killed0").exists()
    assert computed(tmp_path) == dict.fromkeys((1, 2, 3, 4, 5), 1), "somebody else was computed again"


@pytest.mark.parametrize("victim", [1, 3, 5])
def test_a_process_that_is_killed_twice_is_lost_in_words_and_the_others_are_not(tmp_path, victim):
    found = dict(computed_in_processes(2, Squared(tmp_path, victim=victim, kills=9), [1, 2, 3, 4, 5]))
    lost = found.pop(victim)
    assert isinstance(lost, Lost)
    assert (
        "2 times it was killed (SIGKILL)" in lost.reason
        and "run it with --jobs 1, or on a machine with more" in lost.reason
    )
    assert found == {number: number**2 for number in (1, 2, 3, 4, 5) if number != victim}
    assert computed(tmp_path) == dict.fromkeys(found, 1)
    assert len(list(tmp_path.glob("killed*"))) == 2


def too_large(_):
    raise MemoryError


def test_memory_that_runs_out_is_as_a_kill():
    [(_, lost)] = computed_in_processes(1, too_large, [1])
    assert "2 times it ran out of memory" in lost.reason and "; use a machine with more memory." in lost.reason


def wrong(_):
    raise KeyError("a defect")


def test_a_defect_is_not_hidden():
    with pytest.raises(KeyError, match="a defect"):
        list(computed_in_processes(2, wrong, [1, 2]))


class Unreadable:
    """Can be sent to another process, and not be made again there."""

    def __reduce__(self):
        return too_large, ()  # which lacks an argument


def test_what_cannot_be_sent_is_no_kill():
    with pytest.raises(RuntimeError, match="un-serialize"):
        list(computed_in_processes(1, squared_or_killed, [Unreadable()]))


def test_whoever_stops_listening_stops_the_processes(tmp_path):
    units = computed_in_processes(2, Squared(tmp_path, wait_s=1.0), list(range(10)))
    next(units)
    units.close()
    time.sleep(2.5)
    assert len(computed(tmp_path)) <= 4
