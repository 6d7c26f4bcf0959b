import pytest
from chapter5.reconstruct_field import ALONE, MANY_PLACED, OTHER, OWN, FieldTask, unseen_path
from chapter5.routes import fixed, fixed_at_random
from manufactured_field import travelling_wave

from gaitdisc.errors import ChannelError
from gaitdisc.reconstruction.windows import Lags

WAVE = travelling_wave(240)


def test_the_error_on_a_path_never_fitted_is_stated():
    routes = [fixed(WAVE, [k]) for k in (5, 20, 40, 60)]
    task = FieldTask("wave", Lags(6, 3), energy=0.999)
    cells = {cell.route: cell for cell in unseen_path(WAVE, routes, fixed(WAVE, [33]), task, ("fourier ridge",))}
    own, other = cells[f"{OWN}; {ALONE}"], cells[f"{OTHER}; {ALONE}"]
    placed = cells[f"{OTHER}; {MANY_PLACED.format(4)}"]
    assert own.r2 > 0.9
    assert other.r2 < 0  # a reading means another phase at another place
    assert other.r2 < placed.r2
    assert placed.fitted == 4 * own.fitted


def test_one_path_is_not_many():
    with pytest.raises(ChannelError, match=r"2 paths.*1, 2 sensors"):
        unseen_path(WAVE, [fixed(WAVE, [1]), fixed_at_random(WAVE, 2, 0)], fixed(WAVE, [3]),
                    FieldTask("wave", Lags(6, 3)), ())  # fmt: skip
