"""What the study of engines hides is in the truth and nowhere else; one of its cases is a slow test."""

from importlib.util import find_spec

import numpy as np
import pytest

pytestmark = pytest.mark.skipif(find_spec("mujoco") is None, reason="MuJoCo is not installed: gaitdisc[mujoco]")


@pytest.mark.parametrize("kind", ["spring", "one-sided", "viscous", "Coulomb", "mass", "gravity", "offset", "none"])
def test_the_truth_differs_from_the_model_by_what_is_hidden(kind, tmp_path):
    import engines

    from gaitdisc.engines.engine import read_model
    from gaitdisc.engines.motion import Motion

    case = engines.hidden_in(engines.MODELS["leg"], kind, np.random.default_rng(5))
    (tmp_path / "leg.xml").write_text(case.truth)
    truth, model = read_model(tmp_path / "leg.xml"), read_model(engines.SYSTEMS / "leg.xml")
    at = Motion(np.array([[0.2, 0.6]]), np.array([[1.0, 2.0]]), np.zeros((1, 2)))
    knee = {"spring": -0.6, "one-sided": -0.5, "viscous": -2.0, "Coulomb": -1.0}.get(kind, 0.0)
    number = case.number - 0.5 if kind == "viscous" else case.number  # the number of a damper that was 0.5
    values = {case.named[1]: case.number} if kind in ("mass", "gravity") else {}
    wanted = model.accelerations(at, values, np.array([[0.0, knee * number]]))
    assert np.allclose(truth.accelerations(at, {}), wanted, rtol=1e-7)


@pytest.mark.slow
def test_a_wrong_damper_is_named(tmp_path):
    import engines

    (row,) = engines.study(["leg"], ["viscous"], 1, 0.3).to_dict("records")
    assert row["right"] and row["inside"] and row["native"] == 1, row
