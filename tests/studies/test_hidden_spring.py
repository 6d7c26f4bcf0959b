"""Studies that hide an effect and find it: springs, joints, chains, a knee with memory, EMPS."""

import os
from pathlib import Path

import emps
import hidden_spring
import joints_and_chains
import knee_with_memory
import numpy as np
import pytest
from scipy.signal import lsim

from gaitdisc.simulation.measured_table import read_measured
from gaitdisc.simulation.simulation_file import read_simulation
from gaitdisc.simulation.unit_check import unit_findings


@pytest.fixture(scope="module")
def read(tmp_path_factory):
    simulation, table = hidden_spring.run(tmp_path_factory.mktemp("spring"))
    model = read_simulation(simulation)
    return model, read_measured(table, model)


def test_the_two_files_are_read_as_they_were_meant(read):
    model, measured = read
    assert (measured.trials, measured.channels, measured.rate) == (tuple("12345678"), ("theta",), 100.0)
    assert all(abs(count - 300) <= 1 for count in measured.drive.samples)
    assert 5.0 < np.degrees(np.nanmax(measured.observed)) < 20.0
    assert not model.effects
    assert unit_findings(model) == ()  # so that the README's `gaitdisc discover` prints no warning
    assert 1.0 < model.values()["foot_mass"] < 3.0


def test_an_ankle_that_nothing_acts_on_does_not_follow_its_record(read):
    """Else gains near 0 on every moment would explain any device better than the device does."""
    model, measured = read
    drive, mass = dict(zip((one.name for one in model.inputs), measured.drive.inputs[0].T, strict=True)), model.values()
    acting = drive["plantarflexors"] + drive["others"] - mass["foot_mass"] * drive["per_kg"]
    time, seen = np.arange(len(acting)) / measured.rate, measured.observed[0, :, 0]
    tracked = ([1.0], [1.0, 57.0, 800.0])
    off = [lsim(tracked, drive["recorded"] + share * acting, time)[1] - seen for share in (0.0, 0.3, 1.0)]
    nothing, third, all_of_it = (np.sqrt(np.nanmean(one[50:] ** 2)) for one in off)
    assert nothing > third > all_of_it  # though the spring is missing in all three


def test_what_is_hidden_changes_every_system_s_motion():
    for hidden in joints_and_chains.KNOWN.values():
        model = joints_and_chains.model_of(hidden)
        truth = joints_and_chains.complete(model, hidden, np.random.default_rng(1))
        driven, plain = (
            joints_and_chains.Driven(tuple(hidden.driven_by), 0.2, hidden.fastest_hz),
            joints_and_chains.Sensed(0.0),
        )
        one, other = (joints_and_chains.recorded(of, driven, plain, np.random.default_rng(2)) for of in (model, truth))
        channels = [name for name, _ in model.observations]
        one, other = (table[channels].to_numpy() for table in (one, other))
        assert np.isfinite(other).all()
        assert np.abs(one - other).max() > 0.05 * one.std(), hidden.model


def test_numbers_put_off_hold_the_true_ones_within_their_bounds():
    model = joints_and_chains.model_of(joints_and_chains.KNOWN["elbow"])
    off = joints_and_chains.put_off(model, 0.05, np.random.default_rng(3))
    for one, true in zip(off.parameters, model.parameters, strict=True):
        assert one.low < true.value < one.high
        assert one.value != true.value


@pytest.mark.slow
@pytest.mark.parametrize("name", ["leg", "exo ankle", "elbow", "standing", "chain"])
def test_each_is_named_and_nothing_is_invented(name):
    lines = joints_and_chains.run([name], 1, joints_and_chains.Record(0.02, 0.05, 6.0))
    assert all(": 1 of 1" in line for line in lines), lines


def test_what_is_hidden_changes_the_leg_s_motion_and_nothing_hides_nothing():
    for kind in knee_with_memory.KINDS:
        truth, _ = knee_with_memory.hidden(kind, np.random.default_rng(1))
        plain, _ = knee_with_memory.hidden("nothing", np.random.default_rng(1))
        sensed = knee_with_memory.Sensed(0.0, channels=("hip", "knee"))
        both = (
            knee_with_memory.recorded(leg, knee_with_memory.DRIVEN, sensed, np.random.default_rng(2))
            for leg in (truth, plain)
        )
        one, other = (table.to_numpy() for table in both)
        assert (np.abs(one - other).max() < 1e-9) == (kind == "nothing")


@pytest.mark.slow
def test_each_is_named_where_it_is_hidden():
    lines = knee_with_memory.run(1, 0.02)
    assert len(lines) == len(knee_with_memory.KINDS)
    assert all("named in 1 of 1" in line for line in lines), lines


PROJECT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def found():
    data = Path(os.environ.get("GAITDISC_DATA", PROJECT.parent / "shared" / "data")) / "hidden_effect" / "emps"
    if not (data / "DATA_EMPS.mat").exists():
        pytest.skip(f"the motor's record is absent: {data} (set GAITDISC_DATA)")
    return emps.run(True, data)


def test_dry_friction_is_named_first_and_of_the_published_size(found):
    assert (found.named, found.place) == ("coulomb_friction", "carriage")
    assert found.friction_n == pytest.approx(emps.PUBLISHED_N, rel=0.06)  # mass and damping move within their bounds


def test_free_runs_that_were_never_fitted_lose_three_quarters_of_their_error(found):
    for before, after in found.left_mm.values():
        assert after < 0.25 * before


def test_the_model_is_the_published_one_without_friction():
    values = emps.gd.read_simulation(emps.MODEL).values()
    assert values == {"mass": 95.1089, "viscous": 203.5034, "offset": -3.1648}


def test_the_results_page_has_what_the_quick_run_prints(found):
    from printed_blocks import apart, blocks

    text = (PROJECT / "studies" / "results" / "discovery.md").read_text(encoding="utf-8")
    [block] = [block for block in blocks(text) if "emps.py" in block.commands[-1]]
    assert apart("\n".join(block.written.splitlines()[1:3]), "\n".join(emps.lines(found)[:2])) == ""
