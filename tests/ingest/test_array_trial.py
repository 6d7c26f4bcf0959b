"""A trial out of variables of .mat, .npz and HDF5: channels, units and clocks that the study names."""

import random
import sys

import numpy as np
import pytest
from chapter5.files import read_cutout, read_head, read_oisst
from scipy.io import savemat

from gaitdisc.errors import GaitdiscError, ReadError
from gaitdisc.ingest.array_file import read_arrays
from gaitdisc.ingest.hdf5 import SIGNATURE, attributes, data_set, hdf5_file
from gaitdisc.ingest.reading import read_planned_trial, read_trial
from gaitdisc.ingest.study_file import load_study

T = np.arange(200) / 100
KNEE = np.column_stack([30 + 25 * np.sin(6 * T), 2 * np.cos(6 * T), 0 * T])


@pytest.fixture(scope="module")
def visual3d(tmp_path_factory):
    """As Visual3D exports it: a cell array a signal, a cell a trial, and rates in cells."""
    path = tmp_path_factory.mktemp("v3d") / "export.mat"

    def cells(*arrays):
        held = np.empty((len(arrays), 1), dtype=object)
        held[:, 0] = arrays
        return held

    heel = np.column_stack([1.2 * T, 0 * T, 0.05 + 0 * T, 0.001 + 0 * T])
    savemat(
        path,
        {
            "RKNEE_ANGLE": cells(KNEE, KNEE + 5),
            "RHEE": cells(heel, 2 * heel),
            "FP1": cells(np.tile([0.0, 0, 700], (2000, 1)), np.tile([0.0, 0, 600], (2000, 1))),
            "FRAME_RATE": cells(np.array([[100.0]]), np.array([[100.0]])),
            "ANALOG_RATE": cells(np.array([[1000.0]]), np.array([[1000.0]])),
            "TIME": cells(T[:, None], T[:, None] + 1),
            "FILE_NAME": cells("one.c3d", "two.c3d"),
        },
    )
    return path


CHANNELS = {
    "RKNEE_ANGLE(:,1)": "knee_angle_r [deg] @ FRAME_RATE",
    "RHEE": "RHEE [m] @ 100 Hz",
    "FP1(:,3)": "ground_force_r_vy [N] @ ANALOG_RATE",
}


def test_a_trial_of_visual3d(visual3d):
    trial = read_arrays(visual3d, CHANNELS, "2")
    assert trial.name == "export"
    np.testing.assert_allclose(trial.stream("kinematics")["knee_angle_r"], KNEE[:, 0] + 5)
    assert trial.stream("markers").names == ("RHEE.x", "RHEE.y", "RHEE.z")
    np.testing.assert_allclose(trial.stream("markers")["RHEE.x"], 2.4 * T)
    assert (trial.stream("forces").rate_hz, trial.stream("markers").rate_hz) == (1000.0, 100.0)
    assert trial.stream("forces").source.sha256 and trial.stream("forces").source.reader == "mat"


def test_times_may_be_a_variable(visual3d):
    trial = read_arrays(visual3d, {"RKNEE_ANGLE(:,1)": "knee_angle_r @ TIME"}, "2")
    np.testing.assert_allclose(trial.stream("kinematics").time, T + 1)


@pytest.mark.parametrize(
    ("channels", "said"),
    [
        ({}, r"the study's \[channels\] must state .* each variable .* export.mat; .*contains RKNEE_ANGLE, RHEE, FP1"),
        ({"RKNEE_ANGLE": "knee_angle_r @ 100 Hz"}, r"must have one column for 'knee_angle_r', .* its shape is 200 x 3"),
        ({"RHEE": "RHEE @ 100 Hz"}, r"the marker 'RHEE' of 'RHEE' must have a unit"),
        ({"RHEE(:,1)": "heel [furlong] @ 100 Hz"}, r"must be in the list of units; found 'furlong'"),
        ({"FP1(:,3)": "ground_force_r_vy [N] @ TIME"}, r"has 2000 samples, but 'TIME' has 200 times"),
        ({"FP1(:,3)": "ground_force_r_vy [N] @ 0 Hz"}, r"must have a rate between 0.01 Hz and 1 MHz.* gives 0 Hz"),
        ({"FP1(:,3)": "ground_force_r_vy [N] @ FRAMERATE"}, "'FRAMERATE'.*the nearest is 'FRAME_RATE'"),
        ({"RKNEE_ANGLE(:,1)": "knee_angle_r [rad] @ 100 Hz"}, r"rad"),
        (
            {"RHEE(:,1)": "a [V] @ 100 Hz", "RHEE(:,2)": "b [V] @ 50 Hz"},
            r"all signals must have one time base; a has 200 samples at 100 Hz, b 200 at 50",
        ),
    ],
)
def test_what_does_not_fit_is_said(visual3d, channels, said):
    with pytest.raises(GaitdiscError, match=said):
        read_arrays(visual3d, channels, "1")


def test_a_real_published_file_by_a_study(gait_data, tmp_path):
    """An .npz with a table a trial: against the .mot of the same trial."""
    names = np.load(gait_data / "treadmill_walk_ik" / "addbio_expert3_ik.npz")["columns"].tolist()
    wanted = ("knee_angle_r", "hip_flexion_l", "pelvis_tx")
    lines = [f'"*(:,{names.index(name) + 1})" = "{name} @ rate_hz"' for name in wanted]
    (tmp_path / "study.toml").write_text(
        "[conditions]\nnominal = 'walk'\n[channels]\n" + "\n".join(lines) + "\n[[participants]]\nid = 'P01'\n"
        "[[participants.trials]]\ncondition = 'walk'\npart = 'S01DE504'\n"
        f"files = ['{gait_data / 'treadmill_walk_ik' / 'addbio_expert3_ik.npz'}']\n"
    )
    study = load_study(tmp_path)
    found = read_planned_trial(study, study.participants[0], study.participants[0].trials[0]).stream("kinematics")
    same = read_trial(gait_data / "treadmill_walk_ik" / "S01DE504_ik.mot").stream("kinematics")
    assert found.names == wanted and found.rate_hz == 100.0
    for name in wanted:
        np.testing.assert_allclose(found[name], same[name], atol=1e-4)


def test_the_signature_tells(tmp_path):
    (tmp_path / "a.h5").write_bytes(SIGNATURE + b"rest")
    (tmp_path / "b.nc").write_bytes(b"CDF\x01")
    assert read_head(tmp_path / "a.h5").startswith(SIGNATURE)
    assert not read_head(tmp_path / "b.nc").startswith(SIGNATURE)
    with pytest.raises(ReadError, match=r"absent.nc"):
        read_head(tmp_path / "absent.nc")


def test_a_damaged_file_is_refused(tmp_path):
    pytest.importorskip("h5py")
    (tmp_path / "cut.h5").write_bytes(SIGNATURE + b"\0" * 100)
    said = r"cut.h5 .*HDF5"
    with pytest.raises(ReadError, match=said), hdf5_file(tmp_path / "cut.h5"):
        pass


def test_without_the_library_the_extra_is_named(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "h5py", None)
    with pytest.raises(ReadError, match=r"pip install 'gaitdisc\[fields\]'"), hdf5_file(tmp_path / "a.h5"):
        pass


def _cutout(path, h5py):
    with h5py.File(path, "w") as file:
        for name, count in zip(("zcoor", "ycoor", "xcoor"), (2, 3, 4), strict=True):
            file[name] = 0.1 * np.arange(count)
        for number, packed in ((1, None), (2, "gzip"), (3, None)):
            file.create_dataset(f"Velocity_{number:04d}", data=np.ones((2, 3, 4, 3), np.float32), compression=packed)


def _temperatures(path, h5py):
    with h5py.File(path, "w") as file:
        sst = file.create_dataset("sst", data=np.ones((5, 3, 4), np.int16))
        sst.attrs.update({"scale_factor": [0.01], "units": np.bytes_("degC"), "missing_value": [np.int16(32767)]})
        file["lat"], file["lon"] = np.arange(3.0), np.arange(4.0)
        file.create_dataset("time", data=7.0 * np.arange(5)).attrs["units"] = np.bytes_("days since 1800")


@pytest.mark.parametrize(
    ("write", "read"), [(_cutout, lambda path: read_cutout([path], 0.002)), (_temperatures, read_oisst)]
)
def test_mutated_files_are_read_or_refused_in_words(tmp_path, write, read):
    """85 of each kind, the same ones every time: flipped bits, bytes at their limits, cut files."""
    write(tmp_path / "sound.h5", pytest.importorskip("h5py"))
    sound, dice, path = (tmp_path / "sound.h5").read_bytes(), random.Random(11), tmp_path / "broken.h5"
    refused = 0
    for number in range(85):
        broken = bytearray(sound)
        for _ in range(dice.randint(1, 30)):
            place = dice.randrange(len(broken))
            broken[place] = broken[place] ^ (1 << dice.randrange(8)) if number % 3 else dice.choice([0, 1, 127, 255])
        path.write_bytes(broken if number % 5 else broken[: dice.randrange(len(broken))])
        try:
            read(path)
        except GaitdiscError as error:
            refused += 1
            assert "broken.h5" in str(error) or "1 cut-outs" in str(error)
    assert 20 < refused < 85


def test_what_is_no_data_set_of_numbers_is_refused(tmp_path):
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file.create_group("group")
        file["words"] = ["one", "two"]
        file.create_dataset("huge", (2**20, 2**20), np.float32, chunks=(1, 1024))
    for name, said in (
        ("group", r"a\.h5: 'group' "),
        ("words", r"a\.h5: 'words' .*another type"),
        ("huge", r"a\.h5: .*4294967296 bytes.*'huge' claims 4398046511104"),
        ("absent", r"a\.h5 .*HDF5.*absent"),
    ):
        with pytest.raises(ReadError, match=said), hdf5_file(tmp_path / "a.h5") as file:
            data_set(file, name, tmp_path / "a.h5")


def test_a_text_of_variable_length_is_read_beside_and_within_a_time(tmp_path, monkeypatch):
    h5py = pytest.importorskip("h5py")
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        file.create_dataset("t", data=[1.0]).attrs["units"] = "days since Übermorgen"
    with hdf5_file(path) as file:
        assert attributes(file, "t", path, ("units", "absent")) == {"units": "days since Übermorgen"}
        worker = tmp_path / "worker.py"
        worker.write_text("import sys, time; sys.stdin.readline(); time.sleep(60)")
        monkeypatch.setattr("gaitdisc.ingest.hdf5.TEXT_LIMIT_S", 0.1)
        monkeypatch.setattr("gaitdisc.ingest.reader_process.WORKER", worker)
        with pytest.raises(ReadError, match=r"'units'.*'t'.*0\.6 s"):
            attributes(file, "t", path, ("units",))
