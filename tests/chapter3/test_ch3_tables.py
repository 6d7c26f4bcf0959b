import numpy as np
import pandas as pd
import pytest
from ch3_cell_sets import cell_sets
from ch3_seeds import gathered, rows_of
from ch3_tables import differing, least, printed
from chapter3.cell import FORECAST, ORACLE, PARTS, cell_of
from chapter3.kept_cells import CELLS, measured, set_table
from chapter3.recommend import FOUND, evidence_of
from chapter3.record import recorded
from printed_blocks import apart, blocks
from printed_numbers import pages

OURS = [
    (page.name, block.commands[-1].split()[-1], block.written)
    for page in pages() for block in blocks(page.read_text(encoding="utf-8")) if "ch3_tables.py" in block.commands[-1]
]  # fmt: skip
NUMBERS = pd.DataFrame(
    [
        ("a", method, part, noise, seed, value, np.nan, 2.0, 3.0)
        for method, value in (("sindy", 90.0), ("gp", 95.0))
        for part in PARTS for noise, seeds in ((0.0, 1), (0.1, 3)) for seed in range(seeds)
    ],
    columns=["set", "method", "part", "noise", "seed", "accuracy", "diverged_s", "valid_s", "to_jump"],
)  # fmt: skip


@pytest.mark.parametrize(("page", "name", "written"), OURS)
def test_what_stands_on_a_page_is_what_the_kept_cells_say(page, name, written):
    assert apart(written, printed(name)) == "", page


def test_pages_hold_both_starts():
    assert {page for page, *_ in OURS} == {"chapter3.md", "chapter3_cells.md"}
    for page, _, written in OURS:
        assert "oracle" in written, page


def test_a_cell_computed_anew_is_the_kept_one():
    one = cell_sets()["van_der_pol_text"]
    record = recorded(one.system, one.conditions.__class__(0.01, 0, duration_s=one.conditions.duration_s))
    anew = rows_of(cell_of(record, "sindy", "dynamics")).set_index("part")["accuracy"]
    table = measured()
    kept = table[(table["set"] == "van_der_pol_text") & (table["method"] == "sindy") & (table["noise"] == 0.01)]
    kept = kept[kept["seed"] == 0].set_index("part")["accuracy"]
    assert anew[list(PARTS)].to_numpy() == pytest.approx(kept[list(PARTS)].to_numpy(), abs=0.5)  # points of percent


def test_what_recommend_answers_from_is_made_of_the_kept_cells():
    table = measured()
    made = evidence_of(table[(table["approach"] == "dynamics") & (table["variant"] == "right")])
    pd.testing.assert_frame_equal(made.reset_index(drop=True), pd.read_csv(FOUND), rtol=1e-6, check_dtype=False)


def test_every_cell_of_the_first_grids_rests_on_twelve_seeds():
    table = measured()
    some = table[table["set"].isin(["van_der_pol_text", "van_der_pol_code", "lorenz"]) & (table["noise"] > 0)]
    some = some[(some["method"] != "bopdmd") & (some["part"] == FORECAST)]
    assert some.groupby(["set", "method", "noise"])["seed"].nunique().ge(12).all()


def test_a_cell_is_a_family_of_six_pairs_dmd_among_them():
    values = np.arange(12.0)[:, None] + [0, -5, 0, 0] + np.linspace(0, 1e-3, 48).reshape(12, 4)
    said = differing(pd.DataFrame(values, columns=["sindy", "dmd", "gp", "nn"]))
    assert said.startswith("SINDy > DMD (p 0.0029)") and said.count("DMD") == 3
    assert "least p 0.00049, 0.0029 over the 6 pairs of a cell" in least(12)
    assert "no more than 3 of 12" in least(12) and "no more than 1 of 10" in least(10)


def test_a_row_is_a_method_and_a_start_with_the_seeds_counted():
    head, _, *rows = [line.strip("| ").split(" | ") for line in set_table(NUMBERS, "a", "forecast").splitlines()]
    assert head == ["method", "start", "n", "0.0% noise", "10.0% noise"]
    assert rows[0] == ["SINDy", "estimated", "3", "90.0", "90.0 [90.0, 90.0]"]
    assert rows[1][:3] == ["SINDy", "true state (oracle)", "3"]
    kept = (NUMBERS["part"] != ORACLE) | (NUMBERS["seed"] < 1)
    lost = NUMBERS.assign(accuracy=NUMBERS["accuracy"].where(kept))
    assert set_table(lost, "a", "forecast").splitlines()[3].endswith("diverged in 2 of 3 |")
    assert "| 1.8 [1.8, 1.8] |" in set_table(NUMBERS, "a", "valid")


def test_cells_are_gathered_in_the_order_of_sets_and_methods(tmp_path):
    for name, method in (("lorenz", "gp"), ("van_der_pol_text", "gp"), ("van_der_pol_text", "sindy")):
        row = {"set": name, "method": method, "noise": 0.1, "seed": 0, "part": FORECAST}
        pd.DataFrame([row]).to_csv(tmp_path / f"{name}-0.1-00-{method}.csv", index=False)
    found = gathered(tmp_path)
    assert list(zip(found["set"], found["method"], strict=True)) == [
        ("van_der_pol_text", "sindy"), ("van_der_pol_text", "gp"), ("lorenz", "gp"),
    ]  # fmt: skip
    assert CELLS.name == "ch3_cells.csv"
