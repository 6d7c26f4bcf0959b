from __future__ import annotations

import numpy as np
from texts import says

from gaitdisc.channel import vocabulary
from gaitdisc.recording import Recording, Strides
from gaitdisc.signals.emg import order_of_muscles, stance_over_swing


def walk(*names, swing=()):
    """Envelopes of 1 in stance and 0.2 in swing of the named leg; the other way round for `swing`."""
    time = np.arange(1001) / 100
    columns = []
    for name in names:
        at = (time - (0.5 if name.endswith("l") else 0.0)) % 1.0
        columns.append(np.where((at < 0.6) != (name in swing), 1.0, 0.2))
    strides = {"r": Strides(np.arange(9.0), 1 + np.arange(9.0), "r", "force")}
    strides["l"] = Strides(0.5 + np.arange(9.0), 1.5 + np.arange(9.0), "l", "force")
    return Recording(time, np.stack(columns, axis=1), tuple(vocabulary().named(name) for name in names)), strides


def test_each_muscle_at_its_own_time_says_nothing():
    envelope, strides = walk("emg_gas_r", "emg_ta_r", swing=("emg_ta_r",))
    assert abs(stance_over_swing(envelope, strides["r"], "emg_gas_r") - np.log(5)) < 0.05
    assert order_of_muscles(envelope, strides) == []


def test_calf_and_shin_exchanged_are_named_with_how_much_stronger():
    (finding,) = order_of_muscles(*walk("emg_gas_r", "emg_ta_r", swing=("emg_gas_r",)))
    assert says(finding.what, "emg_gas_r", "emg_ta_r", "emg_gas_r", "5.0 times")
    assert finding.channel == "emg_gas_r, emg_ta_r"


def test_calves_of_both_legs_exchanged_are_named():
    (finding,) = order_of_muscles(*walk("emg_sol_r", "emg_sol_l", swing=("emg_sol_r", "emg_sol_l")))
    assert "emg_sol_l and emg_sol_r look exchanged" in finding.what


def test_one_muscle_out_of_time_is_a_patients_own():
    assert order_of_muscles(*walk("emg_gas_r", "emg_ta_r", swing=("emg_gas_r", "emg_ta_r"))) == []
    assert order_of_muscles(*walk("emg_ta_r")) == []


def test_exchanged_calves_that_begin_before_contact_are_named_by_the_steps_of_both_feet():
    """One foot's steps alone say little of them."""
    envelope, strides = walk("emg_sol_r", "emg_sol_l")
    values = np.array(envelope.values)
    for column, begins in enumerate((0.5, 0.0)):  # each is the other leg's
        at = (envelope.time - begins) % 1.0
        values[:, column] = np.select([(at > 0.9) | (at < 0.06), at < 0.6], [1.8, 1.0], 0.1)
    late = envelope.with_values(values)
    assert -0.5 < stance_over_swing(late, strides["r"], "emg_sol_r") < 0
    (finding,) = order_of_muscles(late, strides)
    assert "emg_sol_l and emg_sol_r look exchanged" in finding.what
