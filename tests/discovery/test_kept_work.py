"""What a stopped search has fitted is used by the same command and by no other; nothing of it stays."""

import pytest

from gaitdisc.discovery.candidate import Candidate
from gaitdisc.discovery.effect_words import named_at
from gaitdisc.discovery.kept_work import keep, kept_work, note_found, recall
from gaitdisc.errors import SchemaError

SPRING = Candidate("missing_physics", "port", "ankle_moment", "one_sided_spring")


def fit(folder, given, stop=None, content="data"):
    """Return the results, which of them were computed, and what was said; stop: raised before the last of these."""
    results, computed, lines = [], [], []
    with kept_work(folder, lines.append):
        recall(content)
        for one in given:
            results.append(recall(repr(one)))
            if results[-1] is None:
                if stop is not None and one == given[-1]:
                    raise stop
                computed.append(one)
                results[-1] = one / 3
                keep(one / 3)
    return results, computed, lines


def stopped(folder, *given, stop=KeyboardInterrupt):
    with pytest.raises(stop):
        fit(folder, given, stop())


def test_the_same_work_continues_where_it_was_stopped_last(tmp_path):
    stopped(tmp_path, 1, 2, 7)
    stopped(tmp_path, 1, 2, 7, 8, stop=SystemExit)
    with pytest.raises(KeyboardInterrupt), kept_work(tmp_path, lambda _: None):
        raise KeyboardInterrupt  # early, with nothing done again
    results, computed, lines = fit(tmp_path, (1, 2, 7, 8))
    assert results == [1 / 3, 2 / 3, 7 / 3, 8 / 3] and computed == [8]
    assert lines == ["continuing an earlier run: 3 fits reused"]
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("changed", ["results before", "content", "versions", "file"])
def test_what_rests_on_something_else_is_computed_again(tmp_path, monkeypatch, changed):
    stopped(tmp_path, 4 if changed == "results before" else 1, 2, 7)
    if changed == "versions":
        monkeypatch.setattr("gaitdisc.discovery.kept_work.list_versions", lambda: {"numpy": "another"})
    if changed == "file":
        (file,) = (tmp_path / "kept").iterdir()
        file.write_text(file.read_text().replace("0.33333", "0.44444"))
    found = fit(tmp_path, (1, 2, 7), content="other data" if changed == "content" else "data")
    assert found == ([1 / 3, 2 / 3, 7 / 3], [1, 2, 7], [])


def test_nothing_stays_behind_a_refusal(tmp_path):
    stopped(tmp_path, 1, 2)
    with pytest.raises(SchemaError):
        fit(tmp_path, (1, 2), SchemaError("a", "b", "c"))
    assert list(tmp_path.iterdir()) == []


def test_whoever_stops_it_reads_what_was_found(tmp_path):
    said = "So far: one-sided spring at the ankle_moment port; "
    with pytest.raises(KeyboardInterrupt, match=said), kept_work(tmp_path, lambda _: None):
        note_found(named_at(SPRING))
        raise KeyboardInterrupt


def test_without_a_folder_nothing_is_kept():
    note_found(named_at(SPRING))
    keep(1)
    assert recall("a") is None
