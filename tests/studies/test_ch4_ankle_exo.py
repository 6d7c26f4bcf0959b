"""Studies of chapter 4: angles, and EMG."""

import sys
import tomllib

import ankle_exo_emg
import ch4_ankle_exo
import numpy as np
import pandas as pd
import pytest
from texts import says


def test_every_printed_number_has_ours_and_its_source():
    printed = tomllib.loads(ch4_ankle_exo.PRINTED.read_text(encoding="utf-8"))["value"]
    assert [value["id"] for value in printed] == list(ch4_ankle_exo.OURS)
    assert all(value["source"] for value in printed if value["printed"] != "not printed")
    assert {key for value in printed for key in value} == {"id", "what", "printed", "source"}  # no reason by hand


@pytest.mark.slow
def test_the_quick_study_is_the_whole_way_for_one_person(tmp_path):
    result = ch4_ankle_exo.run(quick=True, folder=tmp_path, jobs=1)
    assert len(result.run.responses) == len(result.run.quantities) == 1
    ours = result.printed.set_index("what")["ours"]
    assert ours["Augmented explains less than Exo"] == "none"
    assert ours[[one for one in ours.index if one.startswith("(ii) Exo")]].to_list() == ["not tested"]
    figures = {path.stem for path in (tmp_path / "report" / "figures").glob("*.csv")}
    assert {"quantity", "reduction", "residual-W01-1"} <= figures
    assert (tmp_path / "printed.csv").read_text(encoding="utf-8").startswith("what,printed,ours,source")


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_the_order_of_the_chapter_holds(tmp_path):
    """What must hold is the order and the logic, not the numbers: the cohort is another population."""
    run = ch4_ankle_exo.run(quick=False, folder=tmp_path).run
    assert [refusal.participant for refusal in run.refusals] == ["W07"]
    nominal, augmented, exo = (sys.modules["ch4_ours"].medians(run, model) for model in ("nominal", "augmented", "exo"))
    angles = list(sys.modules["ch4_ours"].ANGLES)
    assert (nominal[angles] < augmented[angles]).all()
    assert (abs(augmented - exo) < 0.05).all()
    assert (exo < 1).all()
    tests = run.tests.of_pair("nominal", "augmented")
    assert tests["different"].sum() >= 6
    reductions = run.over.reduction_tests
    of_angles = reductions[reductions["variable"].isin(angles)]
    assert (of_angles["low"] > 0).all()
    whole = [quantity.medians()["exo"] for quantity in run.quantities]
    assert all(exo.iloc[-1] > exo.loc[10.0] > exo.loc[1.0] for exo in whole)


@pytest.fixture(scope="module")
def found(gait_data):
    return ankle_exo_emg.run(gait_data)


def test_parts_of_a_stride_that_begins_with_contact():
    force = np.r_[np.full(20, -800.0), np.full(10, -1.0)]
    assert ankle_exo_emg.part_of_stride(force).tolist() == ["early stance"] * 10 + ["late stance"] * 10 + ["swing"] * 10


def test_parts_of_a_stride_whose_stance_runs_over_its_end():
    force = np.r_[np.full(4, -800.0), np.zeros(11), np.full(15, -800.0)]
    parts = ankle_exo_emg.part_of_stride(force)
    assert parts[:4].tolist() == ["late stance"] * 4
    assert parts[4:15].tolist() == ["swing"] * 11
    assert parts[15:].tolist() == ["early stance"] * 9 + ["late stance"] * 6


def manufactured(ratio, faulty_person=None):
    """Curves whose soleus in late stance is `ratio` times that of C1 in all settings and people."""
    force = np.r_[np.full(20, -800.0), np.zeros(10)]
    curves = {}
    for person in ankle_exo_emg.PEOPLE:
        for setting in ankle_exo_emg.SETTINGS:
            table = pd.DataFrame({"Fz_R": force, "Fz_L": force})
            for name in ankle_exo_emg.electrodes_of():
                table[name] = (0.1 + 0.5 * (np.arange(30) % 10)) * (1 + 0.01 * ankle_exo_emg.PEOPLE.index(person))
                if setting != "C1" and name.startswith(("MSOL", "LSOL")):
                    table.loc[10:19, name] *= ratio + 0.001 * ankle_exo_emg.PEOPLE.index(person)
            if person == faulty_person and setting == "C4":
                table["TA_R"] *= 20.0
            curves[person, setting] = table
    return ankle_exo_emg.Walks(curves, pd.DataFrame(), 0)


def test_a_known_change_is_found_where_it_is_and_nowhere_else():
    table = ankle_exo_emg.contrast(manufactured(0.8), "C6", {}).set_index(["part", "variable"])
    row = table.loc[("late stance", "soleus")]
    assert row["different"] and row["rank_biserial"] == -1
    assert row["shift"] == pytest.approx(-19.7, abs=0.2)
    assert not table.drop(index=[("late stance", "soleus")])["different"].any()


def test_an_electrode_that_jumps_is_left_out_by_name():
    walks = manufactured(1.0, "S03")
    faulty = ankle_exo_emg.faulty_electrodes(walks)
    assert list(faulty) == [("S03", "TA_R")] and says(faulty["S03", "TA_R"], "20 times", "C4")
    ratios = ankle_exo_emg.log_ratios(walks, "C4", "swing", faulty)
    assert ratios.loc["S03", "tibialis anterior"] == pytest.approx(0.0)


@pytest.mark.slow
def test_the_recordings_are_those_of_the_source(found):
    walks, _, _ = found
    assert walks.strides == 3548
    assert walks.energy_w.mean().round().tolist() == [313, 333, 349, 364, 360, 381, 345, 321, 323]


@pytest.mark.slow
def test_broken_electrodes_are_found(found):
    _, faulty, _ = found
    assert len(faulty) == 12
    assert says(faulty["S06", "MSOL_R"], "17 times", "C2")
    assert faulty["S04", "RF_R"].startswith("no burst")


@pytest.mark.slow
def test_nothing_is_below_what_eight_people_allow(found):
    _, _, tests = found
    assert len(tests) == 8 * 3 * 6
    assert (tests["n"] == 8).all() and (tests["tests"] == 6).all()
    assert tests["p"].min() == 2 / 2**8
    assert (tests.loc[tests["different"], "p"] == 2 / 2**8).all()


@pytest.mark.slow
def test_the_hardest_against_the_easiest(found):
    tests = found[2]
    hardest = tests[tests["setting"] == "C6"]
    assert hardest.loc[hardest["different"], ["part", "variable"]].to_numpy().tolist() == [
        ["late stance", "tibialis anterior"]
    ]
    assert hardest["shift"].abs().max() == pytest.approx(45, abs=1)
    soleus = tests[(tests["part"] == "late stance") & (tests["variable"] == "soleus") & tests["different"]]
    assert soleus["setting"].tolist() == ["C5", "C8", "C9"]
