import os

from gaitdisc.report.side_by_side import drawn_side_by_side


def _where(word):
    return word, os.getpid()


def test_few_are_drawn_here_and_many_elsewhere_in_order(monkeypatch):
    monkeypatch.setattr("gaitdisc.report.side_by_side.os.cpu_count", lambda: 2)
    few = drawn_side_by_side(_where, [("a",), ("b",)], 2)
    assert few == [("a", os.getpid()), ("b", os.getpid())]
    many = drawn_side_by_side(_where, [("a",), ("b",), ("c",)], 2)
    assert [word for word, _ in many] == ["a", "b", "c"] and os.getpid() not in {at for _, at in many}


def test_one_processor_draws_alone(monkeypatch):
    monkeypatch.setattr("gaitdisc.report.side_by_side.MOST_PROCESSES", 1)
    assert {at for _, at in drawn_side_by_side(_where, [(k,) for k in range(4)], 2)} == {os.getpid()}
