import pytest
from texts import says

from gaitdisc.batch.run_study import computed_unit


def alone(study, **changes):
    person = study.participants[0].model_copy(update=changes)
    return study.model_copy(update={"participants": (person,)}), person


def test_the_device_is_what_the_augmented_model_adds(study, tmp_path):
    shares = []
    unit = computed_unit(study, study.participants[0], tmp_path, shares.append)
    response = unit.response
    assert response is not None
    nominal, augmented, exo = (response.r2_of("ankle_angle_r", model) for model in ("nominal", "augmented", "exo"))
    assert nominal < augmented - 0.02
    assert augmented == pytest.approx(exo, abs=0.05)
    assert response.r2_of("knee_angle_r", "nominal") == pytest.approx(
        response.r2_of("knee_angle_r", "augmented"), abs=0.05
    )
    assert shares == sorted(shares)
    assert shares[-1] <= 1.0


def test_one_condition_only_is_refused_by_name(study, tmp_path):
    lonely, person = alone(study, trials=study.participants[0].trials[:1])
    unit = computed_unit(lonely, person, tmp_path, lambda _: None)
    assert unit.response is None
    assert says(unit.refusals[0].reason, "P01", "1", "'nominal', none", "'exo'")


def test_two_trials_of_one_condition_are_pooled_and_not_chosen_between(study, tmp_path):
    first, second = study.participants[0].trials
    halves = [first.model_copy(update={"crop_s": crop}) for crop in ((0.0, 15.0), (15.0, 30.0))]
    twice, person = alone(study, trials=(*halves, second))
    unit = computed_unit(twice, person, tmp_path, lambda _: None)
    assert says(unit.unfitted, "P01", "2", "'nominal', 1", "'exo'")
    assert unit.response is None and unit.refusals == ()
    nominal, exo = unit.cycles
    assert (nominal.trials, exo.trials) == (2, 1)
    of_trial = nominal.kept[nominal.kept["side"] == "r"]["trial"].value_counts()
    assert min(of_trial[1], of_trial[2]) >= 10  # 15 s of strides of 1.1 s each


def test_an_excluded_person_is_left_out_with_the_reason(study, tmp_path):
    without, person = alone(study, excluded="changed shoes")
    assert computed_unit(without, person, tmp_path, lambda _: None).refusals[0].reason.endswith("changed shoes")


def test_a_held_out_part_longer_than_the_trial_is_refused(study, tmp_path):
    held = study.held_out.model_copy(update={"seconds": 60.0, "share": None})
    unit = computed_unit(study.model_copy(update={"held_out": held}), study.participants[0], tmp_path, lambda _: None)
    assert says(unit.refusals[0].reason, "too short to hold out", "60 s")
    assert len(unit.walks) == 2
