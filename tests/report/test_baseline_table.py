from dataclasses import replace

from gaitdisc.report.baseline_table import baseline_sentences, baseline_table


def test_each_variable_and_model_has_its_baselines(tested):
    table = baseline_table(tested)
    assert len(table.rows) == 3 * 3
    assert table.rows[0][:3] == ("hip flexion, right", "Nominal", "11")
    assert all(cell.split()[1] == "higher" for cell in table.rows[2][3:])
    assert sum(span for _, span in table.groups) == len(table.columns)


def test_a_network_that_beats_everything_is_said_to(tested):
    every = tested.over.baselines.assign(different=True, rank_biserial=1.0)
    said = baseline_sentences(replace(tested, over=replace(tested.over, baselines=every)))
    assert said[2] == "The Exo network beats every baseline in all."


def test_where_it_does_not_the_variables_are_named(tested):
    tests = tested.over.baselines.assign(different=True, rank_biserial=1.0)
    mine = (tests["model"] == "exo") & (tests["first"] == "ridge")
    tests.loc[mine & (tests["variable"] == "ankle_angle_l"), "different"] = False
    tests.loc[mine & (tests["variable"] == "emg_sol_r"), "rank_biserial"] = -1.0
    said = baseline_sentences(replace(tested, over=replace(tested.over, baselines=tests)))
    assert said[2] == (
        "The Exo network is not shown to beat ridge with phase harmonics (in ankle angle, left; EMG soleus, right)."
    )


def test_nothing_where_nothing_was_compared(run):
    assert baseline_table(run) is None
    assert baseline_sentences(run) == []
