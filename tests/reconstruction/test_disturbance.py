import numpy as np
import pandas as pd
import pytest
from chapter5.gait import DISTURBED, NOISES, SHARES, against_missing, against_noise, noisy

KINDS = ("linear", "delay ridge")


@pytest.fixture
def walks(pair):
    return [(pair.recording, 100 * (pair.recording.time % 1.0))]


def test_noise_is_on_the_sensors_alone_and_of_the_size_that_is_asked_for(pair):
    more = noisy(pair.recording, ("a",), 0.05, seed=1).values - pair.recording.values
    assert more[:, 0].std() == pytest.approx(0.05 * pair.recording["a"].std(), rel=0.05)
    assert not more[:, 1].any()


@pytest.mark.parametrize(("against", "levels"), [(against_noise, NOISES), (against_missing, SHARES)])
def test_the_error_grows_with_noise_as_history_is_worth_less_and_with_missing_readings(pair, walks, against, levels):
    rows = against(walks, pair.what, pair.channels[1:], KINDS)
    found = pd.DataFrame(rows, columns=pd.Index(DISTURBED)).pivot_table("rmse_deg", "level", "model")
    assert found.index.tolist() == list(levels)
    assert found["delay ridge"].is_monotonic_increasing
    assert np.isfinite(found.to_numpy()).all()
    if against is against_noise:
        assert found["delay ridge"].iloc[0] < 0.01
        # one reading tells the state: its noise is all there is
        assert found["delay ridge"].iloc[-1] == pytest.approx(0.1 * pair.recording["a"].std(), rel=0.3)
