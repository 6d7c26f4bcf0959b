"""The house does not grow: no room has more lines than budget.toml allows it, and no file is without a room."""

import budget
from texts import says

ROOMS, WHOLE = budget.read_rooms()
SIZES, HOMELESS = budget.measure(ROOMS)


def test_every_file_has_a_room():
    assert HOMELESS == []


def test_no_room_has_more_lines_than_it_may():
    assert budget.list_excess(SIZES, ROOMS) == []


def test_the_package_stays_below_the_figure_of_the_issue_that_is_open():
    lines = budget.sum_package(SIZES, ROOMS).lines
    assert lines <= WHOLE["now"] <= WHOLE["ceiling"]


def test_a_room_that_grows_is_named_with_both_numbers():
    rooms = {"signals": {"now": 10, "texts": 2}}
    over = budget.list_excess({"signals": budget.Size(11, 3, 1)}, rooms)
    assert says(over[0], "signals: 11 lines", "10") and says(over[1], "signals: 3 lines", "2")
