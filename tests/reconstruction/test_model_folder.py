"""A model saved, as ONNX too, and loaded elsewhere."""

import json
import sys
from dataclasses import replace

import numpy as np
import pytest
import torch
from resealed import resealed

from gaitdisc.channel import Channel
from gaitdisc.errors import ChannelError, SamplingError, SchemaError, UnitError
from gaitdisc.models.networks import ShallowDecoder, Shred
from gaitdisc.models.trained_network import TrainedNetwork
from gaitdisc.reconstruction.model_folder import SensingModel, load_model, save_model
from gaitdisc.reconstruction.onnx_file import write_onnx
from gaitdisc.reconstruction.window_model import WindowModel, fit_reconstructor
from gaitdisc.recording import Recording, fit_scale
from gaitdisc.saved.unit_folder import file_sha256


def as_saved(done, pair):
    return SensingModel(done, pair.channels, np.array([0.5]))


@pytest.fixture(scope="module")
def saved(pair):
    fitted = fit_reconstructor("delay ridge", pair.what, pair.parts.fitted(), pair.parts.checked())
    return as_saved(fitted, pair)


def test_a_loaded_model_tells_the_same_of_a_new_recording(pair, saved, tmp_path):
    save_model(saved, tmp_path / "model")
    kept = load_model(tmp_path / "model")
    new = pair.recording.selected(["a"])
    states = kept(new)
    np.testing.assert_array_equal(states.values, saved(new).values)
    reach = pair.what.lags.reach
    assert np.isnan(states.values[:reach]).all()
    np.testing.assert_allclose(states["late"][reach:], pair.recording["late"][reach:], atol=0.05)
    assert (states.names, kept.half_widths.tolist()) == (("late",), [0.5])


def test_where_it_was_fitted_is_kept(saved, tmp_path):
    save_model(replace(saved, reconstructor=replace(saved.reconstructor, device="cuda")), tmp_path)
    assert load_model(tmp_path).reconstructor.device == "cuda"


def test_a_network_is_loaded_with_its_kind(pair, tmp_path):
    fitted = fit_reconstructor("shallow decoder", pair.what, pair.parts.fitted(), pair.parts.checked())
    save_model(as_saved(fitted, pair), tmp_path)
    test = pair.parts.tested()
    np.testing.assert_array_equal(load_model(tmp_path).reconstructor(test), fitted(test))


def test_refusals(pair, saved, tmp_path):
    r = pair.recording
    with pytest.raises(SamplingError, match=r"100 Hz.*50 Hz"):
        saved(replace(r, time=r.time * 2))
    other = (Channel("a", "angle", "rad"), r.channels[1])
    with pytest.raises(UnitError, match=r"deg, the unit of the model; the recording.*rad"):
        saved(Recording(r.time, r.values, other))
    with pytest.raises(ChannelError, match="'a' is"):
        saved(r.selected(["late"]))
    with pytest.raises(SchemaError, match=r"model\.json.*model saved by gaitdisc"):
        load_model(tmp_path / "nothing")
    save_model(saved, tmp_path)
    resealed(tmp_path / "model.json", lambda data: data.update(format=9))
    with pytest.raises(SchemaError, match=r"format 9.*1"):
        load_model(tmp_path)


@pytest.mark.parametrize("kind", ["shred", "masked shred", "shred ensemble", "shred-text"])
def test_every_recurrent_network_is_loaded_as_it_was(pair, untrained, tmp_path, kind):
    done = untrained(kind)
    save_model(as_saved(done, pair), tmp_path)
    test = pair.parts.tested()
    np.testing.assert_array_equal(load_model(tmp_path).reconstructor(test), done(test))
    files = {f"weights_{k}.npz" for k in range(1, 6)} if kind == "shred ensemble" else {"weights.npz"}
    assert {path.name for path in tmp_path.iterdir()} == {"model.json", *files}


def test_the_order_of_channels_in_a_recording_does_not_matter(pair, saved):
    turned = pair.recording.selected(["late", "a"])
    np.testing.assert_array_equal(saved(turned).values, saved(pair.recording).values)


def test_damaged_and_foreign_files(pair, saved, untrained, tmp_path):
    save_model(saved, tmp_path)
    whole = (tmp_path / "weights.npz").read_bytes()
    (tmp_path / "weights.npz").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(SchemaError, match=r"gaitdisc.*weights\.npz.*changed"):
        load_model(tmp_path)
    (tmp_path / "weights.npz").unlink()
    with pytest.raises(SchemaError, match=r"gaitdisc.*weights\.npz.*missing"):
        load_model(tmp_path)
    static = fit_reconstructor("linear", pair.what, pair.parts.fitted(), pair.parts.checked())
    save_model(as_saved(static, pair), tmp_path / "static")
    (tmp_path / "weights.npz").write_bytes((tmp_path / "static" / "weights.npz").read_bytes())
    sha256 = file_sha256(tmp_path / "weights.npz")
    resealed(tmp_path / "model.json", lambda data: data["sha256"].update({"weights.npz": sha256}))
    with pytest.raises(SchemaError, match=r"1 numbers.*11"):
        load_model(tmp_path)
    (tmp_path / "model.json").write_text("{")
    with pytest.raises(SchemaError, match=r"model\.json.*not.*JSON"):
        load_model(tmp_path)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda data: data.update(kind="forest"), "its kind 'forest' is unknown to this version"),
        (lambda data: data.update(half_widths=[0.5, 0.5]), "it has 2 interval half-widths for 1 states"),
        (lambda data: data["channels"][1].update(name="later"), "its channels differ from its sensors and states"),
        (lambda data: data.pop("kind"), "it lacks 'kind'"),
        (lambda data: data["sensing"]["lags"].update(spacing=0), "a window must have at least one sample"),
        (lambda data: data.update(sha256=[]), "model saved by gaitdisc; .*Run `gaitdisc reconstruct` again"),
    ],
)
def test_a_model_file_of_another_form(saved, tmp_path, change, said):
    save_model(saved, tmp_path)
    resealed(tmp_path / "model.json", change)
    with pytest.raises(SchemaError, match=said):
        load_model(tmp_path)


def test_a_model_that_was_edited_or_is_of_before_it_had_a_hash_is_refused(saved, tmp_path):
    save_model(saved, tmp_path)
    file = tmp_path / "model.json"
    whole = file.read_text()
    file.write_text(whole.replace('"rate_hz": 100.0', '"rate_hz": 999.0'))
    assert file.read_text() != whole
    with pytest.raises(SchemaError, match=r"model\.json.*changed.*`gaitdisc reconstruct` again"):
        load_model(tmp_path)
    data = json.loads(whole)
    data.pop("own_sha256")
    file.write_text(json.dumps(data))
    with pytest.raises(SchemaError, match=r"model\.json.*has no hash of its own"):
        load_model(tmp_path)


def run(path, windows):
    """What another program makes of the file."""
    runtime = pytest.importorskip("onnxruntime")
    return runtime.InferenceSession(path, providers=["CPUExecutionProvider"]).run(
        None, {"window": np.float32(windows)}
    )[0]


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
    network = TrainedNetwork(tuple("abcdefgh"), tuple("xyz"), fit_scale(x), fit_scale(y), build())
    two = pair.what.__class__(("a", "late"), ("late",), pair.what.lags, 100.0)
    write_onnx(
        SensingModel(WindowModel("shred", two, network, 0, 0.0), pair.channels * 2, np.ones(1)), tmp_path / "m.onnx"
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
