import importlib
from pathlib import Path

import numpy as np
import pytest


def study(name):
    return importlib.import_module(name)


@pytest.fixture(scope="module")
def contact_bias(gait_data):
    module = study("contact_bias")
    return module, module.walks(gait_data, quick=True)


def test_most_contacts_of_a_turn_are_found_from_markers(contact_bias):
    module, found = contact_bias
    [turn] = [row for row in module.against_events(found) if row[0] == "turn, 1" and row[1] == "markers"]
    pairs, contacts = map(int, turn[2].split(" of "))
    assert (contacts, turn[5], turn[6]) == (9, "0", "0")
    assert pairs >= 6


def test_markers_place_contacts_some_fifty_milliseconds_before_a_plate(contact_bias):
    module, found = contact_bias
    offsets, corrections = module.against_plates(found)
    assert [(row[0], row[1], row[2]) for row in offsets] == [("markers", "2", "4"), ("angles", "2", "3")]
    assert float(offsets[0][3]) == pytest.approx(-46, abs=10)
    placed, corrected = float(corrections[0][5]), float(corrections[0][7])
    assert corrected < placed / 2


def test_a_correction_by_the_other_step_leaves_the_steps_difference():
    module = study("contact_bias")
    contacts = module.gd.Contacts(np.array([1.0, 2.0]), "r", "force")
    early = module.gd.Contacts(np.array([0.95, 1.97]), "r", "markers")
    walk = {Path("walk.c3d"): {"force": {"r": contacts}, "markers": {"r": early}, "angles": {"r": early}}}
    offsets, corrections = module.against_plates(walk)
    assert offsets[0] == ("markers", "1", "2", "-40", "-40 to -40")
    assert corrections[0] == ("markers", "floor", "2", "2", "40", "49", "20", "20")
