"""Parts of chapters run as programs, the literature of a result, and the installation they need."""

import json
import re
from dataclasses import replace
from unittest.mock import patch

import numpy as np
import pandas as pd
import pytest
from made_cycles import made_cycles
from manufactured_discovery import manufactured
from texts import says

from gaitdisc.channel import Channel
from gaitdisc.comparison.mismatch import CHANNEL_COLUMNS, CURVES, REGION_COLUMNS, Exchange, Mismatch
from gaitdisc.errors import SchemaError, TrainingError, WriteError
from gaitdisc.ingest.reading import write_recording
from gaitdisc.reconstruction.reconstruction import Reconstruction
from gaitdisc.reconstruction.window_model import KINDS, ON_REQUEST
from gaitdisc.recording import PERCENT, Finding
from gaitdisc.run import chapter_run, installation
from gaitdisc.run.chapter_parts import CHAPTERS, OUT, PARTS, Part, costs, list_parts, studies_folder
from gaitdisc.run.chapter_run import find_lack, run_part
from gaitdisc.run.citations import MENTIONED, OF_MODELS, OF_PARTS, entries, list_citations, list_methods
from gaitdisc.run.installation import checks
from gaitdisc.saved.provenance import Provenance
from gaitdisc.saved.unit_folder import seal_text

WORKS = """
import os, sys
from pathlib import Path
out = Path(sys.argv[1])
(out / "count.txt").open("a").write("x")
if (out / "stop.txt").exists():
    raise ValueError("walk.mot has no strides")
print("| a table |", sys.argv[2:], Path(os.environ["GAITDISC_DATA"]).name)
"""
ONE = Part(3, "one", "made", "a table", 0.1, 0.1)


@pytest.fixture
def studies(tmp_path, monkeypatch):
    folder = tmp_path / "made" / "studies"
    folder.mkdir(parents=True)
    (folder / "made.py").write_text(WORKS)
    monkeypatch.setattr(chapter_run, "studies_folder", lambda: folder)
    return folder


def counted(out):
    return len((out / "one" / "count.txt").read_text())


def test_a_part_is_computed_once_and_kept(studies, tmp_path):
    out, ticks = tmp_path / "out", []
    made = run_part(ONE, out, True, tmp_path / "lab", ticks.append)
    assert (made, ticks != []) == ((out / "one", False), True)
    assert says((made.folder / "printed.md").read_text(), "| a table |", "['--quick'] lab\n")
    assert run_part(ONE, out, True, None) == (out / "one", True)
    assert counted(out) == 1
    assert sorted(path.name for path in made.folder.iterdir()) == ["chapter.json", "count.txt", "printed.md"]


def test_a_part_that_failed_says_why_and_goes_on_in_its_folder(studies, tmp_path):
    out = tmp_path / "out"
    run_part(ONE, out, True, None)
    state = json.loads((out / "one" / "chapter.json").read_text())
    assert state["seconds"] >= 0
    (tmp_path / "two" / "one").mkdir(parents=True)
    with pytest.raises(TrainingError, match=r"ValueError: walk.mot.*no strides.*said.txt"):
        broken = Part(3, "one", "made", "a table", 0.1, 0.1, quick_words=(OUT, "--quick"))
        (studies / "made.py").write_text(WORKS.replace('(out / "stop.txt").exists()', "True"))
        run_part(broken, tmp_path / "two", True, None)
    assert "Traceback" in (tmp_path / "two" / "one" / "said.txt").read_text()
    assert not (tmp_path / "two" / "one" / "printed.md").exists()
    with pytest.raises(TrainingError):  # begun and not finished: it runs again, in what stands there
        run_part(broken, tmp_path / "two", True, None)
    assert counted(tmp_path / "two") == 2


def test_quick_and_whole_and_other_code_never_share_a_folder(studies, tmp_path):
    run_part(ONE, tmp_path, True, None)
    with pytest.raises(SchemaError, match=r"quick.*another folder"):
        run_part(ONE, tmp_path, False, None)
    (studies / "made.py").write_text(WORKS + "\n# another line\n")
    with pytest.raises(SchemaError, match="other"):
        run_part(ONE, tmp_path, True, None)


def test_a_folder_of_something_else_is_left_alone(studies, tmp_path):
    (tmp_path / "one").mkdir()
    (tmp_path / "one" / "mine.txt").write_text("")
    with pytest.raises(SchemaError, match=r"no chapter\.json"):
        run_part(ONE, tmp_path, True, None)
    assert [path.name for path in (tmp_path / "one").iterdir()] == ["mine.txt"]


def test_what_a_machine_lacks_is_said_with_what_to_do(studies, tmp_path):
    lack = find_lack(ONE._replace(needs=("json", "nosuchlibrary")), None)
    assert says(str(lack), "chapter 3", "nosuchlibrary", "pip install 'gaitdisc[chapter3]'")
    sea = ONE._replace(data="fields/sea")
    with pytest.raises(SchemaError, match=r"fields/sea.*--data"):
        run_part(sea, tmp_path, True, tmp_path)
    (tmp_path / "fields" / "sea").mkdir(parents=True)
    assert find_lack(sea, tmp_path) is None


def test_two_at_once_do_not_write_into_one_folder(studies, tmp_path):
    (tmp_path / "one").mkdir()
    (tmp_path / "one" / ".lock").write_text('{"pid": 1, "host": "elsewhere"}')
    with pytest.raises(WriteError, match=r"Process 1 on elsewhere"):
        run_part(ONE, tmp_path, True, None)


def test_every_part_has_its_study_and_the_words_that_it_takes():
    for part in PARTS:
        text = (studies_folder() / f"{part.study}.py").read_text(encoding="utf-8")
        for word in (*part.words, *part.quick_words):
            if word.startswith("--"):
                assert re.search(rf"\[{word}\b", text), (part.name, word)  # as the first lines of the file show it
        assert OUT in part.words or part.name == "tables"
        assert part.quick_minutes <= part.minutes


def test_no_two_parts_share_a_folder():
    names = [part.name for part in PARTS]
    assert len(set(names)) == len(names)


def test_every_study_of_a_chapter_is_a_part_or_is_used_by_one():
    texts = {path.stem: path.read_text(encoding="utf-8") for path in studies_folder().glob("ch[345]_*.py")}
    named = {part.study for part in PARTS}
    for study in set(texts) - named:
        assert any(f"from {study} import" in texts[name] for name in texts if name != study), study


def test_the_parts_of_a_chapter():
    assert [part.name for part in list_parts(5, "turbulence")] == ["turbulence"]
    assert sum(len(list_parts(chapter)) for chapter in CHAPTERS) == len(PARTS)
    for name in (part.name for part in PARTS):
        assert f" {name}: " in costs()


def test_what_is_no_part_is_refused_with_the_nearest():
    with pytest.raises(SchemaError, match=r"'van_der_poll'.*'van_der_pol'"):
        list_parts(3, "van_der_poll")
    with pytest.raises(SchemaError, match=r"3, 4, 5.*6"):
        list_parts(6)


MADE = Provenance({}, 0, {"walk.C3D": "ab"}, {}, "", "2026-01-01T00:00:00+00:00")


def keys(folder):
    return {one.key for one in list_citations(folder)}


def of_markers(*notes):
    findings = tuple(Finding("note", kind, "a.c3d", what, "") for kind, what in notes)
    return set(list_methods(replace(made_cycles(), findings=findings)))


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
    without_legs = of_markers(("marker set", "plug_in_gait: x"), ("hip", "hip centres are those of Harrington"))
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
    (tmp_path / "chapter.json").write_text(seal_text({"part": "who_names"}))
    assert {"ebers2023", "ebers2024discrepancy", "askham2018", "bock1984"} <= keys(tmp_path)
    assert not {"fasel2022", "sashidhar2022", "tu2014", "julier2004"} & keys(tmp_path)
    (tmp_path / "chapter.json").write_text(seal_text({"part": "further"}))
    learned, filtered = {"tu2014", "fasel2022", "messenger2021", "rasmussen2006"}, {"julier2004", "evensen1994"}
    assert learned | filtered <= keys(tmp_path) and "sashidhar2022" not in keys(tmp_path)
    (tmp_path / "chapter.json").write_text(seal_text({"part": "measurement_bias"}))
    assert {"kalman1960", "julier2004", "sashidhar2022"} <= keys(tmp_path) and "evensen1994" not in keys(tmp_path)
    (tmp_path / "chapter.json").write_text(seal_text({"part": "no such"}))
    with pytest.raises(SchemaError, match="names 'no such'"):
        list_citations(tmp_path)


@pytest.mark.parametrize(("split", "cited"), [("subject: each in turn", True), ("temporal: the last 15 %", False)])
def test_an_interval_over_people_cites_cv_plus_and_every_reconstruction_its_paper(split, cited):
    errors, curves = pd.DataFrame({"model": ["shred"]}), pd.DataFrame()
    made = Reconstruction("a", (), (), split, "", {"shred": "x"}, errors, errors, curves, (), (), MADE)
    assert any(one.startswith("intervals from models") for one in list_methods(made)) == cited
    assert any(one.startswith("reconstruction") and "ebers2024sensors" in keys for one, keys in MENTIONED.items())


def test_what_is_written_is_read_back_here():
    found = {one.what: one for one in checks()}
    assert {found[f"reads {kind}"].state for kind in ("C3D", ".mot", "CSV")} == {"ok"}
    assert found["numpy"].state == "ok" and found["gaitdisc"].words.startswith("0.")


def test_a_reader_that_fails_or_reads_other_numbers_is_wrong():
    knee = installation._wave("knee_angle_r", rate_hz=100)
    with patch("gaitdisc.ingest.reading.read_trial", side_effect=OSError("none.csv")):
        failed = installation._read_back("CSV", knee, "walk.csv")
    assert failed.state == "wrong" and "none.csv" in failed.words

    def shifted(made, path):
        return write_recording(made.with_values(made.values + 1.0), path)

    with patch("gaitdisc.ingest.reading.write_recording", shifted):
        assert installation._read_back(".mot", knee, "walk.mot").words == "other than written"


def test_a_library_that_is_absent_is_said_with_what_it_is_for():
    with patch.object(installation, "EXTRAS", {"no_such_library": "something"}):
        assert [one.words for one in checks() if one.what == "no_such_library"] == ["needed for something"]
