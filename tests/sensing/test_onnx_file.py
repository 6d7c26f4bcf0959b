import json
import sys

import numpy as np
import pytest
import torch

from gaitdisc.errors import SchemaError
from gaitdisc.networks.shred import ShallowDecoder, Shred
from gaitdisc.networks.trained_network import TrainedNetwork
from gaitdisc.recording import scale_of
from gaitdisc.sensing.model_folder import SensingModel
from gaitdisc.sensing.onnx_file import write_onnx
from gaitdisc.sensing.reconstructor import Reconstructor, fit_reconstructor


def run(path, windows):
    """What another program makes of the file."""
    runtime = pytest.importorskip("onnxruntime")
    return runtime.InferenceSession(path, providers=["CPUExecutionProvider"]).run(
        None, {"window": np.float32(windows)}
    )[0]


def as_saved(done, pair):
    return SensingModel(done, pair.channels, np.array([0.5]))


@pytest.mark.parametrize("kind", ["linear", "delay ridge", "fourier ridge"])
def test_ridge_regression_by_another_program(pair, tmp_path, kind):
    pytest.importorskip("onnx")
    done = fit_reconstructor(kind, pair.what, pair.parts.fitted(), pair.parts.checked())
    write_onnx(as_saved(done, pair), tmp_path / "model.onnx")
    test = pair.parts.tested()
    x = test.x[:, -len(done.model.inputs) :]
    rounded = np.float64(np.float32(x))
    np.testing.assert_allclose(run(tmp_path / "model.onnx", x), done.model(rounded), atol=1e-5)


@pytest.mark.parametrize("kind", ["shred", "masked shred", "shred ensemble", "shred-text"])
def test_networks_by_another_program(pair, untrained, tmp_path, kind):
    pytest.importorskip("onnx")
    done = untrained(kind)
    write_onnx(as_saved(done, pair), tmp_path / "model.onnx")
    x = pair.parts.tested().x.copy()
    if kind == "masked shred":
        x[::2, 3:6] = np.nan
    states = run(tmp_path / "model.onnx", x)
    assert np.isfinite(states).all()
    np.testing.assert_allclose(states, done.model(x), atol=2e-6)


@pytest.mark.parametrize(
    "build",
    [
        lambda: Shred(8, 3, 2, nodes=5, layers=2, cell="lstm"),
        lambda: Shred(8, 3, 2, nodes=5, layers=2),
        lambda: ShallowDecoder(8, 3),
    ],
)
def test_other_networks(pair, tmp_path, build):
    pytest.importorskip("onnx")
    torch.manual_seed(1)
    rng = np.random.default_rng(0)
    x, y = rng.normal(20, 9, (40, 8)), rng.normal(size=(40, 3))
    x[:, 0] = 4.0  # never varied: weighs nothing
    network = TrainedNetwork(tuple("abcdefgh"), tuple("xyz"), scale_of(x), scale_of(y), build())
    two = pair.what.__class__(("a", "late"), ("late",), pair.what.lags, 100.0)
    write_onnx(
        SensingModel(Reconstructor("shred", two, network, 0, 0.0), pair.channels * 2, np.ones(1)), tmp_path / "m.onnx"
    )
    np.testing.assert_allclose(run(tmp_path / "m.onnx", x), network(x), atol=1e-5)


def test_the_file_says_what_it_reads_and_tells(pair, untrained, tmp_path):
    onnx = pytest.importorskip("onnx")
    write_onnx(as_saved(untrained("shred"), pair), tmp_path / "model.onnx")
    said = {entry.key: entry.value for entry in onnx.load(tmp_path / "model.onnx").metadata_props}
    assert json.loads(said["sensors"]) == ["a"] and json.loads(said["sensor_units"]) == ["deg"]
    assert json.loads(said["states"]) == ["late"] and said["rate_hz"] == "100"
    assert json.loads(said["readings"]) == {"spacing": 5, "ahead": 0, "count": 11}


def test_without_onnx_it_is_one_sentence(pair, untrained, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "onnx", None)
    with pytest.raises(SchemaError, match=r"onnx.*not.*gaitdisc\[onnx\]"):
        write_onnx(as_saved(untrained("shred"), pair), tmp_path / "model.onnx")
    assert not (tmp_path / "model.onnx").exists()
