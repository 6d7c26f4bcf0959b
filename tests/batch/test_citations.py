"""Literature of what a result used, and of nothing else."""

import re
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from made_cycles import made_cycles
from manufactured_discovery import manufactured

from gaitdisc.batch.chapter_parts import PARTS
from gaitdisc.batch.citations import MENTIONED, OF_MODELS, OF_PARTS, citations_of, entries, methods_of
from gaitdisc.channel import Channel
from gaitdisc.errors import SchemaError
from gaitdisc.recording import PERCENT, Finding
from gaitdisc.results.mismatch import CHANNEL_COLUMNS, CURVES, REGION_COLUMNS, Exchange, Mismatch
from gaitdisc.results.provenance import Provenance
from gaitdisc.results.reconstruction import Reconstruction
from gaitdisc.results.sealed_json import sealed_text
from gaitdisc.sensing.reconstructor import KINDS, ON_REQUEST

MADE = Provenance({}, 0, {"walk.C3D": "ab"}, {}, "", "2026-01-01T00:00:00+00:00")


def keys(folder):
    return {one.key for one in citations_of(folder)}


def of_markers(*notes):
    findings = tuple(Finding("note", kind, "a.c3d", what, "") for kind, what in notes)
    return set(methods_of(replace(made_cycles(), findings=findings)))


def test_the_table_and_the_file_name_the_same_entries_with_sound_dois():
    assert set(entries()) == {key for used in MENTIONED.values() for key in used}
    for key, entry in entries().items():
        assert "title = {" in entry and "author = {" in entry, key
        assert entry.count("{") == entry.count("}"), key
        doi = re.search(r"doi = \{(.*)\}", entry)
        assert doi is None or re.fullmatch(r"10\.\d{4,5}/\S+", doi[1]), key


def test_every_model_and_every_part_of_a_chapter_has_its_methods():
    assert set(OF_MODELS) == {*KINDS, *ON_REQUEST}
    assert set(OF_PARTS) == {part.name for part in PARTS}
    for methods in (*OF_MODELS.values(), *OF_PARTS.values()):
        assert set(methods) <= set(MENTIONED)


def test_a_discovery_cites_its_search_and_a_reading_only_where_there_is_one(tmp_path):
    found = manufactured()
    assert {"gaitdisc", "bock1984", "levenberg1944", "marquardt1963", "schwarz1978", "wilcoxon1945"} <= keys(
        found.save(tmp_path / "one")
    )
    assert not {"brunton2016", "hampel1974", "williams2024"} & keys(tmp_path / "one")
    read = replace(found, effects=(replace(found.effects[0], reads_as="-8*x**2*v"),))
    assert "brunton2016" in keys(read.save(tmp_path / "two"))


def test_cycles_cite_the_detectors_hips_and_angles_that_made_them(tmp_path):
    assert keys(made_cycles().save(tmp_path / "events")) == {"gaitdisc", "michaud2021"}  # "file 1" may be a C3D
    assert keys(made_cycles(files={"a.mot": 64 * "a"}).save(tmp_path / "mot")) == {"gaitdisc"}
    assert "zeni2008" in keys(made_cycles(detectors={"markers": 2}).save(tmp_path / "markers"))
    davis = of_markers(("marker set", "plug_in_gait: Plug-in Gait; joints free"))
    assert davis >= {"segments from markers", "joint angles", "hip centres after Davis"}
    assert not davis & {"hip centres after Harrington", "inertia of the segments"}
    without_legs = of_markers(("marker set", "plug_in_gait: x"), ("hip", "hips after Harrington, not Davis"))
    assert "hip centres after Harrington" in without_legs and "hip centres after Davis" not in without_legs
    assert "hip centres after Harrington" in of_markers(("marker set", "gait2354: OpenSim's; joints free"))
    assert "inertia of the segments" in of_markers(("marker set", "gait2354: x"), ("residual", "markers lie 2 mm"))


def test_a_mismatch_cites_its_permutation_test(tmp_path):
    curves = {name: np.zeros((len(PERCENT), 1)) for name in CURVES}
    tables = [pd.DataFrame(columns=pd.Index(names)) for names in (REGION_COLUMNS, CHANNEL_COLUMNS)]
    channels = (Channel("knee_angle_r", "angle", "deg", "r"),)
    made = Mismatch("a", "b", channels, curves, *tables, Exchange("stride", 8, 8, 8, 8, 10, False, 2.0, 0.05), (), MADE)
    assert keys(made.save(tmp_path)) == {"gaitdisc", "nichols2002", "pataky2015", "michaud2021"}


def test_a_part_of_a_chapter_cites_its_methods(tmp_path):
    (tmp_path / "chapter.json").write_text(sealed_text({"part": "who_names"}))
    assert {"ebers2023", "ebers2024discrepancy", "askham2018", "bock1984"} <= keys(tmp_path)
    assert not {"fasel2022", "sashidhar2022", "tu2014", "julier2004"} & keys(tmp_path)
    (tmp_path / "chapter.json").write_text(sealed_text({"part": "further"}))
    learned, filtered = {"tu2014", "fasel2022", "messenger2021", "rasmussen2006"}, {"julier2004", "evensen1994"}
    assert learned | filtered <= keys(tmp_path) and "sashidhar2022" not in keys(tmp_path)
    (tmp_path / "chapter.json").write_text(sealed_text({"part": "measurement_bias"}))
    assert {"kalman1960", "julier2004", "sashidhar2022"} <= keys(tmp_path) and "evensen1994" not in keys(tmp_path)
    (tmp_path / "chapter.json").write_text(sealed_text({"part": "no such"}))
    with pytest.raises(SchemaError, match="names 'no such'"):
        citations_of(tmp_path)


@pytest.mark.parametrize(("split", "cited"), [("subject: each in turn", True), ("temporal: the last 15 %", False)])
def test_an_interval_over_people_cites_cv_plus_and_every_reconstruction_its_paper(split, cited):
    errors, curves = pd.DataFrame({"model": ["shred"]}), pd.DataFrame()
    made = Reconstruction("a", (), (), split, "", {"shred": "x"}, errors, errors, curves, (), (), MADE)
    assert any(one.startswith("intervals from models") for one in methods_of(made)) == cited
    assert any(one.startswith("reconstruction") and "ebers2024sensors" in keys for one, keys in MENTIONED.items())
