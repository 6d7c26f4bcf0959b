import numpy as np
import pytest
from driven_walker import DrivenWalker
from typer.testing import CliRunner

from gaitdisc.channel import Channel
from gaitdisc.cli import app
from gaitdisc.ingest.storage import write_storage
from gaitdisc.recording import Samples
from gaitdisc.sensing.model_folder import SensingModel, save_model
from gaitdisc.sensing.reconstructor import Sensing, fit_reconstructor
from gaitdisc.sensing.windows import Lags


def test_export_brings_streams_to_one_time_base(tmp_path, called):
    trial = DrivenWalker("A", seed=8).walked(10.0, "natural")
    for key in ("kinematics", "forces"):
        write_storage(trial.stream(key), tmp_path / f"{key}.mot")
    done = called("export", tmp_path / "kinematics.mot", tmp_path / "forces.mot", "--out", tmp_path / "both.csv")
    assert done.returncode == 0, done.stderr
    assert "12 channels, 1000 samples at 100 Hz" in done.stdout
    assert called("check", tmp_path / "both.csv").returncode == 0


def test_a_saved_model_as_onnx(tmp_path):
    pytest.importorskip("onnx")
    time = np.arange(400) / 100
    x, y = np.sin(time)[:, None], np.cos(time)[:, None]
    samples = Samples(x, y, ("a",), ("b",), time, time)
    what = Sensing(("a",), ("b",), Lags(1, 1), 100.0)
    done = fit_reconstructor("delay ridge", what, samples.rows(slice(0, 300)), samples.rows(slice(300, None)))
    channels = Channel("a", "angle", "deg"), Channel("b", "angle", "deg")
    save_model(SensingModel(done, channels, np.ones(1)), tmp_path / "model")
    run = CliRunner().invoke(app, ["export", str(tmp_path / "model"), "--out", str(tmp_path / "model.onnx")])
    assert run.exit_code == 0, run.output
    assert "delay ridge, a to 1 states" in run.stdout
    assert (tmp_path / "model.onnx").stat().st_size > 200
    two = CliRunner().invoke(app, ["export", "one", "two", "--out", str(tmp_path / "both.onnx")])
    assert "an .onnx file holds one model; 2 are named" in str(two.exception)
