import pytest

from gaitdisc.commands.options import REFUSED

pytestmark = pytest.mark.usefixtures("unpainted")


@pytest.fixture(scope="module")
def model(study, called, tmp_path_factory):
    out = tmp_path_factory.mktemp("fitted")
    words = ["-s", "hip_flexion_r", "-s", "knee_angle_r", "--condition", "natural", "--out", out, "-q"]
    assert called("reconstruct", study, *words, "--kinds", "linear,delay ridge").returncode == 0
    [model] = (out / "models").iterdir()
    return model


def test_a_saved_model_reconstructs_a_recording(model, recordings, tmp_path, called):
    out = tmp_path / "states.mot"
    done = called("apply", model, recordings / "walker1" / "exo.mot", "--out", out)
    assert done.returncode == 0, done.stderr
    assert "ankle_angle_r: RMSE" in done.stdout and "% inside the 90 % interval" in done.stdout
    assert out.is_file()


def test_model_and_recording_in_the_wrong_order_are_refused(model, recordings, called):
    done = called("apply", recordings / "walker1" / "exo.mot", model)
    assert done.returncode == REFUSED
    assert "exo.mot" in done.stderr and "Traceback" not in done.stderr
    assert "gaitdisc apply MODEL RECORDING" in done.stderr
