"""What may be written of a recording: words of the package, its vocabulary and the study; every other is hidden."""

import numpy as np
import pytest

from gaitdisc.batch.public_words import HIDDEN, PublicWords, with_public_labels
from gaitdisc.channel import Channel
from gaitdisc.errors import ChannelError
from gaitdisc.recording import Finding, Recording

WORDS = PublicWords(frozenset({"W01", "nominal"}), {"Erika_2.mot": "W01 nominal, file 1"})


def test_words_of_the_package_and_of_the_study_stay():
    said = "trial of W01: ankle_angle_r has 12 samples, 3 are missing"
    assert WORDS.said(said) == said


@pytest.mark.parametrize("word", ["Mustermann", "Erika_M", "Zürich", "ログ"])
def test_any_other_word_is_hidden_and_the_reader_hears_where_it_stands(word):
    said = WORDS.said(f"column {word!r} has no unit")
    assert word not in said and HIDDEN in said
    assert said.endswith("words of the recording; `gaitdisc check` shows them.)")


def test_files_are_called_by_participant_condition_and_number():
    assert WORDS.said("Erika_2.mot has no unit") == "W01 nominal, file 1 has no unit"
    finding = WORDS.finding(Finding("warning", "gap", "Erika_2.mot", "a gap of 3 samples", "what rests on it", "Erika"))
    assert finding.file == "W01 nominal, file 1" and finding.channel == HIDDEN


def test_an_error_keeps_its_kind_and_its_remedy():
    error = WORDS.error(ChannelError("a channel is needed", "Erika_2.mot has 'Mustermann'", "Map it in the study."))
    assert isinstance(error, ChannelError)
    assert (
        "Mustermann" not in str(error) and "W01 nominal, file 1" in str(error) and "Map it in the study." in str(error)
    )


def test_an_error_on_the_way_is_said_in_public_words():
    def work():
        raise ChannelError("a channel is needed", "found Mustermann", "Map it.")

    with pytest.raises(ChannelError) as refusal:
        WORDS.of(work)
    assert "Mustermann" not in str(refusal.value)


def test_labels_of_no_vocabulary_are_numbered():
    channels = (Channel("Mustermann", "signal", "V"), Channel("ankle_angle_r", "angle", "deg", "r"))
    named, hidden = with_public_labels(Recording(np.arange(3) / 100, np.zeros((3, 2)), channels))
    assert named.names == ("signal_1", "ankle_angle_r") and hidden == 1
