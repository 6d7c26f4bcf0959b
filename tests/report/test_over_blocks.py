from dataclasses import replace

from gaitdisc.report.over_blocks import over_blocks, responder_sentences, responder_table


def test_the_blocks_that_have_something_to_say(tested, run):
    assert [block.anchor for block in over_blocks(tested)] == ["reduced", "baselines", "responders"]
    assert over_blocks(run) == []


def test_none_is_said_with_n_and_with_what_it_is_worth(tested):
    none = replace(
        tested.over, responders=tested.over.responders.assign(group=0), responders_said="No sub-groups (n = 11)"
    )
    said = responder_sentences(replace(tested, over=none))
    assert said[0] == "No sub-groups (n = 11)."
    assert "no proof of one kind" in said[1]
    assert responder_table(replace(tested, over=none)) is None


def test_groups_are_listed_by_participant(tested):
    groups = tested.over.responders.assign(group=[1 + i % 2 for i in range(11)])
    table = responder_table(replace(tested, over=replace(tested.over, responders=groups)))
    assert table.rows[0] == ("1", "P01, P03, P05, P07, P09, P11")
    assert "n = 11" in table.caption
