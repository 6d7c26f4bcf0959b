from driven_walker import DrivenWalker

from gaitdisc.ingest.storage import write_storage


def test_export_brings_streams_to_one_time_base(tmp_path, called):
    trial = DrivenWalker("A", seed=8).walked(10.0, "natural")
    for key in ("kinematics", "forces"):
        write_storage(trial.stream(key), tmp_path / f"{key}.mot")
    done = called("export", tmp_path / "kinematics.mot", tmp_path / "forces.mot", "--out", tmp_path / "both.csv")
    assert done.returncode == 0, done.stderr
    assert "12 channels, 1000 samples at 100 Hz" in done.stdout
    assert called("check", tmp_path / "both.csv").returncode == 0
