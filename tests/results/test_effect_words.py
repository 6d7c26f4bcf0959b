from gaitdisc.results.effect_words import at_place, spoken


def test_places_and_names_as_they_are_said():
    assert at_place("observation", "x") == "in the observation x"
    assert spoken("viscous_damping") == "viscous damping"
