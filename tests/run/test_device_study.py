from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from made_joint import made_joint, short_trials
from manufactured_discovery import manufactured
from texts import says

from gaitdisc.channel import vocabulary
from gaitdisc.discovery.candidate import Candidate
from gaitdisc.discovery.catalogue import Request
from gaitdisc.discovery.device_study import (
    DeviceWalks,
    NoMomentsError,
    PersonWalks,
    check_calibrated,
    check_kinetics,
    check_length,
    weigh_foot,
)
from gaitdisc.discovery.discover_device import (
    NOTHING,
    beside,
    device_findings,
    discover_study,
    lines,
    over_conditions,
    over_people,
    with_model_error,
)
from gaitdisc.discovery.effect_words import estimate_text
from gaitdisc.discovery.folder import load_discovery, save_discovery
from gaitdisc.discovery.joint_and_trials import nominal_moment
from gaitdisc.discovery.page import write_discovery_report
from gaitdisc.discovery.result import Discovery, Estimate, FoundEffect, GapSize, Runs
from gaitdisc.errors import SchemaError, StrideError
from gaitdisc.ingest.public_words import PublicWords
from gaitdisc.ingest.study import Conditions, Participant, PlannedTrial, Study
from gaitdisc.ingest.study_file import write_study
from gaitdisc.recording import Finding, Recording, Trial


def trial(*keys, findings=(), lasts_s=0.03):
    channel = vocabulary().named("emg_sol_r")
    one = Recording(np.linspace(0, lasts_s, 4), np.zeros((4, 1)), (channel,))
    return Trial("W01_exo", dict.fromkeys(keys, one), findings=tuple(findings))


def test_forces_that_do_not_carry_the_body_and_moments_per_kg_that_say_newton_metres_are_refused():
    balance = Finding("warning", "force balance", "walk.c3d", "mean -29.4 % of weight", "")
    with pytest.raises(SchemaError, match=r"W01_exo.*-29.4 %.*mass_kg"):
        check_kinetics(trial("emg", "moments", findings=[balance]))
    per_kg = Finding("warning", "per body mass", "id.sto", "peaks at 1.4 N m", "", "ankle_angle_r_moment")
    with pytest.raises(SchemaError, match=r"ankle_angle_r_moment.*1.4 N m.*m/kg.*\[channels\]"):
        check_kinetics(trial("emg", "moments", findings=[per_kg]))


@pytest.mark.parametrize(("has", "lacks", "mend"), [("moments", "EMG", "file with the EMG"),
                                                    ("emg", "joint moments", "force plates")])  # fmt: skip
def test_a_walk_without_emg_or_forces_says_which(has, lacks, mend):
    with pytest.raises(NoMomentsError, match=rf"both.*{lacks}.*W01_exo has no {lacks}.*{mend}"):
        check_kinetics(trial(has))


def test_trials_of_a_few_strides_are_refused_for_their_length_and_sent_to_pooled_cycles():
    with pytest.raises(StrideError, match=r"12 strides.*W01_exo: 1 trial, 4\.7 s in all\..*--before A --after B"):
        check_length([trial("kinematics", lasts_s=4.7)], 0.4)
    check_length([trial("kinematics", lasts_s=2.5)] * 2, 0.4)


def one_walk(word="nominal", **others):
    walk = PlannedTrial(condition=word, files=(f"{word}.mot",))
    person = Participant(id="W01", trials=(walk,))
    return Study(title="x", conditions=Conditions(nominal="nominal", device="exo"), participants=(person,), **others)


@pytest.mark.parametrize(
    ("joint", "said"),
    [("ankle_angle", r"both.*W01.*1.*'nominal', none.*'exo'"), ("toe", r"ankle_angle, knee_angle, hip_flexion.*'toe'")],
)
def test_conditions_without_a_pair_and_a_joint_that_is_none_are_refused(joint, said):
    study = one_walk()
    with pytest.raises(SchemaError, match=said):
        PersonWalks(study, study.participants[0]).calibrated("exo", joint)


def test_a_study_without_a_device_compares_none_of_its_conditions(tmp_path):
    study = one_walk().model_copy(update={"conditions": Conditions(nominal="nominal", others=("turn",))})
    write_study(study, tmp_path / "study.toml")
    with pytest.raises(SchemaError, match=r"both walks of W01 are required; the study does not compare a device"):
        discover_study(tmp_path / "study.toml", "W01")


def test_an_unusable_trial_costs_no_other_and_a_condition_without_a_usable_one_is_refused(monkeypatch):
    planned = [PlannedTrial(condition=word, files=(f"{word}{k}.mot",)) for word in ("nominal", "exo") for k in range(3)]
    person = Participant(id="W01", trials=tuple(planned))
    study = one_walk().model_copy(update={"participants": (person,)})
    bad = [planned[4]]

    def record(_, trial, __):
        if trial in bad:
            raise NoMomentsError("needed", "no plate was hit", "Mend.")
        return made_joint(12, seed=planned.index(trial))

    monkeypatch.setattr(PersonWalks, "_trial_record", record)
    device = PersonWalks(study, person).at("exo", "ankle_angle").device
    assert device.stride.max() + 1 == 24
    assert [(finding.kind, finding.file) for finding in device.findings] == [("excluded trial", "W01 exo 2")]
    assert "no plate was hit" in device.findings[0].what
    left_out = [*planned[:3], *(trial.model_copy(update={"leave_out": "tripped"}) for trial in planned[3:])]
    nobody = person.model_copy(update={"trials": tuple(left_out)})
    with pytest.raises(SchemaError, match="both walks of W01"):
        PersonWalks(study, nobody).at("exo", "ankle_angle")
    bad += planned[3:]
    with pytest.raises(NoMomentsError, match="no plate"):
        PersonWalks(study, person).at("exo", "ankle_angle")


CONDITIONS = Conditions(nominal="nominal", device="exo", others=("exo_soft", "turn"))
SPRINGS = {"nominal": 0.0, "exo": 150.0, "exo_soft": 75.0}


@pytest.fixture
def three_walks(tmp_path, monkeypatch):
    """Three walks of a person, in a study of four conditions."""
    trials = tuple(PlannedTrial(condition=word, files=(f"{word}.mot",)) for word in SPRINGS)
    people = (Participant(id="W01", trials=trials),)
    study = Study(title="x", conditions=CONDITIONS, participants=people).placed(tmp_path)
    write_study(study, tmp_path / "study.toml")
    for word in SPRINGS:
        (tmp_path / f"{word}.mot").touch()
    records = {word: made_joint(seed=seed, spring=SPRINGS[word]) for seed, word in enumerate(SPRINGS, 1)}
    monkeypatch.setattr(PersonWalks, "_record", lambda _, word, __: records[word])
    return study


def test_the_nominal_walk_calibrates_one_model_for_all_conditions(three_walks):
    walks = PersonWalks(three_walks, three_walks.participants[0])
    stiff, soft = (walks.calibrated(word) for word in ("exo", "exo_soft"))
    assert stiff.model is soft.model and stiff.nominal is soft.nominal and stiff.device is not soft.device


@pytest.mark.usefixtures("unpainted")
def test_conditions_stand_side_by_side_and_one_without_a_walk_costs_no_other(three_walks, tmp_path, monkeypatch):
    def answered(walks, word, request, joint):
        walks.calibrated(word, joint)
        request.progress("done")
        spring = FoundEffect("port", "ankle_moment", "one_sided_spring", "", {"stiffness": numbers[word]}, 0.9, 80.0)
        return manufactured(sentence=word, effects=(spring,), beside={"Nominal": 9.0, "Exo": 5.0}), None

    numbers = {word: Estimate(size, size - 9, size + 9, "N m/rad") for word, size in SPRINGS.items()}
    monkeypatch.setattr("gaitdisc.discovery.discover_device._discover_condition", answered)
    steps = []
    answers = discover_study(tmp_path / "study.toml", "W01", Request(progress=steps.append))
    assert "exo_soft: done" in steps
    found = answers["exo_soft"][0]
    assert list(answers) == ["exo", "exo_soft"]
    exo, soft, turn = found.conditions
    assert (exo.sentence, soft.sentence) == ("exo", "exo_soft")
    assert (turn.condition, turn.verdict, turn.effects) == ("turn", "", ())
    assert says(turn.sentence, "both walks of W01 are required", "none of 'turn'")
    save_discovery(found, tmp_path / "found")
    kept = load_discovery(tmp_path / "found")
    assert kept.conditions == answers["exo"][0].conditions == found.conditions
    page = write_discovery_report(kept, tmp_path / "found").read_text()
    assert says(page, "Conditions of the study, n = 3", "refused: both walks of W01 are required")
    table = pd.read_csv(tmp_path / "found" / "tables" / "conditions.csv").set_index("condition")
    assert table.loc["exo_soft", ["value", "low", "high", "nominal_n_m"]].tolist() == [75.0, 66.0, 84.0, 9.0]
    people = over_conditions({"W01": {word: one for word, (one, _) in answers.items()}})
    assert people["condition"].tolist() == ["exo", "exo_soft"]
    assert lines(people)[1].startswith("exo_soft: one_sided_spring at ankle_moment, stiffness: 1 of 1, mean 75")


@pytest.mark.slow
def test_each_spring_of_a_study_has_its_own_number(three_walks, tmp_path):
    answers = discover_study(tmp_path / "study.toml", "W01")
    for word in ("exo", "exo_soft"):
        found = answers[word][0]
        number = found.effects[0].estimates["stiffness"]
        assert number.low < SPRINGS[word] < number.high
        assert found.provenance.settings["title"].endswith(f", {word}")


@pytest.fixture(scope="module")
def walks():
    nominal = made_joint(seed=1)
    return DeviceWalks(nominal, made_joint(seed=3, spring=150.0), nominal_moment(nominal))


def test_the_models_of_chapter_4_stand_beside_in_newton_metres(walks):
    """Augmented can follow the spring; Exo, whose muscles cannot, leaves more of it."""
    held = np.flatnonzero(walks.device.stride >= 18)
    blank = np.full((1, len(held), 2), np.nan)
    runs = Runs(np.zeros(1, int), walks.device.time[held][None], np.empty((0, 0)), blank, blank, blank)
    size = GapSize(1.0, 0.2, 0.1, channels={"net_moment": (9.0, 1.5, 1.0)})
    found = Discovery("no_gap", "s", (), (), (), size, size, ("ankle_angle", "net_moment"), ("rad", "N m"), runs)
    sizes = beside(walks, found)
    assert list(sizes)[:2] == ["Nominal", "Nominal + named effect"]
    assert sizes["Nominal + named effect"] == sizes["Nominal"]  # nothing is named
    assert 0.5 < sizes["Augmented (plain regression)"] < sizes["Exo"] < sizes["Nominal"]


def test_short_trials_show_the_spring_that_they_share(walks):
    """The walks, cut into eight trials of three strides, from the middle of a stride on."""
    apart = DeviceWalks(short_trials(walks.nominal), short_trials(walks.device), nominal_moment(walks.nominal))
    assert apart.device.stride.max() + 1 == 16  # two whole strides each
    change = replace(apart, model=nominal_moment(apart.nominal)).changed
    assert change.change.name == "one_sided_spring"
    assert change.value == pytest.approx(150.0, abs=1.96 * change.spread)
    assert change.value == pytest.approx(walks.changed.value, rel=0.1)


@pytest.mark.slow
def test_it_is_said_what_the_moment_model_is_worth_and_that_no_mass_can_be_weighed(walks):
    said = [finding.what for finding in device_findings(walks)]
    assert any("the ankle moment model leaves a residual of" in one and "ms later" in one for one in said)
    assert any(says(line, "not estimated", "no marker") for line in said)
    heavier = replace(walks, device=replace(walks.device, per_kg=0.5 * np.cos(walks.device.time)))
    assert any(says(finding.what, "kg", "the foot would") for finding in device_findings(heavier))


def loaded(seed, kg, per_kg):
    device = made_joint(seed=seed)
    per_kg = per_kg * np.cos(2 * np.pi * device.phase)
    return replace(device, per_kg=per_kg, moment=device.moment - kg * per_kg)


def knee_and_hip(walks, knee, hip):
    return {"knee_angle": replace(walks, device=knee), "hip_flexion": replace(walks, device=hip)}


@pytest.mark.parametrize(("kg", "named"), [(0.8, True), (0.0, False)])
def test_a_mass_at_the_foot_is_what_the_knee_says_and_the_hip_bears_out(walks, kg, named):
    mass = weigh_foot(knee_and_hip(walks, loaded(5, kg, 5.0), loaded(6, kg / 2, 8.0)))
    assert (mass is not None) == named
    assert not named or mass.low < mass.value == pytest.approx(kg, rel=0.15)


def test_joints_that_disagree_about_a_mass_or_do_not_know_the_foot_name_none(walks):
    assert weigh_foot(knee_and_hip(walks, loaded(5, 1.2, 5.0), loaded(6, -0.4, 5.0))) is None
    assert weigh_foot(knee_and_hip(walks, made_joint(seed=5), made_joint(seed=5))) is None
    assert weigh_foot({"knee_angle": replace(walks, device=loaded(5, 1.2, 5.0))}) is None


def test_the_size_of_what_is_named_at_a_hip_without_electrodes_on_its_deep_muscles_is_doubted(walks):
    own = FoundEffect("port", "hip_moment", "one_sided_spring", "", {"stiffness": Estimate(140.0, 139.0, 141.0)})
    size = GapSize(1.0, 0.2, 0.1)
    found = Discovery("missing_physics", "a spring.", (), (own,), (), size, size, (), (), None)
    at_hip = {"joint": "hip_flexion", "muscles": ("emg_ham_r", "emg_bf_r", "emg_rf_r")}
    hip = DeviceWalks(replace(walks.nominal, **at_hip), replace(walks.device, **at_hip), walks.model)
    assert says(with_model_error(found, hip).sentence, "effect is unreliable")
    assert "trusted" not in with_model_error(found, walks).sentence


def test_the_number_of_both_walks_stands_with_the_error_of_the_moment_model(walks):
    """The discovery's own interval knows the noise alone."""
    own = FoundEffect(
        "port", "ankle_moment", "one_sided_spring", "", {"stiffness": Estimate(140.0, 139.0, 141.0, "N m/rad")}
    )
    size = GapSize(1.0, 0.2, 0.1)
    told = f"a spring, {estimate_text(own.estimates['stiffness'])}."
    found = Discovery("missing_physics", told, (), (own,), (), size, size, (), (), None)
    mended = with_model_error(found, walks)
    new = mended.effects[0].estimates["stiffness"]
    assert new.value == walks.changed.value
    assert new.high - new.low > 2 * 1.96 * walks.changed.spread
    assert estimate_text(new) in mended.sentence
    assert says(mended.sentence, "140 N m/rad")


def test_a_walk_that_the_nominal_model_follows_lacks_nothing_whatever_a_search_makes_of_the_rest(walks):
    same = replace(walks, device=made_joint(seed=2))
    assert same.agrees and not walks.agrees
    candidate = Candidate("missing_physics", "port", "ankle_moment", "phase_locked_moment", ("1",), None, "")
    assert not same.weighed(candidate)
    size = GapSize(1.0, 0.2, 0.1)
    invented = FoundEffect("port", "ankle_moment", "phase_locked_moment", "")
    found = Discovery("missing_physics", "s", (), (invented,), (), size, size, (), (), None)
    mended = with_model_error(found, same)
    assert (mended.verdict, mended.effects) == ("no_gap", ())
    assert "as well as held-out Nominal strides" in mended.sentence


def test_a_model_that_does_not_explain_the_nominal_walk_names_no_device(walks):
    check_calibrated(walks.model, walks.nominal)
    noise = np.random.default_rng(0).normal(0.0, 30.0, len(walks.nominal.time))
    model = nominal_moment(replace(walks.nominal, moment=noise))
    with pytest.raises(SchemaError, match=r"W01.*24 strides\..*more strides"):
        check_calibrated(model, walks.nominal)


@pytest.mark.parametrize("verdict", ["The simulation lacks a linear spring.", "No effect is named: they agree."])
def test_a_walk_without_emg_has_one_verdict(monkeypatch, verdict):
    def refused(*_):
        raise NoMomentsError("naming the effect needs EMG in both walks", "W01 exo has no EMG", "Add it.")

    who = SimpleNamespace(id="W01", trials=())
    study = SimpleNamespace(participant=lambda _: who, conditions=one_walk().conditions)
    monkeypatch.setattr("gaitdisc.discovery.discover_device.load_study", lambda _: study)
    monkeypatch.setattr("gaitdisc.discovery.discover_device.list_words", lambda *_: PublicWords())
    monkeypatch.setattr(PersonWalks, "calibrated", refused)
    monkeypatch.setattr("gaitdisc.discovery.discover_device.against", lambda study, _: study)
    monkeypatch.setattr("gaitdisc.discovery.discover_device.nominal_and_trials", lambda *_: (None, None))
    compared = manufactured(sentence=verdict)
    monkeypatch.setattr("gaitdisc.discovery.discover_device.find_missing", lambda *_: (compared, None))
    found, _ = discover_study(Path("study.toml"), "W01")["exo"]
    reason, _, said = found.sentence.partition(". ")
    assert reason == (
        "Naming the effect needs EMG in both walks, but W01 exo has no EMG: only the motion of both walks was "
        "compared, which gives no moment of the device"
    )
    assert said == verdict and found.effects == compared.effects


@pytest.mark.slow
def test_without_moments_the_motion_is_compared(tmp_path):
    from gaitdisc.cohort.demonstration import write_demonstration

    study = write_demonstration(tmp_path, 30.0, 1)
    write_study(study, tmp_path / "study.toml")
    found, _ = discover_study(tmp_path / "study.toml", "W01")["exo"]
    assert "has no joint moments" in found.sentence
    assert says(found.sentence, "both walks must have joint moments")


def spring(stiffness):
    estimates = {"stiffness": Estimate(stiffness, stiffness - 9, stiffness + 9, "N m/rad")}
    return manufactured(effects=(FoundEffect("port", "ankle_moment", "one_sided_spring", "", estimates),))


def test_an_effect_is_said_with_who_shows_it_and_an_interval_over_people():
    found = {"W01": spring(200.0), "W02": spring(300.0), "W03": spring(280.0), "W04": manufactured(effects=())}
    table = over_people(found)
    row = table.iloc[0]
    assert (row["effect"], row["people"], row["of"]) == ("one_sided_spring", 3, 4)
    assert row["who"].split(", ") == ["W02 300", "W03 280", "W01 200"]
    half = 4.302653 * np.std([200.0, 300.0, 280.0], ddof=1) / np.sqrt(3)  # Student's t, 2 degrees of freedom
    assert (row["mean"], row["low"]) == (pytest.approx(260.0), pytest.approx(260.0 - half, rel=1e-6))
    assert says(lines(table)[0], "one_sided_spring", "ankle_moment", "3 of 4, mean 260 N m/rad (95 % CI", "): W02")
    assert says(lines(table)[1], "nothing", "1 of 4: W04")
    assert (table.iloc[1]["effect"], table.iloc[1]["who"]) == (NOTHING, "W04")


def test_one_person_has_no_interval_over_people():
    row = over_people({"W01": spring(200.0)}).iloc[0]
    assert np.isnan(row["low"])
