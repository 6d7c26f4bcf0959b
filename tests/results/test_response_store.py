import numpy as np
import pandas as pd

from gaitdisc.results import Refusal
from gaitdisc.results.response_store import load_refused, load_response, save_refused, save_response


def test_a_response_comes_back_as_it_was(response, tmp_path):
    save_response(response, tmp_path, "key")
    loaded, _ = load_response(tmp_path)
    pd.testing.assert_frame_equal(loaded.r2, response.r2)
    pd.testing.assert_frame_equal(loaded.fits, response.fits)
    np.testing.assert_array_equal(loaded.held_out.predicted["nominal"], response.held_out.predicted["nominal"])
    np.testing.assert_array_equal(loaded.residuals["nominal"], response.residuals["nominal"])
    assert (loaded.inputs, loaded.outputs, loaded.units) == (response.inputs, response.outputs, response.units)


def test_saving_twice_gives_the_same_bytes(response, tmp_path):
    for folder in ("a", "b"):
        save_response(response, tmp_path / folder, "key")
    for file in ("response.json", "r2.csv", "fits.csv", "arrays.npz"):
        assert (tmp_path / "a" / file).read_bytes() == (tmp_path / "b" / file).read_bytes()


def test_why_somebody_was_refused_comes_back_as_it_was(tmp_path):
    refusals = (Refusal("P07", "exo", "the gait changes at 38 s"),)
    save_refused(refusals, ("nominal",), tmp_path, "key")
    assert load_refused(tmp_path) == (refusals, ("nominal",), "key")
