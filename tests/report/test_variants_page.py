import pandas as pd

from gaitdisc.report.variants_page import variant_sentences, variant_tables, write_variants
from gaitdisc.results import Refusal
from gaitdisc.results.variants import VARIANT_TEST_COLUMNS, VariantRun, Variants

NO_TESTS = pd.DataFrame(columns=pd.Index(VARIANT_TEST_COLUMNS))


def variant_run(question, variants):
    rows = [
        (variant, variable, model, "network", 0.5 + 0.1 * place, 99)
        for variant in variants
        for variable in ("knee_angle_r", "emg_sol_r")
        for place, model in enumerate(("nominal", "augmented", "exo"))
    ]
    table = pd.DataFrame(rows, columns=["variant", "variable", "model", "kind", "r2", "n"])
    people = (Variants("P01", question, table, {}),)
    refusals = (Refusal("P02", "exo", "the gait <changes>"),)
    return VariantRun("a study", "exo", question, people, NO_TESTS, refusals, (7.5, 7.5))


def test_a_page_stands_alone_and_is_the_same_each_time(tmp_path):
    for question, variants in (
        ("modalities", ("all inputs", "EMG")),
        ("sensitivity", ("as the study has it", "EMG 4 Hz")),
    ):
        run = variant_run(question, variants)
        page = write_variants(run, tmp_path / question)
        text = page.read_text(encoding="utf-8")
        assert "the gait &lt;changes&gt;" in text
        assert "<script" not in text
        assert 'src="http' not in text
        assert (tmp_path / question / "tables" / "r2.csv").is_file()
        assert write_variants(run, tmp_path / question).read_text(encoding="utf-8") == text


def test_nobody_is_said(tmp_path):
    run = VariantRun("a study", "exo", "sensitivity", (), NO_TESTS, (), (0.0, 0.0))
    assert variant_tables(run) == []
    assert variant_sentences(run) == ("Nobody's models could be fitted.",)
    assert "Nobody" in write_variants(run, tmp_path).read_text(encoding="utf-8")
