from gaitdisc.discovery.catalogue import known_shapes
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.penalty import BENT, FLEXIBLE, penalty_of


def penalty(case, label, **values):
    candidate = next(one for one in case.search.candidates if one.label == label)
    return penalty_of(candidate, dict.fromkeys(candidate.slots, 1.0) | values)


def test_what_imitates_anything_costs_more_than_a_plain_term(case):
    plain = penalty(case, "viscous_damping@load", factor=-0.3)
    assert plain == CRITERIA.plain
    for name in ("delayed_feedback", "product_coupling", "periodic_forcing"):
        assert penalty(case, f"{name}@load") == CRITERIA.flexible > 2 * plain


def test_a_friction_that_drives_costs_more(case):
    resists, drives = (penalty(case, "coulomb_friction@load", factor=one) for one in (-1.0, 1.0))
    assert drives == resists + CRITERIA.drives


def test_every_price_is_of_an_explanation_that_there_is(case):
    names = {shape.name for shape in known_shapes()} | {one.name for one in case.search.candidates}
    assert {*BENT, *FLEXIBLE} <= names | {"unnamed"}
