"""Files count once they stand still; answers by a clock that the test turns."""

import os
from pathlib import Path
from unittest.mock import patch

import pytest

from gaitdisc.commands.watch import WatchedFolder


class Clock:
    """Time, and what happens to files as it goes by."""

    def __init__(self, *events):
        self.now, self.events = 0.0, dict(events)

    def sleep(self, seconds):
        self.now += seconds
        for at in [at for at in self.events if at <= self.now]:
            self.events.pop(at)()
        if self.now > 100:
            raise KeyboardInterrupt


def written(path, content, time_s=1):
    def write():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
        os.utime(path, ns=(time_s * 10**9, time_s * 10**9))

    return write


def seen(folder, clock, still_s=5.0):
    found = []
    watch, turned = (
        WatchedFolder(folder, folder / "run", still_s),
        {"monotonic": lambda: clock.now, "sleep": clock.sleep},
    )
    with patch.multiple("gaitdisc.commands.watch", **turned), pytest.raises(KeyboardInterrupt):
        for files in watch.changes():
            found.append((clock.now, [file.as_posix() for file in files]))
    return found


def test_a_file_counts_once_it_stands_still_and_not_while_it_is_written(tmp_path):
    one, two = tmp_path / "P01" / "1.c3d", tmp_path / "P01" / "2.c3d"
    written(one, b"whole")()
    pieces = [(10.0 + 4.0 * k, written(two, b"x" * k, k + 1)) for k in range(5)]  # the last at 26 s, the first empty
    found = seen(tmp_path, Clock(*pieces))
    assert [files for _, files in found] == [["P01/1.c3d"], ["P01/1.c3d", "P01/2.c3d"]]
    assert 5.0 <= found[0][0] <= 6.1 and 31.0 <= found[1][0] <= 32.1


def test_a_file_that_is_written_anew_counts_again_and_nothing_meanwhile(tmp_path):
    written(tmp_path / "1.c3d", b"first")()
    events = [(20.0, written(tmp_path / "1.c3d", b"second", 2)), (20.5, written(tmp_path / "2.c3d", b"other")),
              (24.0, written(tmp_path / "1.c3d", b"longer second", 3))]  # fmt: skip
    found = seen(tmp_path, Clock(*events))
    assert [files for _, files in found] == [["1.c3d"], ["1.c3d", "2.c3d"]]
    assert found[1][0] >= 29.0


def test_the_run_and_other_files_are_not_looked_at(tmp_path):
    written(tmp_path / "run" / "cycles.csv", b"a")()
    written(tmp_path / "notes.docx", b"a")()
    assert seen(tmp_path, Clock()) == []
    assert WatchedFolder(Path(tmp_path), tmp_path / "run").settled() == {}
