"""Numbers fitted by the engine's own runs: those of the truth, wherever the expansion's lay."""

import numpy as np
import pytest
from saved_folders import PENDULUM

from gaitdisc.discovery.candidate import Candidate
from gaitdisc.discovery.candidate_model import Part
from gaitdisc.discovery.discover_engine import _NOTHING
from gaitdisc.discovery.fit_by_engine import NO_FILTER, EngineFit, base_runs
from gaitdisc.discovery.record_filter import RecordFilter
from gaitdisc.simulation.compiled_simulation import Drive
from gaitdisc.simulation.measured import Measured

SPRING = Candidate(
    "missing_physics", "port", "pivot_moment", "linear_stiffness", ("pivot",), names={"factor": "stiffness"}
)
DAMPED = Candidate("wrong_parameter", "parameter", "pivot_damping", "wrong_parameter", value=0.3)
WEAK = Candidate("input_error", "input", "drive", "input_gain")
CLIPPED = Candidate("input_error", "input", "drive", "input_saturation", ("min({s}, {limit})",), {"limit": ""})


@pytest.mark.parametrize(
    ("change", "part", "number", "truth", "low_pass"),
    [
        (("damping=", 'stiffness="6" damping='), Part(SPRING, {"factor": -6.6}), "stiffness", 6.0, NO_FILTER),
        (('gear="5"', 'gear="4"'), Part(WEAK, {"gain": 0.88}), "gain", 0.8, NO_FILTER),
        (("gear=", 'ctrlrange="-9 0.4" gear='), Part(CLIPPED, {"limit": 0.45}), "limit", 0.4, NO_FILTER),
        (('damping="0.3"', 'damping="0.6"'), Part(DAMPED, {"value": 0.5}), "value", 0.6, RecordFilter((4.0,), 100.0)),
    ],
)
def test_the_engines_own_runs_bring_a_number_to_the_truth(tmp_path, change, part, number, truth, low_pass):
    """A low-pass takes a little of each swing, as a damper would: the runs go through it as well."""
    pytest.importorskip("mujoco", reason="MuJoCo is not installed: gaitdisc[mujoco]")
    from dataclasses import replace

    from gaitdisc.discovery.result import FoundEffect
    from gaitdisc.engines.engine import read_model
    from gaitdisc.engines.mapping import draft
    from gaitdisc.engines.motion import Motion

    (tmp_path / "plain.xml").write_text(PENDULUM)
    (tmp_path / "truth.xml").write_text(PENDULUM.replace(*change))
    plain, t, rng = read_model(tmp_path / "plain.xml"), np.arange(300) / 100, np.random.default_rng(2)
    controls = [0.5 * np.sin(2 * np.pi * f * t)[:, None] + 0.2 * np.cos(5 * f * t)[:, None] for f in (0.6, 1.0, 1.3)]
    start = Motion(np.full((3, 1), 0.2), np.zeros((3, 1)), np.zeros((3, 1)))
    whole = read_model(tmp_path / "truth.xml").run(start, np.stack(controls), 100.0)
    seen = whole[:, :, :1] + 0.003 * rng.normal(size=(3, 300, 1))
    seen = low_pass.filtered(seen, 1)
    measured = Measured(Drive.of(controls, 100.0), seen, tuple("123"), ("pivot",))
    fit = EngineFit(draft(plain), plain, measured, whole, (part,), low_pass)
    effect = FoundEffect(part.candidate.kind, part.candidate.place, part.candidate.name, "")
    found = fit.fitted(replace(_NOTHING, effects=(effect,)), fit.mapping, base_runs(plain, fit))
    one = found.effects[0].estimates[number]
    assert one.low < truth < one.high and one.high - one.low < 0.05 * truth
