from __future__ import annotations

import json

import numpy as np
import pytest
from made_clinic import made_controls

from gaitdisc.errors import SchemaError
from gaitdisc.results.clinical_reference import FILE, load_reference, save_reference
from gaitdisc.results.sealed_json import sealed_text


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
    with pytest.raises(SchemaError, match=r"a reference is a folder with reference\.json"):
        load_reference(tmp_path)
    path = save_reference(made_controls(2), tmp_path)
    data = json.loads(path.read_text())
    path.write_text(path.read_text().replace('"person": 1', '"person": 7', 1))
    with pytest.raises(SchemaError):
        load_reference(tmp_path)
    del data["own_sha256"]
    data["legs"]["walk"][0]["curves"]["knee_flexion"].pop()
    path.write_text(sealed_text(data))
    with pytest.raises(SchemaError, match="a curve has not 101 points"):
        load_reference(tmp_path)
    path.write_text(sealed_text({**data, "format": 9}))
    with pytest.raises(SchemaError, match="a reference of format 1 is needed"):
        load_reference(tmp_path)


def test_a_curve_whose_end_is_not_known_is_saved_so(tmp_path):
    made = made_controls(2)
    made.of("walk")[0].curves["ankle_power"][95:] = np.nan
    text = save_reference(made, tmp_path).read_text()
    assert "NaN" not in text
    assert np.isnan(load_reference(tmp_path).of("walk")[0].curves["ankle_power"][95:]).all()
