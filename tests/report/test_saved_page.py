"""Every result that is saved is drawn again from its folder: the same page as of the result in memory."""

import json

import pandas as pd
import pytest
from driven_walker import DrivenWalker
from made_cycles import made_cycles
from manufactured_discovery import manufactured
from texts import says

from gaitdisc.comparison.compare import compare_walks
from gaitdisc.comparison.page import write_mismatch_report
from gaitdisc.discovery.page import write_discovery_report
from gaitdisc.errors import SchemaError
from gaitdisc.processing.pooled_cycles import CYCLES
from gaitdisc.processing.walk_pair import walk_pair
from gaitdisc.reconstruction.page import write_reconstruction_report
from gaitdisc.report.saved_page import draw_saved, find_page
from gaitdisc.response.page import write_report
from gaitdisc.response.variants import VARIANT_COLUMNS, VARIANT_TEST_COLUMNS, VariantRun, Variants
from gaitdisc.response.variants_page import write_variants
from gaitdisc.saved import kind as kinds
from gaitdisc.saved.provenance import provenance_now
from gaitdisc.saved.study_run import StudyRun, save_run
from gaitdisc.saved.unit_folder import read_sealed, seal_text

pytestmark = pytest.mark.usefixtures("unpainted")


def variants():
    models = (("nominal", 0.5), ("augmented", 0.6), ("exo", 0.7))
    rows = [
        (word, "knee_angle_r", model, "network", r2, 50)
        for word in ("as in the study", "EMG 4 Hz")
        for model, r2 in models
    ]
    table = pd.DataFrame(rows, columns=pd.Index(VARIANT_COLUMNS))
    tests = pd.DataFrame(columns=pd.Index(VARIANT_TEST_COLUMNS))
    return VariantRun("a study", "exo", "sensitivity", (Variants("P01", "sensitivity", table, {}),), tests, (), (5, 9))


def mismatch():
    walks = [DrivenWalker("A", seed=1, spring_per_s2=k).walked(20.0, str(k)) for k in (250.0, 0.0)]
    return compare_walks(*walk_pair(*walks), ("ankle_angle_r",))


KINDS = {
    "ResponseRun": (lambda request: request.getfixturevalue("run_maker")(outputs=("ankle_angle_l",)), write_report),
    "Discovery": (lambda _: manufactured(), write_discovery_report),
    "Mismatch": (lambda _: mismatch(), write_mismatch_report),
    "Reconstruction": (lambda request: request.getfixturevalue("reconstruction"), write_reconstruction_report),
    "VariantRun": (lambda _: variants(), write_variants),
}


def test_every_kind_that_is_read_has_a_page_but_a_fitted_model():
    every = [kinds.load_word(word) for word in kinds.KINDS.values()]
    assert [kind.file for kind in every] == list(kinds.KINDS)
    assert [kind.file for kind in every if not kind.page] == ["model.json"]
    assert all(callable(kinds.load_word(kind.page)) for kind in every if kind.page)


@pytest.mark.parametrize("kind", KINDS)
def test_a_saved_result_is_drawn_as_it_was_in_memory(kind, request, tmp_path):
    made, write = KINDS[kind][0](request), KINDS[kind][1]
    assert type(made).__name__ == kind
    pages = draw_saved(made.save(tmp_path / "saved"))
    assert list(pages) == ["report"]
    assert pages["report"].read_bytes() == write(made, tmp_path / "memory").read_bytes()


def test_cycles_that_stand_alone_are_drawn_and_claim_no_date(tmp_path):
    made = made_cycles()
    text = draw_saved(made.save(tmp_path))["report"].read_text()
    assert says(text, "4 left cycles", "4 right cycles", "2 trials", "kept")
    assert says(text, "run.json", "settings and date")
    assert pd.read_csv(tmp_path / "report" / "tables" / "cycles.csv")["kept"].sum() == 8


def test_the_questions_beside_a_run_are_drawn_with_it(run, tmp_path):
    variants().save(run.save(tmp_path) / "sensitivity")
    pages = draw_saved(tmp_path)
    assert set(pages) == {"report", "sensitivity"}
    assert pages["sensitivity"] == tmp_path / "sensitivity" / "report.html"


def test_a_folder_of_a_newer_version_is_refused_in_words_and_nothing_is_drawn(tmp_path):
    for made, file in ((manufactured(), "discovery.json"), (made_cycles(), "cycles.json")):
        place = made.save(tmp_path / file) / file
        place.write_text(seal_text(read_sealed(place) | {"format": 2}))
        with pytest.raises(SchemaError, match="format 2, not 1"):
            draw_saved(place.parent)
        assert not list(tmp_path.rglob("*.html"))


def test_a_folder_without_a_result_is_refused_with_what_it_holds(tmp_path):
    (tmp_path / "study.toml").write_text("")
    with pytest.raises(SchemaError, match=r"a saved result.*run.json.*study.toml"):
        draw_saved(tmp_path)
    (tmp_path / "discovery.json").write_text(json.dumps({"verdict": "no_gap"}))
    with pytest.raises(SchemaError, match="has no hash of its own"):
        draw_saved(tmp_path)


@pytest.fixture
def folder(tmp_path):
    one = made_cycles()
    CYCLES.save(one, tmp_path / "cycles" / "P01-walk", "key")
    _save(tmp_path, one)
    return tmp_path


def _save(folder, one, title="t"):
    save_run(StudyRun(title, "walk", "", (), provenance_now({}, 0, {}, "4.2"), {CYCLES.file: (one,)}), folder)


def _drawing(folder, drawn):
    def draw():
        drawn.append(1)
        (folder / "report" / "figures").mkdir(parents=True, exist_ok=True)
        (folder / "report" / "figures" / "a.svg").write_text("<svg/>")
        page = folder / "report" / "report.html"
        page.write_text("page")
        return page

    return draw


def test_a_page_of_the_same_run_is_not_drawn_again(folder):
    drawn: list[int] = []
    first = find_page(folder, _drawing(folder, drawn))
    _save(folder, made_cycles())  # another time of making, the same run
    assert find_page(folder, _drawing(folder, drawn)) == first and len(drawn) == 1


@pytest.mark.parametrize("change", ["title", "unit", "page", "figure", "seal"])
def test_whatever_is_changed_is_drawn_anew(folder, change):
    drawn: list[int] = []
    find_page(folder, _drawing(folder, drawn))
    if change == "title":
        _save(folder, made_cycles(), "another")
    elif change == "unit":
        CYCLES.save(made_cycles(each=3), folder / "cycles" / "P01-walk", "other")
    elif change == "page":
        (folder / "report" / "report.html").write_text("edited")
    elif change == "figure":
        (folder / "report" / "figures" / "a.svg").unlink()
    else:
        (folder / "report" / "drawn.json").write_text("{}")
    find_page(folder, _drawing(folder, drawn))
    assert len(drawn) == 2
