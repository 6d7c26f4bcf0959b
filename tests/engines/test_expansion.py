"""A pendulum expanded along a run answers as MuJoCo does; the engine's own runs meet a record that it made."""

from dataclasses import replace

import numpy as np
import pytest
from texts import says

from gaitdisc.discovery.estimated_filter import find_record_filter
from gaitdisc.discovery.record_filter import RecordFilter
from gaitdisc.engines import own_runs
from gaitdisc.engines.engine import read_model
from gaitdisc.engines.expansion import FASTEST, _slow_speeds, expand
from gaitdisc.engines.mapping import draft, with_input_changed
from gaitdisc.engines.motion import Motion
from gaitdisc.engines.own_runs import Driven, OwnRuns, Stretches, residual_by, spread_stretches
from gaitdisc.engines.written import write_model
from gaitdisc.recording.arrays import root_mean_square
from gaitdisc.simulation.compiled_simulation import Drive, Rows
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.parts import Sensor, State, Term
from gaitdisc.simulation.running import compile_simulation
from gaitdisc.simulation.simulation import Simulation

from .conftest import DAMPING, GEAR, PENDULUM

RATE, SAMPLES = 100.0, 150


def recorded(model):
    """Controls, what is measured and all states of a run."""
    controls = 0.3 * np.sin(9.0 * np.arange(SAMPLES) / RATE)[:, None]
    whole = model.run(Motion(np.array([[0.4]]), np.zeros((1, 1)), np.zeros((1, 1))), controls[None], RATE)
    return controls, Measured(Drive.of([controls], RATE), whole[:, :, :1], ("1",), ("pivot",)), whole


def test_runs_near_the_record_are_those_of_the_engine(pendulum, monkeypatch):
    model = read_model(pendulum)
    controls, measured, whole = recorded(model)
    linear, driven = expand(draft(model), model, measured, whole)
    machine = compile_simulation(linear)
    start = whole[:, 0]
    run = machine.run(driven.drive, Rows(np.zeros(1, int), np.zeros(1, int), start), SAMPLES - 1)[0]
    assert np.abs(run[0, :, 0] - whole[0, :, 0]).max() < 3e-3 * np.ptp(whole[0, :, 0])  # steps of 1 ms, first order
    names = [one.name for one in linear.inputs if one.computed]
    assert names and all(one.startswith("pivot_speed_") for one in names)
    assert [one.name for one in linear.driving] == ["drive"]

    point = [np.array([70 / RATE]), whole[:, 70], driven.drive.inputs[:, 70]]
    pushed = compile_simulation(linear.with_effect(Term("pivot_moment", "port", "push", "2.5")))
    at = Motion(whole[:, 70, :1], whole[:, 70, 1:], controls[70:71])
    assert np.allclose(machine.rates(*point)[:, 1:], model.accelerations(at, {}), rtol=1e-9)
    assert np.allclose(pushed.rates(*point)[:, 1:], model.accelerations(at, {}, np.full((1, 1), 2.5)), rtol=1e-9)

    half = expand(with_input_changed(draft(model), "drive", "0.5*drive"), model, measured, whole)[0]
    at = Motion(at.q, at.v, at.u / 2)
    assert np.allclose(compile_simulation(half).rates(*point)[:, 1:], model.accelerations(at, {}), rtol=1e-9)
    at = Motion(at.q, at.v, at.u * 2)

    heavier = compile_simulation(linear.with_values({"rod_mass": 2.02}))
    wanted = model.accelerations(at, {"rod_mass": 2.02})
    assert np.allclose(heavier.rates(*point)[:, 1:], wanted, rtol=1e-3)
    around, other = expand(draft(model), model, measured, whole, {"rod_mass": 2.02})
    again = compile_simulation(replace(around, parameters=around.with_values({"rod_mass": 2.02}).parameters))
    assert np.allclose(again.rates(*point[:2], other.drive.inputs[:, 70])[:, 1:], wanted, rtol=1e-9)
    monkeypatch.setattr("gaitdisc.engines.expansion.MOST_MIXED", 0)
    few = expand(draft(model), model, measured, whole)[0]
    assert any("_and_" in one for one in names) and not any("_and_" in one.name for one in few.inputs)


@pytest.mark.parametrize("late", [1.0, 0.2, -1.0])
def test_a_servo_at_the_limit_of_its_force_is_expanded_exactly(pendulum, late):
    """The record saturates; another control takes the motor off its limit, or to the other one."""
    motor = '<position kp="30" kv="0.2" forcerange="-0.4 0.4" name="drive"'
    pendulum.write_text(PENDULUM.replace('<motor name="drive"', motor).replace(f'gear="{GEAR}"', 'gear="2"'))
    model = read_model(pendulum)
    _, measured, whole = recorded(model)
    linear, driven = expand(draft(model), model, measured, whole)
    u = late * driven.drive.inputs[0, :, :1]
    at = Motion(whole[0, :, :1], whole[0, :, 1:], u)
    inputs = np.hstack([u, driven.drive.inputs[0, :, 1:]])
    rates = compile_simulation(linear).rates(np.arange(SAMPLES) / RATE, whole[0], inputs)
    wanted = model.accelerations(at, {})
    assert np.ptp(wanted) > 1.0 and np.allclose(rates[:, 1:], wanted, rtol=1e-9, atol=1e-9)


def test_a_motor_of_a_tendon_keeps_the_limit_of_its_force(pendulum):
    """It has no form in the expansion: that takes it from the record, as it is at its limit there."""
    cord = '<tendon><fixed name="cord"><joint joint="pivot" coef="1"/></fixed></tendon></mujoco>'
    motor = '<position kp="30" forcerange="-0.4 0.4" name="drive" tendon="cord"'
    text = PENDULUM.replace('<motor name="drive" joint="pivot"', motor).replace("</mujoco>", cord)
    pendulum.write_text(text)
    model = read_model(pendulum)
    controls, measured, whole = recorded(model)
    linear, driven = expand(draft(model), model, measured, whole)
    rates = compile_simulation(linear).rates(np.arange(SAMPLES) / RATE, whole[0], driven.drive.inputs[0])
    wanted = model.accelerations(Motion(whole[0, :, :1], whole[0, :, 1:], controls), {})
    assert np.allclose(rates[:, 1:], wanted, rtol=1e-9, atol=1e-9)
    assert model.without_force_limits({}) == (model, [])


def test_a_run_beside_the_record_is_that_of_the_muscles_whose_fibres_follow(elbow):
    """Started 2 degrees and 0.3 rad/s off, it comes back as OpenSim's does: stiffness and damping of the fibres."""
    model, t = read_model(elbow), np.arange(70) / RATE
    u = np.column_stack([0.2 + 0.15 * np.sin(9 * t), 0.2 + 0.1 * np.cos(7 * t)])
    begun = Motion(np.array([[0.2]]), np.zeros((1, 1)), u[:1])
    whole = model.run(begun, u[None], RATE)
    measured = Measured(Drive.of([u], RATE), whole[:, :, :1], ("1",), ("elbow",))
    mapping = draft(model)
    quick = replace(mapping, parameters=mapping.parameters[:1], equations=_rest(mapping))
    linear, driven = expand(quick, model, measured, whole)
    first, count = 15, 40
    along = model.along(whole[0, :, :1], whole[0, :, 1:], u, RATE).at(np.array([first]))
    off = whole[0, [first]] + np.array([[0.035, 0.3]])
    runs = [
        model.run(model.near(along, each[:, :1], each[:, 1:]), u[None, first : first + count + 1], RATE)[0]
        for each in (off, whole[0, [first]])
    ]
    machine = compile_simulation(linear)
    found = [
        machine.run(driven.drive, Rows(np.zeros(1, int), np.array([first]), each), count)[0][0]
        for each in (off, whole[0, [first]])
    ]
    wanted, moved = runs[0][:, 0] - runs[1][:, 0], found[0][:, 0] - found[1][:, 0]
    assert np.sqrt(np.mean((moved - wanted) ** 2)) < 0.2 * np.sqrt(np.mean(wanted**2))


def _rest(mapping):
    """Equations that name the first parameter alone."""
    named = " + ".join([one.name for one in (*mapping.inputs, *mapping.parameters[:1], *mapping.ports)])
    return tuple((one.name, named) for one in mapping.states)


def test_what_is_too_fast_for_a_run_is_made_heavier_and_comes_to_rest_at_the_same_place():
    damping = np.array([[[1200.0, 30.0], [10.0, 20.0]]])
    factor, more = _slow_speeds(damping)
    assert np.allclose(factor @ (more + np.eye(2)), np.eye(2))
    before, after = (np.sort(np.linalg.eigvals(each[0]).real) for each in (damping, factor @ damping))
    assert np.isclose(after[1], FASTEST) and np.isclose(before[0], after[0])


def test_a_joint_whose_damping_settles_in_half_a_millisecond_can_be_followed(pendulum):
    stiff = PENDULUM.replace(f'damping="{DAMPING}"', 'damping="740"').replace(f'gear="{GEAR}"', 'gear="5000"')
    pendulum.write_text(stiff)
    model = read_model(pendulum)
    controls, measured, whole = recorded(model)
    linear, driven = expand(draft(model), model, measured, whole)
    aside = Rows(np.zeros(1, int), np.full(1, 20), whole[:, 20] + np.array([0.05, 0.0]))
    run, ok = compile_simulation(linear).run(driven.drive, aside, 60, substeps=2)
    own = model.run(Motion(aside.starts[:, :1], aside.starts[:, 1:], controls[:1]), controls[None, 20:81], RATE)
    assert ok.all() and np.abs(run[0, 5:, 0] - own[0, 5:, 0]).max() < 0.05 * 0.05


def test_the_true_model_meets_its_own_record_from_a_wrong_start(pendulum, tmp_path):
    plain = read_model(pendulum)
    other = tmp_path / "sprung.xml"
    other.write_text(PENDULUM.replace("damping=", 'stiffness="6" damping='))
    sprung = read_model(other)
    controls = 0.3 * np.sin(8 * np.arange(100) / 100)[:, None]
    whole = sprung.run(Motion(np.array([[0.3]]), np.array([[0.5]]), np.zeros((1, 1))), controls[None], 100.0)
    measured = Measured(Drive.of([controls], 100.0), np.rad2deg(whole[:, :, :1]), ("1",), ("pivot",))
    at = spread_stretches(measured, 50.0, fewer=True)
    mapping, begun = draft(plain, degrees=True), whole + np.array([0.02, 0.1])
    upright = Driven(plain, mapping, controls[None]), measured, begun + np.array([np.pi, 0.0]), 50.0, 0
    assert [own_runs.cut_stretches(*upright, by).length == at.length for by in (2, 1e6)] == [False, True]
    by_hand = mapping.with_effect(Term("pivot_moment", "port", "unnamed", "-6*sin(pivot) - (pivot - sin(pivot))*6"))
    forced = write_model(plain, by_hand)
    assert forced.engine.pushes and not forced.absent and forced.text == plain.path.read_text()
    models = (plain, sprung, forced.engine)
    left = [residual_by(Driven(one, mapping, measured.drive.inputs), measured, at, begun) for one in models]
    before, *exact = (float(root_mean_square(one)[0]) for one in left)
    assert max(exact) < 1e-4 and before > 0.5
    found = OwnRuns(*left[:2], at, "MuJoCo", {"pivot": "deg"}, np.array([1e-4]), begun[:1, 0])
    assert says(found.sentence, "MuJoCo", "pivot") and not found.leave_mere_noise


def test_no_run_begins_farther_from_the_record_than_that_reaches():
    """A light foot whose speed muscles damp: what is left says almost nothing of it, and a full step is 40 rad/s."""
    begun = []

    def left_from(starts):
        begun.extend(starts)
        return np.column_stack([starts[:, 0] - 0.3, 1e-3 * (starts[:, 1] - 40.0), np.zeros(len(starts))])

    start, left = own_runs._find_start(left_from, np.zeros(2), np.array([1.0, 5.0]))
    assert np.abs(begun).max() < 13.0 and start[0] == pytest.approx(0.3, abs=0.01) and abs(left[0]) < 0.01


def test_no_sample_is_compared_in_two_runs_and_none_at_the_ends_of_a_filtered_one():
    drive = Drive.of([np.zeros((400, 0)), np.zeros((310, 0))], 100.0)
    at = spread_stretches(Measured(drive, np.zeros((2, 400, 1)), ("1", "2"), ("x",)), 117.0, margin=17)
    inner = [range(first + 17, first + at.length - 17) for first in at.first]
    for trial, samples in ((0, 400), (1, 310)):
        compared = [k for one, of in zip(inner, at.trial, strict=True) if of == trial for k in one]
        assert len(compared) == len(set(compared)) > 0.7 * samples
        assert min(compared) == 17 and max(compared) == samples - 18


def test_white_noise_is_mere_noise_and_a_slow_bend_of_half_its_size_is_not():
    rng, at = np.random.default_rng(4), Stretches(np.zeros(8, int), np.zeros(8, int), 200, 100.0)
    noise, bend = rng.normal(size=(8, 200, 1)), 0.5 * np.sin(np.arange(200) / 16)[None, :, None]
    runs = [OwnRuns(one, one, at, "MuJoCo", {"x": "rad"}, np.ones(1), np.zeros(16)) for one in (noise, noise + bend)]
    assert [one.leave_mere_noise for one in runs] == [True, False]


def test_a_channel_whose_spectrum_hides_a_filter_has_that_of_its_unit():
    rng, t = np.random.default_rng(0), np.arange(4000) / 100
    sine, noise = np.sin(2 * np.pi * t)[:, None], rng.normal(0, 0.05, (4000, 3))
    raw = np.hstack([sine + noise[:, :1], sine + noise[:, 1:2].cumsum(axis=0), sine + noise[:, 2:]])
    seen = RecordFilter((6.0, 6.0, None), 100.0).filtered(raw[None], 1)
    measured = Measured(Drive.of([np.zeros((4000, 0))], 100.0), seen, ("1",), tuple("abc"))
    sensors = (Sensor("a", "rad"), Sensor("b", "rad"), Sensor("c", "m"))
    shown = (("a", "x"), ("b", "x"), ("c", "x"))
    simulation = Simulation("", (State("x"),), equations=(("x", "-x"),), observations=shown, sensors=sensors)
    found, _ = find_record_filter(simulation, measured, 1.0)
    assert found.cutoffs_hz[2] is None and found.cutoffs_hz[:2] == pytest.approx((6.0, 6.0), abs=0.5)


def test_noise_that_went_through_the_records_filter_is_mere_noise_as_well_and_its_size_is_seen():
    """Of 6 Hz: taken for white it would be what a model lacks, and its roughness shows a tenth of its size."""
    rng, at = np.random.default_rng(4), Stretches(np.zeros(8, int), np.zeros(8, int), 200, 100.0)
    passed, bend = RecordFilter((6.0,), 100.0), 0.2 * np.sin(np.arange(200) / 16)[None, :, None]
    noise, memory = passed.filtered(rng.normal(size=(8, 234, 1)), 1)[:, 17:-17], passed.autocorrelation(200)
    runs = OwnRuns(noise, noise, at, "MuJoCo", {"x": "rad"}, passed.gains, np.zeros(0), passed.every, memory)
    assert runs.leave_mere_noise and not replace(runs, before=noise + bend).leave_mere_noise
    assert not replace(runs, every=1, memory=None).leave_mere_noise
    assert np.sqrt(np.mean(runs.variances(noise)[1])) == pytest.approx(passed.gains[0], rel=0.1)
    bent = replace(runs, before=noise + 50 * bend, floor=np.array([3.0]))  # a rough guess, from runs that miss so much
    assert bent.with_floor([0.0]).floor == pytest.approx(passed.gains, rel=0.1)
