import json

import jsonschema
import numpy as np
import pytest
from manufactured_discovery import SPRING, manufactured

from gaitdisc.channel import schema_folder
from gaitdisc.results.discovery import VERDICTS, GapSize, Whereabouts

SCHEMA = json.loads((schema_folder() / "discovery.schema.json").read_text(encoding="utf-8"))
CONTRACT = ["verdict", "where", "effects", "rivals", "gap"]


def test_the_contracts_keys_come_first():
    assert list(manufactured().to_json())[:5] == CONTRACT


def test_json_fits_the_schema():
    jsonschema.validate(manufactured().to_json(), SCHEMA)


def test_an_answer_without_an_effect_fits_the_schema_too():
    empty = manufactured(verdict="no_gap", where=(), effects=(), rivals=(), findings=(), provenance=None)
    jsonschema.validate(empty.to_json(), SCHEMA)


def test_schema_and_noun_know_the_same_verdicts():
    assert tuple(SCHEMA["properties"]["verdict"]["enum"]) == VERDICTS


def test_an_effect_says_its_place_by_its_kind():
    told = manufactured().to_json()["effects"][0]
    assert told["port"] == "ankle_moment"
    assert told["term"] == SPRING.term
    assert told["estimates"]["engagement"] == {"value": 0.035, "low": 0.033, "high": 0.037, "unit": "rad"}


def test_what_was_not_computed_is_null():
    nan = float("nan")
    gap = GapSize(nan, 1.0, 1.0, nan, {"theta": (nan, 1.0, 1.0)})
    told = manufactured(held_out=gap, where=(Whereabouts("equation", "v", nan),)).to_json()
    json.dumps(told, allow_nan=False)
    assert told["gap"]["held_out"]["before"] is None
    assert told["gap"]["held_out"]["channels"]["theta"]["before"] is None
    assert told["where"][0]["share_of_gap"] is None
    assert told["rivals"][0]["estimates"]["stiffness"]["low"] is None


def test_runs_are_told_sample_by_sample_under_the_trials_name():
    columns = manufactured().runs.table(("theta",))
    assert list(columns) == ["run", "trial", "time", "phase", "theta_measured", "theta_simulated", "theta_augmented"]
    assert set(columns["trial"]) == {"d"}
    assert np.unique(columns["run"]).tolist() == [1, 2]
    assert len(columns["time"]) == 800


def test_another_verdict_is_a_defect():
    with pytest.raises(ValueError, match="verdict is one of"):
        manufactured(verdict="perhaps")
