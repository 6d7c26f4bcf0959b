"""The pipe's two ends without OpenSim: what it answers where the engine is absent; it ends with its questions."""

import io
import pickle
import sys

from gaitdisc.engines.opensim_worker import serve


def test_an_absent_engine_is_an_answer_and_no_crash(monkeypatch):
    monkeypatch.setitem(sys.modules, "opensim", None)
    questions, answers = io.BytesIO(pickle.dumps(("described", ()))), io.BytesIO()
    serve(questions, answers, "arm.osim")
    word, said = pickle.loads(answers.getvalue())
    assert word == "absent" and "opensim" in said
