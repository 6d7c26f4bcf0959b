from gaitdisc.chapters.discrepancy.naming import Naming
from gaitdisc.chapters.pages.naming_figure import naming_figure


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
