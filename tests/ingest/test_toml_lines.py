"""Lines of keys in nested tables and arrays of tables."""

from __future__ import annotations

import pytest

from gaitdisc.ingest.study_file import line_of

TEXT = """title = "x"
[conditions]
nominal = "a"

[[participants]]
id = "P01"
[[participants.trials]]
condition = "a"
[[participants.trials]]
condition = "b"
[[participants]]
id = "P02"
  [[ participants.trials ]]
  "condition" = "c"
[strides]
detector.name = 1
"""


@pytest.mark.parametrize(
    ("place", "line"),
    [
        (("title",), 1),
        (("conditions", "nominal"), 3),
        (("conditions", "device"), 2),
        (("participants", 0, "id"), 6),
        (("participants", 0, "trials", 1, "condition"), 10),
        (("participants", 1, "trials", 0, "condition"), 14),
        (("participants", 1, "trials", 0, "files"), 13),
        (("participants", 1, "excluded"), 11),
        (("strides", "detector", "name"), 16),
        (("filters", "order"), None),
    ],
)
def test_the_line_of_a_key_or_of_its_table(place, line):
    assert line_of(TEXT, place) == line
