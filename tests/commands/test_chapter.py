import pytest
from texts import says

from gaitdisc.commands.options import REFUSED, SOME_REFUSED, STOPPED
from gaitdisc.errors import SchemaError
from gaitdisc.run import chapter_run
from gaitdisc.run.chapter_parts import PARTS


@pytest.fixture
def computed(monkeypatch):
    """Which parts were computed; none is."""
    seen = []

    def run(part, out, quick, data, ticked):
        seen.append(part.name)
        ticked(1.0)
        return chapter_run.Made(out / part.name, False)

    monkeypatch.setattr(chapter_run, "run_part", run)
    monkeypatch.setattr(chapter_run, "find_lack", lambda *_: None)
    return seen


def test_help_lists_every_part_with_its_cost(called):
    said = called("chapter", "--help").stdout
    for part in PARTS:
        assert f"{part.chapter} {part.name}: {part.makes}; " in said
    assert "van_der_pol: 3.4.1, Figs. 3.2-3.5, 3.11; " in said and "in brackets with --quick" in " ".join(said.split())


def test_all_parts_of_a_chapter_are_computed_and_the_rest_is_counted(computed, called, tmp_path):
    done = called("chapter", 5, tmp_path, "--quick")
    assert (done.returncode, computed) == (0, [part.name for part in PARTS if part.chapter == 5])
    assert f"turbulence: done: {tmp_path / 'turbulence'}" in done.stdout
    assert f"gait_individual, 1 of {len(computed)}: the remaining parts take about " in done.stderr
    assert called("chapter", 4, tmp_path, "--quiet").stderr == ""


def test_what_a_machine_cannot_compute_is_left_out_and_said(computed, called, tmp_path, monkeypatch):
    lack = SchemaError("sea_surface needs data", "none is there", "Name the folder.")
    monkeypatch.setattr(chapter_run, "find_lack", lambda part, _: lack if part.name == "sea_surface" else None)
    done = called("chapter", 5, tmp_path, ends=SOME_REFUSED)
    assert "sea_surface" not in computed
    assert says(done.stderr, "left out: sea_surface", "data")


def test_a_wrong_name_is_refused_and_a_stop_is_said(computed, called, tmp_path, monkeypatch):
    done = called("chapter", 3, tmp_path, "--part", "lorentz", ends=REFUSED)
    assert "the nearest is 'lorenz'" in done.stderr

    def stopped(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(chapter_run, "run_part", stopped)
    done = called("chapter", 4, tmp_path, ends=STOPPED)
    assert "same command" in done.stderr


@pytest.mark.slow
def test_the_quickest_part_prints_the_tables_of_the_pages(called, tmp_path):
    called("chapter", 3, tmp_path, "--part", "tables", ends=0)
    text = (tmp_path / "tables" / "printed.md").read_text(encoding="utf-8")
    assert says(text, "Van der Pol", "estimated", "true state (oracle)", "10.0%")
    assert text.count("## ") > 8
    assert "kept as it stands" in called("chapter", 3, tmp_path, "--part", "tables").stdout
