"""Whether a recording is fit for use."""

import gaitdisc as gd


def test_a_file_of_a_walk_is_looked_at(tmp_path):
    angles, analog = gd.example_files(tmp_path, 10.0)["nominal"]
    seen = gd.check(angles)
    assert isinstance(seen, gd.Inspection) and seen.light == "green" and set(seen.strides) == {"r", "l"}
    (tmp_path / "words.csv").write_text("these,are\nno,numbers\n")
    assert gd.check(tmp_path / "words.csv").light == "red"
    assert analog.suffix == ".c3d"
