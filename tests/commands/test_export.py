import numpy as np
import pandas as pd
import pytest
from driven_walker import DrivenWalker
from made_cycles import made_cycles
from texts import says

from gaitdisc.channel import Channel
from gaitdisc.commands.options import REFUSED
from gaitdisc.ingest.reading import read_trial
from gaitdisc.ingest.storage import write_storage
from gaitdisc.processing.pooled_cycles import CYCLES, cycles_name
from gaitdisc.reconstruction.model_folder import SensingModel, save_model
from gaitdisc.reconstruction.window_model import Sensing, fit_reconstructor
from gaitdisc.reconstruction.windows import Lags
from gaitdisc.recording import Samples
from gaitdisc.response.participant_response import ResponseRun
from gaitdisc.saved.provenance import provenance_now
from gaitdisc.saved.study_run import save_run


def test_export_brings_streams_to_one_time_base(tmp_path, called):
    trial = DrivenWalker("A", seed=8).walked(10.0, "natural")
    for key in ("kinematics", "forces"):
        write_storage(trial.stream(key), tmp_path / f"{key}.mot")
    files = (tmp_path / "kinematics.mot", tmp_path / "forces.mot")
    done = called("export", *files, "--out", tmp_path / "both.csv", ends=0)
    assert says(done.stdout, "12 channels, 1000 samples", "100 Hz")
    called("check", tmp_path / "both.csv", ends=0)


def test_a_saved_model_as_onnx(tmp_path, called):
    pytest.importorskip("onnx")
    time = np.arange(400) / 100
    x, y = np.sin(time)[:, None], np.cos(time)[:, None]
    samples = Samples(x, y, ("a",), ("b",), time, time)
    what = Sensing(("a",), ("b",), Lags(1, 1), 100.0)
    done = fit_reconstructor("delay ridge", what, samples.rows(slice(0, 300)), samples.rows(slice(300, None)))
    channels = Channel("a", "angle", "deg"), Channel("b", "angle", "deg")
    save_model(SensingModel(done, channels, np.ones(1)), tmp_path / "model")
    assert says(called("export", tmp_path / "model", "--out", tmp_path / "model.onnx", ends=0).stdout, "1 states")
    assert (tmp_path / "model.onnx").stat().st_size > 200
    two = called("export", "one", "two", "--out", tmp_path / "both.onnx", ends=REFUSED)
    assert says(two.stderr, ".onnx", "one model", "found 2")


def save_cycles(folder, session=""):
    """A run of one person's cycles, as it is saved; the cycles."""
    one = made_cycles(each=3, out=1, session=session)
    CYCLES.save(one, folder / "cycles" / cycles_name("P01", session, "walk"), "key")
    save_run(ResponseRun("t", "walk", "", (), provenance_now({}, 0, {}, "4.2"), {"cycles.json": (one,)}), folder)
    return one


@pytest.mark.parametrize("ending", ["csv", "parquet"])
def test_cycles_of_a_run_as_tidy_tables(tmp_path, called, ending):
    one = save_cycles(tmp_path / "run")
    form = ["--parquet"] if ending == "parquet" else []
    called("export", tmp_path / "run", "--out", tmp_path / "out", *form, ends=0)
    read = pd.read_csv if ending == "csv" else pd.read_parquet
    tables = {name: read(tmp_path / "out" / f"{name}.{ending}") for name in ("cycles", "curves", "means")}
    assert len(tables["cycles"]) == 8 and tables["cycles"]["kept"].sum() == 6
    knee = tables["curves"].query("channel == 'knee_angle_r' and start_s == 2.0")
    assert knee["value"].to_numpy() == pytest.approx(one.curves[5, :, 1])  # the third cycle of the right foot
    assert set(tables["means"]["n"]) <= {1, 3}


def test_mean_cycles_of_a_run_as_mot_and_back(tmp_path, called):
    one = save_cycles(tmp_path / "run", "visit 1")
    called("export", tmp_path / "run", "--out", tmp_path / "out", "--mot", ends=0)
    means = one.mean_curves()
    for side in "lr":
        trial = read_trial(tmp_path / "out" / f"P01_visit-1_walk_{side}.mot")
        angles = trial.stream("kinematics")
        assert len(angles.time) == 101 and angles.time[-1] == pytest.approx(1.0)  # all cycles last a second
        for name in (f"knee_angle_{side}", "pelvis_tilt"):
            mean = means[(means["channel"] == name) & (means["side"] == side)]["mean"]
            assert angles[name] == pytest.approx(mean.to_numpy())
        assert not [name for name in angles.names if name.endswith("_l" if side == "r" else "_r")]


def test_a_run_without_cycles_has_none_to_export(tmp_path, called):
    save_run(ResponseRun("t", "walk", "exo", (), provenance_now({}, 0, {}, "4.2"), {}), tmp_path)
    assert says(called("export", tmp_path, "--out", tmp_path / "out", ends=REFUSED).stderr, "tables of cycles")
