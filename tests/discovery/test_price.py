from gaitdisc.discovery.catalogue import known_shapes
from gaitdisc.discovery.price import DRIVES, PLAIN, PRICES, price_of


def price(inquiry, label, **values):
    candidate = next(one for one in inquiry.search.candidates if one.label == label)
    return price_of(candidate, dict.fromkeys(candidate.slots, 1.0) | values)


def test_what_imitates_anything_costs_more_than_a_plain_term(inquiry):
    plain = price(inquiry, "viscous_damping@load", factor=-0.3)
    assert plain == PLAIN
    for name in ("delayed_feedback", "product_coupling", "periodic_forcing"):
        assert price(inquiry, f"{name}@load") > 3 * plain


def test_a_friction_that_drives_costs_more(inquiry):
    resists, drives = (price(inquiry, "coulomb_friction@load", factor=one) for one in (-1.0, 1.0))
    assert drives == resists + DRIVES


def test_every_price_is_of_an_explanation_that_there_is(inquiry):
    names = {shape.name for shape in known_shapes()} | {one.name for one in inquiry.search.candidates}
    assert set(PRICES) <= names | {"unnamed"}
