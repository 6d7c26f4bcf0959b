from dataclasses import replace

import numpy as np
import pytest

from gaitdisc.errors import ShapeError


def test_r2_of(response):
    assert response.r2_of("hip_flexion_r", "nominal") == pytest.approx(0.3)
    assert np.isnan(response.r2_of("hip_flexion_r", "augmented"))


def test_columns_fit_the_outputs(response):
    with pytest.raises(ShapeError, match=r"as many columns in residuals\[nominal\]; found 2 for P01"):
        replace(response, residuals={"nominal": np.zeros((3, 101, 2))})
    with pytest.raises(ShapeError, match="101 points a stride"):
        replace(response, residuals={"nominal": np.zeros((3, 51, 1))})
