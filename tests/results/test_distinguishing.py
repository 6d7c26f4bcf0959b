import pytest

from gaitdisc.results.distinguishing import would_distinguish


@pytest.mark.parametrize(
    ("name", "other", "recording"),
    [
        ("one_sided_spring", "cubic_stiffness", "wider range"),
        ("coulomb_friction", "viscous_damping", "different speeds"),
        ("input_delay", "sensor_lag", "sharp push"),
        ("periodic_forcing", "one_sided_spring", "another cadence"),
        ("wrong_parameter", "input_gain", "drive switched off"),
        ("wrong_parameter", "viscous_damping", "measurement of the parameter itself"),
        ("my_own", "cubic_stiffness", "longer trials"),
        ("one_sided_spring", "one_sided_spring", "two places"),
    ],
)
def test_a_recording_is_named_whichever_comes_first(name, other, recording):
    assert recording in would_distinguish(name, other)
    assert would_distinguish(name, other) == would_distinguish(other, name)
