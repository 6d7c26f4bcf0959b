import pytest

pytestmark = pytest.mark.usefixtures("unpainted")


def test_sensitivity(study, called):
    done = called("sensitivity", study, "--quiet")
    assert done.returncode == 0, done.stderr
    assert (study / "run" / "sensitivity" / "report.html").is_file()
    assert (study / "run" / "sensitivity" / "tables" / "r2.csv").is_file()
    assert "1 participant in" in done.stdout
