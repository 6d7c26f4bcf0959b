from __future__ import annotations

import numpy as np
import pytest
from made_clinic import made_controls, made_person
from texts import says

from gaitdisc.clinic.reading import read_beside
from gaitdisc.recording import Finding
from gaitdisc.results.provenance import Refusal


def test_a_person_beside_a_reference_has_all_of_a_page():
    found = read_beside(made_person(), made_controls(6))
    assert found.light == "green" and found.reasons == ()
    assert found.profile is not None and set(found.legs) == {"l", "r"}
    assert found.consistency["knee_flexion", "l"] == pytest.approx(1.0, abs=0.01)
    assert "30 controls" in found.no_index
    assert set(found.bands) >= {"pelvis_tilt", "ankle_power"}


def test_without_a_reference_and_for_another_condition_the_reason_is_said():
    assert "there is no reference" in read_beside(made_person(), None).silent
    other = read_beside(made_person(condition="turn"), made_controls(6))
    assert other.silent == other.no_profile and says(other.silent, "'turn'", "'walk'")
    assert other.bands == {}


def test_the_light_says_why():
    found = (
        Finding("refused", "dead", "a", "flat", "the channel", "emg_ta_l"),
        Finding("warning", "gap", "a", "0.2 s", "angles"),
    )
    few = read_beside(made_person(each=2, findings=found, refusals=(Refusal("P01", "walk 3", "unread"),)), None)
    assert few.light == "amber"
    assert says(few.reasons[0], "few cycles", "2 left, 2 right")
    assert few.reasons[1:] == ("trials left out: 1", "EMG left out: 1 channel", "warnings: gap")
    nothing = made_person(refusals=(Refusal("P01", "walk", "no cycle of P01"),))
    nothing = made_person(
        cycles=nothing.cycles.assign(kept=False), curves=np.zeros((0, *nothing.curves.shape[1:])),
        refusals=nothing.refusals,
    )  # fmt: skip
    assert (read_beside(nothing, made_controls(6)).light, read_beside(nothing, None).reasons) == (
        "red",
        ("no cycle of P01",),
    )
