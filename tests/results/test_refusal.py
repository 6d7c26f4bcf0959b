from gaitdisc.results import Refusal


def test_a_refusal_is_a_participant_a_walk_and_a_reason():
    assert Refusal("P01", "", "why").reason == "why"
    assert Refusal("P01", "walk 2", "why") != Refusal("P01", "walk 3", "why")
