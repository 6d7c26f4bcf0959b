import numpy as np
import pytest
from texts import says

from gaitdisc.channel import Channel
from gaitdisc.ingest.c3d import C3DReader
from gaitdisc.ingest.reading import read_trial
from gaitdisc.processing.standing import person_findings, segment_distances
from gaitdisc.recording import Recording

PLACES = {
    "LASI": (0.0, 0.12, 0.9), "RASI": (0.0, -0.12, 0.9), "LPSI": (-0.15, 0.05, 0.92), "LKNE": (0.0, 0.1, 0.45),
    "LANK": (0.0, 0.1, 0.08), "LHEE": (-0.05, 0.1, 0.03), "LTOE": (0.14, 0.1, 0.03),
}  # fmt: skip


def _person(size=1.0, shank=1.0):
    time = np.arange(50) / 100
    columns, channels = [], []
    for name, (x, y, z) in PLACES.items():
        up = 0.08 + (z - 0.08) * shank if name == "LKNE" else z
        columns += [size * x + time, size * y + 0 * time, size * up + 0 * time]
        channels += [Channel(f"{name}.{axis}", "marker", "m") for axis in "xyz"]
    return Recording(time, np.column_stack(columns), tuple(channels))


def test_distances_of_a_segment_do_not_walk():
    found = segment_distances(_person())
    assert found["LASI", "RASI"] == pytest.approx(0.24)
    assert found["LKNE", "LANK"] == pytest.approx(0.37)
    assert ("LKNE", "LHEE") not in found


def test_another_person_is_named_with_the_two_distances():
    (said,) = person_findings(_person(), _person(size=1.08), "walk.c3d")
    assert (said.severity, said.kind, said.file) == ("warning", "static trial", "walk.c3d")
    assert says(said.what, "markers were moved")
    assert says(said.what, "370 mm", "400 mm") or says(said.what, "240 mm", "259 mm")


def test_one_marker_that_was_set_again_is_no_other_person():
    assert person_findings(_person(), _person(shank=1.1), "walk.c3d") == []
    assert person_findings(_person(), _person(size=1.02), "walk.c3d") == []


def test_few_markers_show_nothing():
    few = _person().selected([f"{name}.{axis}" for name in ("LKNE", "LANK") for axis in "xyz"])
    assert person_findings(few, _person(size=1.3), "walk.c3d") == []


def test_six_people_in_seventy_two_pairs(gait_data):
    walks, standing = {}, {}
    with C3DReader() as reader:
        for folder in sorted(path for path in (gait_data / "young_straight_and_turn").iterdir() if path.is_dir()):
            place = gait_data / "young_static" / folder.name
            place = place if place.is_dir() else folder / "static"
            standing[folder.name] = read_trial(next(place.glob("*.c3d")), reader=reader).stream("markers")
            for file in sorted(folder.glob("[st][tu]r*/*.c3d")):
                walks[folder.name, file.stem] = read_trial(file, reader=reader).stream("markers")
    said = {
        (person, file, other): bool(person_findings(static, walk, file))
        for (person, file), walk in walks.items()
        for other, static in standing.items()
    }
    assert len(said) == 72
    assert all(found == (person != other) for (person, _, other), found in said.items())
