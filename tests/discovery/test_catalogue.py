import pytest

from gaitdisc.discovery.catalogue import Shape, read_catalogue, read_shapes
from gaitdisc.errors import SchemaError

CONTRACT = {
    *("constant_load", "linear_stiffness", "quadratic_stiffness", "cubic_stiffness", "one_sided_spring"),
    *("dead_zone_spring", "viscous_damping", "one_sided_damper", "quadratic_drag", "coulomb_friction"),
    *("gravity_moment", "linear_coupling", "product_coupling", "periodic_forcing", "phase_locked_moment"),
    "delayed_feedback",
}
BEYOND_IT = {"contact_damper", "hysteresis", "series_elasticity", "input_product", "input_saturation"}


def test_the_catalogue_holds_the_names_of_the_contract_and_few_others():
    assert {shape.name for shape in read_shapes()} == CONTRACT | BEYOND_IT


def test_a_state_of_the_effects_own_is_no_role_and_its_derivative_names_roles():
    shape = Shape("slow", ("z",), {"tau": "delays"}, states={"z": "v - z/tau"})
    assert shape.roles == ("v",)


def test_every_shape_has_a_clause_for_a_reader():
    assert all(len(shape.means) > 5 for shape in read_shapes())


def test_roles_are_read_off_the_pieces():
    assert Shape("one", ("a*b", "v")).roles == ("v", "a", "b")
    assert Shape("one", ("exp(-x)",), {"x": "delays"}).roles == ()


def test_phase_is_seen_in_the_pieces():
    assert Shape("one", ("sin(phase)",)).uses_phase
    assert not Shape("one", ("sin(x)",)).uses_phase


def test_a_difference_is_put_in_parentheses():
    assert Shape("one", ("x**2",)).written({"x": "a1 - a2"}) == ("(a1 - a2)**2",)


def test_a_negative_number_is_put_in_parentheses():
    assert Shape("one", ("x - x0",)).written({"x": "q", "x0": "-0.25"}) == ("q - (-0.25)",)


def test_names_are_replaced_once_and_functions_stay():
    assert Shape("one", ("exp(x)*v",)).written({"x": "v", "v": "x"}) == ("exp(v)*x",)


def _refusal(tmp_path, text):
    file = tmp_path / "mine.toml"
    file.write_text(text)
    with pytest.raises(SchemaError) as caught:
        read_catalogue(file)
    return str(caught.value)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[[shape]", "a catalogue must be a TOML file of [[shape]] entries; mine.toml: "),
        ("", "a catalogue must contain only [[shape]] entries; mine.toml has no entries"),
        ('name = "x"', 'mine.toml has name. Begin each effect with a line "[[shape]]"'),
        ("shape = [1]", "mine.toml, shape 1 is not. Begin"),
        ('[[shape]]\nname = "a"\npiece = ["x"]', "mine.toml, shape 1 has 'piece'. Did you mean pieces?"),
        (
            '[[shape]]\nname = "a"\npieces = ["z"]\nstates = ["z"]',
            "must be names, each with its time derivative as an expression; mine.toml, shape 1 has ['z']",
        ),
        ('[[shape]]\nname = "a"\npieces = ["z"]\nstates = { z = "v - z/tau" }', "has 'tau'"),
        ('[[shape]]\nname = "a"\ncolour = 1', "mine.toml, shape 1 has 'colour'. Remove the key."),
        ('[[shape]]\nname = "My Effect"\npieces = ["x"]', "mine.toml, shape 1 has 'My Effect'"),
        ('[[shape]]\nname = "a"\npieces = "x"', "pieces must be a list of expressions; mine.toml, shape 1 has 'x'"),
        ('[[shape]]\nname = "a"\npieces = ["x*d"]\nconstants = { d = "guess" }', "has {'d': 'guess'}. Choose one"),
        ('[[shape]]\nname = "a"\npieces = ["x"]\nneeds = "luck"', "mine.toml, shape 1 has 'luck'. Remove the line."),
        (
            '[[shape]]\nname = "a"\npieces = ["x"]\n[[shape]]\nname = "b"\npieces = []',
            "mine.toml, shape 2 has []. Write pieces",
        ),
    ],
)
def test_a_catalogue_that_does_not_have_the_form_is_refused_in_words(tmp_path, text, words):
    assert words in _refusal(tmp_path, text)


def test_a_file_that_is_not_there_is_named(tmp_path):
    with pytest.raises(SchemaError, match=r"nowhere\.toml: .*No such file"):
        read_catalogue(tmp_path / "nowhere.toml")


def test_a_file_of_the_users_own_is_read_in_its_order(tmp_path):
    file = tmp_path / "mine.toml"
    file.write_text(
        '[[shape]]\nname = "b"\npieces = ["x**5"]\n[[shape]]\nname = "a"\npieces = ["v**3"]\nmeans = "thick"'
    )
    first, second = read_catalogue(file)
    assert (first.name, first.roles, second.means) == ("b", ("x",), "thick")
