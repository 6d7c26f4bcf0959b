import pytest
from texts import says


def test_demo_does_the_whole_job(tmp_path, called, unpainted):
    done = called("demo", tmp_path / "demo", "--seconds", "30", "--people", "1", "--jobs", "1", "--quiet", ends=0)
    assert (tmp_path / "demo" / "run" / "report" / "report.html").stat().st_size > 10_000
    assert "simulated" in done.stdout


@pytest.mark.slow
def test_a_made_week_becomes_pages_that_find_what_was_planted(called, tmp_path):
    called("demo", tmp_path, "--clinic", "--jobs", "1", "--quiet", ends=0)
    people = tmp_path / "week" / "run" / "report" / "people"
    pages = {path.stem: path.read_text(encoding="utf-8") for path in people.glob("*.html")}
    assert "knee flexion in swing: left" in pages["P02"]
    assert "Reduced dorsiflexion in swing: right" in pages["P04"]
    assert "knee flexion in swing: right" in pages["P05_before"]
    # how many of forty healthy people have a sentence of the second tier, benchmarks/clinic_gaits.py counts
    assert sum("■ Outside the" in pages[healthy] for healthy in ("P01", "P03", "P05_after", "P07", "P08")) <= 1
    assert all("■ Outside the prediction limits" in pages[planted] for planted in ("P02", "P04", "P05_before"))
    assert says(pages["P08"], "controls are adults", "8 years")
    assert "These controls are adults" not in pages["P01"]
    assert "no cycle is kept" in pages["P06"]
    index = (people.parent / "index.html").read_text(encoding="utf-8")
    assert index.index("P06") < index.index("P01<") and "gait deviations: P02 stiff knee left" in index
    assert "P08 child" in index
    assert {path.stem for path in people.glob("*.pdf")} == set(pages)  # clinic.toml of the week says pdf = true
