from __future__ import annotations

import numpy as np
import pytest

from gaitdisc.errors import UnitError
from gaitdisc.ingest.stated_units import distance_from_origin, refuse_other_unit
from gaitdisc.ingest.trc import read_trc


def test_millimetres_called_metres_and_the_other_way_round_are_refused():
    with pytest.raises(UnitError, match=r"15 m.*1500 away.*mm"):
        refuse_other_unit("m", 1500.0, "a.trc", "Units in line 3")
    for metres in (0.5, 1.5, 7.0):  # a walkway may be long, or lie far from the origin
        with pytest.raises(UnitError, match=rf"15 mm.*{metres:g} away.*line 3"):
            refuse_other_unit("mm", metres, "a.trc", "Units in line 3")
    refuse_other_unit("mm", 1500.0, "a.trc", "")
    refuse_other_unit("m", float("nan"), "a.trc", "")


def test_the_far_end_counts_and_gaps_do_not():
    assert np.isnan(distance_from_origin(np.full((3, 3), np.nan)))
    assert distance_from_origin(np.array([[np.nan, -2.0]])) == 2.0


def test_a_real_trc_whose_header_states_the_other_unit_is_refused(gait_data, tmp_path):
    source = gait_data.parent / "opensim_gait10dof" / "ExperimentalData" / "subject01_walk.trc"
    lines = source.read_text().splitlines()
    assert "\tmm\t" in lines[2]
    lines[2] = lines[2].replace("\tmm\t", "\tm\t")
    path = tmp_path / "walk.trc"
    path.write_text("\n".join(lines) + "\n")
    with pytest.raises(UnitError, match="which looks like mm"):
        read_trc(path)
