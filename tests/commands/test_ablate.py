import pytest

pytestmark = pytest.mark.usefixtures("unpainted")


def test_ablate_keeps_what_less_data_gave_and_draws_it(study, called):
    done = called("ablate", study, "--length", "5", "--quiet")
    assert done.returncode == 0, done.stderr
    assert (study / "run" / "quantities").is_dir()
    assert "How much data" in (study / "run" / "report" / "report.html").read_text(encoding="utf-8")
