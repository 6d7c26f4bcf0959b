from dataclasses import replace

from gaitdisc.report.comparison_tables import comparison_sentences, comparison_tables, p_text


def test_a_table_a_pair_and_one_of_the_families(tested):
    tables = {table.name: table for table in comparison_tables(tested)}
    assert list(tables) == [
        "tests-nominal-augmented",
        "tests-nominal-exo",
        "tests-augmented-exo",
        "tests-exo-perfect",
        "tests-families",
    ]
    for table in list(tables.values())[:4]:
        assert sum(span for _, span in table.groups) == len(table.columns) == len(table.rows[0])
        assert "n = 11 participants, Holm-Sidak over 3 tests" in table.caption
    row = dict(zip(tables["tests-augmented-exo"].columns, tables["tests-augmented-exo"].rows[1], strict=True))
    assert row["variable"] == "ankle angle, left"
    assert (row["n"], row["zeros"], row["W"], row["p"], row["adjusted p"]) == ("11", "0", "0", "0.000977", "0.00293")
    assert (row["level of its step"], row["Exo is"], row["rank-biserial"]) == ("0.0170", "higher", "1.00")
    assert abs(float(row["shift [95 %]"].split()[0]) - 0.02) < 0.001


def test_the_families_say_how_many_tests_and_which_level(tested):
    rows = comparison_tables(tested)[-1].rows
    assert [row[2] for row in rows] == ["3", "3", "3", "9", "9", "9", "3", "3", "3"]
    assert rows[0][3:5] == ("0.0500", "3 of 3")
    assert rows[2][5] == "ankle angle, left"


def test_what_is_said(tested):
    said = " ".join(comparison_sentences(tested))
    assert "Exo against Augmented: it explains more in 1 of 3 variables (ankle angle, left)" in said
    assert "Augmented against Nominal: it explains more in 3 of 3 variables" in said
    assert "A difference that is not shown is not an equality" in said
    assert "With n = 11 the smallest p is 0.000977, and adjusted over 3 tests 0.00293" in said
    assert "Of 9 tests of the three pairs, a difference is shown by 7 over the variables of one pair" in said


def test_a_model_that_is_worse_is_said_to_be_worse(tested):
    worse = replace(tested.tests, tests=tested.tests.tests.assign(rank_biserial=-1.0))
    said = comparison_sentences(replace(tested, tests=worse))
    assert said[0].startswith("Augmented against Nominal: it explains less in 3 of 3 variables")


def test_no_difference_is_said_plainly(tested):
    none = replace(tested.tests, tests=tested.tests.tests.assign(different=False))
    said = comparison_sentences(replace(tested, tests=none))
    assert said[2] == "Exo against Augmented: no difference is shown in any of 3 variables."
    row = comparison_tables(replace(tested, tests=none))[0].rows[0]
    assert "not shown" in row


def test_too_few_are_said_and_not_tabled(tested_maker, run):
    few = tested_maker(4)
    assert comparison_tables(few) == []
    assert comparison_sentences(few)[0].startswith("4 participants are too few for a test: the smallest p is 0.125")
    assert comparison_sentences(run) == comparison_tables(run) == []


def test_a_variable_that_was_not_tested_says_so(tested_maker):
    run = tested_maker(6)
    from gaitdisc.response.comparison import compare_models

    def without_soleus(response):
        return replace(
            response, r2=response.r2.assign(r2=response.r2["r2"].where(response.r2["variable"] != "emg_sol_r"))
        )

    responses = (*(without_soleus(one) for one in run.responses[:2]), *run.responses[2:])
    run = replace(run, responses=responses, tests=compare_models(responses))
    table = comparison_tables(run)[0]
    assert table.rows[2][3:5] == ("4", "not tested")
    assert "Holm-Sidak over 2 tests" in table.caption
    assert "Left out: EMG soleus, right: not computed: P01, P02." in table.caption


def test_p_in_three_figures():
    assert [p_text(p) for p in (1.0, 0.04199, 2e-6)] == ["1", "0.042", "<0.0001"]
