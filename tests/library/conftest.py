"""A mapping of a walk with recorded forces, whose files are there and empty."""

import pytest


@pytest.fixture
def tracked_walk(tmp_path):
    for name in ("leg.osim", "grf.mot"):
        (tmp_path / name).touch()
    (tmp_path / "grf.xml").write_text("<ExternalLoads><datafile>grf.mot</datafile></ExternalLoads>")
    file = tmp_path / "walk.toml"
    file.write_text('model = "leg.osim"\n\n[tracked]\nexternal_loads = "grf.xml"\n')
    return file
