import pytest
from made_clinic import made_controls, made_person, made_run

from gaitdisc.clinic.clinical_reference import PersonSession
from gaitdisc.clinic.run_pages import before_and_after, cycles_of_people, read_session
from gaitdisc.errors import SchemaError


def test_one_page_a_person_and_session_the_first_condition_first():
    run = made_run(made_person(condition="turn"), made_person(), made_person("P02", session="before"))
    people = cycles_of_people(run)
    assert list(people) == ["P01", "P02 before"]
    found = {title: read_session(title, own, run.nominal, made_controls(6)) for title, own in people.items()}
    assert [one.pooled.condition for one in found["P01"].readings] == ["walk", "turn"]
    assert len(found["P01"].contrasts) == 1 and isinstance(found["P02 before"], PersonSession)


def test_before_and_after_are_found_by_their_words():
    run = made_run(made_person(session="s1"), made_person(session="s2"), made_person(session="s2", condition="fast"))
    for words in (("s1", "s2"), ("walk", "fast")):
        found = before_and_after(run, None, "P01", words)
        second, first = found.readings
        assert found.before_after is not None and found.before_after.first is first
        assert words[0] in first.pooled.where and words[1] in second.pooled.where
    with pytest.raises(SchemaError, match=r"s1 walk, s2 walk, s2.*fast"):
        before_and_after(run, None, "P01", ("s1", "s3"))
    with pytest.raises(SchemaError, match=r"kept cycles.*'P07'.*one of: P01"):
        before_and_after(run, None, "P07", ("s1", "s2"))
