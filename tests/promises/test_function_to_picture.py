"""A Python function goes through `discover` to a result that is saved, loaded, drawn and run."""

import matplotlib as mpl
import numpy as np
import pandas as pd
import pytest

import gaitdisc as gd

mpl.use("Agg")
TIME = np.arange(0.0, 4.0, 0.1)
HIDDEN = 0.3


def cooling(temperature, rate=0.5):
    return -rate * temperature


def truth(temperature):
    return -0.5 * temperature - HIDDEN * temperature**3


@pytest.mark.slow
def test_what_a_function_lacks_is_found_saved_loaded_drawn_and_run(tmp_path):
    noise, runs = np.random.default_rng(0), []
    for trial in range(2):
        run = gd.simulate(truth, TIME, start=[2.0 - 0.3 * trial])
        measured = run["temperature"] + noise.normal(0.0, 0.005, len(TIME))
        runs.append(pd.DataFrame({"trial": trial, "time": TIME, "temperature": measured}))
    found, augmented = gd.discover(cooling, pd.concat(runs))
    (effect,) = found.effects
    (number,) = effect.estimates.values()
    assert effect.name == "cubic_stiffness" and number.value == pytest.approx(HIDDEN, rel=0.03)

    again = gd.load(found.save(tmp_path / "found"))
    assert isinstance(again, gd.Discovery)
    assert (again.sentence, again.effects) == (found.sentence, found.effects)
    gd.plot.discovery(again, left=True).figure.savefig(tmp_path / "left.png")
    assert (tmp_path / "left.png").stat().st_size > 5000

    later = gd.simulate(augmented, TIME, start=[2.0])["temperature"]
    np.testing.assert_allclose(later, gd.simulate(truth, TIME, start=[2.0])["temperature"], atol=0.02)
