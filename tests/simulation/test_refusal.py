"""A refusal tells its part of the simulation."""

from texts import says

from gaitdisc.simulation.refusal import SimulationError


def test_it_says_where_before_what():
    error = SimulationError("every name is known", "'omgea' is not", "Write 'omega'.").at("equations", "omega")
    assert says(str(error), "[equations] omega", "'omgea'", "'omega'")


def test_without_a_place_it_is_the_sentence_alone():
    assert str(SimulationError("a", "b", "C.")) == "a; b. C."
