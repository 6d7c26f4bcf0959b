"""The cohort against published facts and its own laws: norms, muscles, family-wise errors, pooled cycles, contacts."""

from pathlib import Path

import cohort_muscles
import cohort_norms
import compare_exo_emg
import compare_halves
import contact_bias
import family_wise_error
import no_discrepancy
import numpy as np
import pooled_cycles
import pytest


@pytest.mark.slow
def test_the_table_prints_and_its_numbers_are_those_of_walking(capsys):
    found = cohort_norms.run(quick=True)
    printed = capsys.readouterr().out
    assert all(name in printed for name in cohort_norms.SOURCES)
    assert all(f"| {name} |" in printed for name in cohort_norms.BURSTS)
    ranges = {
        "knee flexion, swing peak [deg]": (50, 68),
        "ankle dorsiflexion, peak [deg]": (7, 16),
        "hip flexion moment [N m/kg]": (0.4, 1.0),  # 0.62 +- 0.20 in children, 0.9 +- 0.2 in fast ones
        "knee extension moment [N m/kg]": (0.2, 0.8),
        "ankle plantarflexion moment [N m/kg]": (1.1, 1.7),
        "stance [% stride]": (56, 63),
        "vertical force, first peak [BW]": (1.0, 1.3),
    }
    [sole] = [name for name in found if name.startswith("sole over belt speed")]
    ranges[sole] = (0.95, 1.05)
    for name, (low, high) in ranges.items():
        assert np.all((found[name] > low) & (found[name] < high)), (name, found[name])


def test_a_burst_that_goes_over_the_contact_is_read_as_one():
    curve = np.zeros(101)
    curve[90:], curve[:11] = 1.0, 1.0
    assert cohort_norms.burst(curve) == "90-10"


MUSCLES = ("ham", "rf", "vas", "gas", "sol", "ta", "gmed")


def of(values, *names):
    return np.array([values[MUSCLES.index(name)] for name in names])


@pytest.mark.slow
def test_emg_angle_and_rate_explain_the_moments():
    explained = cohort_muscles.run(quick=True)["explained"]
    assert np.all(np.median(explained, axis=0) > (0.7, 0.8, 0.9))  # hip, knee, ankle


@pytest.mark.slow
def test_the_cohorts_muscles_are_as_those_of_people():
    found = cohort_muscles.run()
    correlation, variation = cohort_muscles.alike(found["curves"])
    # Winter and Yack (1987): distal muscles of one joint differ least between people, proximal and two-joint ones most
    assert of(variation, "sol", "ta").mean() < of(variation, "ham", "rf", "gas", "gmed").mean()
    assert np.all((variation > 0.2) & (variation < 0.9))
    assert np.all((correlation > 0.70) & (correlation < 0.98))
    assert np.all((found["curves"].min(axis=1) / found["curves"].max(axis=1)).mean(axis=0) < 0.08)
    change = found["change"].mean(axis=0)
    assert -0.5 < of(change, "sol")[0] < of(change, "gas")[0] < -0.05  # soleus falls most
    assert of(change, "ta")[0] > 0.0
    assert np.all(np.median(found["explained"], axis=0) > (0.7, 0.8, 0.9))


@pytest.mark.slow
def test_every_variable_has_its_difference(capsys):
    apart = no_discrepancy.run(quick=True)
    printed = capsys.readouterr().out
    assert apart.shape == (2, len(no_discrepancy.OUTPUTS))
    assert np.all(np.abs(apart[:, :3]) < 0.1)  # angles, 5 s held out
    assert all(name in printed for name in (*no_discrepancy.OUTPUTS, "standard error", "2 pairs of walks"))


def test_every_sum_has_its_p():
    found = family_wise_error.p_of_sums(11)
    assert len(found) == 34
    assert found[[0, 3, 10]].round(5).tolist() == [0.00098, 0.00488, 0.04199]
    assert found[-1] == 1


@pytest.mark.parametrize("correlation", [0.0, pytest.param(0.8, marks=pytest.mark.slow)])
def test_a_family_raises_no_more_false_alarms_than_it_may(correlation):
    studies = 2000
    found = family_wise_error.false_alarms(11, 8, correlation, studies)
    assert found["one pair"] <= 0.05 + 3 * (0.05 * 0.95 / studies) ** 0.5
    assert found["all"] <= 0.05 + 3 * (0.05 * 0.95 / studies) ** 0.5
    assert found["one pair"] <= found["pair"] <= 3 * 0.05 + 0.02  # three families have three chances
    assert correlation or found["one pair"] > 0.03  # and is not needlessly strict


def test_events_of_one_person_found_without_the_file_s_own(gait_data):
    study = pooled_cycles.study_of(gait_data, quick=True)
    whole, _ = pooled_cycles.pooled(study)
    assert [count for what, count in pooled_cycles.counts(whole) if "each foot" in what] == ["2 of 2"]
    found, trials = pooled_cycles.pooled(study, withhold=True)
    assert all("markers" in one.detectors for one in found)
    for kind, most in (("contacts", 50), ("foot offs", 40)):
        apart = pooled_cycles.differences_ms(found, trials, kind)
        assert len(apart) >= 6 and np.percentile(np.abs(apart), 95) <= most
    assert len(pooled_cycles.against_events(found, trials)) == 4


@pytest.fixture(scope="module")
def found(gait_data):
    return contact_bias.walks(gait_data, quick=True)


def test_most_contacts_of_a_turn_are_found_from_markers(found):
    [turn] = [row for row in contact_bias.against_events(found) if row[0] == "turn, 1" and row[1] == "markers"]
    pairs, contacts = map(int, turn[2].split(" of "))
    assert (contacts, turn[5], turn[6]) == (9, "0", "0")
    assert pairs >= 6


def test_markers_place_contacts_some_fifty_milliseconds_before_a_plate(found):
    offsets, corrections = contact_bias.against_plates(found)
    assert [(row[0], row[1], row[2]) for row in offsets] == [("markers", "2", "4"), ("angles", "2", "3")]
    assert float(offsets[0][3]) == pytest.approx(-46, abs=10)
    placed, corrected = float(corrections[0][5]), float(corrections[0][7])
    assert corrected < placed / 2


def test_a_correction_by_the_other_step_leaves_the_steps_difference():
    contacts = contact_bias.gd.Contacts(np.array([1.0, 2.0]), "r", "force")
    early = contact_bias.gd.Contacts(np.array([0.95, 1.97]), "r", "markers")
    walk = {Path("walk.c3d"): {"force": {"r": contacts}, "markers": {"r": early}, "angles": {"r": early}}}
    offsets, corrections = contact_bias.against_plates(walk)
    assert offsets[0] == ("markers", "1", "2", "-40", "-40 to -40")
    assert corrections[0] == ("markers", "floor", "2", "2", "40", "49", "20", "20")


@pytest.mark.slow
def test_a_planted_shift_is_found_and_nothing_is_named(gait_data):
    found = compare_halves.run(gait_data, quick=True)
    percent = {(one.walk, one.shift): one.mismatch.alignment.percent for one in found}
    walks = {walk for walk, _ in percent}
    assert len(walks) == 3 and len(percent) == 6
    assert [percent[walk, 7] - percent[walk, 0] for walk in walks] == pytest.approx([-7.0] * 3, abs=0.4)
    assert [one.mismatch.ordered() for one in found] == [[]] * 6


def test_eight_people_two_settings_paired(gait_data):
    found = compare_exo_emg.run(gait_data)
    assert (found.exchange.unit, found.exchange.first, found.exchange.permutations) == ("participant", 8, 128)
    assert found.summary_of("emg_ta_l")["differs"]  # as the signed rank of late stance has it (results/chapter4.md)
    assert found.summary_of("emg_ta_l")["largest_gap"] > 0
    assert len(found.names) == 16
