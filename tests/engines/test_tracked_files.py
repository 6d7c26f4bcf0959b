"""Files of a walk with recorded forces: read on one time base, and refused in words."""

import numpy as np
import pytest
from texts import says

from gaitdisc.engines.motion import Coordinate
from gaitdisc.engines.tracked_files import check_loads, draft_tracked, read_tracked_motion
from gaitdisc.engines.tracked_mapping import read_tracked
from gaitdisc.errors import ChannelError, GaitdiscError, ReadError, SamplingError, SchemaError, UnitError

JOINTS = (Coordinate("pelvis_ty", "m", "pelvis_ty"), Coordinate("ankle_angle_r", "rad", "ankle_angle_r"))
ACTUATORS = ("soleus_r", "ankle_angle_r_reserve")
TIME = np.arange(0, 2, 0.01)
MODEL = """<OpenSimDocument><Model name="m"><BodySet><objects><Body name="pelvis"/><Body name="calcn_r"/></objects>
</BodySet>
<Coordinate name="ankle_angle_r"/><ForceSet><objects><CoordinateLimitForce name="ankle_limit"/></objects></ForceSet>
</Model></OpenSimDocument>"""
LOADS = """<OpenSimDocument><ExternalLoads><objects><ExternalForce name="right">
<applied_to_body>{body}</applied_to_body><force_identifier>ground_force_v</force_identifier>
<point_identifier>ground_force_p</point_identifier></ExternalForce></objects><datafile>grf.mot</datafile>
</ExternalLoads></OpenSimDocument>"""
MAPPING = """[tracked]
external_loads = "grf.xml"
forces = "forces.sto"
"""


def storage(path, columns, time=TIME, degrees="no"):
    rows = np.column_stack([time, *columns.values()])
    head = f"{path.stem}\nnRows={len(rows)}\nnColumns={len(columns) + 1}\ninDegrees={degrees}\nendheader\n"
    body = "\n".join("\t".join(f"{one:.8f}" for one in row) for row in rows)
    path.write_text(head + "\t".join(["time", *columns]) + "\n" + body + "\n")


@pytest.fixture
def walk(tmp_path):
    """Return a folder with a model, its mapping and the files that it names."""
    (tmp_path / "leg.osim").write_text(MODEL)
    (tmp_path / "leg.toml").write_text(MAPPING)
    (tmp_path / "grf.xml").write_text(LOADS.format(body="calcn_r"))
    storage(tmp_path / "grf.mot", {f"ground_force_{k}{axis}": TIME for k in "vp" for axis in "xyz"})
    pulls = {"soleus_r": 100 * TIME, "ankle_angle_r_reserve": TIME, "ankle_limit": TIME, "calcn_r_right_Fx": TIME}
    storage(tmp_path / "forces.sto", pulls)
    angle = 10 * np.sin(2 * np.pi * TIME)
    storage(tmp_path / "walk.mot", {"pelvis_ty": 1 + 0 * TIME, "ankle_angle_r": angle}, degrees="yes")
    return tmp_path


def motion(walk):
    tracked = read_tracked(walk / "leg.osim")
    assert tracked is not None
    check_loads(tracked)
    return read_tracked_motion(tracked, walk / "walk.mot", JOINTS, ACTUATORS)


def test_degrees_become_radians_and_rates_follow_the_angles_whose_ends_are_left_out(walk):
    read = motion(walk)
    assert 1 / 6 < read.time[0] < 0.2 and 1.79 < read.time[-1] < 1.99 - 1 / 6  # one period of 6 Hz
    inner = slice(50, -50)
    assert np.allclose(read.q[inner, 1], np.radians(10) * np.sin(2 * np.pi * read.time[inner]), atol=1e-3)
    assert np.allclose(read.v[inner, 1], np.radians(10) * 2 * np.pi * np.cos(2 * np.pi * read.time[inner]), atol=5e-3)
    assert read.actuators == ACTUATORS and np.allclose(read.forces[:, 0], 100 * read.time)  # the rest is given anyway
    assert read.differentiated


def test_net_moments_of_the_joints_stand_for_all_actuators(walk):
    storage(walk / "forces.sto", {"ankle_angle_r_moment": 9 * TIME, "ankle_limit": TIME})
    read = motion(walk)
    assert read.actuators == ("ankle_angle_r_moment",) and np.allclose(read.forces[:, 0], 9 * read.time)


def test_a_mapping_without_the_table_is_none_and_a_part_of_the_time_is_kept(walk):
    (walk / "leg.toml").write_text(MAPPING + "start_s = 0.5\n")
    assert motion(walk).time[0] == pytest.approx(0.5)
    (walk / "leg.toml").write_text(MAPPING + "end_s = 1.5\n")
    assert motion(walk).time[-1] == pytest.approx(1.5)
    (walk / "leg.toml").write_text('model = "leg.osim"\n')
    assert read_tracked(walk / "leg.osim") is None and read_tracked(walk / "none.osim") is None


@pytest.mark.parametrize(
    ("text", "error", "words"),
    [
        ('[tracked]\nforces = "forces.sto"\n', SchemaError, "leg.toml names no external_loads. Write external_loads"),
        (
            MAPPING.replace("xml", "mot"),
            ReadError,
            "grf.mot holds the forces themselves. Give the external-loads file (.xml)",
        ),
        (MAPPING + 'force = "a.sto"\n', SchemaError, "leg.toml has 'force'. Did you mean 'forces'"),
        (MAPPING.replace("forces.sto", "gone.sto"), ReadError, "there is no file gone.sto"),
        (MAPPING + "lowpass_hz = '6'\n", SchemaError, "lowpass_hz must be from 0 to 1000"),
        (MAPPING + "start_s = 1.9\n", SamplingError, "Correct start_s and end_s"),
    ],
)
def test_a_mapping_that_cannot_be_meant_is_refused(walk, text, error, words):
    (walk / "leg.toml").write_text(text)
    with pytest.raises(error) as refused:
        motion(walk)
    assert words in str(refused.value)


def test_forces_on_a_body_that_is_not_there_are_refused(walk):
    (walk / "grf.xml").write_text(LOADS.format(body="calc_r"))
    with pytest.raises(SchemaError) as refused:
        motion(walk)
    assert says(str(refused.value), "'right'", "'calc_r'", "leg.osim lacks", "'calcn_r'?")


SWING, HEIGHT = np.sin(2 * np.pi * TIME), {"pelvis_ty": 1 + 0 * TIME}


@pytest.mark.parametrize(
    ("file", "columns", "later_s", "degrees", "error", "words"),
    [
        ("grf.mot", dict.fromkeys(("ground_force_vx", "ground_force_vy", "ground_force_vz"), TIME), 0, "no",
         ChannelError, r"'right'.*no column 'ground_force_px'"),
        ("forces.sto", {"soleus_r": TIME}, 0, "no",
         ChannelError, r"forces.sto.*'ankle_angle_r_reserve'. Export all forces"),
        ("forces.sto", dict.fromkeys(("ankle_angle_r_moment", "soleus_r"), TIME), 0, "no",
         ChannelError, r"forces.sto.*'ankle_angle_r_reserve'. Export all forces"),
        ("forces.sto", dict.fromkeys((*ACTUATORS, "FX"), TIME), 0, "no", ChannelError, r"forces.sto.*'FX', which"),
        ("forces.sto", dict.fromkeys(ACTUATORS, TIME), 5, "no", SamplingError, r"forces.sto.*5 s.*1.99 s..*both"),
        ("walk.mot", {"pelvis_ty": TIME, "ankle_r": 10 * np.sin(TIME)}, 0, "yes",
         ChannelError, r"walk.mot has no column 'ankle_angle_r'"),
        ("walk.mot", HEIGHT | {"ankle_angle_r": 0.02 * np.sin(TIME)}, 0, "yes",
         SchemaError, r"Write inDegrees=no in the header"),
        ("walk.mot", HEIGHT | {"ankle_angle_r": 40 * SWING}, 0, "no",
         UnitError, r"ankle_angle_r.*40.*inDegrees=yes"),
        ("walk.mot", HEIGHT | {"hip_flexion_r": 0.5 * SWING, "ankle_angle_r": 0.2 * SWING}, 0, "yes",
         UnitError, r"looks like radians..*inDegrees=no"),
    ],
)  # fmt: skip
def test_a_file_that_does_not_go_with_the_others_is_refused(walk, file, columns, later_s, degrees, error, words):
    storage(walk / file, columns, time=TIME + later_s, degrees=degrees)
    with pytest.raises(error, match=words):
        motion(walk)


def test_a_coordinate_of_a_name_that_nobody_else_uses_is_in_the_unit_of_the_header(walk):
    own = (JOINTS[0], Coordinate("tarsal_roll", "rad", "tarsal_roll"))
    tracked = read_tracked(walk / "leg.osim")
    assert tracked is not None
    for degrees, size in (("yes", 10.0), ("no", np.radians(10.0))):
        columns = {"pelvis_ty": 1 + 0 * TIME, "tarsal_roll": size * np.sin(2 * np.pi * TIME)}
        storage(walk / "walk.mot", columns, degrees=degrees)
        read = read_tracked_motion(tracked, walk / "walk.mot", own, ACTUATORS)
        assert np.ptp(read.q[:, 1]) == pytest.approx(2 * np.radians(10.0), rel=0.02)
    text = (walk / "walk.mot").read_text().replace("inDegrees=no\n", "")
    (walk / "walk.mot").write_text(text)
    with pytest.raises(UnitError, match=r"walk.mot.*angles are in degrees.*no line"):
        read_tracked_motion(tracked, walk / "walk.mot", own, ACTUATORS)


@pytest.mark.parametrize("name", ["walk.c3d", "walk.trc", "walk.csv"])
def test_markers_in_the_place_of_angles_are_refused(walk, name):
    (walk / name).write_bytes(b"\x02P")
    tracked = read_tracked(walk / "leg.osim")
    assert tracked is not None
    with pytest.raises(ReadError, match=rf"{name}.*OpenSim's"):
        read_tracked_motion(tracked, walk / name, JOINTS, ACTUATORS)


def test_files_that_do_not_fit_are_refused_before_a_model_is_loaded(tmp_path):
    model = tmp_path / "leg.osim"
    model.write_text("<OpenSimDocument/>")
    (tmp_path / "grf.mot").write_text("")
    for given, words in {
        (tmp_path / "leg.xml", tmp_path / "grf.xml"): "leg.xml.*--external-loads",
        (model, None): "Add --external-loads grf.xml",
        (model, tmp_path / "grf.xml"): "there is no file .*grf.xml",
        (model, tmp_path / "grf.mot"): r"grf\.mot .*\.xml",
    }.items():
        with pytest.raises(GaitdiscError, match=words):
            draft_tracked(*given)
