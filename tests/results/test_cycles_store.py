from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from made_cycles import made_cycles

from gaitdisc.errors import SchemaError
from gaitdisc.results.cycles_store import cycles_name, load_cycles, save_cycles


@pytest.mark.parametrize("fields", [{}, {"session": "after", "group": "control", "contact_offset_s": 0.06}])
def test_cycles_come_back_as_they_were(tmp_path, fields):
    made = made_cycles(**fields)
    save_cycles(made, tmp_path, "key")
    loaded, key = load_cycles(tmp_path)
    assert key == "key"
    np.testing.assert_array_equal(loaded.curves, made.curves)
    pd.testing.assert_frame_equal(loaded.cycles, made.cycles, check_dtype=False)
    pd.testing.assert_frame_equal(loaded.kept, made.kept, check_dtype=False)
    for name in ("name", "group", "trials", "detectors", "contact_offset_s", "foot_off_offset_s", "offset_steps",
                 "over_ground", "channels", "findings", "refusals", "files"):  # fmt: skip
        assert getattr(loaded, name) == getattr(made, name), name


def test_a_set_without_a_kept_cycle_comes_back_too(tmp_path):
    save_cycles(made_cycles(each=0, out=2), tmp_path, "key")
    assert len(load_cycles(tmp_path)[0].kept) == 0


def test_what_was_changed_by_hand_is_refused(tmp_path):
    save_cycles(made_cycles(), tmp_path, "key")
    table = tmp_path / "cycles.csv"
    table.write_text(table.read_text().replace("events", "markers", 1))
    with pytest.raises(SchemaError, match="changed since it was saved"):
        load_cycles(tmp_path)


def test_no_two_sets_share_a_folder():
    names = [cycles_name("P01", *words) for words in (("", "a b"), ("a", "b"), ("", "a_b"), ("a b", "c"), ("a", "b c"))]
    assert len({*names}) == len(names)
