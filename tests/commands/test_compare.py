import pytest
from texts import says

from gaitdisc.commands.options import REFUSED

pytestmark = pytest.mark.usefixtures("unpainted")
USAGE = 2


def test_two_recordings_give_a_sentence_a_table_and_a_report(recordings, tmp_path, called):
    files = (recordings / "walker1" / f"{word}.mot" for word in ("exo", "natural"))
    done = called("compare", *files, "--out", tmp_path, ends=0)
    assert done.stdout.startswith("In natural the ")
    assert "ankle is up to" in done.stdout.split(".")[0] + done.stdout.split(".")[1]
    assert (tmp_path / "report.html").is_file()
    assert (tmp_path / "mismatch.json").is_file()


def test_a_participant_of_a_study(study, called):
    done = called("compare", study, "--participant", "P01", "--channel", "ankle_angle_r", ends=0)
    assert says(done.stdout, "P01", "right")
    assert (study / "compare" / "report.html").is_file()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["{exo}"], "must have two recordings, or a study; exo.mot is one recording. Name the measured walk after it"),
        (["{exo}", "{exo}"], "are identical files"),
        (["{exo}", "{natural}", "--channel", "ankle_ange_r"], "the most similar common name is 'ankle_angle_r'"),
        (["{exo}", "{natural}", "--detector", "force"], "the same detector must find strides in both"),
    ],
)
def test_refusals_are_one_sentence(called, recordings, tmp_path, words, said):
    files = {word: recordings / "walker1" / f"{word}.mot" for word in ("exo", "natural")}
    done = called("compare", *(word.format(**files) for word in words), "--out", tmp_path, ends=REFUSED)
    assert said in done.stderr


def test_a_participant_of_two_files_is_wrong_usage(recordings, called):
    files = (recordings / "walker1" / f"{word}.mot" for word in ("exo", "natural"))
    called("compare", *files, "--participant", "P01", ends=USAGE)
