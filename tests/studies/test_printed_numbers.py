import re
import shlex

import pytest
from claims import write_table
from command_line import SHARED
from printed_blocks import FORMS, Block, apart, blocks, difference, first_two, quoted, renewed, scores
from printed_numbers import PROJECT, answer, commands_of_tables, pages, without_command

PAGES = {page.relative_to(PROJECT).as_posix(): page.read_text(encoding="utf-8") for page in pages()}
EVERY = [(name, block) for name, text in PAGES.items() for block in blocks(text)]


@pytest.mark.parametrize(
    ("printed", "words"),
    [
        ("falls 1.65 to 0.22 deg", ""),
        ("falls 1.66 to 0.21 deg", ""),  # the last digit is what another processor rounds otherwise
        ("falls 1.67 to 0.22 deg", "1.65 is printed as 1.67"),
        ("rises 1.65 to 0.22 deg", "'falls 1.65 to 0.22 deg' is printed as 'rises"),
        ("falls −1.65 to 0.22 deg", "1.65 is printed as −1.65"),
        ("falls 1.65 to 0.22 deg\nmore", "1 lines are printed as 2"),
    ],
)
def test_words_are_compared_exactly_and_numbers_to_their_last_digit(printed, words):
    found = apart("falls 1.65 to 0.22 deg", printed)
    assert found.startswith(words) and bool(found) == bool(words)


def test_numbers_of_one_machine_are_not_compared_but_their_words_are():
    block = Block(("gaitdisc x",), "measured", "run [s] 0.41")
    assert difference(block, "run [s] 0.95") == ""
    assert "fit [s]" in difference(block, "fit [s] 0.41")


def test_powers_and_thousands():
    assert apart("1,690 calls, 9e-8", "1,691 calls, 1e-7") == ""
    assert "1,690" in apart("1,690 calls", "1,700 calls")


def test_a_quotation_may_be_broken_elsewhere():
    assert apart("> a b\n> 1.0", "> a\n> b 1.1") == ""


def test_a_block_is_rewritten_and_the_rest_of_the_page_left():
    text = "before 1\n<!-- printed by: gaitdisc x; gaitdisc y | code -->\nold\n<!-- end -->\nafter 2\n"
    [block] = blocks(text)
    assert (block.commands, block.form, block.written) == (("gaitdisc x", "gaitdisc y"), "code", "old")
    assert renewed(text, lambda _: "new") == text.replace("old", "new")
    assert renewed(text, lambda _: None) == text


def test_forms_take_what_readers_need():
    assert quoted("One. Two. Three.\nreport: here") == "> One. Two. Three."
    assert first_two("1.5 deg. Two. Three.") == "> 1.5 deg. Two. …"
    assert scores("  W01\n\n     network\nW01  0.68\n────\n\nmedian\n") == "```\n     network\nW01  0.68\n```"


def test_marks_are_whole_and_forms_known():
    for name, text in PAGES.items():
        assert text.count("<!-- printed by:") == text.count("<!-- end -->") == len(blocks(text)), name
    assert {block.form.removesuffix(", slow") for _, block in EVERY} <= set(FORMS)
    assert [heads for page in pages() for heads in without_command(page)] == []
    assert commands_of_tables("| a |\n|---|\n| 1 |\n") == {"| a |": ""}
    assert {"README.md", "docs/examples.md", "docs/discover.md", "studies/results/chapter3.md"} <= {
        name for name, _ in EVERY
    }


@pytest.mark.parametrize("page", ["README.md", "docs/examples.md"])
def test_a_reader_finds_the_commands_of_every_block(page):
    for block in blocks(PAGES[page]):
        for command in block.commands:
            assert PAGES[page].replace(f"printed by: {'; '.join(block.commands)}", "").count(command), command


def test_one_command_has_one_answer_on_all_pages():
    answers: dict[tuple[object, ...], str] = {}
    for name, block in EVERY:
        first = answers.setdefault((block.commands, block.form), block.written)
        assert apart(first, block.written) == "", name


def test_friction_in_the_examples_is_that_of_the_results():
    [block] = [block for _, block in EVERY if "emps.py" in block.commands[-1]]
    [friction] = re.findall(r"coulomb_friction at carriage, (\S+) N", block.written)
    assert f"dry friction of {friction}." in PAGES["docs/examples.md"]
    assert "exclude the published 20.4 N" in PAGES["docs/examples.md"]


@pytest.mark.slow
@pytest.mark.parametrize("last", sorted({one.commands[-1] for _, one in EVERY}), ids=lambda one: shlex.split(one)[1])
def test_every_block_is_what_its_command_prints(last, tmp_path):
    block = next(block for _, block in EVERY if block.commands[-1] == last)
    if "DATA" in last and not SHARED.is_dir():
        pytest.skip(f"real recordings are absent: {SHARED} (set GAITDISC_DATA)")
    assert difference(block, str(answer(block, tmp_path, {}))) == ""


@pytest.mark.parametrize("block", [block for _, block in EVERY if "claims.py" in block.commands[-1]])
def test_claims_are_what_the_results_behind_them_say(block):
    assert write_table(block.commands[-1].split()[-1]) == block.written
