from chapter3.naming import Naming
from chapter3.pages import naming_figure, naming_table
from texts import says

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
    assert says(table.rows[0][3], "named 1/2", "wrong name 1/2", "1.02")
    assert says(table.rows[0][4], "curve", "7 % off")
    assert table.rows[1] == ("d", "nothing", "1.0%", "nothing", "refused: needs 2 states")
    assert len(table.numbers) == len(ANSWERS)


def answer(tool, seed, answer, accuracy, diverged=None):
    return Naming("c", "x³", tool, 0.01, seed, answer, "", accuracy=accuracy, diverged_s=diverged)


def test_a_tile_says_the_answer_of_most_seeds_and_the_forecast():
    names = [answer("sindy", k, a, 90.0) for k, a in enumerate(("named", "named", "curve"))]
    figure = naming_figure([*names, answer("gp", 0, "curve", -2e4), answer("nn", 0, "curve", 5.0, diverged=3.0)], "n")
    assert figure.numbers["kind"].tolist() == ["right", "curve", "curve"]
    assert figure.numbers["forecast"].tolist() == ["90", "<−999", "div."]
    texts = [text.get_text() for text in figure.drawn.axes[0].texts]
    assert texts == ["N 67", "90"]


def test_every_case_has_a_label_with_what_is_hidden():
    figure = naming_figure([answer("sindy", 0, "named", 90.0)], "n")
    assert [label.get_text() for label in figure.drawn.axes[0].get_yticklabels()] == ["c:\nx³"]
