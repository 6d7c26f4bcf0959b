"""TOML nested deeper than anybody writes: one refusal in every file that a user writes in TOML."""

import tomllib

import pytest

from gaitdisc.discovery.catalogue import read_catalogue
from gaitdisc.errors import GaitdiscError
from gaitdisc.ingest.study_file import load_study
from gaitdisc.simulation.simulation_file import read_simulation
from gaitdisc.toml_text import DEEPEST, parse_toml

DEEP = {
    "brackets": "a = " + "[" * 5000,
    "closed brackets": "a = " + "[" * 300 + "]" * 300,
    "endless brackets": "a = " + "[" * 100_000 + "]" * 100_000,
    "dots": "a" + ".a" * 5000 + " = 1",
    "dots with blanks": "a" + " . 'a'" * 5000 + " = 1",
    "quoted dots": '"a"' + '."a"' * 5000 + " = 1",
    "table": "[a" + ".a" * 5000 + "]\nb = 1",
    "tables in a row": "[[a" + ".a" * 5000 + "]]\nb = 1",
    "inline tables": "a = " + "{a=" * 300 + "1" + "}" * 300,
    "lists of tables": "a = " + "[{a=" * 200 + "1" + "}]" * 200,
    "table in table": "\n".join("[" + ".".join(["a"] * depth) + "]" for depth in range(1, 60)),
}


@pytest.mark.parametrize("text", DEEP.values(), ids=DEEP.keys())
@pytest.mark.parametrize("read", [load_study, read_simulation, read_catalogue])
def test_every_file_of_toml_refuses_it_in_words(tmp_path, read, text):
    (tmp_path / "mine.toml").write_text(text)
    with pytest.raises(
        GaitdiscError, match=r"mine\.toml(.|\n)*(more than 40|Expected|Unclosed|Invalid|at line|end of)"
    ):
        read(tmp_path / "mine.toml")


def test_forty_levels_are_read_and_one_more_is_not():
    depth = DEEPEST
    assert parse_toml("a = " + "[" * (depth - 1) + "]" * (depth - 1))
    with pytest.raises(tomllib.TOMLDecodeError, match="nested more than 40"):
        parse_toml("a = " + "[" * depth + "]" * depth)


@pytest.mark.parametrize(
    "text",
    [
        "a = [" + ", ".join(["0.5"] * 200) + "]",
        'a = "' + "one. " * 200 + '"',
        "# " + "one. " * 200 + "\na = 1",
        "a = '" + "one. " * 200 + "'",
    ],
    ids=["decimals", "sentences", "comment", "literal"],
)
def test_dots_that_are_no_key_do_no_harm(text):
    assert list(parse_toml(text)) == ["a"]
