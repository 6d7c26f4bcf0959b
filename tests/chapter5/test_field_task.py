from dataclasses import replace

from chapter5.reconstruct_field import FieldTask, Label

from gaitdisc.reconstruction.windows import RANDOM, Lags

TASK = FieldTask("wave", Lags(8, 3), energy=0.9999)


def test_a_cell_is_named_after_its_task():
    assert TASK.label("r", TASK.named("linear")) == Label("wave", "r", "temporal", "linear", 0)
    task = replace(TASK, departures=True, rule=RANDOM, seed=3)
    assert task.label("r", task.named("linear")) == Label("wave", "r", RANDOM, "linear, departures", 3)
