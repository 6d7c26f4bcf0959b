import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from hidden_in_a_function import tank, write_record
from hidden_in_a_mass import MASS, Experiment, record, with_load
from made_simulation import system
from manufactured_discovery import manufactured

import gaitdisc as gd
from gaitdisc.discovery.catalogue import Request
from gaitdisc.discovery.discover_files import discover_files, seal
from gaitdisc.discovery.folder import save_discovery
from gaitdisc.discovery.page import write_discovery_report
from gaitdisc.errors import SamplingError, SchemaError
from gaitdisc.recording import Finding
from gaitdisc.regular_file import file_sha256
from gaitdisc.simulation.parts import Term
from gaitdisc.simulation.writing import read_into, write_simulation


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("mass")
    (folder / "mass.toml").write_text(MASS.replace('unit = "N s/m"', 'unit = "N"'))
    measured = record(with_load("-14*x**3"), 3, Experiment(seconds=10.0))
    rows = ["trial,time,push,x"]
    for trial, name in enumerate(measured.trials):
        columns = (measured.time(trial), measured.drive.inputs[trial, :, 0], measured.observed[trial, :, 0])
        rows += [f"{name},{t:.3f},{push:.6g},{x:.6g}" for t, push, x in zip(*columns, strict=True)]
    (folder / "walk.csv").write_text("\n".join(rows) + "\n")
    return folder


def test_the_answer_carries_what_it_rests_on(files):
    steps = []
    found, augmented = discover_files(files / "mass.toml", files / "walk.csv", Request(progress=steps.append))
    assert steps[0] == "reading mass.toml and walk.csv"
    assert found.provenance is not None
    called = {"simulation": "mass.toml", "measured table": "walk.csv"}
    assert found.provenance.files == {role: file_sha256(files / name) for role, name in called.items()}
    assert any(one.kind == "unit" for one in found.findings)
    assert found.runs.names == ("1", "2", "3", "4")
    (term,) = augmented.effects
    assert (term.place, term.name) == ("load", "cubic_stiffness")


def test_names_of_people_are_hidden_in_what_is_written_and_held_by_python(tmp_path, unpainted):
    """A trial may have the name of whoever walked it."""
    data = SimpleNamespace(trials=("Otto", "1", "2", "Erika"), rate=100.0, channels=("x",))
    seen = Finding("warning", "odd trial", "walk.csv", "trial 'Erika' is late", "", "x")
    found = manufactured(sentence="Erika is late.", findings=(seen, Finding("note", "limit", "model", "knee", "")))
    size, runs = replace(found.held_out, of="trial Erika"), replace(found.runs, names=data.trials)
    found = replace(found, held_out=size, runs=runs)
    held = seal(found, system({"x": "-x"}), data, {})
    assert (held.sentence, held.runs.names, held.findings) == ("Erika is late.", data.trials, found.findings)
    save_discovery(held, tmp_path)
    text = (tmp_path / "discovery.json").read_text() + (tmp_path / "held_out.csv").read_text()
    assert "Erika" not in text and "trial 'trial 4' is late" in text and '"knee"' in text
    assert "Erika" not in write_discovery_report(held, tmp_path).read_text()


def test_a_catalogue_is_read_before_anything_is_computed(files):
    (files / "mine.toml").write_text('[[shape]]\nname = "mine"\npieces = ["q**2"]\n')
    with pytest.raises(SchemaError, match=r"mine.toml.*1.*'q\*\*2'.*'q'"):
        Request.read(files / "mine.toml")


def with_leak(term: str):
    return lambda model: model.with_effect(Term("leak", "port", "hidden", term))


BUMPS = "1.2*exp(-((level - 0.2)/0.12)**2) - 1.2*exp(-((level + 0.3)/0.12)**2)"
QUICK = ("no_gap", "wrong_initial_condition", "missing_physics")  # the others take the same way
HIDDEN = {
    "no_gap": {},
    "wrong_initial_condition": {},
    "missing_physics": {"change": with_leak("-0.4*level**2")},
    "wrong_parameter": {"change": lambda model: model.with_values({"drain": 1.5})},
    "sensor_error": {"change": lambda model: model.with_observation("level", "level + 0.2")},
    "input_error": {"change": lambda model: model.with_input("pump", "delay(pump, 0.15)")},
    "unnamed": {"change": with_leak(BUMPS)},
}


@pytest.mark.usefixtures("unpainted")
@pytest.mark.parametrize("verdict", [pytest.param(v, marks=() if v in QUICK else pytest.mark.slow) for v in HIDDEN])
def test_a_simulation_that_is_a_function_goes_all_the_way(tmp_path, verdict):
    model = tank(initial=3.0 if verdict == "wrong_initial_condition" else None)
    measured = write_record(tmp_path / "tank.csv", seed=1, **HIDDEN[verdict])
    found, augmented = gd.discover(model, measured)
    assert found.verdict == verdict
    assert found.provenance is not None and list(found.provenance.files) == ["measured table"]

    out = tmp_path / "found"
    read = read_into(model, write_simulation(augmented, out / "augmented.toml"))
    assert (read.parts, read.replaced) == (augmented.parts, augmented.replaced)
    assert json.loads(save_discovery(found, out).read_text())["verdict"] == verdict
    assert found.sentence.split(" ")[0] in write_discovery_report(found, out).read_text()
    if verdict == "missing_physics":
        assert [(one.place, one.name) for one in read.effects] == [("leak", "quadratic_stiffness")]
    if verdict == "wrong_parameter":
        assert read.values()["drain"] == pytest.approx(1.5, rel=0.01)
    if verdict == "wrong_initial_condition":
        assert read.states[0].initial is not None and 0.2 < read.states[0].initial < 0.6
    if verdict == "input_error":
        assert read.replaced[0][1].startswith("delay(pump, 0.1")


@pytest.mark.slow
def test_milliseconds_whose_slopes_overflow_are_refused_in_words(tmp_path):
    """A pendulum that swings three times in a sample of 10 s: numpy said "SVD did not converge"."""
    write_simulation(system({"x": "v", "v": "-k*sin(x)"}, parameters={"k": 9.8}), tmp_path / "pendulum.toml")
    t, rng = np.arange(0, 8, 0.01), np.random.default_rng(0)
    x = 0.5 * np.sin(3 * t) * np.exp(-0.05 * t) + 1e-3 * rng.normal(size=len(t))
    table = pd.DataFrame({"trial": (t >= 4).astype(int), "time": 1000 * t, "x": x, "v": np.gradient(x, t)})
    table.to_csv(tmp_path / "walk.csv", index=False)
    with pytest.raises(SamplingError, match=r"10 s.*times in seconds, not"):
        discover_files(tmp_path / "pendulum.toml", tmp_path / "walk.csv")
