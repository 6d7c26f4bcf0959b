"""What an engine offers: names of ports, and what is said of unknown names."""

from gaitdisc.engines.engine import Coordinate, refuse_unknown


def test_a_slide_has_a_force_and_a_hinge_a_moment():
    assert Coordinate("pelvis_ty", "m", "pelvis_ty").port == "pelvis_ty_force"
    assert Coordinate("knee", "rad", "knee").port == "knee_moment"


def test_an_unknown_name_is_told_with_the_nearest():
    said = str(refuse_unknown("control", "hip_moter", ("hip_motor", "knee_motor"), "leg.xml"))
    assert "leg.xml has none called 'hip_moter'" in said and "Did you mean 'hip_motor'?" in said
