"""Every slip in a study file is said with file, line, key, what was found and what to do."""

from __future__ import annotations

import pytest
from pydantic import ValidationError

from gaitdisc.errors import SchemaError
from gaitdisc.ingest.study import Study
from gaitdisc.ingest.study_file import load_study, schema_error

TEXT = """title = "t"
[conditions]
nominal = "natural"
device = "exo"
[filters]
kinematics_hz = 6.0
[strides]
detector = "auto"
[[participants]]
id = "P01"
[[participants.trials]]
condition = "natural"
files = ["a.mot"]
crop_s = [1.0, 2.0]
"""


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("kinematics_hz", "kinematic_hz", r"line 6: .* 'kinematic_hz' is not known\. Did you mean 'kinematics_hz'\?"),
        ("[filters]", "[filter]", r"line 5: the keys of the study are .*'filter' is not .* mean 'filters'\?"),
        ("= 6.0", '= "6"', r"line 6: \[filters\] kinematics_hz must be a number; found '6'\. Write it without quotes"),
        ("= 6.0", "= -1", r"line 6: \[filters\] kinematics_hz must be above 0; found -1"),
        ("= 6.0", "= nan", r"kinematics_hz must be a finite number; found nan"),
        ("= 6.0", "= 6.0\norder = 3", r"line 7: \[filters\] order must be one of 2, 4, 6 or 8; found 3"),
        ("auto", "forces", r"line 8: \[strides\] detector must be one of .*; found 'forces'\. Did you mean 'force'\?"),
        ('"P01"', '"Anna M."', r"line 10: participants 1: id must be a pseudonym: .*\. Use for example P01"),
        ('["a.mot"]', '"a.mot"', r"line 13: participants 1, trials 1: files must be a list; found 'a\.mot'"),
        ('["a.mot"]', "[]", r"line 13: .* files must not be empty"),
        ('["a.mot"]', '["a.mot", 3]', r"line 13: participants 1, trials 1: files, entry 2, must be text; found 3"),
        ("[1.0, 2.0]", "[1.0]", r"line 14: .* crop_s needs 2 or more entries; found 1\. Add the other"),
        ("[1.0, 2.0]", "[2.0, 1.0]", r"line 14: .* crop_s needs a start before its end; found \[2\.0, 1\.0\]"),
        ('"natural"\nfiles', '"naturl"\nfiles', r"line 12: .* condition needs 'natural' or 'exo'; found 'naturl'"),
        ('nominal = "natural"\n', "", r"line 2: \[conditions\] needs 'nominal'; it is absent\. Add nominal \(the ref"),
        ("[[participants]]", "[participants]", r"must be a TOML file|two pairs of brackets: \[\[participants\]\]"),
        ('"t"', "t", r"must be a TOML file; it says: Invalid value \(at line 1, column 9\)"),
        ('"t"', "3", r"line 1: title must be text; found 3\. Write it in quotes"),
        ("[strides]\ndetector =", "strides =", r"must be a table; found 'auto'|kinematics_hz"),
        ("6.0", "true", r"kinematics_hz must be a number; found True"),
        ("[strides]", "[quality]\nmin_strides = 0\n[strides]", r"\[quality\] min_strides must be at least 1; found 0"),
        ("[strides]", "[held_out]\nshare = 1\n[strides]", r"line 8: \[held_out\] share must be below 1; found 1"),
        ("[strides]", "[quality]\nmin_strides = 2.5\n[strides]", r"min_strides must be a whole number; found 2\.5"),
    ],
)  # fmt: skip
def test_slips_are_named(tmp_path, old, new, message):
    assert old in TEXT
    path = tmp_path / "study.toml"
    path.write_text(TEXT.replace(old, new))
    with pytest.raises(SchemaError, match=message) as refusal:
        load_study(path)
    assert str(refusal.value).startswith("study.toml")


def test_what_else_is_wrong_is_counted(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(TEXT.replace("6.0", "-6.0").replace("auto", "x").replace('"t"', "1"))
    with pytest.raises(SchemaError, match=r"line 1.*\(2.*correct after this\.\)"):
        load_study(path)


def test_without_text_there_is_no_line():
    with pytest.raises(ValidationError) as refusal:
        Study.model_validate({})
    assert str(schema_error(refusal.value, Study, "", "a.toml")).startswith("a.toml: the study needs 'conditions'")
