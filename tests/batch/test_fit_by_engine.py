"""Numbers fitted by the engine's own runs: those of the truth, wherever the expansion's lay."""

from dataclasses import replace
from importlib.util import find_spec

import numpy as np
import pytest

from gaitdisc.batch.fit_by_engine import EngineFit
from gaitdisc.discovery.candidate_model import Part, fit_model
from gaitdisc.discovery.case import set_up_case
from gaitdisc.discovery.scored_model import scored
from gaitdisc.simulation.drive import Drive
from gaitdisc.simulation.measured import Measured

PENDULUM = """<mujoco><option timestep="0.002"/><worldbody><body name="rod">
<joint name="pivot" type="hinge" axis="0 -1 0" damping="0.3"/>
<inertial pos="0 0 -0.4" mass="2" diaginertia="0.05 0.05 0.001"/></body></worldbody>
<actuator><motor name="drive" joint="pivot" gear="5"/></actuator></mujoco>
"""
STIFFNESS, NOISE = 6.0, 0.003  # [N m/rad], [rad]


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """What a search would hand over: the pendulum's fit, and its numbers off by as much as an expansion may be."""
    if find_spec("mujoco") is None:
        pytest.skip("MuJoCo is not installed: gaitdisc[mujoco]")
    from gaitdisc.engines.engine import Motion, read_model
    from gaitdisc.engines.expansion import expanded
    from gaitdisc.engines.mapping import drafted

    folder = tmp_path_factory.mktemp("pendulum")
    (folder / "plain.xml").write_text(PENDULUM)
    (folder / "truth.xml").write_text(PENDULUM.replace("damping=", f'stiffness="{STIFFNESS}" damping='))
    plain, truth = read_model(folder / "plain.xml"), read_model(folder / "truth.xml")
    t, rng = np.arange(300) / 100, np.random.default_rng(2)
    controls = [
        0.5 * np.sin(2 * np.pi * f * t)[:, None] + 0.2 * np.cos(5 * f * t)[:, None] for f in (0.6, 0.8, 1.0, 1.3)
    ]
    start = Motion(np.full((4, 1), 0.2), np.zeros((4, 1)), np.zeros((4, 1)))
    whole = truth.run(start, np.stack(controls), 100.0)
    seen = whole[:, :, :1] + NOISE * rng.normal(size=(4, 300, 1))
    measured = Measured(Drive.of(controls, 100.0), seen, tuple("1234"), ("pivot",))
    mapping = drafted(plain)
    case = set_up_case(*expanded(mapping, plain, measured, whole))
    spring = next(one for one in case.search.candidates if one.label == "linear_stiffness@pivot_moment")
    as_read = case.as_read()
    parts = (Part(spring, {"factor": -STIFFNESS}),)
    fitted = fit_model(as_read.shooting, case.search.base, parts, as_read.model.fit.starts)
    return EngineFit(mapping, plain, measured, whole), scored(as_read.shooting, case.search.base, fitted)


@pytest.mark.slow
def test_the_engines_own_runs_bring_a_number_to_the_truth(found):
    fit, search = found
    values = search.model.fit.values.copy()
    values[search.model.machine.parameters.index("part0_factor")] *= 1.1
    off = replace(search.model.parts[0], values={"factor": -1.1 * STIFFNESS})
    model = replace(search.model, parts=(off,), fit=replace(search.model.fit, values=values))
    again = fit.refitted(replace(search, model=model))
    error = float(np.sqrt(again.fit.covariance[0, 0]))
    assert fit.done and abs(again.parts[0].values["factor"] + STIFFNESS) < 4 * error < 0.03 * STIFFNESS
    assert again.fit.residual.std() == pytest.approx(NOISE, rel=0.15)


def test_what_has_no_form_in_the_models_file_stays_as_it_was(found):
    fit, search = found
    late = replace(search.model.parts[0].candidate, verdict="input_error")
    model = replace(search.model, parts=(replace(search.model.parts[0], candidate=late),))
    assert fit.refitted(replace(search, model=model)) is model and not fit.done
