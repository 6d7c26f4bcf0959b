"""`discover` on a pendulum of MuJoCo: refusals, what goes into the mapping, and one whole inquiry."""

from dataclasses import replace
from importlib.util import find_spec

import numpy as np
import pandas as pd
import pytest
from manufactured_discovery import manufactured
from saved_folders import PENDULUM, SPRING, pendulum_trials
from texts import says
from typer.testing import CliRunner

from gaitdisc.cli import app


@pytest.fixture(scope="module")
def lab(tmp_path_factory):
    """Return a folder with a model, the truth, and four trials of it in degrees."""
    if find_spec("mujoco") is None:
        pytest.skip("MuJoCo is not installed: gaitdisc[mujoco]")
    folder = tmp_path_factory.mktemp("lab")
    (folder / "pendulum.xml").write_text(PENDULUM)
    (folder / "truth.xml").write_text(PENDULUM.replace("</mujoco>", f"{SPRING}</mujoco>"))

    def drive(rng, t):
        slow = 0.35 * np.sin(2 * np.pi * rng.uniform(0.5, 1.2) * t + rng.uniform(0, 6))
        return slow + 0.25 * np.sin(2 * np.pi * rng.uniform(1.2, 1.8) * t)

    pendulum_trials(folder / "truth.xml", 3, drive).to_csv(folder / "trials.csv", index=False)
    return folder


def test_a_mapping_is_written_by_new_and_not_over_an_edited_one(lab, tmp_path):
    file = tmp_path / "pendulum.toml"
    done = CliRunner().invoke(app, ["new", str(file), "--from", str(lab / "pendulum.xml"), "--degrees"])
    assert done.exit_code == 0 and "columns pivot, drive" in done.output
    file.write_text(f"{file.read_text()}\n# by hand\n")
    again = CliRunner().invoke(app, ["new", str(file), "--from", str(lab / "pendulum.xml")])
    assert again.exit_code != 0 and "was changed after" in str(again.exception)


def test_degrees_for_radians_and_a_column_that_is_not_there_are_refused(lab, tmp_path):
    said = CliRunner().invoke(app, ["discover", str(lab / "pendulum.xml"), str(lab / "trials.csv")])
    assert said.exit_code != 0 and "rad; it may be in degrees" in str(said.exception)
    table = pd.read_csv(lab / "trials.csv").rename(columns={"drive": "torque"})
    table.to_csv(tmp_path / "other.csv", index=False)
    said = CliRunner().invoke(app, ["discover", str(lab / "pendulum.xml"), str(tmp_path / "other.csv")])
    assert "must have a column 'drive'" in str(said.exception)


def test_a_coordinate_that_no_column_shows_is_refused(lab):
    from gaitdisc.discovery.discover_engine import read_trials
    from gaitdisc.engines.conventions import refuse_unmeasured
    from gaitdisc.engines.engine import read_model
    from gaitdisc.engines.mapping import draft
    from gaitdisc.errors import ChannelError

    model = read_model(lab / "pendulum.xml")
    mapping = draft(model)
    blind = replace(mapping, observations=(("pivot", "drive"),), sensors=())
    with pytest.raises(ChannelError, match="no column shows 'pivot'"):
        refuse_unmeasured(blind, model, read_trials(lab / "trials.csv", blind))


def test_what_was_found_goes_into_the_mapping(lab):
    from gaitdisc.discovery.candidate import Candidate
    from gaitdisc.discovery.discover_engine import _NOTHING
    from gaitdisc.discovery.fit_by_engine import EngineFit
    from gaitdisc.discovery.scored_model import Part
    from gaitdisc.engines.engine import read_model
    from gaitdisc.engines.mapping import draft

    engine = read_model(lab / "pendulum.xml")
    mapping = draft(engine)
    slow = {"z": "pivot_speed - z/_tau"}
    late = Part(Candidate("input_error", "input", "drive", "input_delay"), {"seconds": 0.04})
    mass = Part(Candidate("wrong_parameter", "parameter", "rod_mass", "wrong_parameter"), {"value": 2.1})
    own = Candidate("missing_physics", "port", "pivot_moment", "series", ("z",), {"tau": "delays"}, states=slow)
    fit = EngineFit(mapping, engine, measured=None, states=None)
    changed = fit.in_mapping(_NOTHING, (late, mass, Part(own, {"factor": -2.0, "tau": 0.1})))
    assert changed.model == "pendulum.xml" and changed.values()["rod_mass"] == 2.1
    assert changed.effects[0].place == "pivot_moment" and changed.states[-1].name == "z"
    assert changed.definitions == (("replaced_drive", "delay(drive, 0.04)"),)


def test_what_the_engine_itself_does_not_bear_out_is_taken_back():
    from gaitdisc.discovery.discover_engine import withdraw_effects

    said = manufactured()
    found = withdraw_effects(said, type("Runs", (), {"engine": "MuJoCo"})())
    assert (found.verdict, found.effects) == ("unexplained", ())
    assert found.rivals == (*said.effects, *said.rivals)
    assert says(found.sentence, "Not proven", "one-sided spring", "ankle_moment", "MuJoCo's", "without")


def test_what_mujoco_warns_of_is_a_finding_said_once():
    from gaitdisc.engines.conventions import list_warnings

    model = type("Model", (), {"called": "MuJoCo", "warnings": ("Nan in QACC.",)})()
    (finding,) = list_warnings(model, model)
    assert (finding.severity, finding.what) == ("warning", "MuJoCo warns: Nan in QACC.")


@pytest.mark.slow
def test_half_a_step_of_a_coarse_integrator_is_no_late_sensor(tmp_path):
    pytest.importorskip("mujoco", reason="MuJoCo is not installed: gaitdisc[mujoco]")
    from gaitdisc import discover

    def drive(rng, t):
        return sum(0.3 * np.sin(2 * np.pi * f * t + rng.uniform(0, 6)) for f in rng.uniform(0.4, 2.0, 3))

    (tmp_path / "coarse.xml").write_text(PENDULUM.replace('timestep="0.001"', 'timestep="0.02"'))
    trials = pendulum_trials(tmp_path / "coarse.xml", 5, drive, 50.0, 0.3, np.rad2deg(0.001))
    found, _ = discover(tmp_path / "coarse.xml", trials.assign(pivot=np.deg2rad(trials["pivot"])))
    assert found.verdict == "no_gap"


@pytest.mark.slow
def test_a_spring_is_named_written_into_the_model_and_met_by_its_own_runs(lab, tmp_path):
    mapping = ["new", str(lab / "pendulum.toml"), "--from", str(lab / "pendulum.xml"), "--degrees"]
    assert CliRunner().invoke(app, mapping).exit_code == 0
    words = ["discover", str(lab / "pendulum.xml"), str(lab / "trials.csv"), "--out", str(tmp_path), "-q"]
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 0, done.exception
    assert says(done.output, "a one-sided spring", "pivot_moment")
    assert "<tendon>" in (tmp_path / "pendulum_augmented.xml").read_text()
    from gaitdisc import discover, load

    (effect,) = load(tmp_path).effects
    assert effect.estimates["stiffness"].low < 20.0 < effect.estimates["stiffness"].high
    said = [one.what for one in load(tmp_path).findings if one.kind in ("own runs", "written back")]
    assert len(said) == 2 and "rms errors without and with the effects" in said[1]
    found, augmented = discover(lab / "pendulum.toml", pd.read_csv(lab / "trials.csv"))
    assert [one.name for one in found.effects] == ["one_sided_spring"] and augmented.model == "pendulum.xml"
    (lab / "pendulum.toml").unlink()
