import pytest

pytestmark = pytest.mark.usefixtures("unpainted")


@pytest.mark.parametrize("command", ["modalities", "sensitivity"])
def test_a_variation_is_written_and_its_page_drawn_again(study, called, command):
    done = called(command, study, "--quiet")
    assert done.returncode == 0, done.stderr
    assert (study / "run" / command / "tables" / "r2.csv").is_file()
    assert "1 participant in" in done.stdout
    page = study / "run" / command / "report.html"
    first = page.read_bytes()
    page.unlink()
    again = called("report", study / "run")
    assert again.returncode == 0, again.stderr
    assert page.read_bytes() == first
