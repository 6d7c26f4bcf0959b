import json

import pandas as pd
import pytest
from manufactured_discovery import manufactured

from gaitdisc.errors import WriteError
from gaitdisc.results.discovery_folder import save_discovery
from gaitdisc.results.sealed_json import check_files, read_sealed


def test_json_and_runs_are_written_whole(tmp_path):
    discovery = manufactured()
    path = save_discovery(discovery, tmp_path / "found")
    held = read_sealed(path)
    check_files(path.parent, held.pop("sha256"))
    assert held == json.loads(json.dumps(discovery.to_json()))
    runs = pd.read_csv(path.parent / "held_out.csv")
    assert len(runs) == 800
    assert sorted(file.name for file in path.parent.iterdir()) == ["discovery.json", "held_out.csv"]


def test_the_same_discovery_gives_the_same_bytes(tmp_path):
    first, second = (save_discovery(manufactured(), tmp_path / name) for name in "ab")
    assert first.read_bytes() == second.read_bytes()


def test_a_folder_that_cannot_be_made_is_told(tmp_path):
    (tmp_path / "found").write_text("a file")
    with pytest.raises(WriteError, match=r"held_out.csv is to be written whole"):
        save_discovery(manufactured(), tmp_path / "found")
