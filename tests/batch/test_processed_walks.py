from gaitdisc.batch.processed_walks import processed_walks, walks_and_errors
from gaitdisc.errors import ReadError


def test_both_walks_say_what_the_models_leave_away(study):
    walks, refusals = processed_walks(study, study.participants[0])
    assert (list(walks), refusals) == (["nominal", "exo"], ())
    assert all(walk.findings[-1].severity == "note" for walk in walks.values())


def test_one_walk_that_cannot_be_read_leaves_the_other(study):
    person = study.participants[0]
    lost = person.trials[1].model_copy(update={"files": ("gone.mot",)})
    person = person.model_copy(update={"trials": (person.trials[0], lost)})
    walks, errors = walks_and_errors(study, person)
    assert (list(walks), list(errors)) == (["nominal"], ["exo"])
    assert isinstance(errors["exo"], ReadError)
    assert processed_walks(study, person)[1][0].reason == str(errors["exo"])
