def test_demo_does_the_whole_job(tmp_path, called, unpainted):
    done = called("demo", tmp_path / "demo", "--seconds", "30", "--people", "1", "--jobs", "1", "--quiet")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "demo" / "run" / "report" / "report.html").stat().st_size > 10_000
    assert "no people" in done.stdout
