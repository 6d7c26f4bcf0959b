import pytest
from hidden_in_a_mass import MASS, TWO_RODS, mass, two_rods

from gaitdisc.discovery.candidate import list_candidates
from gaitdisc.discovery.catalogue import read_shapes
from gaitdisc.discovery.places import find_driven_state, kinematic_rates, list_places, moved_by
from gaitdisc.simulation.running import compile_simulation
from gaitdisc.simulation.simulation_file import parse_simulation

LORENZ = """
[states.x]
[states.y]
[states.z]
[equations]
x = "10*(y - x)"
y = "x*(28 - z) - y"
z = "x*y - 2.7*z"
"""


def _places(simulation):
    return {place.name: place for place in list_places(simulation)}


def test_a_state_whose_derivative_is_another_state_is_kinematic():
    rods = two_rods()
    assert kinematic_rates(rods) == {"upper": "upper_rate", "lower": "lower_rate"}


def test_a_rate_that_is_scaled_is_not_kinematic():
    text = MASS.replace('x = "v"', 'x = "2*v"')
    scaled = parse_simulation(text, "scaled.toml")
    assert kinematic_rates(scaled) == {}


def test_a_port_sees_the_motion_that_it_drives():
    place = _places(mass())["load"]
    assert (place.kind, place.motions, place.others, place.angle) == ("port", (("x", "v"),), (), False)
    assert place.products == (("x", "v"),)
    held = parse_simulation(MASS.replace("push + load", "push - load"), "held.toml")  # a push holds it back
    assert (place.power, _places(held)["load"].power) == (1.0, -1.0)


@pytest.mark.parametrize(("port", "own"), [("upper_moment", "upper"), ("lower_moment", "lower")])
def test_in_a_chain_each_joint_sees_its_own_angle_first_then_the_difference_then_the_other(port, own):
    other = "lower" if own == "upper" else "upper"
    place = _places(two_rods())[port]
    assert place.angle
    assert place.motions == (
        (own, f"{own}_rate"),
        (f"{own} - {other}", f"{own}_rate - {other}_rate"),
        (other, f"{other}_rate"),
    )
    assert place.others == (other, f"{other}_rate")


def test_a_port_with_a_name_of_its_own_drives_what_it_moves_most():
    renamed = parse_simulation(TWO_RODS.replace("lower_moment", "brace"), "renamed.toml")
    machine = compile_simulation(renamed)
    assert find_driven_state(machine.states, "brace", moved_by(renamed, "brace")) == "upper_rate"


def test_a_model_without_ports_takes_effects_in_every_equation():
    places = _places(parse_simulation(LORENZ, "lorenz.toml"))
    assert list(places) == ["x", "y", "z"]
    assert places["y"].kind == "equation"
    assert places["y"].motions == (("y", ""),)
    assert places["y"].others == ("x", "z")


def test_a_kinematic_equation_takes_no_effect():
    portless = MASS.replace('[ports.load]\nunit = "N"\n', "").replace("push + load", "push")
    assert list(_places(parse_simulation(portless, "portless.toml"))) == ["v"]


def test_a_state_in_metres_a_second_without_its_position_is_a_speed():
    """Drag and friction act on it, and no spring."""
    simulation = parse_simulation("""
title = "A sled that is pushed"
[states.v]
unit = "m/s"
[inputs.push]
unit = "N"
[equations]
v = "push/80"
""")
    (place,) = list_places(simulation)
    assert place.motions == (("v", "v"),)
    names = {one.name for one in list_candidates(simulation, (place,), read_shapes()) if one.kind == "equation"}
    assert {"viscous_damping", "coulomb_friction", "quadratic_drag"} <= names
    assert not {"linear_stiffness", "cubic_stiffness", "one_sided_spring", "dead_zone_spring"} & names
