from pathlib import Path

import pytest
from texts import says

from gaitdisc.errors import ReadError
from gaitdisc.ingest.public_words import PublicWords, list_words, package_words
from gaitdisc.ingest.study import Kinematics


def test_a_name_is_hidden_and_a_file_is_called_by_its_participant(study):
    [person, other] = study.participants
    public = list_words(study, person)
    assert says(public.said("P01_exo.mot, line 31: 'Erika Mustermann'"), "P01", "1, line 31", "'…'")
    assert says(public.said("Zq2_exo.mot: knee_angle_r is 'x'"), "knee_angle_r", "'x'")
    assert list_words(study, other).files["P02_nominal.mot"] == "P02 nominal, file 1"


@pytest.mark.parametrize("word", ["Mustermann", "erika", "Zqtoken_knee", "knee_Zqtoken", "19700102a3b", "Müller"])
def test_no_word_from_outside_is_public(word):
    assert word not in PublicWords().said(f"column {word} is damaged")


def test_people_who_are_cited_in_the_source_are_no_public_words():
    assert not {"Ebers", "Zeni", "Winter", "Rajagopal", "Mustermann"} & package_words()


def test_an_error_stays_of_its_kind_and_says_where_the_words_are():
    error = PublicWords().error(ReadError("Erika.mot is to be read", "it is empty", "Export it again."))
    assert type(error) is ReadError
    assert says(str(error), "recording; `gaitdisc check`")


def test_settings_and_title_name_no_file_no_label_and_no_folder(study):
    labelled = study.model_copy(update={"title": "", "channels": {"Erika knee": "knee_angle_r"}})
    settings = labelled.placed(Path("Mustermann")).public_settings()
    assert settings["channels"] == {"label 1": "knee_angle_r"}
    assert settings["participants"][0]["trials"][0]["files"] == 1
    assert labelled.placed(Path("Mustermann")).public_title == "nominal against exo"
    assert "kinematics" not in settings and "mass_kg" not in settings["participants"][0]


def test_the_file_of_a_marker_set_and_the_measures_of_a_person_stand_in_no_settings(study):
    person = study.participants[0].model_copy(update={"mass_kg": 61.3, "height_m": 1.787, "sex": "f", "age_years": 57})
    own = Kinematics(angles="markers", marker_set="Mustermann.toml")
    settings = study.model_copy(update={"kinematics": own, "participants": (person,)}).public_settings()
    assert settings["kinematics"]["marker_set"] == "a file of the laboratory"
    assert not [said for said in ("61.3", "1.787", "57") if said in str(settings)]
    assert "Mustermann" not in str(settings)


def test_labels_of_the_marker_sets_that_come_along_are_public_and_those_they_cite_are_not():
    assert {"LASI", "RKNE", "condyles", "helen"} <= package_words()
    assert not {"Stebbins", "Delp"} & package_words()
