from texts import says

from gaitdisc.response.over_participants import compare_participants


def test_one_participant_is_described_but_not_compared(judged):
    over = compare_participants([judged])
    assert set(over.reductions["participant"]) == {judged.participant}
    assert not len(over.lengths) + len(over.baselines) + len(over.reduction_tests) + len(over.responders)
    assert over.lengths_said == ""
    assert says(over.responders_said, "6 participants", "n = 1")
