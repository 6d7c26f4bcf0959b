"""What does not fit a simulation is refused before anything is computed."""

from dataclasses import replace

import numpy as np
import pytest
from hidden_in_a_mass import Experiment, mass, record

from gaitdisc.discovery.case import set_up_case
from gaitdisc.discovery.catalogue import Request, Shape
from gaitdisc.discovery.discover import discover
from gaitdisc.discovery.matched import match_channels
from gaitdisc.errors import GaitdiscError, SamplingError, SimulationError
from gaitdisc.simulation.compiled_simulation import Drive
from gaitdisc.simulation.parts import Sensor


@pytest.fixture(scope="module")
def measured():
    return replace(record(mass(), 3, Experiment(trials=2, seconds=4.0)), source="walk.csv")


def with_value(measured, value, place):
    observed = np.array(measured.observed)
    observed[place] = value
    return replace(measured, observed=observed)


def with_inputs(measured, inputs):
    return replace(measured, drive=Drive(measured.rate, measured.drive.time0, inputs, measured.drive.samples))


def short(measured):
    drive = Drive.of(measured.drive.inputs[:, :9], measured.rate)
    return replace(measured, drive=drive, observed=measured.observed[:, :9])


def gap_in_push(measured):
    inputs = np.array(measured.drive.inputs)
    inputs[1, 7, 0] = np.nan
    return with_inputs(measured, inputs)


WRONG = {
    "no observation": (
        lambda m: replace(m, channels=("xx",)),
        r"every measured channel must be an observation of 'A mass on a spring, pushed': x; walk.csv has 'xx', the "
        r"nearest is 'x'. Add 'xx' to the observations, or remove the channel.",
    ),
    "twice": (
        lambda m: replace(m, channels=("x", "x"), observed=np.repeat(m.observed, 2, axis=2)),
        r"each channel must have its own name; walk.csv has 'x' twice. Rename one.",
    ),
    "trial twice": (
        lambda m: replace(m, trials=("1", "1")),
        r"each trial must have its own name; walk.csv has '1' twice. Rename one trial.",
    ),
    "inputs": (
        lambda m: with_inputs(m, np.zeros((2, 200, 3))),
        r"must have the inputs of .*: push; the number of inputs in walk.csv is 3. Give one column for each input",
    ),
    "input gap": (
        gap_in_push,
        r"an input must have a value in every sample; walk.csv, trial '2', 'push': nan in sample 8. Fill the gap",
    ),
    "no value": (
        lambda m: with_value(m, np.nan, 1),
        r"channel must have values in every trial; walk.csv, trial '2' has no value of 'x'. Remove the trial",
    ),
    "constant": (
        lambda m: with_value(m, 0.25, slice(None)),
        r"the observed channel 'x' must vary; walk.csv has 0.25 in every sample. Remove the channel",
    ),
    "short": (short, r"a trial must have at least 16 samples; walk.csv, trial '1' has 9 samples. Remove this trial"),
}


@pytest.mark.parametrize("wrong", WRONG)
def test_what_does_not_fit_is_refused_in_words(measured, wrong):
    change, words = WRONG[wrong]
    with pytest.raises(GaitdiscError, match=words):
        discover(mass(), change(measured))


def test_of_the_observations_those_that_were_measured_are_kept(measured):
    both = mass().with_observation("v", "v")
    assert match_channels(both, measured).observations == (("x", "x"),)
    assert set_up_case(both, measured).search.base.observations == (("x", "x"),)
    assert match_channels(mass(), measured) is not None and match_channels(mass(), measured) == mass()


def test_channels_are_found_by_name_whatever_their_order(measured):
    both = mass().with_observation("v", "v")
    swapped = replace(
        measured, channels=("v", "x"), observed=np.concatenate([0.5 * measured.observed, measured.observed], 2)
    )
    assert [name for name, _ in match_channels(both, swapped).observations] == ["v", "x"]


@pytest.mark.parametrize(
    ("piece", "words"),
    [
        (
            "delay(x, -1)",
            r"\[shape\] mine: the delay of a state must not be.*'delay\(x, -1\)' is -1 s. Write the delay without",
        ),
        (
            "delay(x, 1e9)",
            r"\[shape\] mine: .* the shortest trial .'1', 4 s.; 'delay\(x, .*\)' is 1e\+09 s. Write the delay",
        ),
    ],
)
def test_delays_of_the_users_own_effects_are_refused_as_those_of_the_file(measured, piece, words):
    with pytest.raises(SimulationError, match=words):
        discover(mass(), measured, Request((Shape("mine", (piece,)),)))
    discover_begins = set_up_case(mass(), measured, Request((Shape("mine", ("delay(x, 0.5*d)",), {"d": "delays"}),)))
    assert any(one.name == "mine" for one in discover_begins.search.candidates)


def test_a_delay_of_the_simulation_longer_than_the_shortest_trial_is_refused(measured):
    late = mass().with_equation("v", "push + load - delay(x, 1e9)")
    with pytest.raises(SimulationError, match=r"\[equations\].*shorter.*'1'"):
        discover(late, measured)


def test_a_filter_beyond_half_the_rate_is_refused(measured):
    filtered = mass().with_sensor(Sensor("x", lowpass=25.0))
    with pytest.raises(SamplingError, match=r"25 Hz.*\[observations.x\].*walk.csv.*50 samples"):
        match_channels(filtered, measured)
    assert match_channels(mass().with_sensor(Sensor("x", lowpass=24.0)), measured).sensors
