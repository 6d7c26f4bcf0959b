"""The four models of a participant on known walks: samples, blocks, bands of refits that cover what they promise."""

from dataclasses import replace

import numpy as np
import pytest
from texts import says

from gaitdisc.errors import ChannelError, SamplingError, TrainingError
from gaitdisc.ingest.reading import read_trial
from gaitdisc.processing.samples import gait_samples
from gaitdisc.recording import PERCENT, Samples
from gaitdisc.response.fit_response import (
    BLOCKS,
    Fit,
    ResponseSettings,
    fit_kinds,
    fit_linear,
    fit_models,
    fit_network,
    fit_response,
    part,
    residual_strides,
    response_bands,
    split_held_out,
    training_samples,
)
from gaitdisc.signals.butterworth import low_pass
from gaitdisc.signals.contact_movement import angle_contacts
from gaitdisc.signals.derivatives import trajectory
from gaitdisc.signals.strides import cut_strides
from gaitdisc.statistics.r2 import r2
from gaitdisc.statistics.stride_residuals import mean_over_strides

KNEE, ANKLE = "knee_angle_r", "ankle_angle_r"
SPRING = 40.0


@pytest.fixture(scope="module")
def fitted(nominal, exo, settings):
    return fit_kinds(*training_samples(nominal, exo, settings), settings)


@pytest.fixture
def response(judged):
    return judged


def test_the_discrepancy_model_is_the_spring(fitted, exo, settings):
    held = gait_samples(split_held_out(exo, settings)[1], settings.outputs)[0]
    found = fitted["network"].discrepancy.model(held.x)
    spring = -SPRING * np.maximum(held.x[:, 1], 0.0)
    assert r2(spring[:, None], found[:, 1:])[0] > 0.94
    assert np.sqrt(np.mean((found[:, 1] - spring) ** 2)) < 0.06 * np.std(held.y[:, 1])
    assert np.sqrt(np.mean(found[:, 0] ** 2)) < 0.06 * np.std(held.y[:, 0])  # nothing at the knee


def test_a_linear_spring_is_found_exactly_by_the_linear_rival(nominal, linear_exo, settings):
    samples = [gait_samples(split_held_out(walk, settings)[0], settings.outputs)[0] for walk in (nominal, linear_exo)]
    models = fit_models(*samples, fit=lambda part, _: fit_linear(part))
    held = gait_samples(split_held_out(linear_exo, settings)[1], settings.outputs)[0]
    spring = np.column_stack([np.zeros(len(held)), -SPRING * held.x[:, 1]])
    np.testing.assert_allclose(models.discrepancy.model(held.x), spring, atol=0.01)  # of some 1,000 deg/s2


def test_the_augmented_model_explains_what_the_nominal_one_misses(response):
    assert response.r2_of(ANKLE, "nominal") < response.r2_of(ANKLE, "augmented") - 0.1
    for variable in (KNEE, ANKLE):
        assert response.r2_of(variable, "augmented") >= response.r2_of(variable, "nominal") - 0.001
        assert response.r2_of(variable, "augmented") == pytest.approx(response.r2_of(variable, "exo"), abs=0.005)
        assert response.r2_of(variable, "nominal", walk="nominal") > 0.99


def test_without_a_spring_there_is_no_discrepancy(nominal, no_spring, settings):
    found = fit_response(nominal, no_spring, settings)
    for kind in ("network", "ridge"):  # without harmonics, a torque locked to the phase is not known
        for variable in (KNEE, ANKLE):
            here, there = (found.r2_of(variable, "nominal", kind, walk) for walk in ("exo", "nominal"))
            assert here == pytest.approx(there, abs=0.01)
            assert found.r2_of(variable, "augmented", kind) == pytest.approx(here, abs=0.01)


def test_the_held_out_part_is_never_seen(nominal, exo, settings, fitted):
    held = round(0.125 * len(exo.time))
    seen = np.arange(len(exo.time)) < len(exo.time) - held
    changed = [
        replace(walk, x=walk.x + 50.0 * ~seen[:, None], xddot=np.where(seen[:, None], walk.xddot, -7e3))
        for walk in (nominal, exo)
    ]
    again = fit_kinds(*training_samples(*changed, settings), settings)
    for name in ("nominal", "exo", "discrepancy"):
        one, other = (found["network"].fits()[name].model for found in (fitted, again))
        for key, weights in one.weights().items():
            assert weights.tobytes() == other.weights()[key].tobytes()
        assert one.x_scale.mean.tobytes() == other.x_scale.mean.tobytes()
        ridges = [found["ridge"].fits()[name].model.weights.tobytes() for found in (fitted, again)]
        assert ridges[0] == ridges[1]


def test_tables_name_what_is_in_them(response):
    assert response.outputs == (KNEE, ANKLE)
    assert response.units == ("deg/s2", "deg/s2")
    assert len(response.inputs) == 5
    assert response.held_out_s == 7.5
    assert len(response.r2) == 3 * 2 * 4 + 1
    assert (response.r2["n"] == 750).all()
    assert response.r2_of(ANKLE, "nominal", "null") == 0.507
    assert np.isnan(response.r2_of(KNEE, "nominal", "null"))
    assert response.fits["model"].tolist() == ["nominal", "exo", "discrepancy"] * 3
    assert (response.fits["n_training"] == 6000 - 750 - 30).all()
    assert response.r2_of(ANKLE, "exo", "ridge") < response.r2_of(ANKLE, "exo")  # a slack spring is not linear
    assert response.r2_of(KNEE, "exo", "linear") < response.r2_of(KNEE, "exo", "ridge")  # nor a torque locked to phase


def test_r2_is_that_of_the_held_out_predictions_kept(response):
    held = response.held_out
    for model in ("nominal", "augmented", "exo"):
        found = r2(held.measured, held.predicted[model])
        np.testing.assert_allclose(found, [response.r2_of(v, model) for v in (KNEE, ANKLE)], rtol=1e-9)


def test_residuals_are_measured_minus_predicted_on_whole_strides(exo, settings):
    held = split_held_out(exo, settings)[1]
    samples = gait_samples(held, settings.outputs)[0]
    by_phase = np.column_stack([np.sin(2 * np.pi * samples.phi / 100), samples.phi / 100])
    curves = residual_strides(held, samples, samples.y - by_phase)
    contacts = int(np.sum(np.diff(held.phi) < 0))
    assert curves.shape == (contacts - 1, 101, 2)  # the first and the last stride are not whole
    np.testing.assert_allclose(curves[..., 0] - np.sin(2 * np.pi * PERCENT / 100), 0.0, atol=2e-3)
    np.testing.assert_allclose(curves[:, 3:97, 1] - PERCENT[3:97] / 100, 0.0, atol=1e-9)


def test_missing_samples_are_missing_in_the_residual(exo, settings):
    held = split_held_out(exo, settings)[1]
    usable = held.usable.copy()
    usable[300:305] = False
    holed = replace(held, usable=usable)
    samples = gait_samples(holed, settings.outputs)[0]
    curves = residual_strides(holed, samples, samples.y)
    assert len(curves) == np.sum(np.diff(held.phi) < 0) - 1
    assert 4 <= np.isnan(curves[:, :, 0]).sum() <= 9
    assert np.nanmax(np.abs(curves)) == 0.0


def test_walks_that_do_not_belong_together(nominal, exo, settings):
    with pytest.raises(ChannelError, match=r"P01.*P02"):
        fit_response(nominal, replace(exo, subject="P02"), settings)
    renamed = replace(exo, channels=(exo.channels[0], exo.channels[1].renamed("subtalar_angle_r")))
    with pytest.raises(ChannelError, match="differ in ankle_angle_r, subtalar_angle_r"):
        fit_response(nominal, renamed, settings)


def test_walks_that_are_too_short_or_unusable_at_the_end(nominal, exo, settings):
    with pytest.raises(SamplingError, match=r"must be longer than the 60 s to be held out"):
        fit_response(nominal, exo, replace(settings, held_out_s=60.0))
    usable = exo.usable.copy()
    usable[-800:, 1] = False
    short = ResponseSettings(settings.outputs, training=settings.training)
    with pytest.raises(TrainingError, match=r"least.*50.*750.*ankle_angle_r not"):
        fit_response(nominal, replace(exo, usable=usable), short)


def test_running_with_an_exotendon(gait_data, settings):
    """Real angles of one person: the device changes what the Nominal model explains, and Augmented catches up."""
    angles = [f"{joint}_{side}" for side in "rl" for joint in ("hip_flexion", "knee_angle", "ankle_angle")]
    runs = []
    for pattern in ("*natural2*", "*exotendon3*"):
        (file,) = (gait_data / "exotendon_run").glob(pattern)
        recording = read_trial(file, subject="welk007", condition=pattern).stream("kinematics").selected(angles)
        runs.append(trajectory(low_pass(recording), cut_strides(angle_contacts(recording)["r"], recording)))
    found = fit_response(*runs, replace(settings, outputs=(KNEE, ANKLE)), {KNEE: 0.507, ANKLE: 0.507})
    for variable in (KNEE, ANKLE):
        nominal, augmented, exo = (found.r2_of(variable, model) for model in ("nominal", "augmented", "exo"))
        assert 0.507 < nominal < augmented - 0.05
        assert augmented == pytest.approx(exo, abs=0.02)
        assert found.r2_of(variable, "nominal", walk="nominal") > 0.97
    before, after = (mean_over_strides(found.residuals[model]).rms for model in ("nominal", "augmented"))
    assert np.all(after < 0.3 * before)


class Offset:
    """Predicts the mean of what it was fitted to."""

    def __init__(self, samples):
        self.inputs, self.outputs, self.mean = samples.inputs, samples.outputs, samples.y.mean(axis=0)

    def __call__(self, x):
        return np.tile(self.mean, (len(x), 1))


def samples(mean, seed=0):
    rng = np.random.default_rng(seed)
    time = np.arange(400) / 100
    return Samples(rng.normal(size=(400, 1)), mean + rng.normal(size=(400, 1)), ("a",), ("b",), time, time)


def test_the_discrepancy_model_learns_what_the_nominal_model_misses_of_device_walking():
    told = []

    def fit(part, progress):
        progress(1.0)
        return Fit(Offset(part), 0.0, 0, len(part), 0)

    nominal, exo = samples(10.0), samples(17.0, seed=1)
    models = fit_models(nominal, exo, fit, told.append)
    x = np.zeros((3, 1))
    missing = exo.y.mean() - nominal.y.mean()
    np.testing.assert_allclose(models.discrepancy.model(x), missing)
    np.testing.assert_allclose(models.augmented(x), models.exo.model(x))
    assert list(models.on_exo()) == ["nominal", "augmented", "exo"]
    np.testing.assert_allclose(told, [1 / 3, 2 / 3, 1])


def test_both_kinds_say_how_they_were_fitted():
    for fit in (fit_linear(samples(3.0)), fit_network(samples(3.0))):
        assert (fit.n_training, fit.n_inner) == (400, 60)


def walk(seed: int, gain: float, count: int = 2000) -> Samples:
    """y = gain x + noise that is three times as large in the first half of the stride."""
    rng, time = np.random.default_rng(seed), np.arange(count) / 100
    phi, x = 100 * (time % 1.0), rng.normal(size=(count, 1))
    noise = rng.normal(size=(count, 1)) * np.where(phi < 50, 0.3, 0.1)[:, None]
    return Samples(np.column_stack([x, phi]), gain * x + noise, ("a", "phi"), ("b",), time, phi)


@pytest.fixture(scope="module")
def bands():
    nominal, exo, held = walk(0, 1.0), walk(1, 2.0), walk(2, 2.0)
    models = fit_models(nominal, exo, fit=lambda part, _: fit_linear(part, harmonics=2))
    found = response_bands(models, lambda _, samples: fit_linear(samples, harmonics=2).model, nominal, exo, held)
    return held, found


def share_inside(held, band):
    return np.mean((band[0] <= held.y) & (held.y <= band[1]))


def test_nine_in_ten_lie_inside_and_fewer_inside_the_nominal_models(bands):
    held, found = bands
    for model in ("exo", "augmented"):  # 20 strides are ten blocks: 90 % times 1.1: samples do not err together
        assert share_inside(held, found[model]) == pytest.approx(0.975, abs=0.02)
    assert share_inside(held, found["nominal"]) < 0.5


def test_a_band_is_wide_where_errors_are_large(bands):
    held, found = bands
    width = (found["exo"][1] - found["exo"][0])[:, 0]
    wide, narrow = (np.median(width[part]) for part in (held.phi < 45, held.phi > 55))
    assert wide / narrow == pytest.approx(3.0, rel=0.2)


def test_the_more_strides_the_nearer_to_nine_in_ten():
    nominal, exo, held = walk(0, 1.0, 16000), walk(1, 2.0, 16000), walk(2, 2.0)
    models = fit_models(nominal, exo, fit=lambda part, _: fit_linear(part, harmonics=2))
    found = response_bands(models, lambda _, samples: fit_linear(samples, harmonics=2).model, nominal, exo, held)
    assert share_inside(held, found["exo"]) == pytest.approx(0.9 * (1 + 2 / 160), abs=0.012)


def test_a_block_and_what_lies_within_the_seam_are_left_out():
    samples = walk(0, 1.0, 800)
    rest, block = part(samples, 3)
    assert block.time[[0, -1]].tolist() == [3.0, 3.99]
    assert rest.time[np.searchsorted(rest.time, 3.0) + np.array([-1, 0])].round(2).tolist() == [2.69, 4.3]
    assert sum(len(part(samples, number)[1]) for number in range(BLOCKS)) == 800


def test_a_short_walk_has_no_band():
    models = fit_models(walk(0, 1.0), walk(1, 2.0), fit=lambda part, _: fit_linear(part, harmonics=2))
    short = walk(0, 1.0, 1500)
    assert response_bands(models, lambda model, _: model, short, walk(1, 2.0), walk(2, 2.0)) == {}


def test_eq_4_2_state_rate_and_percent_stride_in_acceleration_out(nominal):
    samples, excluded = gait_samples(nominal, (ANKLE,))
    assert samples.inputs == (
        "knee_angle_r", "ankle_angle_r", "d(knee_angle_r)/dt", "d(ankle_angle_r)/dt", "phi",
    )  # fmt: skip
    assert samples.outputs == ("d2(ankle_angle_r)/dt2",)
    np.testing.assert_array_equal(samples.x[:, 1], nominal.x[:, 1])
    np.testing.assert_array_equal(samples.x[:, 2], nominal.xdot[:, 0])
    np.testing.assert_array_equal(samples.x[:, 4], nominal.phi)
    np.testing.assert_array_equal(samples.y[:, 0], nominal.xddot[:, 1])
    assert (excluded.severity, excluded.what) == ("note", "excluded samples: 0 of 6000")


def test_the_dissertations_49_inputs(nominal):
    wide = replace(
        nominal,
        channels=tuple(nominal.channels[0].renamed(f"c{k}") for k in range(24)),
        **{part: np.tile(getattr(nominal, part), (1, 12)) for part in ("x", "xdot", "xddot", "usable")},
    )
    samples, _ = gait_samples(wide, ("c0", "c3"))
    assert samples.x.shape == (6000, 49)


def test_what_is_left_away_is_counted_with_its_reason(nominal):
    usable, phi = nominal.usable.copy(), nominal.phi.copy()
    usable[100:200, 0] = False
    phi[150:350] = np.nan
    samples, excluded = gait_samples(replace(nominal, usable=usable, phi=phi), (ANKLE,))
    assert len(samples) == 5750
    assert np.isfinite(samples.phi).all()
    assert says(excluded.line(), "P01", "excluded samples: 250 of 6000", "200 outside", "50", "knee_angle_r not")
    usable[:3000] = False
    assert gait_samples(replace(nominal, usable=usable), (ANKLE,))[1].severity == "warning"


def test_an_output_that_is_not_there(nominal):
    with pytest.raises(ChannelError, match=r"'ankle_angl_r'.*P01.*2 channels"):
        gait_samples(nominal, ("ankle_angl_r",))
    with pytest.raises(ChannelError, match=r"predict at least one channel"):
        gait_samples(nominal, ())
