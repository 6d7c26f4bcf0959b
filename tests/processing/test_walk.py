import numpy as np

from gaitdisc.processing.process import processed


def test_summary_keeps_every_stride_and_cuts_each_side_by_its_own_foot(trial, study):
    walk = processed(trial, study)
    summary = walk.summary()
    assert summary.counted() == {side: len(strides) for side, strides in walk.strides.items()}
    right, left = (summary.curves[:, :, walk.state.index(f"knee_angle_{side}")] for side in "rl")
    assert np.isfinite(right).all(axis=1).sum() >= len(walk.strides["r"]) - 1
    apart = np.abs(np.nanmean(right, axis=0) - np.nanmean(left, axis=0)).max()
    assert apart < 3.0  # the same habit, half a stride later; by the other foot's strides it would be 60 deg apart


def test_summary_says_every_dropped_stride(trial, study):
    longest = float(np.percentile(processed(trial, study).strides["r"].duration_s, 75))
    rules = study.strides.model_copy(update={"max_s": longest})
    summary = processed(trial, study.model_copy(update={"strides": rules})).summary()
    dropped = summary.strides[~summary.strides["kept"]]
    assert len(dropped) > 5
    assert dropped["reason"].str.contains("longer than").all()
