import pytest
from hidden_in_a_mass import MASS, Experiment, record, with_load

from gaitdisc.batch.discover_files import discover_files
from gaitdisc.errors import SchemaError
from gaitdisc.ingest.file_hash import file_sha256


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("mass")
    (folder / "mass.toml").write_text(MASS.replace('unit = "N s/m"', 'unit = "N"'))
    measured = record(with_load("-14*x**3"), 3, Experiment(seconds=10.0))
    rows = ["trial,time,push,x"]
    for trial, name in enumerate(measured.trials):
        columns = (measured.time(trial), measured.drive.inputs[trial, :, 0], measured.observed[trial, :, 0])
        rows += [f"{name},{t:.3f},{push:.6g},{x:.6g}" for t, push, x in zip(*columns, strict=True)]
    (folder / "walk.csv").write_text("\n".join(rows) + "\n")
    return folder


def test_the_answer_carries_what_it_rests_on(files):
    steps = []
    found, augmented = discover_files(files / "mass.toml", files / "walk.csv", told=steps.append)
    assert steps[0] == "reading mass.toml and walk.csv"
    assert found.provenance is not None
    called = {"simulation": "mass.toml", "measured table": "walk.csv"}
    assert found.provenance.files == {role: file_sha256(files / name) for role, name in called.items()}
    assert any(one.kind == "unit" for one in found.findings)
    assert found.runs.names == ("1", "2", "3", "4")
    (term,) = augmented.effects
    assert (term.place, term.name) == ("load", "cubic_stiffness")


def test_a_catalogue_is_read_before_anything_is_computed(files):
    (files / "mine.toml").write_text('[[shape]]\nname = "mine"\npieces = ["q**2"]\n')
    with pytest.raises(SchemaError, match=r"mine.toml, shape 1, piece 'q\*\*2' has 'q'"):
        discover_files(files / "mass.toml", files / "walk.csv", files / "mine.toml")
