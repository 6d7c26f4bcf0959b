"""Cycles pooled over trials that wait on disk: a made walk cut into short trials gives those of the whole."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from changed_trials import with_stream
from texts import says

from gaitdisc.channel import Channel
from gaitdisc.errors import ReadError
from gaitdisc.ingest.c3d import C3DReader
from gaitdisc.ingest.reading import read_planned_trial
from gaitdisc.ingest.study import Conditions, Participant, PlannedTrial, Quality, StrideRules, Study, Treadmill
from gaitdisc.processing.pooled import can_pool, pool_cycles, put_away
from gaitdisc.processing.pooled_cycles import CYCLES
from gaitdisc.recording import Event, Recording, Source, Trial


def _planned(count, condition="walk", session=None):
    return tuple(PlannedTrial(condition=condition, session=session, files=(f"{k}.c3d",)) for k in range(count))


def _study(trials, **parts):
    person = Participant(id="P01", group="control", trials=trials)
    return Study(conditions=Conditions(nominal="walk"), participants=(person,), **parts), person


@pytest.fixture(scope="module")
def pieces():
    """One walk of 40 s with belts, cut into eight short trials of 3.5 s each and one of 12 s."""
    from driven_walker import DrivenWalker

    trial = DrivenWalker("P01", stride_s=1.1, seed=4).walked(40.0, "walk")
    cut = []
    for k in range(8):
        streams = {key: r.between(4.0 * k, 4.0 * k + 3.5) for key, r in trial.streams.items()}
        cut.append(replace(trial, name=f"piece {k}", streams=streams))
    return [*cut, replace(trial, streams={key: r.between(0.0, 12.0) for key, r in trial.streams.items()})]


OVERGROUND = {"strides": StrideRules(ground="overground")}


def test_cycles_of_short_trials_are_those_of_each_trial_and_none_crosses(pieces):
    study, person = _study(_planned(8), **OVERGROUND)
    (found,) = pool_cycles(study, person, lambda planned: pieces[int(planned.files[0][0])])
    assert (found.name, found.group, found.trials, found.over_ground) == ("P01 walk", "control", 8, True)
    assert found.refusals == () and dict(found.detectors) == {"force": 8}
    for side in "rl":
        assert 15 <= found.counted(side) <= 8 * 3
    for number, rows in found.kept.groupby("trial"):
        piece = pieces[int(number) - 1].stream("kinematics")
        assert rows["start_s"].min() >= piece.time[0] - 0.01 and rows["end_s"].max() <= piece.time[-1] + 0.01
    assert found.kept["stride_s"].median() == pytest.approx(1.1, abs=0.03)
    assert found.kept["kinetic"].all()


def test_raw_emg_of_one_cycle_of_each_leg_is_kept_and_saved(pieces, tmp_path):
    study, person = _study(_planned(8), **OVERGROUND)
    (found,) = pool_cycles(study, person, lambda planned: pieces[int(planned.files[0][0])])
    assert set(found.raw_emg) == {"l", "r"}
    CYCLES.save(found, tmp_path)
    for side, raw in CYCLES.load(tmp_path).raw_emg.items():
        muscles = [one.name for one in found.channels if (one.quantity, one.side) == ("emg", side)]
        stretches = []
        for row in found.kept[found.kept["side"] == side].itertuples():
            recorded = pieces[row.trial - 1].stream("emg").selected(muscles)
            first, last = np.searchsorted(recorded.time, (row.start_s, row.end_s))
            stretches.append(recorded.values[first : last + 1])
        assert muscles and sum(np.array_equal(raw, one) for one in stretches) == 1


def test_a_child_s_foot_is_on_the_ground_at_its_own_weight():
    """15 kg: a force that rises to 140 N over 0.2 s passes 20 N some 43 ms before 50 N."""
    from driven_walker import DrivenWalker

    trial = DrivenWalker("P01", stride_s=1.1, seed=4).walked(8.0, "walk")
    forces = trial.stream("forces")
    ramp = np.ones(round(0.2 * forces.rate_hz)) / round(0.2 * forces.rate_hz)
    slow = np.column_stack([np.convolve(column > 50, ramp, "same") for column in forces.values.T])
    light = with_stream(trial, "forces", forces.with_values(140.0 * slow))
    starts = {}
    for mass in (None, 15.0):
        person = Participant(id="P01", mass_kg=mass, trials=_planned(1))
        study = Study(conditions=Conditions(nominal="walk"), participants=(person,), **OVERGROUND)
        (found,) = pool_cycles(study, person, lambda _: light)
        assert dict(found.detectors) == {"force": 1}
        starts[mass] = found.kept["start_s"].to_numpy()[1:-1]
    assert len(starts[15.0]) == len(starts[None]) > 4
    np.testing.assert_allclose(starts[None] - starts[15.0], 0.2 * (50 - 20) / 140, atol=2e-3)


def test_the_mean_over_trials_is_that_of_the_walker(pieces):
    study, person = _study(_planned(8), **OVERGROUND)
    (found,) = pool_cycles(study, person, lambda planned: pieces[int(planned.files[0][0])])
    means = found.mean_curves()
    knee = means[means["channel"] == "knee_angle_r"].set_index("percent")
    assert set(knee["side"]) == {"r"}  # by the cycles of its own foot alone
    assert (knee["n"] == found.counted("r")).all()
    assert 45 < knee["mean"].max() < 65 and 65 < knee["mean"].idxmax() < 80  # bends most in swing
    assert (knee["sd"] < 6).all() and (knee["sd"] > 0).all()


def test_a_trial_that_fails_is_left_out_with_its_reason_and_the_others_go_on(pieces):
    study, person = _study(_planned(3), **OVERGROUND)

    def read(planned):
        number = int(planned.files[0][0])
        if number == 1:
            raise ReadError("1.c3d is to be read", "it is damaged", "Export it again.")
        return pieces[number] if number else Trial("empty", {"emg": pieces[0].stream("emg")})

    (found,) = pool_cycles(study, person, read)
    assert found.trials == 1 and len(found.kept)
    assert set(found.kept["trial"]) == {3}
    assert [refusal.condition for refusal in found.refusals] == ["walk 1", "walk 2"]
    assert says(found.refusals[0].reason, "two initial contacts")
    assert "it is damaged" in found.refusals[1].reason


def test_a_cycle_that_the_study_leaves_out_stays_with_its_reason(pieces):
    def pooled(first):
        study, person = _study((first, *_planned(8)[1:]), **OVERGROUND)
        return pool_cycles(study, person, lambda planned: pieces[int(planned.files[0][0])])[0]

    (first,) = _planned(1)
    whole = pooled(first)
    start = whole.kept.query("trial == 1 and side == 'l'")["start_s"].iloc[0]
    said = (f"left {start:.2f} looked aside", "right 99")
    found = pooled(first.model_copy(update={"leave_out_cycles": said}))
    assert found.counted("l") == whole.counted("l") - 1 and found.counted("r") == whole.counted("r")
    assert "left out by the study: looked aside" in set(found.left_out["reason"])
    assert [says(one.what, "'right 99'") for one in found.findings if one.kind == "cycle not found"] == [True]


def test_only_gaps_at_the_ends_of_a_walk_over_ground_spoil_nothing(pieces):
    """There a person enters and leaves the measured volume; between kept cycles a marker was hidden."""
    angles = pieces[8].stream("kinematics")
    cases = ("overground", 11.7, "note"), ("overground", 6.0, "warning"), ("treadmill", 11.7, "warning")
    for ground, late_s, severity in cases:
        values = np.array(angles.values)
        hidden = (angles.time < 0.3) | (np.abs(angles.time - late_s - 0.15) < 0.15)
        values[hidden, angles.index("knee_angle_r")] = np.nan
        trial = replace(pieces[8], streams=pieces[8].streams | {"kinematics": angles.with_values(values)})
        study, person = _study(_planned(1), strides=StrideRules(ground=ground), quality=Quality(min_strides=1))
        (found,) = pool_cycles(study, person, lambda _, trial=trial: trial)
        gaps = [(finding.channel, finding.severity) for finding in found.findings if finding.kind == "gap"]
        assert len(found.kept) and gaps == [("knee_angle_r", severity)]


def test_too_few_cycles_are_refused_by_the_setting_of_the_ground(pieces):
    cases = (2, "overground", "min_cycles", 9, "2 trials have"), (1, "treadmill", "min_strides", 10, "1 trial has")
    for count, ground, key, needed, has in cases:
        quality = Quality(min_cycles=9)
        study, person = _study(_planned(count), strides=StrideRules(ground=ground), quality=quality)
        (found,) = pool_cycles(study, person, lambda planned: pieces[int(planned.files[0][0])])
        assert len(found.kept) == 0 and found.curves.shape[0] == 0
        (refusal,) = found.refusals
        assert refusal.reason.startswith("P01 walk: ") and says(refusal.reason, f"at least {needed};", has, key)
        assert set(found.left_out["reason"]) == {"too few cycles"}
        assert not can_pool([found])


def test_sessions_are_pooled_apart(pieces):
    trials = (*_planned(2, session="before"), *_planned(3, session="after"))
    study, person = _study(trials, sessions=("before", "after"), **OVERGROUND)
    later = {"before": 0, "after": 2}
    found = pool_cycles(study, person, lambda one: pieces[int(one.files[0][0]) + later[one.session]])
    assert [(one.where, one.trials) for one in found] == [("before walk", 2), ("after walk", 3)]
    assert can_pool(found)


def test_a_stride_of_twice_the_others_length_is_left_out_over_all_trials(pieces):
    """One trial alone cannot show it: it has three strides."""
    slow = pieces[0]
    streams = {key: replace(r, time=2.0 * r.time) for key, r in slow.streams.items()}
    trials = [replace(slow, streams=streams), *pieces[1:4]]
    study, person = _study(_planned(4), **OVERGROUND)
    (found,) = pool_cycles(study, person, lambda planned: trials[int(planned.files[0][0])])
    slow_rows = found.cycles[found.cycles["trial"] == 1]
    assert not slow_rows["kept"].any()
    assert any(says(reason, "median stride", "1.1") for reason in slow_rows["reason"])


def test_swapped_sides_are_refused(pieces):
    kinematics = pieces[0].stream("kinematics")
    swap = {"r": "l", "l": "r"}
    channels = tuple(
        replace(c, name=c.name[:-1] + swap[c.side], side=swap[c.side]) if c.side else c for c in kinematics.channels
    )
    swapped = with_stream(pieces[0], "kinematics", replace(kinematics, channels=channels))
    study, person = _study(_planned(1), **OVERGROUND)
    (found,) = pool_cycles(study, person, lambda _: swapped)
    assert "left and right are exchanged" in found.refusals[0].reason


def test_a_contact_that_an_event_misses_costs_its_strides_and_not_the_trial(pieces):
    """Two strides of the right foot taken for one show its knee's peak in the middle of what seems to be stance."""
    study, person = _study(_planned(1), **OVERGROUND)
    (whole,) = pool_cycles(study, person, lambda _: pieces[0])
    landed = {side: sorted({*rows["start_s"], *rows["end_s"]}) for side, rows in whole.kept.groupby("side")}
    seen = [("l", at) for at in landed["l"]] + [("r", at) for at in landed["r"][0:3:2]]
    events = tuple(Event("initial contact", side, float(at)) for side, at in sorted(seen, key=lambda one: one[1]))
    streams = {key: stream for key, stream in pieces[0].streams.items() if key != "forces"}
    missed = replace(pieces[0], streams=streams, events=events)
    (found,) = pool_cycles(study, person, lambda _: missed)
    assert found.refusals == () and found.counted("l") == whole.counted("l") - 1
    (reason,) = found.cycles.loc[found.cycles["side"] == "r", "reason"]
    assert says(reason, "2 contacts", "other foot")


def test_a_belt_s_speed_gives_lengths(pieces):
    trials = (PlannedTrial(condition="walk", files=("0.c3d",), speed_m_per_s=1.2),)
    rules = {"strides": StrideRules(ground="treadmill"), "quality": Quality(min_strides=1)}
    study, person = _study(trials, **rules, treadmill=Treadmill(speed_m_per_s=1.0))
    (found,) = pool_cycles(study, person, lambda _: pieces[0])
    np.testing.assert_allclose(found.kept["speed_m_per_s"], 1.2)  # the trial's own belt before the study's
    assert found.kept["step_m"].isna().all()  # no markers, so nobody saw where the feet were
    without, person = _study(_planned(1), **rules)
    (found,) = pool_cycles(without, person, lambda _: pieces[0])
    assert found.kept["stride_m"].isna().all()


def test_leg_length_goes_with_the_stature_where_no_file_has_it(pieces):
    study, person = _study(_planned(1), **OVERGROUND)
    (found,) = pool_cycles(study, person, lambda _: pieces[0])
    assert found.leg_m is None and found.age_years is None
    grown = person.model_copy(update={"height_m": 1.8, "age_years": 41})
    (found,) = pool_cycles(study.model_copy(update={"participants": (grown,)}), grown, lambda _: pieces[0])
    assert found.leg_m == pytest.approx(0.53 * 1.8) and found.age_years == 41


@pytest.fixture(scope="module")
def turning(request):
    """The six people of the laboratory, each with a straight walk and a turn."""
    data = request.getfixturevalue("gait_data") / "young_straight_and_turn"
    people = []
    for number, folder in enumerate(sorted(path for path in data.iterdir() if path.is_dir()), 1):
        trials = tuple(
            PlannedTrial(condition=word, files=(str(file),))
            for word in ("straight", "turn")
            for file in sorted((folder / word).glob("*.c3d"))
        )
        people.append(Participant(id=f"P{number:02d}", trials=trials))
    study = Study(conditions=Conditions(nominal="straight", others=("turn",)), participants=tuple(people))
    with C3DReader() as reader:
        reads = [partial(read_planned_trial, study, person, reader=reader) for person in people]
        return [walk for person, read in zip(people, reads, strict=True) for walk in pool_cycles(study, person, read)]


@pytest.mark.slow
def test_all_twelve_walks_have_a_clean_cycle(turning):
    assert len(turning) == 12
    assert all(one.counted("r") >= 1 and one.counted("l") >= 1 for one in turning)
    assert all(not one.refusals and one.over_ground for one in turning)
    assert sum(len(one.kept) for one in turning) >= 44


def test_the_turn_without_events_is_moved_by_its_one_plate_and_says_so(turning):
    last = turning[-1]
    assert (last.name, dict(last.detectors), last.offset_steps) == ("P06 turn", {"markers": 1}, 1)
    assert 0.04 < last.contact_offset_s < 0.08
    (said,) = [finding.what for finding in last.findings if finding.kind == "contact offset"]
    assert says(said, "markers", "59 ms later")
    assert last.kept[last.kept["side"] == "r"]["start_by"].tolist() == ["force"]


def test_spatiotemporal_values_of_young_people_are_those_of_walking(turning):
    for one in turning:
        kept = one.kept
        assert kept["stance_percent"].between(53, 67).all(), one.name
        assert kept["double_support_percent"].between(8, 32).all(), one.name
        assert kept["stride_m"].between(0.6, 1.4).all() and kept["speed_m_per_s"].between(0.6, 1.6).all(), one.name
    straight = [one for one in turning if one.condition == "straight"]
    for one in straight:
        left, right = (one.kept[one.kept["side"] == side]["step_m"].mean() for side in "lr")
        assert left + right == pytest.approx(one.kept["stride_m"].mean(), abs=0.06)  # two steps make a stride


def test_moments_are_there_only_where_a_plate_carried_the_foot(turning):
    for one in turning:
        names = [channel.name for channel in one.channels]
        for side in "lr":
            column = one.curves[:, :, names.index(f"ankle_angle_{side}_moment")]
            own = (one.kept["side"] == side).to_numpy()
            kinetic = one.kept["kinetic"].to_numpy()
            assert np.isnan(column[~kinetic]).all()
            push = column[own & kinetic]
            assert len(push) == 0 or (np.nanmin(push, axis=1) < -0.8).all()  # plantarflexion, N m/kg
    assert sum(int(one.kept["kinetic"].sum()) for one in turning) >= 20


@pytest.mark.slow
def test_a_static_trial_of_another_person_is_said_and_costs_no_cycle(gait_data):
    folder = gait_data / "young_straight_and_turn"
    walk = PlannedTrial(condition="walk", files=(str(folder / "HC030A" / "straight" / "HC030A05.c3d"),))
    own = PlannedTrial(condition="static", files=(str(gait_data / "young_static" / "HC030A" / "HC030A01.c3d"),))
    wrong = PlannedTrial(condition="static", files=(str(folder / "HC032A" / "static" / "HC032A01.c3d"),))
    broken = PlannedTrial(condition="static", files=(str(folder / "manifest.csv"),))
    said = {}
    with C3DReader() as reader:
        for name, static in (("own", own), ("wrong", wrong), ("none", None), ("broken", broken)):
            study, person = _study((walk, static) if static else (walk,))
            (found,) = pool_cycles(study, person, partial(read_planned_trial, study, person, reader=reader))
            assert found.counted("r") == found.counted("l") == 1 and not found.refusals
            said[name] = [(f.severity, f.what) for f in found.findings if f.kind == "static trial"]
    assert said["own"] == []
    ((severity, what),) = said["wrong"]
    assert severity == "warning" and says(what, "static", "markers were moved")
    assert said["none"] == [("note", "there is no static trial")]
    assert says(said["broken"][0][1], "static", "cannot be used: manifest.csv")


def test_one_recording_saved_twice_is_counted_once(pieces):
    study, person = _study(_planned(3), **OVERGROUND)
    files = [pieces[0], replace(pieces[0], name="the same, saved again"), pieces[1]]
    (found,) = pool_cycles(study, person, lambda planned: files[int(planned.files[0][0])])
    assert set(found.kept["trial"]) == {1, 3}
    (refusal,) = found.refusals
    assert refusal.condition == "walk 2" and says(refusal.reason, "samples are identical", "P01", "1")


EMG = Recording(
    np.arange(5000) / 1000,
    np.random.default_rng(0).normal(size=(5000, 2)),
    tuple(Channel(f"emg_{muscle}_r", "emg", "V", "r") for muscle in ("sol", "ta")),
    "P01",
    "walking",
    Source("a.c3d"),
    np.random.default_rng(1).random((5000, 2)) < 0.1,
)


def test_what_was_put_away_comes_back_to_the_last_bit_and_is_not_in_memory(tmp_path):
    first, second = put_away(EMG, tmp_path), put_away(EMG.with_values(2 * EMG.values), tmp_path)
    assert first.kept.values.nbytes < 50 and first.kept.channels == EMG.channels
    for name in ("time", "values", "suspect"):
        np.testing.assert_array_equal(getattr(first.recording(), name), getattr(EMG, name))
    found = first.recording()
    assert (found.subject, found.condition, found.source) == ("P01", "walking", EMG.source)
    assert first.file is not None
    first.file.unlink()  # a count of the folder would give its place, and that of the second, away
    put_away(EMG, tmp_path)
    np.testing.assert_array_equal(second.recording().values, 2 * EMG.values)


def test_a_full_disk_leaves_them_in_memory(monkeypatch, tmp_path):
    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np, "savez", full)
    assert put_away(EMG, tmp_path).recording() is EMG


def test_the_folder_is_cleared_after_an_error(pieces, monkeypatch, tmp_path):
    def read(planned):
        if planned.files == ("1.c3d",):
            waiting.extend(tmp_path.glob("*/*.npz"))
            raise ZeroDivisionError
        return pieces[0]

    waiting = []
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    study, person = _study(_planned(2), **OVERGROUND)
    with pytest.raises(ZeroDivisionError):
        pool_cycles(study, person, read)
    assert waiting and not [*tmp_path.iterdir()]
