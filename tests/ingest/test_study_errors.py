"""Every slip in a study file, of one key or of several together, is said with file, line, key, what to do."""

import pytest
from pydantic import ValidationError
from pydantic_core import PydanticCustomError

from gaitdisc.errors import SchemaError
from gaitdisc.ingest.study import (
    Conditions,
    Participant,
    PlannedTrial,
    Study,
    check_conditions,
    check_participants,
    check_sessions,
)
from gaitdisc.ingest.study_file import find_line, load_study, schema_error
from gaitdisc.ingest.study_settings import Models, check_channels, check_variables, refuse

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
        ("kinematics_hz", "kinematic_hz", r"line 6: .*known\. Did you mean 'kinematics_hz'\?"),
        ("[filters]", "[filter]", r"line 5: the keys of the study.*'filter' is.* mean 'filters'\?"),
        ("= 6.0", '= "6"', r"line 6: \[filters\] kinematics_hz must be a number; found '6'\. Write the number without"),
        ("= 6.0", "= -1", r"line 6: \[filters\] kinematics_hz must be above 0; found -1"),
        ("= 6.0", "= nan", r"kinematics_hz must be a finite number; found nan"),
        ("= 6.0", "= 6.0\norder = 3", r"line 7: \[filters\] order must be one of 2, 4, 6 or 8; found 3"),
        ("auto", "forces", r"line 8: \[strides\] detector must be one of .*; found 'forces'\. Did you mean 'force'\?"),
        ('"P01"', '"Anna M."', r"line 10: participants 1: id must be a pseudonym: .*\. Use for example P01"),
        ('["a.mot"]', '"a.mot"', r"line 13: participants 1, trials 1: files must be a list; found 'a\.mot'"),
        ('["a.mot"]', "[]", r"line 13: .* files must not be empty"),
        ('["a.mot"]', '["a.mot", 3]', r"line 13: participants 1, trials 1: files, entry 2, must be text; found 3"),
        ("[1.0, 2.0]", "[1.0]", r"line 14: .* crop_s must have at least 2 entries; found 1\. Add one"),
        ("[1.0, 2.0]", "[2.0, 1.0]", r"line 14: .*a start before its end; found \[2\.0, 1\.0\]"),
        ('"natural"\nfiles', '"naturl"\nfiles', "line 12: .*'natural' or 'exo'; found 'naturl'"),
        ('nominal = "natural"\n', "", r"line 2: \[conditions\] must have 'nominal'; it is missing\. Add nominal \("),
        ("[[participants]]", "[participants]", r"must be a TOML file|two pairs of brackets: \[\[participants\]\]"),
        ('"t"', "t", r"must be a TOML file; the parser reports: Invalid value \(at line 1, column 9\)"),
        ('"t"', "3", r"line 1: title must be text; found 3\. Write the text in quotes"),
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
    with pytest.raises(SchemaError, match=r"line 1.*\(Further settings to correct: 2"):
        load_study(path)


def test_without_text_there_is_no_line():
    with pytest.raises(ValidationError) as refusal:
        Study.model_validate({})
    assert str(schema_error(refusal.value, Study, "", "a.toml")).startswith("a.toml: the study must have 'conditions'")


def test_a_refusal_carries_its_place_and_three_parts():
    with pytest.raises(PydanticCustomError) as refusal:
        refuse(("a", 1), "x", "y", "z.")
    assert refusal.value.context == {"place": ("a", 1), "needed": "x", "found": "y", "remedy": "z."}


def _participants(words, *people):
    """Study that is not validated, so that one rule can be tested alone."""
    trials = [Participant(id=id, trials=(PlannedTrial(condition=word, files=("a.mot",)),)) for id, word in people]
    return Study.model_construct(conditions=Conditions(nominal=words[0], device=words[1]), participants=tuple(trials))


@pytest.mark.parametrize(
    ("words", "people", "message"),
    [
        (("natural", "exo"), [("P1", "naturl")], r"'natural' or 'exo'; found 'naturl'\. Did you mean 'natural'\?"),
        (("natural", "exo"), [("P1", "zzz")], "Use one of these words, or 'unknown'"),
        (("natural", "exo"), [("p1", "exo"), ("P1", "exo")], "2 times"),
    ],
)
def test_conditions_and_pseudonyms(words, people, message):
    with pytest.raises(PydanticCustomError, match=message):
        check_participants(_participants(words, *people))


def test_unknown_conditions_may_be_listed():
    check_participants(_participants(("natural", "exo"), ("P1", "unknown"), ("P2", "exo")))


@pytest.mark.parametrize(
    ("conditions", "message"),
    [
        ({"nominal": "a", "device": "a"}, "different words.*found 'a' and 'a'"),
        ({"nominal": "a", "device": "unknown"}, "none of them 'unknown'"),
        ({"nominal": "a", "others": ("b", "b")}, "different words.*found 'a' and 'b' and 'b'"),
        ({"nominal": "a", "unnamed": "c"}, "one of 'a'; found 'c'"),
    ],
)
def test_words_of_conditions_differ(conditions, message):
    with pytest.raises(PydanticCustomError, match=message):
        check_conditions(Conditions(**conditions))


def _sessions(sessions, of_trial):
    trial = PlannedTrial(condition="a", session=of_trial, files=("a.c3d",))
    people = (Participant(id="P1", trials=(trial,)),)
    return Study.model_construct(sessions=sessions, conditions=Conditions(nominal="a"), participants=people)


@pytest.mark.parametrize(
    ("sessions", "of_trial", "message"),
    [
        (("2024-03-01",), None, "not be a date, because a date can identify a person; found '2024-03-01'"),
        (("01.03.24",), None, "date"),
        (("20240301",), None, "date"),
        (("March 2024",), None, "date"),
        (("pre", "pre"), None, "differ from the others; 'pre' occurs twice"),
        (("before", "after"), "befor", r"\('before', 'after'\); found 'befor'\. Did you mean 'before'\?"),
        ((), "pre", r"\(none\); found 'pre'\. Add it: sessions = \['pre'\]"),
    ],
)
def test_sessions_are_listed_and_no_dates(sessions, of_trial, message):
    with pytest.raises(PydanticCustomError, match=message):
        check_sessions(_sessions(sessions, of_trial))


def test_words_and_numbers_of_visits_are_no_dates():
    check_sessions(_sessions(("pre", "visit 2", "6 months", "session 12"), "visit 2"))


@pytest.mark.parametrize(
    ("channels", "message"),
    [
        ({"x": "emg_sol_r [mVs]"}, "be in the list of units; found 'mVs', the nearest is 'mV'"),
        ({"x": "emg_solr"}, r"found 'emg_solr'\. Did you mean 'emg_sol_r'\?"),
        ({"x": " [V]"}, r"the name of a channel; found ' \[V\]'"),
        ({"x": "emg_sol_r", "y": "emg_sol_r [V]"}, "'x' and 'y' both name 'emg_sol_r'"),
    ],
)
def test_channel_maps(channels, message):
    with pytest.raises(PydanticCustomError, match=message):
        check_channels(channels)


def test_own_channels_are_allowed_and_near_ones_if_they_state_a_unit():
    check_channels({"x": "belt_speed", "y": "emg_solr [V]", "z": "emg_sol"})


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ({"angles": ("knee_angle_r", "knee_angle_r")}, "each name once; 'knee_angle_r' occurs twice"),
        ({"angles": ("knee_angel_r",)}, "Did you mean 'knee_angle_r'"),
        ({"outputs": ("emg_sol_r",)}, "be among the inputs"),
        ({"emg": ("knee_angle_r",)}, "'knee_angle_r' is in both"),
    ],
)
def test_model_variables(parts, message):
    with pytest.raises(PydanticCustomError, match=message) as refusal:
        check_variables(Models(**parts), {})
    assert (refusal.value.context or {})["place"][:2] == ("models", *parts)


def test_names_of_the_map_are_known():
    models = Models(angles=("knee_angel_r",), outputs=("knee_angel_r",))
    check_variables(models, {"k": "knee_angel_r [deg]"})


NESTED = """title = "x"
[conditions]
nominal = "a"

[[participants]]
id = "P01"
[[participants.trials]]
condition = "a"
[[participants.trials]]
condition = "b"
[[participants]]
id = "P02"
  [[ participants.trials ]]
  "condition" = "c"
[strides]
detector.name = 1
"""


@pytest.mark.parametrize(
    ("place", "line"),
    [
        (("title",), 1),
        (("conditions", "nominal"), 3),
        (("conditions", "device"), 2),
        (("participants", 0, "id"), 6),
        (("participants", 0, "trials", 1, "condition"), 10),
        (("participants", 1, "trials", 0, "condition"), 14),
        (("participants", 1, "trials", 0, "files"), 13),
        (("participants", 1, "excluded"), 11),
        (("strides", "detector", "name"), 16),
        (("filters", "order"), None),
    ],
)
def test_the_line_of_a_key_or_of_its_table(place, line):
    assert find_line(NESTED, place) == line
