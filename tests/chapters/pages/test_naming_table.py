from gaitdisc.chapters.discrepancy.naming import Naming
from gaitdisc.chapters.pages.naming_table import naming_table

ANSWERS = [
    Naming("c", "x³", "sindy", 0.01, 0, "named", "y: x**3", 1.02, 90.0),
    Naming("c", "x³", "sindy", 0.01, 1, "wrong name", "y: x", accuracy=10.0),
    Naming("c", "x³", "gp", 0.01, 0, "curve", "a curve of the states, 7 % off what is missing", accuracy=80.0),
    Naming("d", "", "sindy", 0.01, 0, "nothing", "nothing"),
    Naming("d", "", "gp", 0.01, 0, "refused", "needs 2 states; 1 is measured. Measure both."),
]


def test_answers_are_counted_over_seeds_and_a_curve_says_how_far_it_is_off():
    table = naming_table(ANSWERS, "names")
    assert table.columns == ("case", "hidden", "noise", "SINDy", "Gaussian process")
    assert table.rows[0][3:] == (
        "named 1/2, wrong name 1/2 (× 1.02)",
        "curve: a curve of the states, 7 % off what is missing",
    )
    assert table.rows[1] == ("d", "nothing", "1.0%", "nothing", "refused: needs 2 states")
    assert len(table.numbers) == len(ANSWERS)
