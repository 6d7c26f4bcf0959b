import json
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from manufactured_discovery import manufactured

from gaitdisc.discovery.folder import load_discovery, save_discovery
from gaitdisc.discovery.result import Correction, Estimate, FoundEffect
from gaitdisc.errors import WriteError
from gaitdisc.saved.unit_folder import check_files, read_sealed


def test_json_and_runs_are_written_whole(tmp_path):
    discovery = manufactured()
    path = save_discovery(discovery, tmp_path / "found")
    held = read_sealed(path)
    check_files(path.parent, held.pop("sha256"))
    assert held.pop("format") == 1
    assert held == json.loads(json.dumps(discovery.to_json()))
    runs = pd.read_csv(path.parent / "held_out.csv")
    assert len(runs) == 800
    assert sorted(file.name for file in path.parent.iterdir()) == ["discovery.json", "held_out.csv"]


def test_the_same_discovery_gives_the_same_bytes(tmp_path):
    first, second = (save_discovery(manufactured(), tmp_path / name) for name in "ab")
    assert first.read_bytes() == second.read_bytes()


def test_a_folder_that_cannot_be_made_is_reported(tmp_path):
    (tmp_path / "found").write_text("a file")
    with pytest.raises(WriteError, match=r"held_out.csv.*cannot be written"):
        save_discovery(manufactured(), tmp_path / "found")


def test_every_part_of_a_discovery_comes_back(tmp_path):
    inf = float("inf")
    wrong = FoundEffect("parameter", "mass", "changed", "", {"mass": Estimate(2.0, 1.9, 2.1, "kg")}, 0.4, 9.0,
                        bounds=(-inf, 3.0), states={"z": "-z"})  # fmt: skip
    read = FoundEffect("port", "load", "unnamed", "-14.02*(x**3)", held_out=0.4, bic=9.0, reads_as="-14*(x**3)",
                       reads_as_effect="cubic_stiffness")  # fmt: skip
    nameless = replace(read, term="-8.0725*(x**2*v)", reads_as="-8.07*(x**2*v)", reads_as_effect="")
    moved = (Correction("mass", 1.5, Estimate(2.0, 1.9, 2.1, "kg")),)
    beside = {"Nominal": 21.4, "Exo": 4.8}
    discovery = manufactured(effects=(wrong, read, nameless), corrections=moved, beside=beside)
    save_discovery(discovery, tmp_path)
    again = load_discovery(tmp_path)
    assert (again.effects, again.corrections) == (discovery.effects, discovery.corrections)
    assert (again.held_out, again.channels, again.units) == (discovery.held_out, discovery.channels, discovery.units)
    assert (again.provenance, again.beside) == (discovery.provenance, beside)
    runs = again.runs
    np.testing.assert_allclose(runs.measured, discovery.runs.measured, rtol=1e-7)
    assert [runs.names[trial] for trial in runs.trial] == ["d", "d"]


def test_runs_of_unequal_length_and_trials_called_like_numbers_come_back(tmp_path):
    whole = manufactured()
    seen = whole.runs.measured.copy()
    seen[1, 250:] = np.nan
    runs = replace(whole.runs, trial=np.array([0, 1]), measured=seen, names=("007", "7"), phase=np.empty((0, 0)))
    save_discovery(manufactured(runs=runs), tmp_path)
    again = load_discovery(tmp_path).runs
    assert again.names == ("007", "7") and again.phase.size == 0
    assert np.isfinite(again.measured[:, :, 0]).sum(axis=1).tolist() == [400, 250]
    np.testing.assert_allclose(again.augmented[0], whole.runs.augmented[0], rtol=1e-7)
