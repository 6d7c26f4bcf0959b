from gaitdisc.commands.exit_codes import REFUSED


def test_a_study_is_not_overwritten(study, recordings, called):
    done = called("new", study, "--from", recordings)
    assert done.returncode == REFUSED
    assert "is there already" in done.stderr
