import pickle

from gaitdisc.errors import ChannelError, GaitdiscError


def test_sentence_says_needed_found_remedy():
    error = ChannelError("strides need a vertical force", "walk.mot has none", "Name it in [channels].")
    assert str(error) == "strides need a vertical force; walk.mot has none. Name it in [channels]."
    assert (error.needed, error.found, error.remedy) == error.args


def test_errors_cross_process_borders():
    error = pickle.loads(pickle.dumps(ChannelError("a", "b", "c")))
    assert isinstance(error, GaitdiscError)
    assert str(error) == "a; b. c"
