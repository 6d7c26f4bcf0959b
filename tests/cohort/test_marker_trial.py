"""Markers over belts, moving or still, give back through the package's own kinematics and kinetics what was walked."""

import numpy as np
import pytest

from gaitdisc.cohort import marker_trial as laboratory
from gaitdisc.cohort.habit import habitual
from gaitdisc.cohort.marker_trial import STANDS_N, belts, marker_trial, overground, standing
from gaitdisc.cohort.person import Spring
from gaitdisc.cohort.walk import walked
from gaitdisc.ingest.c3d_writing import write_c3d
from gaitdisc.ingest.reading import read_trial
from gaitdisc.kinematics.motion import move_body
from gaitdisc.kinetics.body_inertia import Person
from gaitdisc.kinetics.joint_moments import KineticsSettings
from gaitdisc.kinetics.trial_kinetics import trial_kinetics
from gaitdisc.processing.markers_to_moments import find_foot_paths
from gaitdisc.recording.arrays import runs

JOINTS = {"hip_flexion": 0, "hip_adduction": 1, "hip_rotation": 2, "knee_angle": 3, "ankle_angle": 4}


@pytest.fixture(scope="module")
def walk(person):
    return walked(person, None, 6.0, seed=5)


@pytest.fixture(scope="module")
def files(walk, tmp_path_factory):
    folder = tmp_path_factory.mktemp("markers")
    trial, static = marker_trial(walk, "walk", "nominal"), standing(walk.person)
    write_c3d([trial.stream("markers"), trial.stream("forces")], folder / "walk.c3d", trial.surfaces)
    write_c3d([static.stream("markers")], folder / "static.c3d")
    return read_trial([folder / "walk.c3d"]), read_trial([folder / "static.c3d"])


def off(moved, walk):
    """Measured minus true angles of the right leg [deg], mean and standard deviation by joint."""
    tilt = habitual("pelvis_tilt", walk.person.dimensionless_speed).mean
    apart = {n: moved.angles[f"{n}_r"] - walk.angles[:, 0, j] - tilt * (j == 0) for n, j in JOINTS.items()}
    return {name: (float(np.mean(one)), float(np.std(one))) for name, one in apart.items()}


def test_without_skin_the_angles_are_those_of_the_bones(walk, monkeypatch):
    monkeypatch.setattr(laboratory, "SKIN_M", dict.fromkeys(laboratory.SKIN_M, 0.0))
    trial, static = marker_trial(walk, "walk", "nominal"), standing(walk.person)
    moved = move_body(trial.stream("markers"), static.stream("markers"))
    for name, (mean, spread) in off(moved, walk).items():
        assert abs(mean) < 0.1, name
        assert spread < 0.3, name


def test_skin_spoils_rotation_more_than_flexion(files, walk):
    """Skin spoils rotation of the hip by several degrees, flexion of knee and hip by one or two (Leardini 2005)."""
    moved = move_body(files[0].stream("markers"), files[1].stream("markers"))
    found = {name: np.hypot(*one) for name, one in off(moved, walk).items()}
    assert 0.2 < found["knee_angle"] < 4.0
    assert found["ankle_angle"] < 2.0
    assert found["hip_flexion"] < 4.0
    assert 0.5 < found["hip_rotation"] < 12.0


def test_skin_moves_a_thighs_markers_by_5_to_15_mm(walk, monkeypatch):
    seen = marker_trial(walk, "walk", "nominal").stream("markers").values
    monkeypatch.setattr(laboratory, "SKIN_M", dict.fromkeys(laboratory.SKIN_M, 0.0))
    still = marker_trial(walk, "walk", "nominal").stream("markers")
    thigh = [n for n, name in enumerate(still.names) if "TH" in name]
    moved = np.linalg.norm((seen - still.values)[:, thigh].reshape(len(seen), -1, 3), axis=2).max(axis=0)
    assert 0.005 < np.median(moved) < 0.020


def test_moments_by_newton_and_euler_are_those_that_walked(files, walk):
    read, static = files
    moved = move_body(read.stream("markers"), static.stream("markers"))
    person = Person(walk.person.mass_kg)
    found = trial_kinetics(read, moved.poses, find_foot_paths(moved), person, KineticsSettings())
    assert sum(step.clean for step in found.steps) >= 8
    for joint, (column, alike) in {"ankle_angle": (2, 0.97), "knee_angle": (1, 0.8), "hip_flexion": (0, 0.8)}.items():
        seen = found.moments[f"{joint}_r_moment"]
        true = walk.moments[:, 0, column] / walk.person.mass_kg
        known = np.isfinite(seen)
        assert known.mean() > 0.5
        assert np.corrcoef(seen[known], true[known])[0, 1] > alike, joint


def test_a_spring_on_the_ankle_is_in_the_moment_about_it(person):
    """The belt turns the foot against the spring, and its plate measures that as well."""
    worn = walked(person, Spring(5.0), 6.0, seed=5)
    trial, static = marker_trial(worn, "walk", "exo"), standing(person)
    moved = move_body(trial.stream("markers"), static.stream("markers"))
    who = Person(person.mass_kg)
    found = trial_kinetics(trial, moved.poses, find_foot_paths(moved), who, KineticsSettings())
    seen, spring = found.moments["ankle_angle_r_moment"] * person.mass_kg, worn.spring[:, 0]
    known = np.isfinite(seen) & (spring < -5.0)
    assert known.sum() > 100
    lacks = (seen - worn.moments[:, 0, 2] - spring)[known].mean()
    assert abs(lacks) < 0.25 * -spring[known].mean()  # 0.6 of it without the turning moment


def test_a_force_lies_on_its_belt_and_pushes_inwards(files):
    forces = files[0].stream("forces")
    for number, belt in enumerate(belts(), 1):
        loaded = forces[f"plate_{number}_fz"] > 50.0
        point = np.column_stack([forces[f"plate_{number}_p{axis}"] for axis in "xyz"])[loaded]
        assert np.all(belt.outside(point) < 0)
        assert np.sign(forces[f"plate_{number}_fy"][loaded].mean()) == (1 if number == 1 else -1)


START_S = 2.0


@pytest.fixture(scope="module")
def still(person):
    return marker_trial(walked(person, None, 8.0, seed=5), "walk", "nominal")


@pytest.fixture(scope="module")
def floor(still, person):
    return overground(still, START_S, person.stride_s, person.speed_m_per_s, "walk_1")


def test_a_foot_that_stands_rests_on_the_floor(floor, still, person):
    heel = floor.stream("markers")["RMT5.x"]
    speed = np.gradient(heel, 0.01)
    a, b = max(runs(floor.stream("forces")["plate_1_fz"] > STANDS_N), key=lambda run: run[1] - run[0])
    middle = speed[int(0.1 * a + 0.04 * (b - a)) : int(0.1 * a + 0.05 * (b - a))]  # 40 to 50 % of stance, at 100 Hz
    assert np.abs(middle).max() < 0.25 * person.speed_m_per_s
    came = floor.stream("markers")["RASI.x"][-1] - floor.stream("markers")["RASI.x"][0]
    assert came == pytest.approx(person.speed_m_per_s * (floor.stream("markers").time[-1]), abs=0.1)


def test_each_plate_sees_one_step_inside_its_corners(floor):
    forces = floor.stream("forces")
    begun = []
    for plate in floor.surfaces:
        force = forces[f"{plate.name}_fz"]
        steps = [(a, b) for a, b in runs(force > STANDS_N) if b - a > 100]
        assert len(steps) == 1
        a, b = steps[0]
        begun.append(a)
        loaded = slice(a + (b - a) // 10, b - (b - a) // 10)
        point = -forces[f"{plate.name}_my"][loaded] / force[loaded] + plate.corners.mean(axis=0)[0]
        assert plate.corners[:, 0].min() < point.min() and point.max() < plate.corners[:, 0].max()
        foot = floor.stream("markers")["RMT5.x" if plate.name == "plate_1" else "LMT5.x"]
        assert np.abs(point - np.interp(forces.time[loaded], floor.stream("markers").time, foot)).max() < 0.25
    first, second = floor.surfaces
    assert begun[0] < begun[1] and first.corners[:, 0].max() <= second.corners[:, 0].min() + 1e-9


def test_moments_of_the_step_are_those_of_the_belts(floor, still, person):
    static = standing(person).stream("markers")

    def ankle(trial):
        moved = move_body(trial.stream("markers"), static)
        who = Person(person.mass_kg, person.sex)
        found = trial_kinetics(trial, moved.poses, find_foot_paths(moved), who, KineticsSettings()).moments
        return found.time, found["ankle_angle_r_moment"]

    (time, own), (belt_time, belt) = ankle(floor), ankle(still)
    there = np.isfinite(own)
    other = np.interp(time[there] + START_S, belt_time, belt)
    assert there.sum() > 30
    assert np.nanmin(own) == pytest.approx(np.nanmin(other), rel=0.05)
    assert np.nanmedian(np.abs(own[there] - other)) < 0.05
