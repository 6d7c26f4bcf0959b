"""Words that a recording brings may say who a person is: planted everywhere in one, they stand in no result."""

import base64
import io
import re
import zipfile
import zlib

import ezc3d
import numpy as np
import pyarrow.parquet as pq
import pytest
from driven_walker import DrivenWalker
from pypdf import PdfReader
from texts import says

from gaitdisc.commands.options import SOME_REFUSED
from gaitdisc.discovery.decision import Verdict
from gaitdisc.ingest.storage import write_storage
from gaitdisc.ingest.table import write_table

pytestmark = pytest.mark.usefixtures("trained_briefly")
# each is planted in one kind of place, and told from the others if it is found
PLACES = """
folder person file header column subject maker described analog point
event group trc marker comment csv meta broken home
"""
TOKENS = tuple(f"Zq{place}" for place in PLACES.split())
OF_A_CLINIC = ("Zqward", "Zqname", "1987-06-05", "19870605", "Zqcontrols")  # fmt: skip
ANGLES = [f"{joint}_{side}" for side in "rl" for joint in ("hip_flexion", "knee_angle", "ankle_angle")]


def angles_with(trial, label):
    """Angles of a walk, and a column that no vocabulary knows."""
    kinematics = trial.stream("kinematics").selected(ANGLES)
    return kinematics, np.column_stack([kinematics.time, kinematics.values, np.sin(kinematics.time)]), label


def write_mot(trial, path):
    """OpenSim's first line is the name of the motion, mostly that of the file."""
    kinematics, table, label = angles_with(trial, "Zqcolumn_secret")
    write_storage(kinematics, path)
    head, _, _ = path.read_text().partition("endheader")
    lines = [f"Zqheader {path.stem}", *head.splitlines()[1:], "Zqheader: measured by Zqheader", "endheader"]
    lines = [re.sub(r"nColumns=.*", f"nColumns={table.shape[1]}", line) for line in lines]
    rows = ["\t".join(map(repr, row)) for row in table.tolist()]
    path.write_text("\n".join([*lines, "\t".join(["time", *ANGLES, label]), *rows]) + "\n")


def write_text_table(trial, path):
    _, table, label = angles_with(trial, "Zqcsv secret [V]")
    heads = ["time [s]", *(f"{name} [deg]" for name in ANGLES), label]
    rows = [",".join(map(repr, row)) for row in table.tolist()]
    path.write_text("\n".join(["# Zqcomment, born 1970", ",".join(heads), *rows]) + "\n")


def write_parquet(trial, path):
    write_table(trial.stream("kinematics").selected(ANGLES), path)
    table = pq.read_table(path)
    pq.write_table(table.replace_schema_metadata({"patient": "Zqmeta"}), path)


def write_trc(path, seconds=24.0):
    """One marker that means nothing, in a file that says its own name and path."""
    time = np.arange(round(100 * seconds)) / 100
    rows = [f"{k + 1}\t{t:.2f}\t{1000 + 10 * np.sin(t):.3f}\t900\t5" for k, t in enumerate(time)]
    head = [
        f"PathFileType\t4\t(X/Y/Z)\tC:/Zqtrc/{path.name}",
        "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames",
        f"100\t100\t{len(rows)}\t1\tmm\t100\t1\t{len(rows)}",
        "Frame#\tTime\tZqmarker\t\t",
        "\t\tX1\tY1\tZ1",
        "",
    ]
    path.write_text("\n".join([*head, *rows]) + "\n")


def write_c3d(trial, path):
    """EMG and force as any laboratory exports them, with a name in every field that holds text."""
    emg = trial.stream("emg")
    file = ezc3d.c3d()
    labels = [*emg.names, "Zqanalog secret"]
    points = ["Zqpoint", "Zqsubject:RHEE"]
    texts = {
        ("SUBJECTS", "NAMES"): ["Zqsubject"],
        ("SUBJECTS", "LABEL_PREFIXES"): ["Zqsubject:"],
        ("MANUFACTURER", "COMPANY"): ["Zqmaker"],
        ("MANUFACTURER", "SOFTWARE"): ["Zqmaker"],
        ("ZQGROUP", "PATIENT"): ["Zqgroup"],
        ("POINT", "RATE"): [100.0],
        ("POINT", "UNITS"): ["mm"],
        ("POINT", "LABELS"): points,
        ("POINT", "DESCRIPTIONS"): ["Zqdescribed"] * 2,
        ("ANALOG", "RATE"): [1000.0],
        ("ANALOG", "LABELS"): labels,
        ("ANALOG", "DESCRIPTIONS"): ["Zqdescribed"] * len(labels),
        ("ANALOG", "UNITS"): ["V"] * len(labels),
        ("EVENT", "USED"): [2],
        ("EVENT", "LABELS"): ["Zqevent", "Foot Strike"],
        ("EVENT", "CONTEXTS"): ["Zqevent", "Right"],
        ("EVENT", "SUBJECTS"): ["Zqsubject"] * 2,
        ("EVENT", "DESCRIPTIONS"): ["Zqevent"] * 2,
    }
    for (group, name), value in texts.items():
        file.add_parameter(group, name, value)
    file.add_parameter("EVENT", "TIMES", np.array([[0.0, 0.0], [1.0, 2.0]]))
    frames = len(emg.time) // 10
    where = np.ones((4, 2, frames))
    where[:3] = 1000 + 10 * np.sin(np.arange(frames) / 30)
    file["data"]["points"] = where
    values = np.column_stack([emg.values, np.sin(emg.time)])[: 10 * frames]
    file["data"]["analogs"] = np.ascontiguousarray(values.T)[None]
    file.write(str(path))


@pytest.fixture(scope="module")
def recordings(tmp_path_factory):
    """Four people: .mot with C3D and .trc, CSV, Parquet, and one whose file will be damaged in a private column."""
    home = tmp_path_factory.mktemp("lab") / "Zqfolder_Mustermann"
    writers = {"a": write_mot, "b": write_text_table, "c": write_parquet, "d": write_mot}
    endings = {"a": "mot", "b": "csv", "c": "parquet", "d": "mot"}
    for seed, (letter, write) in enumerate(writers.items(), 1):
        folder = home / f"Zqperson_{letter * 3}"
        folder.mkdir(parents=True)
        for word, spring in (("natural", 0.0), ("exo", 250.0)):
            trial = DrivenWalker("A", seed=seed, spring_per_s2=spring).walked(24.0, word)
            path = folder / f"Zqfile_{word}_ik.{endings[letter]}"
            write(trial, path)
            if letter == "a":
                write_c3d(trial, folder / f"Zqfile_{word}_emg.c3d")
                write_trc(folder / f"Zqfile_{word}_markers.trc")
    return home


@pytest.fixture(scope="module")
def study(recordings, tmp_path_factory, said):
    """As `new` makes it, with few channels to fit; after that, a file is damaged."""
    folder = tmp_path_factory.mktemp("work") / "Zqhome"
    said("new", folder, "--from", recordings, ends=0)
    text = (folder / "study.toml").read_text()
    for key in ("angles", "outputs"):
        text, changed = re.subn(rf"(?s)(?<=\n{key} = \[).*?(?=\])", '"knee_angle_r", "ankle_angle_r"', text)
        assert changed == 1
    (folder / "study.toml").write_text(text)
    damaged = recordings / "Zqperson_ddd" / "Zqfile_exo_ik.mot"
    lines = damaged.read_text().splitlines()
    lines[500] = re.sub(r"\t[^\t]*$", "\tZqbroken", lines[500])
    damaged.write_text("\n".join(lines) + "\n")
    return folder


def planted(text, *more):
    return sorted({token for token in (*TOKENS, *more) if re.search(token, text, re.IGNORECASE)})


def found_in(folder):
    """Which tokens stand in which file of a folder, in its name, its bytes, its arrays and the pictures of a page."""
    hits = {}
    for path in [each for each in folder.rglob("*") if each.is_file() and each.name != "study.toml"]:
        content = path.read_bytes()
        if zipfile.is_zipfile(path):
            with zipfile.ZipFile(path) as packed:
                content = b"".join([name.encode() + packed.read(name) for name in packed.namelist()])
        pictures = re.findall(rb"base64,([A-Za-z0-9+/=]+)", content)
        content += b"".join(map(base64.b64decode, pictures)) + printed(content)
        there = planted(str(path.relative_to(folder)) + content.decode("utf-8", "replace"), *OF_A_CLINIC)
        if there:
            hits[str(path.relative_to(folder))] = there
    return hits


def printed(content):
    """Text of a PDF: its pages and metadata, and what its objects hold, such as words for those who cannot see it."""
    packed = re.findall(rb"stream\r?\n(x.*?)\r?\nendstream", content, re.DOTALL)
    objects = [zlib.decompressobj().decompress(part) for part in packed]
    reader = PdfReader(io.BytesIO(content)) if content.startswith(b"%PDF") else None
    words = [*(page.extract_text() for page in reader.pages), repr(reader.metadata)] if reader else []
    return b"\n".join([*(one.encode() for one in words), *objects])


def test_the_tokens_are_planted(recordings, study):
    """Or nothing below could fail."""
    everything = b"".join(path.read_bytes() for path in recordings.rglob("*") if path.is_file())
    text = everything.decode("utf-8", "replace") + str(recordings) + str(study)
    names = " ".join(str(path) for path in recordings.rglob("*"))
    assert planted(text + names) == sorted(TOKENS)


def test_check_names_the_file_to_mend_on_the_own_terminal(study, said):
    words = said("check", study, ends=SOME_REFUSED)
    assert "Zqfile_exo_ik.mot" in words and "Zqbroken" in words


def test_the_study_is_the_key_and_its_title_names_nobody(study):
    text = (study / "study.toml").read_text()
    assert 'title = "natural against exo"' in text
    assert {f"P0{k}" for k in (1, 2, 3, 4)} <= set(re.findall(r'id = "([^"]*)"', text))
    assert "Zqfile_exo_ik.mot" in text


@pytest.fixture(scope="module")
def ran(study, said, briefly):
    """What a run of it prints; its report stands with every figure drawn."""
    with briefly():
        return said("run", study, "--quiet", ends=SOME_REFUSED)


@pytest.fixture(params=[False, pytest.param(True, marks=pytest.mark.slow)], ids=["words", "figures"])
def painted(request):
    """Words alone by default; the figures as well, which take most of the time, among the slow ones."""
    if not request.param:
        request.getfixturevalue("unpainted")


def test_a_run_holds_none_of_them(study, ran):
    assert planted(ran.replace(str(study), "")) == []
    assert says(ran, "P04", "P04", "1")
    assert found_in(study) == {}
    page = (study / "run" / "report" / "report.html").read_text()
    assert "<h1>natural against exo</h1>" in page and "P01 natural, file 1" in page and "P04 exo, file 1" in page


@pytest.mark.usefixtures("ran", "painted")
@pytest.mark.slow
def test_what_is_made_of_a_run_holds_none_of_them(study, said):
    for words, ends in (
        (("ablate", study, "--quiet", "--length", 5), SOME_REFUSED),
        (("modalities", study, "--quiet"), SOME_REFUSED),
        (("report", study / "run"), 0),
    ):
        assert planted(said(*words, ends=ends).replace(str(study), "")) == [], words
    assert found_in(study) == {}


@pytest.mark.usefixtures("painted")
def test_a_comparison_holds_none_of_them(study, recordings, tmp_path, said):
    for what in (
        [study, "--participant", "P01"],
        [recordings / "Zqperson_aaa" / "Zqfile_exo_ik.mot", recordings / "Zqperson_bbb" / "Zqfile_natural_ik.csv"],
        [recordings / "Zqperson_aaa" / "Zqfile_exo_ik.mot", recordings / "Zqperson_bbb" / "Zqfile_exo_ik.csv"],
    ):
        words = said("compare", *what, "--out", tmp_path / "out", ends=0)
        assert planted(words.replace(str(tmp_path), "")) == []
        assert found_in(tmp_path) == {}


@pytest.mark.usefixtures("painted")
def test_models_and_what_they_tell_hold_none_of_them(study, recordings, tmp_path, said):
    options = ["--sensors", "ankle_angle_r", "--kinds", "linear", "--out", tmp_path / "out", "--quiet"]
    words = said("reconstruct", study, *options, ends=SOME_REFUSED)
    assert (tmp_path / "out" / "models" / "P01" / "model.json").exists(), words
    assert planted(words.replace(str(tmp_path), "")) == []
    recording = recordings / "Zqperson_aaa" / "Zqfile_exo_ik.mot"
    said("apply", tmp_path / "out" / "models" / "P01", recording, "--out", tmp_path / "told.mot", ends=0)
    assert (tmp_path / "told.mot").exists()
    assert found_in(tmp_path) == {}


@pytest.mark.slow
def test_a_discovery_from_a_study_holds_none_of_them(study, tmp_path, monkeypatch, said):
    """Whatever is found: the words come from the study, and the search for what is missing has none of them."""
    monkeypatch.setattr("gaitdisc.discovery.discover.decide", lambda _, as_read: Verdict(as_read, ()))
    words = said("discover", study, "--participant", "P01", "--out", tmp_path, "--no-report", "--quiet", ends=0)
    assert (tmp_path / "discovery.json").exists(), words
    assert planted(words.replace(str(tmp_path), "")) == []
    assert found_in(tmp_path) == {}


@pytest.mark.parametrize("ending", ["csv", "mot", "parquet"])
def test_an_export_numbers_labels_of_no_vocabulary_unless_it_shall_keep_them(recordings, tmp_path, said, ending):
    folder = recordings / "Zqperson_aaa"
    files = [folder / f"Zqfile_exo_{kind}" for kind in ("ik.mot", "emg.c3d", "markers.trc")]
    assert re.search(r"names \(\d\).*--labels", said("export", *files, "--out", tmp_path / f"all.{ending}", ends=0))
    assert found_in(tmp_path) == {}
    said("export", *files, "--out", tmp_path / f"kept.{ending}", "--labels", ends=0)
    assert {"Zqcolumn", "Zqmarker"} <= set(found_in(tmp_path)[f"kept.{ending}"])


@pytest.fixture(scope="module")
def clinic(tmp_path_factory, said):
    """A week and its controls as a laboratory stores them: names and dates of birth in folders, files and tables."""
    home = tmp_path_factory.mktemp("clinic")
    week, controls = home / "Zqfolder_Mustermann" / "Zqward 7", home / "Zqcontrols"
    people = {week: ("Zqperson Erika_19870605", "Zqperson O'Neil <b>"), controls: ("Zqperson c",)}
    for seed, (folder, names) in enumerate(people.items(), 1):
        rows = []
        for number, name in enumerate(names, 1):
            rows.append(f"{name}\tZqname, Erika\t1987-06-05\t{30 + number}\tf\t1.70")
            for visit, session in enumerate(("before", "after") if folder == week else ("before",)):
                place = folder / name / session
                place.mkdir(parents=True)
                trial = DrivenWalker("A", seed=10 * seed + 5 * visit + number).walked(16.0, session)
                write_mot(trial, place / "Zqfile_natural_ik.mot")
                write_c3d(trial, place / "Zqfile_natural_emg.c3d")
        if folder == week:
            (place / "Zqfile_natural_emg.c3d").write_bytes(b"Zqbroken")
        head = "participant_id\tname\tbirth_date\tage\tsex\theight"
        (folder / "participants.tsv").write_text("\n".join([head, *rows]) + "\n")
    for word, folder in (("week", week), ("controls", controls)):
        said("new", home / "Zqhome" / word, "--from", folder, ends=0)
    return home / "Zqhome"


@pytest.mark.usefixtures("painted")
@pytest.mark.slow
def test_pages_of_a_clinic_hold_none_of_them(clinic, said):
    text = (clinic / "week" / "study.toml").read_text()
    assert "age_years = 32" in text and 'id = "P01"' in text and "Zqward" in text
    reference, run = clinic / "reference", clinic / "week" / "run"
    for words in (
        ("reference", clinic / "controls", "--out", reference),
        ("run", clinic / "week", "--quiet", "--reference", reference),
        ("report", clinic / "week", "--pdf"),
        ("report", clinic / "week", "--person", "P01", "--before", "before", "--after", "after"),
    ):
        assert planted(said(*words, ends=0).replace(str(clinic), ""), *OF_A_CLINIC) == [], words
    pages = {path.name for path in (run / "report").rglob("*") if path.suffix in (".html", ".pdf")}
    assert {"index.html", "report.html", "P01_before.html", "P01_before.pdf", "P01_before_after.html"} <= pages
    assert b"1 control of the laboratory" in (run / "report" / "people" / "P01_before.html").read_bytes()
    assert b"What stands out" in printed((run / "report" / "people" / "P01_before.pdf").read_bytes())
    assert found_in(clinic) == {}
