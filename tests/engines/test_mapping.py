"""The mapping file: written from a model, read again, and every mismatch with the model refused in words."""

import numpy as np
import pytest
from texts import says

from gaitdisc.engines.engine import read_model
from gaitdisc.engines.mapping import (
    drafted,
    names_engine,
    other_values,
    read_mapping,
    with_input_changed,
    write_mapping,
)
from gaitdisc.engines.tracked_mapping import Tracked
from gaitdisc.errors import GaitdiscError
from gaitdisc.simulation.running import compile_simulation
from gaitdisc.simulation.simulation_file import read_simulation


def test_a_mapping_goes_to_its_file_and_back(pendulum, tmp_path):
    file = pendulum.with_suffix(".toml")
    written = write_mapping(read_model(pendulum), file, degrees=True)
    read, model = read_mapping(pendulum)  # the mapping beside it is found
    assert read == written and model.path == pendulum
    assert 'model = "pendulum.xml"' in file.read_text() and "[equations]" not in file.read_text()
    (name, expression), sensor = read.observations[0], read.sensor("pivot")
    assert (name, sensor.unit) == ("pivot", "deg")
    assert float(expression.partition("*")[0]) == pytest.approx(np.degrees(1.0))
    assert names_engine(file) and names_engine(pendulum) and not names_engine(file.with_name("else.toml"))
    (tmp_path / "walk.toml").write_text('[tracked]\nexternal_loads = "grf.xml"\n')
    assert names_engine(tmp_path / "walk.toml")


def test_a_walk_whose_motion_is_prescribed_has_nothing_to_run_forward(pendulum, tmp_path, monkeypatch):
    tracked = Tracked(tmp_path / "leg.osim", (tmp_path / "grf.xml", tmp_path / "grf.mot"))
    monkeypatch.setattr("gaitdisc.engines.mapping.read_tracked", lambda _: tracked)
    pendulum.with_suffix(".toml").write_text("[tracked]\n")
    with pytest.raises(GaitdiscError, match=r"pendulum.toml.*motion is prescribed"):
        read_mapping(pendulum)


def test_without_a_mapping_columns_have_the_coordinates_names(pendulum):
    mapping, _ = read_mapping(pendulum)
    assert mapping.observations == (("pivot", "pivot"),) and mapping.sensor("pivot").unit == "rad"


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("[inputs.drive]", "[inputs.drife]"), "none called 'drife'. Did you mean 'drive'"),
        (("[states.pivot]", "[states.pivott]"), "a coordinate, or its speed is one of the model's"),
        (("[ports.pivot_moment]", "[ports.hip_moment]"), "a port is one of the model's"),
        (("[parameters.rod_mass]", "[parameters.foot_mass]"), "none called 'foot_mass'"),
    ],
)
def test_what_is_not_the_models_is_refused(pendulum, change, words):
    file = pendulum.with_suffix(".toml")
    write_mapping(read_model(pendulum), file)
    text = file.read_text()
    assert change[0] in text
    if change[0].startswith("[states"):
        text = text.replace('expression = "pivot"', 'expression = "pivott"')
    file.write_text(text.replace(*change))
    with pytest.raises(GaitdiscError, match=words):
        read_mapping(file)


def test_a_number_that_is_not_the_models_is_told(pendulum):
    mapping, model = read_mapping(pendulum)
    assert other_values(mapping, model) == ()
    (said,) = other_values(mapping.with_values({"rod_mass": 3.0}), model)
    assert says(said.what, "rod_mass", "3", "2")


def test_a_mapping_is_no_simulation_that_runs_by_itself(pendulum):
    with pytest.raises(GaitdiscError, match=r"pendulum.xml..*to gaitdisc discover"):
        compile_simulation(drafted(read_model(pendulum)))


def test_equations_beside_a_model_are_refused(pendulum):
    file = pendulum.with_suffix(".toml")
    write_mapping(read_model(pendulum), file)
    file.write_text(file.read_text() + '\n[equations]\npivot = "pivot_speed"\n')
    with pytest.raises(GaitdiscError, match="the equations stand"):
        read_simulation(file)


def test_a_changed_control_is_written_as_a_definition(pendulum):
    changed = with_input_changed(drafted(read_model(pendulum)), "drive", "delay(drive, 0.04)")
    assert changed.definitions == (("replaced_drive", "delay(drive, 0.04)"),)
