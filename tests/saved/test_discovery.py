import json
from dataclasses import replace

import jsonschema
import numpy as np
import pytest
from manufactured_discovery import SPRING, manufactured

from gaitdisc.channel import schema_folder
from gaitdisc.discovery.result import VERDICTS, Correction, Estimate, FoundEffect, GapSize, Whereabouts

SCHEMA = json.loads((schema_folder() / "discovery.schema.json").read_text(encoding="utf-8"))
CONTRACT = ["verdict", "where", "effects", "corrections", "rivals", "gap"]


def test_the_contracts_keys_come_first():
    assert list(manufactured().to_json())[:6] == CONTRACT


def test_json_fits_the_schema():
    jsonschema.validate(manufactured().to_json(), SCHEMA)


def test_an_answer_without_an_effect_fits_the_schema_too():
    empty = manufactured(verdict="no_gap", where=(), effects=(), rivals=(), findings=(), provenance=None)
    jsonschema.validate(empty.to_json(), SCHEMA)


def test_schema_and_noun_know_the_same_verdicts():
    assert tuple(SCHEMA["properties"]["verdict"]["enum"]) == tuple(VERDICTS)


def test_an_effect_says_its_place_by_its_kind():
    saved = manufactured().to_json()["effects"][0]
    assert saved["port"] == "ankle_moment"
    assert saved["term"] == SPRING.term
    assert saved["estimates"]["engagement"] == {"value": 0.035, "low": 0.033, "high": 0.037, "unit": "rad"}


def test_what_was_not_computed_is_null():
    nan = float("nan")
    gap = GapSize(nan, 1.0, 1.0, nan, {"theta": (nan, 1.0, 1.0)})
    saved = manufactured(held_out=gap, where=(Whereabouts("equation", "v", nan),)).to_json()
    json.dumps(saved, allow_nan=False)
    assert saved["gap"]["held_out"]["before"] is None
    assert saved["gap"]["held_out"]["channels"]["theta"]["before"] is None
    assert saved["where"][0]["share_of_gap"] is None
    assert saved["rivals"][0]["estimates"]["stiffness"]["low"] is None


def test_runs_are_given_sample_by_sample_under_the_trials_name():
    columns = manufactured().runs.to_frame(("theta",))
    assert list(columns) == ["run", "trial", "time", "phase", "theta_measured", "theta_simulated", "theta_augmented"]
    assert set(columns["trial"]) == {"d"}
    assert np.unique(columns["run"]).tolist() == [1, 2]
    assert len(columns["time"]) == 800


def test_another_verdict_is_a_defect():
    with pytest.raises(ValueError, match="verdict must be one of"):
        manufactured(verdict="perhaps")


def test_what_moved_within_its_bounds_stands_apart():
    moved = Correction("inertia", 0.110, Estimate(0.1126, 0.1118, 0.1134, "kg m^2"))
    saved = manufactured(corrections=(moved,)).to_json()
    jsonschema.validate(saved, SCHEMA)
    wanted = {"parameter": "inertia", "from": 0.11, "to": 0.1126, "low": 0.1118, "high": 0.1134, "unit": "kg m^2"}
    assert saved["corrections"] == [wanted]


def test_a_wrong_parameter_carries_the_bounds_that_it_left():
    wrong = FoundEffect("parameter", "g", "wrong_parameter", "", {"value": Estimate(17.0, 14.0, 20.0)})
    for bounds, written in (((9.79, 9.83), [9.79, 9.83]), ((-np.inf, 9.83), [None, 9.83])):
        saved = manufactured(effects=(replace(wrong, bounds=bounds),)).to_json()
        jsonschema.validate(saved, SCHEMA)
        assert saved["effects"][0]["bounds"] == written
    assert "bounds" not in manufactured().to_json()["effects"][0]


def test_the_test_on_held_out_data_says_on_how_many_pieces():
    saved = manufactured(held_out=GapSize(1.0, 0.5, 0.4, 0.03, {}, 7)).to_json()
    jsonschema.validate(saved, SCHEMA)
    assert (saved["gap"]["held_out"]["p"], saved["gap"]["held_out"]["pieces"]) == (0.03, 7)
