"""Saved results read back, and pictures on the caller's own axes."""

import json

import matplotlib as mpl
import numpy as np
import pandas as pd
import pytest
from manufactured_discovery import manufactured
from matplotlib.figure import Figure

import gaitdisc as gd
from gaitdisc.channel import Channel
from gaitdisc.errors import ChannelError, SchemaError, ShapeError
from gaitdisc.saved.provenance import Provenance


def test_a_discovery_comes_back_and_is_saved_with_the_same_bytes(tmp_path):
    found = manufactured()
    assert found.save(tmp_path / "one") == tmp_path / "one"
    again = gd.load(tmp_path / "one")
    assert isinstance(again, gd.Discovery)
    again.save(tmp_path / "two")
    assert [(tmp_path / "one" / name).read_bytes() for name in ("discovery.json", "held_out.csv")] == [
        (tmp_path / "two" / name).read_bytes() for name in ("discovery.json", "held_out.csv")
    ]
    assert (again.effects, again.train, again.where, again.findings) == (
        found.effects, found.train, found.where, found.findings)  # fmt: skip
    columns = ["run", "time", "theta_measured", "theta_augmented"]
    pd.testing.assert_frame_equal(again.to_frame()[columns], found.to_frame()[columns], rtol=1e-7)


def test_a_mismatch_comes_back(tmp_path):
    walks = gd.example_walks(12.0)
    found = gd.compare(walks["exo"], walks["nominal"], ["ankle_angle_r"])
    again = gd.load(found.save(tmp_path / "compare"))
    assert isinstance(again, gd.Mismatch) and repr(again) == repr(found)
    np.testing.assert_array_equal(again.curves["gap"], found.curves["gap"])


def test_a_folder_without_a_result_is_refused(tmp_path):
    (tmp_path / "notes.txt").write_text("")
    with pytest.raises(SchemaError, match=r"folder with one.*run.json.*notes.txt"):
        gd.load(tmp_path)
    with pytest.raises(SchemaError, match="nothere is not a folder"):
        gd.load(tmp_path / "nothere")


def test_a_discovery_that_was_edited_or_is_of_another_format_is_refused(tmp_path):
    from gaitdisc.saved.unit_folder import read_sealed, seal_text

    file = manufactured().save(tmp_path) / "discovery.json"
    data = read_sealed(file)
    file.write_text(seal_text(data | {"format": 2}))
    with pytest.raises(SchemaError, match="has format 2, not 1"):
        gd.load(tmp_path)
    file.write_text(seal_text({key: value for key, value in data.items() if key != "gap"}))
    with pytest.raises(SchemaError, match=r"not.*.KeyError: 'gap'"):
        gd.load(tmp_path)
    manufactured().save(tmp_path, overwrite=True)
    text = json.loads(file.read_text()) | {"verdict": "no_gap"}
    file.write_text(json.dumps(text))
    with pytest.raises(SchemaError, match="changed since it was saved"):
        gd.load(tmp_path)


mpl.use("Agg")
X_AND_PERCENT = np.zeros((5, 1))


@pytest.fixture
def ax():
    return Figure().subplots()


def sine():
    time = np.arange(1000) / 100
    knee = np.column_stack([30 * np.sin(2 * np.pi * time), np.cos(time)])
    channels = (Channel("knee_angle_r", "angle", "deg", "r"), Channel("emg_sol_r", "emg", "V", "r"))
    suspect = np.zeros(knee.shape, bool)
    suspect[:50] = True
    return gd.Recording(time, knee, channels, suspect=suspect)


def test_the_latent_state_is_drawn_over_the_stride(ax, trained_briefly):
    phase = np.arange(600) / 100
    x, y = np.sin(6.28 * phase)[:, None], np.cos(6.28 * phase)[:, None]
    model = gd.Reconstructor("shred", history_s=0.2, spacing_s=0.1).fit(x, y)
    assert gd.plot.latent(model, x, 100 * (phase % 1), ax=ax) is ax
    assert len(ax.lines) == 3
    assert ax.get_xlabel() == "stride [%]"


def test_a_recording_is_drawn_over_time_with_what_is_suspect(ax):
    assert gd.plot.recording(sine(), "knee_angle_r", ax=ax) is ax
    line, doubtful = ax.lines
    np.testing.assert_array_equal(line.get_ydata(), sine()["knee_angle_r"])
    assert np.isfinite(doubtful.get_ydata()).sum() == 50
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("time [s]", "[deg]")
    assert len(gd.plot.recording(sine()).lines) == 4


def test_a_table_is_drawn_with_the_units_of_the_names_it_has(ax):
    gd.plot.recording(sine().to_pandas().reset_index(), "knee_angle_r", ax=ax)
    np.testing.assert_array_equal(ax.lines[0].get_ydata(), sine()["knee_angle_r"])
    assert ax.get_ylabel() == "[deg]"


def test_cycles_have_their_mean(ax):
    starts = np.arange(1.0, 8.0)
    strides = gd.Strides(starts, starts + 1.0, "r", "force")
    gd.plot.cycles(sine(), strides, "knee_angle_r", ax)
    mean = ax.lines[-1].get_ydata()
    np.testing.assert_allclose(mean, 30 * np.sin(2 * np.pi * np.arange(101) / 100), atol=0.05)
    assert len(ax.lines) == 1 + 1 and ax.get_xlim() == (0, 100)
    assert len(ax.collections[0].get_segments()) == 7


def test_a_discovery_is_drawn_in_degrees_with_what_is_left_and_after_loading(tmp_path, ax):
    found = gd.load(manufactured().save(tmp_path))
    assert isinstance(found, gd.Discovery)
    gd.plot.discovery(found, ax=ax)
    assert ax.get_ylabel() == "theta [deg]"
    left = gd.plot.discovery(found, "theta", left=True)
    assert left.get_title() == "theta: residual" and "initial model" in left.get_legend().get_texts()[0].get_text()
    with pytest.raises(ChannelError, match="theta, the nearest is 'theta'"):
        gd.plot.discovery(found, "thta")


def test_a_mismatch_and_its_gap_are_drawn():
    walks = gd.example_walks(12.0)
    found = gd.compare(walks["exo"], walks["nominal"], ["ankle_angle_r"])
    both, gap = gd.plot.mismatch(found, "ankle_angle_r"), gd.plot.mismatch(found, "ankle_angle_r", gap=True)
    np.testing.assert_allclose(gap.lines[1].get_ydata(), found.curves["gap"][:, 0])
    assert [text.get_text() for text in both.get_legend().get_texts()][1] == found.first
    with pytest.raises(ChannelError, match="'knee_angle_r' cannot be drawn"):
        gd.plot.mismatch(found, "knee_angle_r")


def test_reconstructed_states_are_drawn(ax):
    percent = np.arange(101.0)
    sine = np.sin(2 * np.pi * percent / 100)
    curves = pd.DataFrame({"participant": "P01", "model": "linear", "state": "knee_angle_r", "percent": percent,
                           "measured": sine, "measured_sd": 0.1, "reconstructed": 0.9 * sine})  # fmt: skip
    summary = pd.DataFrame({"participant": ["P01"], "model": ["linear"], "strides": [9], "check_loss": [0.1]})
    knee, hip = (Channel(f"{name}_r", "angle", "deg", "r") for name in ("knee_angle", "hip_flexion"))
    made = Provenance({}, 0, {}, {}, "", "2026-01-01T00:00:00+00:00")
    done = gd.Reconstruction("", (hip,), (knee,), "", "", {"linear": ""}, curves, summary, curves, (), (), made)
    gd.plot.reconstruction(done, "knee_angle_r", ax=ax)
    np.testing.assert_allclose(ax.lines[0].get_ydata(), 0.9 * sine)
    assert ax.get_ylabel() == "[deg]"


@pytest.mark.parametrize("name", ["r2", "discovery", "latent"])
def test_a_picture_of_another_result_is_refused(name):
    given = {"latent": (X_AND_PERCENT, X_AND_PERCENT)}.get(name, ())
    with pytest.raises(ShapeError, match=r"found Recording.*gaitdisc.load"):
        getattr(gd.plot, name)(sine(), *given)


@pytest.mark.parametrize("name", ["curves", "mismatch", "reconstruction"])
def test_a_picture_of_a_channel_of_another_result_is_refused(name):
    with pytest.raises(ShapeError, match="found Recording"):
        getattr(gd.plot, name)(sine(), "knee_angle_r")


def test_what_is_no_recording_is_refused(ax):
    with pytest.raises(ShapeError, match="found ndarray"):
        gd.plot.recording(np.zeros(5), ax=ax)
    with pytest.raises(ShapeError, match=r"Strides, as gaitdisc\.cycles"):
        gd.plot.cycles(sine(), sine(), "knee_angle_r", ax=ax)
    with pytest.raises(ChannelError, match=r"walk has kinematics.*trial\.stream"):
        gd.plot.recording(gd.Trial("walk", {"kinematics": sine()}), ax=ax)


def test_completion_shows_pictures_alone():
    assert "cycles" in dir(gd.plot) and "np" not in dir(gd.plot)
