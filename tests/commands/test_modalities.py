def test_modalities(study, called):
    done = called("modalities", study, "--quiet")
    assert done.returncode == 0, done.stderr
    assert (study / "run" / "modalities" / "report.html").is_file()
    assert (study / "run" / "modalities" / "tables" / "r2.csv").is_file()
    assert "1 participants" in done.stdout
