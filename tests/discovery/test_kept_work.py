"""What a stopped search has fitted is used by the same command and by no other; nothing of it stays."""

import pytest

from gaitdisc.discovery.candidate import Candidate
from gaitdisc.discovery.kept_work import kept, kept_work, note_found, rest_on
from gaitdisc.errors import SchemaError

SPRING = Candidate("missing_physics", "port", "ankle_moment", "one_sided_spring")


def fit(folder, given, stop=None, content="data"):
    """Return the results, which were computed and not read, and what was said; stop: raised before the last result."""
    computed, lines = [], []

    def compute(number):
        if stop is not None and number == given[-1]:
            raise stop
        computed.append(number)
        return number / 3

    with kept_work(folder, lines.append):
        rest_on(content)
        results = [kept((repr(one),), lambda one=one: compute(one), lambda found: [found], sum) for one in given]
    return results, computed, lines


def stopped(folder, given, **more):
    with pytest.raises(KeyboardInterrupt):
        fit(folder, given, KeyboardInterrupt(), **more)


def test_the_same_work_continues_where_it_was_stopped(tmp_path):
    stopped(tmp_path, (1, 2, 7))
    stopped(tmp_path, (1, 2, 7, 8))
    results, computed, lines = fit(tmp_path, (1, 2, 7, 8))
    assert results == [1 / 3, 2 / 3, 7 / 3, 8 / 3] and computed == [8]
    assert lines == ["continuing an earlier run: 3 fits kept"]
    assert list(tmp_path.iterdir()) == []


def test_a_run_that_is_stopped_early_keeps_what_an_earlier_one_had(tmp_path):
    stopped(tmp_path, (1, 2, 7, 8))
    with pytest.raises(KeyboardInterrupt), kept_work(tmp_path, lambda _: None):
        raise KeyboardInterrupt
    assert fit(tmp_path, (1, 2, 7, 8))[1] == [8]


@pytest.mark.parametrize("changed", [{"given": (1, 2, 7)}, {"content": "other data"}])
def test_what_rests_on_something_else_is_computed_again(tmp_path, changed):
    stopped(tmp_path, (5, 2, 7))
    given = changed.pop("given", (5, 2, 7))
    assert fit(tmp_path, given, **changed)[1:] == ([*given], [])


def test_other_versions_begin_anew(tmp_path, monkeypatch):
    stopped(tmp_path, (1, 2))
    monkeypatch.setattr("gaitdisc.discovery.kept_work.installed_versions", lambda: {"numpy": "another"})
    assert fit(tmp_path, (1, 2))[1] == [1, 2]


def test_a_changed_file_is_not_used(tmp_path):
    stopped(tmp_path, (1, 2))
    (file,) = (tmp_path / "kept").iterdir()
    file.write_text(file.read_text().replace("0.33333", "0.44444"))
    assert fit(tmp_path, (1, 2))[0] == [1 / 3, 2 / 3]


def test_nothing_stays_behind_a_refusal(tmp_path):
    stopped(tmp_path, (1, 2))
    with pytest.raises(SchemaError):
        fit(tmp_path, (1, 2), SchemaError("a", "b", "c"))
    assert list(tmp_path.iterdir()) == []


def test_whoever_stops_it_reads_what_was_found(tmp_path):
    said = "So far: one-sided spring at the ankle_moment port; "
    with pytest.raises(KeyboardInterrupt, match=said), kept_work(tmp_path, lambda _: None):
        note_found([SPRING])
        raise KeyboardInterrupt


def test_where_nothing_is_kept_everything_is_computed():
    note_found([SPRING])
    assert kept(("a",), lambda: 1, lambda _: pytest.fail("written"), lambda _: pytest.fail("read")) == 1
