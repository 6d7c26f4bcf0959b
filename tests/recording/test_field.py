import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from texts import says

from gaitdisc.errors import ChannelError, SamplingError, ShapeError
from gaitdisc.recording.field import Axis, Field

AXES = (Axis("lat", np.array([10.0, 0.0, -10.0]), "deg"), Axis("lon", np.array([5.0, 7.0]), "deg"))
MASK = np.array([[True, False], [True, True], [False, True]])


def field(time=(0.0, 1.0, 2.0), values=None, **changed):
    values = np.arange(len(time) * 8.0).reshape(len(time), 4, 2) if values is None else values
    return Field(**{
        "time": np.asarray(time), "values": values, "axes": AXES, "mask": MASK, "quantities": ("u", "v"),
        "units": ("m/s", "m/s"), "time_unit": "month",
    } | changed)  # fmt: skip


def test_points_lie_where_the_mask_holds_last_axis_fastest():
    sea = field()
    assert (sea.points, len(sea)) == (4, 3)
    assert sea.places.tolist() == [[10.0, 5.0], [0.0, 5.0], [0.0, 7.0], [-10.0, 7.0]]
    assert sea.number_at.tolist() == [[0, -1], [1, 2], [-1, 3]]
    assert says(sea.place_words(2), "lat 0 deg", "lon 7 deg")
    assert not sea.values.flags.writeable


@given(arrays(bool, (3, 2)), st.integers(0, 2**31))
def test_what_is_put_on_the_grid_is_found_again(mask, seed):
    if not mask.any():
        return
    values = np.random.default_rng(seed).normal(size=(2, int(mask.sum()), 1)).astype(np.float32)
    sea = Field(np.arange(2.0), values, AXES, mask, ("sst",), ("degC",))
    on_grid = sea.on_grid(sea.values[1, :, 0])
    assert np.array_equal(on_grid[mask], values[1, :, 0])
    assert np.isnan(on_grid[~mask]).all()


def test_snapshots_and_quantities_are_kept_as_asked():
    sea = field().snapshots(slice(1, None)).selected(["v"])
    assert (len(sea), sea.quantities, sea.units) == (2, ("v",), ("m/s",))
    assert sea.values[0, 0, 0] == 9.0
    with pytest.raises(ChannelError, match="quantities must be among u, v"):
        field().selected(["w"])


def test_a_missing_value_is_named_with_its_place():
    values = np.zeros((3, 4, 2))
    values[1, 3, 1] = np.nan
    with pytest.raises(ShapeError, match=r"1 values.*-10 deg.*7 deg.*snapshot 2"):
        field(values=values)


def test_uneven_time_is_refused_by_number():
    with pytest.raises(SamplingError, match=r"snapshot 3.*3 month.*1"):
        field(time=(0.0, 1.0, 4.0, 5.0, 6.0))
    with pytest.raises(SamplingError, match=r"evenly spaced"):
        field(time=(0.0, 1.0, 0.5))


def test_shapes_that_do_not_fit_are_refused():
    with pytest.raises(ShapeError, match=r"\(3, 4, 2\).*\(3, 5, 2\)"):
        field(values=np.zeros((3, 5, 2)))
    with pytest.raises(ShapeError, match=r"the shape.*\(3, 2\)"):
        field(mask=np.zeros((3, 2), bool))
    with pytest.raises(ShapeError, match=r"'lat'.*that do not"):
        Axis("lat", np.array([0.0, 1.0, 0.5]))


def test_the_step_of_an_axis():
    assert Axis("z", np.array([3.0])).step == float("inf")
    assert AXES[0].step == 10.0
