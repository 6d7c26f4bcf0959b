"""Variables of .mat and .npz files: paths through structs and cells, and files that are damaged or hostile."""

import io
import pickle
import random
import sys
import zipfile
from contextlib import closing

import h5py
import numpy as np
import pytest
from scipy.io import loadmat, savemat

from gaitdisc.errors import ReadError
from gaitdisc.ingest.array_file import open_arrays
from gaitdisc.ingest.reader_process import ReaderProcess

KNEE = np.arange(12.0).reshape(4, 3)


def _cells(*arrays):
    held = np.empty((1, len(arrays)), dtype=object)
    held[0] = arrays
    return held


@pytest.fixture(scope="module")
def mat5(tmp_path_factory):
    path = tmp_path_factory.mktemp("mat") / "walk.mat"
    structs = np.zeros((1, 2), dtype=[("grf", object)])
    structs[0, 0]["grf"], structs[0, 1]["grf"] = 10 * KNEE, 20 * KNEE
    data = {"knee": KNEE, "trial": structs, "name": "walk"}
    savemat(path, {"data": data, "RKNEE": _cells(KNEE, 2 * KNEE), "wrong": KNEE * 1j, "lost": np.array([1.0, np.inf])})
    return path


@pytest.fixture(scope="module")
def mat73(tmp_path_factory):
    """As MATLAB lays it out: arrays transposed, cells and fields of struct arrays as references, a block in front."""
    path = tmp_path_factory.mktemp("mat") / "walk73.mat"
    with h5py.File(path, "w", userblock_size=512) as file:

        def put(place, name, values):
            held = place.create_dataset(name, data=np.asarray(values).T)
            held.attrs["MATLAB_class"] = np.bytes_("double")
            return held.ref

        def refer(place, name, refs, kind):
            held = place.create_dataset(name, data=np.array(refs, dtype=h5py.ref_dtype).reshape(-1, 1))
            if kind:
                held.attrs["MATLAB_class"] = np.bytes_(kind)

        hidden = file.create_group("#refs#")
        refer(file, "RKNEE", [put(hidden, "a", KNEE), put(hidden, "b", 2 * KNEE)], "cell")
        data = file.create_group("data")
        put(data, "knee", KNEE)
        name = data.create_dataset("name", data=np.array([[119], [97]], np.uint16))
        name.attrs["MATLAB_class"] = np.bytes_("char")
        trial = data.create_group("trial")
        refer(trial, "grf", [put(hidden, "c", 10 * KNEE), put(hidden, "d", 20 * KNEE)], "")
        file.create_dataset("wrong", data=np.zeros(3, dtype=[("real", "f8"), ("imag", "f8")]))
        put(file, "lost", np.array([[1.0, np.inf]]))
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64")
    return path


@pytest.fixture(params=["mat5", "mat73"])
def mat(request):
    return request.getfixturevalue(request.param)


@pytest.mark.parametrize(
    ("path", "part", "expected"),
    [
        ("data.knee", "", KNEE),
        ("data.knee(:,2)", "", KNEE[:, 1]),
        ("data.knee(3,:)", "", KNEE[2]),
        ("RKNEE{2}", "", 2 * KNEE),
        ("RKNEE(:,1)", "2", 2 * KNEE[:, 0]),
        ("data.trial(2).grf", "", 20 * KNEE),
        ("data.trial.grf(:,3)", "1", 10 * KNEE[:, 2]),
        ("data.*", "knee", KNEE),
    ],
)
def test_paths_of_both_versions(mat, path, part, expected):
    np.testing.assert_array_equal(open_arrays(mat).numbers(path, part), expected)


@pytest.mark.parametrize(
    ("path", "said"),
    [
        ("dato.knee", r"'dato.knee' must name a variable of numbers; it has .*, the nearest is 'data'"),
        ("data.knees", r"the struct has .*knee.*. Correct the path"),
        ("RKNEE", r"it holds 2 elements. Write part = \"1\" \(up to \"2\""),
        ("RKNEE{3}", r"there is no element 3 \(number of elements: 2\). Give a number from 1 to 2"),
        ("data", r"it is a struct of "),
        ("data.name", r"it is text"),
        ("data.knee(:,4)", r"it is 4 x 3. Give a column, counted from 1"),
        ("data.knee(2,2)", r"it is 4 x 3. Give a column, counted from 1"),
        ("data.knee.x", r"'x' follows an array of 4 x 3, which is not a struct"),
        ("data..knee", r"'..knee' is not a path"),
        ("wrong", r"it is an array of complex numbers, which a recording cannot contain"),
        ("lost", r"it contains 1 infinite numbers"),
    ],
)
def test_what_is_not_there_is_said_in_one_sentence(mat, path, said):
    with pytest.raises(ReadError, match=said):
        open_arrays(mat).numbers(path)


def test_npz_by_names_with_dots(tmp_path):
    path = tmp_path / "a.npz"
    np.savez(path, **{"S1.knee": KNEE, "S1": KNEE[0]})
    file = open_arrays(path)
    np.testing.assert_array_equal(file.numbers("S1.knee(:,1)"), KNEE[:, 0])
    np.testing.assert_array_equal(file.numbers("S1"), KNEE[0])


class _Bomb:
    def __reduce__(self):
        return (open, ("/tmp/gaitdisc_was_here", "w"))


def test_objects_are_never_unpickled(tmp_path, monkeypatch):
    path = tmp_path / "a.npz"
    np.savez(path, knee=np.array([_Bomb()], dtype=object))
    called = []
    monkeypatch.setattr(pickle, "load", lambda *_, **__: called.append(1))
    with pytest.raises(ReadError, match=r"'knee'.*contains Python objects"):
        open_arrays(path).numbers("knee")
    bare = tmp_path / "b.npz"
    with zipfile.ZipFile(bare, "w") as packed:
        packed.writestr("knee.npy", pickle.dumps(_Bomb()))
    with pytest.raises(ReadError, match=r"b.npz.*cannot"):
        open_arrays(bare).numbers("knee")
    assert not called


def test_every_cut_of_a_file_is_refused_or_read(mat, tmp_path):
    whole = mat.read_bytes()
    _cut_and_read(tmp_path / mat.name, whole, "data.knee", KNEE)


def test_every_cut_of_an_npz_is_refused(tmp_path):
    held = io.BytesIO()
    np.savez(held, knee=KNEE)
    _cut_and_read(tmp_path / "a.npz", held.getvalue(), "knee", KNEE)


def _cut_and_read(path, whole, name, expected):
    refused, process = 0, ReaderProcess()
    for end in np.linspace(1, len(whole) - 1, 12).astype(int):
        path.write_bytes(whole[:end])
        try:
            np.testing.assert_array_equal(open_arrays(path, process).numbers(name), expected)
        except ReadError as error:
            refused += 1
            assert path.name in str(error) and "Traceback" not in str(error)
    process.close()
    assert refused >= 6


@pytest.mark.parametrize("name", ["a.mat", "a.npz"])
def test_what_is_no_such_file(tmp_path, name):
    (tmp_path / name).write_bytes(b"time,knee\n0,1\n" * 40)
    with pytest.raises(ReadError, match=rf"{name}.*an? \.\w+ file"):
        open_arrays(tmp_path / name)


@pytest.mark.parametrize("ending", [".mat", ".npz"])
def test_what_claims_too_much_is_refused_before_it_is_unpacked(tmp_path, ending):
    """12 million zeros deflate to 0.1 MB; without compression the same numbers are read."""
    path, zeros = tmp_path / f"bomb{ending}", np.zeros((2**20, 12))
    if ending == ".mat":
        savemat(path, {"trial": {"force": zeros}}, do_compression=True)
    else:
        np.savez_compressed(path, trial=zeros)
    with pytest.raises(ReadError, match=r"7[0-9.]+ MiB.*'trial'.*96"):
        open_arrays(path).numbers("trial")
    if ending == ".mat":
        savemat(path, {"trial": {"force": zeros}})
        assert open_arrays(path).numbers("trial.force").shape == zeros.shape


@pytest.mark.skipif(sys.platform != "linux", reason="address space is capped on Linux")
def test_a_header_that_lies_about_its_array_meets_the_cap(tmp_path):
    """The member is 4 MB by the archive's list, and 800 GB by its own header."""
    path, held = tmp_path / "lies.npz", io.BytesIO()
    np.lib.format.write_array_header_1_0(held, {"descr": "<f8", "fortran_order": False, "shape": (10**11,)})
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as packed:
        packed.writestr("knee.npy", held.getvalue() + bytes(4 * 2**20))
    with pytest.raises(ReadError, match=r"lies.npz"):
        open_arrays(path).numbers("knee")


def test_a_file_that_ends_its_reader_is_refused_and_the_next_one_is_read(mat5, playing, monkeypatch):
    with closing(ReaderProcess()) as process:
        playing("os.kill(os.getpid(), signal.SIGSEGV)")
        with pytest.raises(ReadError, match=r"walk.mat.*-11\)"):
            open_arrays(mat5, process)
        monkeypatch.undo()
        np.testing.assert_array_equal(open_arrays(mat5, process).numbers("data.knee"), KNEE)


def test_flipped_bits_end_in_numbers_or_in_words(mat5, tmp_path):
    """60 damaged files of two kinds, one process for all; one of them in a thousand is a crash of scipy."""
    held = io.BytesIO()
    savemat(held, {name: loadmat(mat5)[name] for name in ("data", "RKNEE")}, do_compression=True)
    npz = io.BytesIO()
    np.savez_compressed(npz, data=KNEE, RKNEE=2 * KNEE)
    dice, refused, process = random.Random(5), 0, ReaderProcess()
    for number in range(60):
        name, sound = ("a.npz", npz.getvalue()) if number % 3 == 0 else ("a.mat", held.getvalue())
        broken = bytearray(mat5.read_bytes() if number % 3 == 1 else sound)
        for _ in range(dice.randint(1, 4)):
            broken[dice.randrange(len(broken))] ^= 1 << dice.randrange(8)
        (tmp_path / name).write_bytes(broken)
        for path in ("data.knee", "data", "RKNEE{2}"):
            try:
                open_arrays(tmp_path / name, process).numbers(path)
            except ReadError as error:
                refused += 1
                assert name in str(error) and "Traceback" not in str(error)
    process.close()
    assert 60 < refused < 180
