from hidden_in_a_mass import mass, two_rods

from gaitdisc.discovery.candidate import unnamed_terms
from gaitdisc.discovery.places import places_of
from gaitdisc.simulation.running import compile_simulation


def terms(simulation):
    found = unnamed_terms(simulation, places_of(simulation, compile_simulation(simulation)))
    return [(one.place, one.pieces[0]) for one in found]


def test_an_input_and_a_state_times_it_may_act_at_a_port():
    assert terms(mass()) == [("load", "push"), ("load", "x*push")]


def test_another_bodys_acceleration_may_act_with_nothing_at_its_port():
    upper, lower = terms(two_rods())
    assert (upper[0], lower[0]) == ("upper_moment", "lower_moment")
    assert "lower_rate" in upper[1] and "upper_rate" in lower[1]
    assert "moment" not in upper[1] + lower[1]


def test_each_compiles_where_it_is_put():
    simulation = two_rods()
    for one in unnamed_terms(simulation, places_of(simulation, compile_simulation(simulation))):
        assert one.name == "unnamed"
        compile_simulation(one.written(simulation, {"factor": "0.5"}))
