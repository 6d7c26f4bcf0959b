from __future__ import annotations

from gaitdisc.channel import vocabulary
from gaitdisc.results.clinical_variables import BY_NAME, PROFILE, VARIABLES


def test_every_variable_is_a_channel_of_the_vocabulary_and_has_a_place_of_its_own():
    for variable in VARIABLES:
        for side in "lr":
            channel = vocabulary().named(variable.channel(side))
            assert channel is not None, variable.name
            assert variable.unit.removesuffix("/kg") == channel.unit or (variable.unit, channel.unit) == ("%", "N")
    places = [(one.kind != "kinematics", one.row, one.column) for one in VARIABLES]
    assert len(set(places)) == len(places)


def test_the_profile_is_the_nine_curves_of_the_paper():
    assert len(PROFILE) == 9 and set(PROFILE) <= set(BY_NAME)
