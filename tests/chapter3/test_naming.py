import pytest
from chapter3.naming import Naming, namings_table


@pytest.mark.parametrize(
    ("hidden", "answer", "right"),
    [
        ("x³", "named", True),
        ("x³", "nothing", False),
        ("x³", "among others", False),
        ("", "nothing", True),
        ("", "named", False),
    ],
)
def test_right_is_the_name_alone_or_rightly_nothing(hidden, answer, right):
    assert Naming("c", hidden, "sindy", 0.01, 0, answer, "").right is right


def test_a_word_that_no_table_knows_is_a_defect():
    with pytest.raises(ValueError, match="'perhaps' of 'sindy'"):
        Naming("c", "x³", "sindy", 0.01, 0, "perhaps", "")


def test_the_table_has_a_row_an_answer():
    table = namings_table([Naming("c", "x³", "nn", 0.0, k, "curve", "s", accuracy=9.0) for k in range(3)])
    assert (len(table), table["accuracy"].tolist(), table["right"].any()) == (3, [9.0] * 3, False)
