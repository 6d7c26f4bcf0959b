"""What a model lacks: the model a file or a function; the data a table, a file or recordings."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

import gaitdisc as gd
from gaitdisc.channel import Channel
from gaitdisc.discovery.catalogue import ALL
from gaitdisc.errors import ChannelError, SchemaError, SimulationError
from gaitdisc.library import discovering

TIME = np.arange(0.0, 6.0, 0.1)


def cooling(temperature, rate=0.5):
    return -rate * temperature


def runs():
    return [gd.simulate(cooling, TIME, start=[2.0 - k]) for k in range(2)]


def table():
    return pd.concat([run.to_pandas().reset_index().assign(trial=k) for k, run in enumerate(runs())])


@pytest.fixture
def given(monkeypatch):
    """Instead of the search: what would be searched."""
    seen = {}

    def instead(model, data, request, files):
        seen.update(model=model, data=data, request=request, files={path.name: word for path, word in files.items()})
        request.progress("searching")
        return None, model

    monkeypatch.setattr(discovering, "find_missing", instead)
    return seen


def test_a_table_its_file_and_recordings_are_the_same_trials(given, tmp_path):
    table().to_csv(tmp_path / "runs.csv", index=False)
    several = [run.to_pandas() for run in runs()]
    for data in (
        table(),
        table().set_index("time"),
        several,
        [several[0], several[1].reset_index()],
        tmp_path / "runs.csv",
        str(tmp_path / "runs.csv"),
        runs(),
    ):
        gd.discover(cooling, data)
        np.testing.assert_allclose(given["data"].observed[1, :, 0], np.exp(-0.5 * TIME), atol=1e-6)
        assert given["data"].observed.shape == (2, 60, 1)
    assert given["files"] == {}
    gd.discover(cooling, runs()[0])
    assert given["data"].observed.shape == (1, 60, 1)


def test_files_are_kept_in_what_the_answer_rests_on(given, tmp_path):
    table().to_csv(tmp_path / "runs.csv", index=False)
    decay = gd.Simulation("decay", gd.bundled_simulation("lorenz").states[:1], equations={"x": "-0.5*x"})
    gd.write_simulation(decay, tmp_path / "decay.toml")
    data = table().rename(columns={"temperature": "x"})
    said = []
    gd.discover(tmp_path / "decay.toml", data, progress=said.append)
    assert given["files"] == {"decay.toml": "simulation"} and said == ["searching"]


def test_data_of_no_kind_or_without_a_column_are_refused(given):
    with pytest.raises(SimulationError, match="file or recordings"):
        gd.discover(cooling, 3)  # pyright: ignore[reportArgumentType]
    with pytest.raises(ChannelError, match=r"must have a column 'temperature'.*temprature"):
        gd.discover(cooling, table().rename(columns={"temperature": "temprature"}))


def test_a_signal_without_a_unit_is_taken_as_it_is_and_another_unit_is_converted(given):
    model = gd.simulation_from_function(cooling, {"temperature": "rad"})
    plain = gd.Recording(TIME, np.exp(-TIME)[:, None], (Channel("temperature", "signal", "1"),))
    gd.discover(model, plain)
    np.testing.assert_allclose(given["data"].observed[0, :, 0], np.exp(-TIME))
    degrees = gd.Recording(TIME, np.exp(-TIME)[:, None], (Channel("temperature", "angle", "deg"),))
    gd.discover(model, degrees)
    np.testing.assert_allclose(given["data"].observed[0, :, 0], np.radians(np.exp(-TIME)))


def test_a_tracked_walk_takes_the_file_of_its_angles_and_nothing_else(tracked_walk, monkeypatch):
    with pytest.raises(SchemaError, match=r"walk.toml.*found DataFrame"):
        gd.discover(tracked_walk, table())
    given = {}

    def discover_tracked(*arguments):
        given["walk"], given["kinematics"], given["request"] = arguments
        return SimpleNamespace(found="found", augmented="augmented")

    monkeypatch.setattr("gaitdisc.discovery.discover_tracked.discover_tracked", discover_tracked)
    assert gd.discover(str(tracked_walk), "walk.mot", progress=print) == ("found", "augmented")
    assert (given["kinematics"], given["request"]) == (Path("walk.mot"), ALL)
    assert given["request"].progress is print
    assert given["walk"].model == tracked_walk.parent / "leg.osim" and given["walk"].lowpass_hz == 6.0
