from __future__ import annotations

import numpy as np
import pytest
from made_cycles import made_cycles

from gaitdisc.errors import ShapeError
from gaitdisc.recording import PERCENT


def test_kept_and_left_out_are_distinguished_and_counted_by_foot():
    one = made_cycles(each=4, out=1)
    assert (one.counted("l"), one.counted("r"), len(one.left_out)) == (4, 4, 2)
    assert len(one.kept) == len(one.curves) == 8
    assert one.name == "P01 walk" and made_cycles(session="after").where == "after walk"


def test_means_go_by_the_cycles_of_the_own_foot_with_their_spread_and_number():
    means = made_cycles(each=4).mean_curves().set_index(["channel", "side"]).sort_index()
    knee = means.loc[("knee_angle_r", "r")]
    assert knee["mean"].to_numpy() == pytest.approx(10 * np.sin(2 * np.pi * PERCENT / 100) + 1.5)
    assert knee["sd"].to_numpy() == pytest.approx(np.std([0, 1, 2, 3], ddof=1))
    assert set(knee["n"]) == {4}
    assert set(means.index.get_level_values("channel")) >= {"pelvis_tilt"}
    assert len(means.loc[("pelvis_tilt", "l")]) == len(means.loc[("pelvis_tilt", "r")]) == 101
    assert ("knee_angle_r", "l") not in means.index


def test_a_single_cycle_has_a_mean_and_no_spread():
    moment = made_cycles().mean_curves()
    moment = moment[moment["channel"] == "ankle_angle_l_moment"]
    assert set(moment["n"]) == {1} and moment["sd"].isna().all() and moment["mean"].notna().all()


def test_curves_need_a_row_for_each_kept_cycle():
    with pytest.raises(ShapeError, match=r"\(8, 101, 6\).*\(3, 101, 6\).*P01"):
        made_cycles(curves=np.zeros((3, 101, 6)))
