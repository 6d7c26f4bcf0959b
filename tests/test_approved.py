"""Whatever a user reads is as it was approved; `python tests/approve.py` shows what differs, `--yes` approves it."""

import pytest
from approve import SAVED, Words, difference, draw_pages, list_help, list_templates, read_approved

APPROVED = read_approved()
KINDS = sorted(folder.name for folder in SAVED.iterdir())


def unlike(made: dict[str, str], start: str) -> list[str]:
    """Differences from the approved texts whose place begins so."""
    names = made.keys() | {name for name in APPROVED if name.startswith(start)}
    return [f"{name}: {d}" for name in sorted(names) if (d := difference(APPROVED.get(name, ""), made.get(name, "")))]


@pytest.mark.usefixtures("unpainted")
@pytest.mark.parametrize("kind", KINDS)
def test_the_pages_of_a_saved_folder_say_what_was_approved(kind):
    assert unlike(draw_pages(kind), f"pages/{kind}/") == []


def test_the_help_of_every_command_is_as_approved():
    assert unlike(list_help(), "help/") == []


def test_refusals_and_findings_of_every_room_are_as_approved():
    assert unlike(list_templates(), "refusals/") == []


def test_a_page_is_read_as_lines_and_rows_without_its_style():
    html = (
        '<style>p {}</style><h1>Knee</h1><p>2&nbsp;<b>deg</b> less</p><tr><td>a</td><td>1</td></tr><img alt="a curve">'
    )
    assert Words(html).text().splitlines() == ["Knee", "2 deg less", "a | 1", "[figure: a curve]"]


@pytest.mark.parametrize(
    ("approved", "made", "same"),
    [
        ("1.20 deg", "1.21 deg", True),
        ("1.20 deg", "1.22 deg", False),
        ("1.20 deg", "1.21 rad", False),
        ("5 of 9", "5 of", False),
        ("P01", "P02", False),
    ],
)
def test_only_the_last_printed_digit_may_differ(approved, made, same):
    assert (difference(approved, made) == "") is same
