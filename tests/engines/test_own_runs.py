"""Runs by the engine itself: a record that it made is met by it, and missed without the spring that made it."""

import numpy as np
import pytest
from texts import says

from gaitdisc.engines.engine import Motion, read_model
from gaitdisc.engines.mapping import drafted
from gaitdisc.engines.own_runs import own_runs
from gaitdisc.results.discovery import Runs
from gaitdisc.simulation.drive import Drive
from gaitdisc.simulation.measured import Measured

from .conftest import PENDULUM


def test_the_true_model_meets_its_own_record_from_a_wrong_start(pendulum, tmp_path):
    plain = read_model(pendulum)
    other = tmp_path / "sprung.xml"
    other.write_text(PENDULUM.replace("damping=", 'stiffness="6" damping='))
    sprung = read_model(other)
    t = np.arange(100) / 100
    controls = 0.3 * np.sin(8 * t)[:, None]
    whole = sprung.run(Motion(np.array([[0.3]]), np.array([[0.5]]), np.zeros((1, 1))), controls[None], 100.0)
    seen = np.rad2deg(whole[:, :, :1])
    measured = Measured(Drive.of([controls], 100.0), seen, ("1",), ("pivot",))
    span = t[None, :]
    runs = Runs(np.zeros(1, int), span, np.zeros((1, 0)), seen, seen, seen, ("1",))
    both = (drafted(plain, degrees=True),) * 2
    found = own_runs((plain, sprung), both, measured, runs, whole + np.array([0.02, 0.1]))
    before, after, unit = found.errors["pivot"]
    assert says(found.said, "MuJoCo", "over the held-out", "pivot")
    assert unit == "deg" and after < 1e-4 and before > 0.5
    assert found.share == pytest.approx(after / before)
    nothing = own_runs((sprung, sprung), both, measured, runs, whole)
    assert nothing.share == pytest.approx(1.0)
