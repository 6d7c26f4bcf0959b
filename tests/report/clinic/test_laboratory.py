"""What a laboratory says of its pages and people, read from `clinic.toml`."""

import pytest

from gaitdisc.clinic.laboratory import LARGEST_LOGO, clinical_axes, load_laboratory
from gaitdisc.errors import SchemaError

PNG = b"\x89PNG\r\n\x1a\n"


def _written(folder, text, logo=PNG):
    (folder / "clinic.toml").write_text(text, encoding="utf-8")
    (folder / "logo.png").write_bytes(logo)
    (folder / "run").mkdir()
    return load_laboratory(folder / "run")


def test_without_a_file_the_axes_are_those_of_the_package(tmp_path):
    assert load_laboratory(tmp_path).axes == clinical_axes() and not load_laboratory(tmp_path).pdf


def test_name_logo_axes_side_and_comment_are_read_beside_the_study_file(tmp_path):
    text = 'laboratory = "Lab"\nlogo = "logo.png"\npdf = true\n[axes]\nknee_flexion = [-20, 90]\n'
    found = _written(tmp_path, f'{text}[people.P07]\naffected = "left"\ncomment = "cane"\n')
    assert (found.name, found.pdf, found.affected, found.comments) == ("Lab", True, {"P07": "left"}, {"P07": "cane"})
    assert found.axes == {**clinical_axes(), "knee_flexion": (-20.0, 90.0)}
    assert found.logo == "data:image/png;base64,iVBORw0KGgo="


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("laboratory = ", r"clinic.toml must be a TOML file"),
        ('colour = "red"', r"may have only laboratory, logo, pdf.*colour = 'red'"),
        ('pdf = "yes"', r"pdf = 'yes'"),
        ('[people.P07]\naffected = "front"', r"\[people.P07\].*front.*Words for affected: left, right, both"),
        ("[axes]\nknee_flexion = [75, -15]", r"the lower first.*knee_flexion = \[75, -15\]"),
        ("[axes]\nelbow = [0, 90]", r"\[axes\]: elbow"),
        ('logo = "other.png"', r"a logo must be a PNG or JPEG.*512 KiB.*other.png"),
    ],
)
def test_what_is_wrong_is_named_with_its_key(tmp_path, text, said):
    with pytest.raises(SchemaError, match=said):
        _written(tmp_path, text)


def test_a_logo_that_is_too_large_to_be_mailed_is_refused(tmp_path):
    with pytest.raises(SchemaError, match="512 KiB"):
        _written(tmp_path, 'logo = "logo.png"', PNG + bytes(LARGEST_LOGO))
