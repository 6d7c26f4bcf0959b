import pytest

pytestmark = pytest.mark.usefixtures("unpainted")


def test_modalities(study, called):
    done = called("modalities", study, "--quiet")
    assert done.returncode == 0, done.stderr
    assert (study / "run" / "modalities" / "report.html").is_file()
    assert (study / "run" / "modalities" / "tables" / "r2.csv").is_file()
    assert "1 participant in" in done.stdout
    page = study / "run" / "modalities" / "report.html"
    first = page.read_bytes()
    page.unlink()
    again = called("report", study / "run")
    assert again.returncode == 0, again.stderr
    assert page.read_bytes() == first
