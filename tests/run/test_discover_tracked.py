"""OpenSim's own example of an ankle spring: named in a walk with recorded forces, and written into the model."""

import shutil
from importlib.util import find_spec
from pathlib import Path

import pytest
from saved_folders import TRACKED
from texts import says
from typer.testing import CliRunner

from gaitdisc.cli import app

DATA = Path(__file__).parents[3] / "shared/data/opensim_gait10dof"
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(find_spec("opensim") is None, reason="OpenSim is not installed: gaitdisc[opensim]"),
    pytest.mark.skipif(not DATA.is_dir(), reason="the recorded walk is not here"),
]


@pytest.fixture
def lab(tmp_path):
    (tmp_path / "data").symlink_to(DATA)
    shutil.copy(DATA / "CMC/subject01_metabolics.osim", tmp_path)
    return tmp_path


def searched(lab, results, model="subject01_metabolics.osim"):
    mapping = (lab / model).with_suffix(".toml")
    if not mapping.is_file():
        mapping.write_text(TRACKED.replace("results_spring", results))
    kinematics = DATA / "CMC" / results / "walk_subject_Kinematics_q.sto"
    words = ["discover", str(lab / model), str(kinematics), "--out", str(lab / "found"), "-q", "--no-report"]
    return CliRunner().invoke(app, words)


def test_the_ankle_spring_is_named_written_and_no_longer_missed(lab):
    from gaitdisc import load

    done = searched(lab, "results_spring")
    assert done.exit_code == 0, done.exception
    found = load(lab / "found")
    (effect,) = found.effects
    assert (effect.name, effect.place) == ("one_sided_spring", "ankle_angle_r_moment")
    assert effect.estimates["stiffness"].value == pytest.approx(599.0, rel=0.15)  # hard-corner equivalent
    assert effect.estimates["engagement"].value == pytest.approx(0.0908, abs=0.01)  # 5.2 deg
    before, after, _ = found.held_out.channels["net_ankle_angle_r_moment"]
    assert before > 20 and after < 0.1 * before
    again = searched(lab / "found", "results_spring", "subject01_metabolics_augmented.osim")
    assert again.exit_code == 0, again.exception
    assert not load(lab / "found/found").effects


def test_where_nothing_was_added_nothing_is_named(lab):
    done = searched(lab, "results_no_spring")
    assert done.exit_code == 0, done.exception
    assert says(done.output, "within the noise", "these data show no missing effect")


def test_the_spring_is_named_from_other_kinematics_than_the_forces_were_computed_for(lab):
    """The angles are those of the markers; the forces belong to a motion that residual reduction had altered."""
    from gaitdisc import load

    mapping = TRACKED.splitlines()
    rates = ("speeds", "accelerations")
    (lab / "subject01_metabolics.toml").write_text("\n".join(line for line in mapping if not line.startswith(rates)))
    kinematics = DATA / "IK/subject01_walk_IK.mot"
    words = ["discover", str(lab / "subject01_metabolics.osim"), str(kinematics), "--out", str(lab / "found")]
    done = CliRunner().invoke(app, [*words, "-q", "--no-report"])
    assert done.exit_code == 0, done.exception
    (effect,) = load(lab / "found").effects
    assert (effect.name, effect.place) == ("one_sided_spring", "ankle_angle_r_moment")
    assert effect.estimates["stiffness"].value == pytest.approx(599.0, rel=0.2)


def test_without_muscles_forces_only_the_residuals_speak(lab):
    (lab / "subject01_metabolics.toml").write_text(
        '[tracked]\nexternal_loads = "data/ExperimentalData/subject01_walk_grf.xml"\n'
    )
    kinematics = DATA / "IK/subject01_walk_IK.mot"
    from gaitdisc import discover

    found, _ = discover(str(lab / "subject01_metabolics.osim"), str(kinematics))
    assert says(found.sentence, "no", "gives the muscle forces")
    assert "N at pelvis_ty" in found.sentence and not found.effects


def test_a_mass_that_the_ground_does_not_carry_is_refused(lab):
    import re

    model = lab / "subject01_metabolics.osim"
    text = re.sub(r"<mass>([^<]*)<", lambda found: f"<mass>{1.15 * float(found[1])!r}<", model.read_text())
    model.write_text(text)
    done = searched(lab, "results_no_spring")
    assert done.exit_code != 0
    assert says(str(done.exception), "subject01_metabolics.osim", "83.5 kg", "pelvis_ty")
    carried = float(re.search(r"the forces carry ([\d.]+) kg", str(done.exception))[1])
    assert carried == pytest.approx(72.6, abs=0.7)  # which it was before


def test_forces_that_balance_another_motion_are_refused(lab):
    results = DATA / "CMC/results_no_spring"
    head, _, body = (results / "walk_subject_Actuation_force.sto").read_text().partition("endheader\n")
    rows = [line.split("\t") for line in body.splitlines()]
    column = rows[0].index("FY")
    for row in rows[1:]:
        row[column] = f"{float(row[column]) + 200:.5f}"
    (lab / "forces.sto").write_text(f"{head}endheader\n" + "\n".join("\t".join(row) for row in rows) + "\n")
    mapping = TRACKED.replace("results_spring", "results_no_spring")
    kept = mapping.replace("data/CMC/results_no_spring/walk_subject_Actuation_force.sto", "forces.sto")
    (lab / "subject01_metabolics.toml").write_text(kept)
    done = searched(lab, "results_no_spring")
    assert says(str(done.exception), "pelvis_ty", "200 N", "7")
    assert says(str(done.exception), "Compute the forces")
