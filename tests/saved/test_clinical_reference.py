"""A published reference as a table; a made one, whose numbers are known; what is read beside it."""

import dataclasses
import json
from dataclasses import replace

import numpy as np
import pytest
from made_clinic import SOURCE, made_controls, made_person, published_table, written_table
from texts import says

from gaitdisc.clinic.clinical_reference import FILE, Limits, Score, load_reference, read_published, save_reference
from gaitdisc.clinic.reading import read_beside
from gaitdisc.errors import SchemaError
from gaitdisc.saved.unit_folder import seal_text


def test_every_second_percent_becomes_a_band_on_101_points(tmp_path):
    source, (slow, free) = read_published(written_table(tmp_path, published_table()))
    assert source == SOURCE[2:] and (slow.name, slow.speeds, slow.people) == ("slow", (0.2, 0.36), 40)
    np.testing.assert_allclose(free.bands["knee_flexion"].mean, 0.1 * np.arange(101))
    np.testing.assert_allclose(free.bands["knee_flexion"].sd, 2.5)
    assert free.bands["knee_flexion"].people == 83


def test_a_person_is_beside_the_group_of_the_own_speed_with_scores_and_without_limits(tmp_path):
    reference = load_reference(written_table(tmp_path, published_table()))
    grown = read_beside(replace(made_person(), leg_m=0.9), reference)  # 1.215 m/s: 0.41
    assert says(grown.beside[1], "“free”", "83 people", "0.36", "0.50", "0.41")
    assert grown.beside[0] == f"Published: {SOURCE[2:]}."
    assert grown.profile is not None and grown.profile.both.people == 83
    assert says(grown.silent, "limits", "single legs") and grown.numbers == ()
    unknown = read_beside(made_person(), reference)
    assert says(unknown.beside[1], "“free” (83 people): the speed is unknown")
    slow = read_beside(replace(made_person(), leg_m=2.5), reference)
    np.testing.assert_allclose(slow.bands["hip_flexion"].mean, 0.1 * np.arange(101) - 5.0)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (published_table().replace(SOURCE + "\n", ""), "has no source"),
        (published_table().replace(",sd\n", ",spread\n"), "has no column sd"),
        (published_table().replace("knee_flexion", "knee"), "slow: a variable must be one of pelvis_tilt"),
        (published_table(lambda row: "" if ",98," in row or ",100," in row else row), "found 49 points from 0 to 96 %"),
        (published_table().replace("2.5\n", "-2.5\n"), "with mean and sd"),
    ],
)
def test_another_form_is_refused_with_its_place(tmp_path, text, words):
    with pytest.raises(SchemaError, match=words):
        load_reference(written_table(tmp_path, text))


def test_it_is_kept_as_its_table_and_saved_as_no_legs(tmp_path):
    with pytest.raises(SchemaError, match=r"must contain single legs; .* has none"):
        save_reference(load_reference(written_table(tmp_path, published_table())), tmp_path / "run")


def test_a_reference_is_one_file_that_is_read_as_it_was_saved(tmp_path):
    made = made_controls(3)
    path = save_reference(made, tmp_path)
    assert path.name == FILE and [one.name for one in tmp_path.iterdir()] == [FILE]
    for place in (tmp_path, path):
        read = load_reference(place)
        assert read.versions == made.versions and read.settings == made.settings
        assert read.people("walk") == 3
        first, second = read.of("walk")[0], made.of("walk")[0]
        np.testing.assert_allclose(first.curves["knee_flexion"], second.curves["knee_flexion"], atol=1e-4)
        assert (first.side, first.cycles, first.stance_percent) == (second.side, second.cycles, second.stance_percent)


def test_no_pseudonym_stands_in_it(tmp_path):
    assert "C00" not in save_reference(made_controls(2), tmp_path).read_text()


def test_what_was_changed_or_is_no_reference_is_refused(tmp_path):
    with pytest.raises(SchemaError, match=r"reference must be a.*reference\.json"):
        load_reference(tmp_path)
    path = save_reference(made_controls(2), tmp_path)
    data = json.loads(path.read_text())
    path.write_text(path.read_text().replace('"person": 1', '"person": 7', 1))
    with pytest.raises(SchemaError):
        load_reference(tmp_path)
    del data["own_sha256"]
    data["legs"]["walk"][0]["curves"]["knee_flexion"].pop()
    path.write_text(seal_text(data))
    with pytest.raises(SchemaError, match="not have 101 points"):
        load_reference(tmp_path)
    path.write_text(seal_text({**data, "format": 9}))
    with pytest.raises(SchemaError, match="format 1"):
        load_reference(tmp_path)


def test_a_curve_whose_end_is_not_known_is_saved_so(tmp_path):
    made = made_controls(2)
    made.of("walk")[0].curves["ankle_power"][95:] = np.nan
    text = save_reference(made, tmp_path).read_text()
    assert "NaN" not in text
    assert np.isnan(load_reference(tmp_path).of("walk")[0].curves["ankle_power"][95:]).all()


def test_what_is_read_is_frozen():
    limits = Limits(1.0, 3.0, 2.0, 0.5, 10)
    with pytest.raises(dataclasses.FrozenInstanceError):
        limits.low = 0.0
    assert Score(1.0, 1.0, 1.0, 1, 2.0, 0.5, 10).people == 10
