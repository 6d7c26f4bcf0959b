import numpy as np
import pytest

from gaitdisc.processing.muscle_moment import FASTEST, FIRMNESS, Driven, Form, fit_moment, force_at_speed, sign_at

RATE_HZ, STRIDES, STRIDE = 100.0, 12, 110


@pytest.fixture(scope="module")
def made():
    """Two muscles of known gain, delay and lag, beside what resists a departure from the usual stride."""
    rng = np.random.default_rng(0)
    count = np.arange(STRIDES * STRIDE) / STRIDE
    phase = count % 1
    heights = [np.interp(count, np.arange(STRIDES + 1), 1 + 0.2 * rng.normal(size=STRIDES + 1)) for _ in range(2)]
    emg = np.column_stack([h * np.exp(-(((phase - a) / 0.08) ** 2)) for h, a in zip(heights, (0.4, 0.75), strict=True)])
    usual = 0.2 * np.sin(2 * np.pi * phase)
    angle = usual + 0.02 * np.interp(count, np.arange(0, STRIDES + 0.1, 0.5), rng.normal(size=2 * STRIDES + 1))
    signs = np.array([-1.0, 1.0])
    driven = Driven(emg, signs, angle, np.gradient(angle, 1 / RATE_HZ), phase, RATE_HZ)
    force = force_at_speed(-signs * driven.rate[:, None] / FASTEST)
    moment = (driven.activation(0.04, 0.03) * force) @ np.array([-80.0, 25.0]) + 60.0 * (usual - angle) + 3.0
    return driven, moment, count.astype(int) // 3


def test_gains_delay_and_the_stiffness_about_the_usual_stride_come_back(made):
    model = fit_moment(*made)
    assert (model.form.delay_s, model.form.lag_s) == (pytest.approx(0.04), 0.03)
    np.testing.assert_allclose(model.gains.mean(axis=1), [80.0, 25.0], rtol=0.05)
    np.testing.assert_allclose(model.firmness, np.full(FIRMNESS, 60.0), rtol=0.25)
    assert model.left_nm < 0.02 * model.before_nm


def test_a_muscle_never_pushes_the_other_way(made):
    driven, moment, blocks = made
    model = fit_moment(driven, -moment, blocks, Form(0.04, 0.03, np.zeros(2), np.zeros(17)))
    assert (model.gains >= 0).all()
    assert (driven.signs * model.gain(driven) >= 0).all()
    assert (model.firmness >= 0).all()


def test_activation_comes_later_and_keeps_its_level(made):
    driven = made[0]
    level = Driven(np.full((300, 1), 0.7), np.ones(1), *(np.zeros(300),) * 3, RATE_HZ)
    np.testing.assert_allclose(level.activation(0.05, 0.05), 0.7)
    late = driven.activation(0.10, 0.01)
    at = [int(np.argmax(one[:STRIDE])) for one in (driven.envelopes[:, 0], late[:, 0])]
    assert 9 <= at[1] - at[0] <= 13


def test_anatomy_says_which_way_a_muscle_turns_a_joint():
    assert [sign_at(joint, "emg_gaslat_l") for joint in ("ankle_angle", "knee_angle", "hip_flexion")] == [-1, 1, 0]
    assert [sign_at(joint, "emg_rf_r") for joint in ("ankle_angle", "knee_angle", "hip_flexion")] == [0, -1, 1]
