import numpy as np
from chapter5.modes import season_of
from manufactured_field import travelling_wave

WAVE = travelling_wave(58, quantities=2)  # the slower wave has a period of 29, the faster one of 17


def test_departures_and_season_make_up_the_field_again():
    season = season_of(WAVE, np.arange(40), 29)
    apart = season.departures(WAVE)
    np.testing.assert_allclose(apart.values + season.at(np.arange(58)), WAVE.values, atol=1e-6)


def test_what_comes_back_every_year_departs_from_nothing():
    field = type(WAVE)(WAVE.time, np.tile(WAVE.values[:29], (2, 1, 1)), WAVE.axes, WAVE.mask, ("h", "g"), ("m", "m"))
    assert np.abs(season_of(field, np.arange(58), 29).departures(field).values).max() < 1e-6


def test_without_a_season_it_is_the_mean():
    season = season_of(WAVE, np.arange(10), 0)
    np.testing.assert_allclose(
        season.at(np.array([3, 57])), np.tile(WAVE.values[:10].mean(axis=0), (2, 1, 1)), atol=1e-6
    )


def test_a_time_of_year_never_trained_has_the_mean():
    season = season_of(WAVE, np.array([0, 1]), 3)
    np.testing.assert_allclose(season.course[2], WAVE.values[:2].mean(axis=0), atol=1e-6)
