"""Insertions into the text of an .osim file, as text: no engine is needed to see where they go."""

import numpy as np

from gaitdisc.engines.opensim_model import with_effect, with_value
from gaitdisc.simulation.parts import Term

TEXT = """<OpenSimDocument Version="40600"><Model name="arm"><gravity>0 -9.81 0</gravity>
<BodySet><objects><Body name="shank"><mass>4.0</mass><inertia>0.1 0.01 0.1 0 0 0</inertia></Body></objects></BodySet>
<ForceSet name="forceset"><objects><ThelenMuscle name="m"><PathPointSet><objects/></PathPointSet>
<max_isometric_force>500</max_isometric_force></ThelenMuscle>
<CoordinateActuator name="knee_motor"><optimal_force>15</optimal_force></CoordinateActuator></objects></ForceSet>
</Model></OpenSimDocument>"""
NAMES = ("knee", "knee_speed")


def inserted(term):
    text = with_effect(TEXT, Term("knee_moment", "port", "spring", term), NAMES, "knee")
    return text and text[text.index("<expression>") + 12 : text.index("</expression>")]


def test_a_force_goes_to_the_end_of_the_models_own_forces():
    text = with_effect(TEXT, Term("knee_moment", "port", "spring", "-2*knee"), NAMES, "knee")
    assert "</CoordinateActuator><ExpressionBasedCoordinateForce" in text
    assert text.replace(text[text.index("<Expr") : text.index("</Expr")], "").count("</objects>") == 2


def test_an_expression_is_written_as_opensim_reads_it():
    assert "max((0.0),((q)-(0.1)))" in inserted("-2*max(0, knee - 0.1)")
    assert inserted("-0.5*sign(knee_speed)").endswith("tanh((qdot)/0.02))")
    assert "sqrt((qdot)*(qdot))" in inserted("-knee_speed*abs(knee_speed)")
    assert "^" in inserted("-3*knee**3")


def test_what_knows_more_than_its_own_coordinate_has_no_form():
    assert inserted("-2*hip") is None
    assert inserted("-2*step(knee)") is None
    assert with_effect("<Model/>", Term("knee_moment", "port", "x", "knee"), NAMES, "knee") is None


def test_numbers_of_the_model():
    assert "<mass>5.0</mass><inertia>0.125 0.0125 0.125 0.0" in with_value(TEXT, "shank_mass", 5.0)
    assert "<optimal_force>18.0</optimal_force>" in with_value(TEXT, "knee_motor_optimal_force", 18.0)
    said = with_value(TEXT, "gravity", 8.0)
    vector = [float(word) for word in said.split("<gravity>")[1].split("</gravity>")[0].split()]
    assert np.allclose(vector, [0.0, -8.0, 0.0])
    assert "<max_isometric_force>350.0</" in with_value(TEXT, "m_max_isometric_force", 350.0)
    assert with_value(TEXT, "n_max_isometric_force", 350.0) is None
    assert with_value(TEXT, "foot_mass", 1.0) is None
