"""Normal data of other programs become the table of a published reference."""

import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

from gaitdisc.cli import app
from gaitdisc.clinic.clinical_reference import load_reference
from gaitdisc.clinic.normal_data import read_normal_data
from gaitdisc.commands.reference import reference
from gaitdisc.errors import SchemaError

PERCENT = np.linspace(0, 100, 51)
KNEE, MOMENT = 30 - 30 * np.cos(np.pi * PERCENT / 50), np.sin(np.pi * PERCENT / 50)


def _gcd(path):
    curves = {"KneeFlexExt": KNEE, "HipFlexExtMoment": MOMENT, "AnklePower": 1e3 * MOMENT, "KneeRotation": 0 * KNEE}
    text = "#!DST-0.1 GCD Oxford Metrics\n$PREFIXES\nLeft\nRight\n!Cadence 3\n0.851 0.006\n"
    for name, curve in curves.items():
        text += f"!{name} 3\n" + "".join(f"{mean:.3f} {0.5 if curve.any() else 0} \n" for mean in curve)
    path.write_text(text, encoding="utf-8")
    return path


def _xlsx(path):
    rows = [["KneeAngles (1)", "KneeAngles (1)"], [0, 0], ["unknown", "unknown"]]
    rows += [[mean - 0.5, mean + 0.5] for mean in KNEE]
    pd.DataFrame(rows).to_excel(path, sheet_name="Normal", header=False, index=False)
    return path


def test_a_gcd_becomes_a_reference_by_one_command(tmp_path):
    given = ["reference", str(_gcd(tmp_path / "normal.gcd")), "--out", str(tmp_path / "ref")]
    assert "number of people" in str(CliRunner().invoke(app, given).exception)
    said = CliRunner().invoke(app, [*given, "--people", "12"]).stdout
    assert "hip moment" in said and "of the angles is 0.5 deg" in said and "cycles of one person" in said
    (group,) = load_reference(tmp_path / "ref").published
    assert group.people == 12 and set(group.bands) == {"knee_flexion", "hip_moment", "ankle_power"}
    np.testing.assert_allclose(group.bands["hip_moment"].mean[25], -1.0, atol=3e-3)  # Plug-in Gait's is of extensors
    np.testing.assert_allclose(group.bands["ankle_power"].mean[25], 1.0, atol=3e-3)


def test_a_workbook_of_polygon_holds_mean_less_and_more_one_deviation(tmp_path):
    table = read_normal_data(_xlsx(tmp_path / "normal.xlsx"), 30)
    assert set(table["variable"]) == {"knee_flexion"} and len(table) == 51
    np.testing.assert_allclose(table[["mean", "sd"]], np.column_stack([KNEE, np.full(51, 0.5)]), atol=1e-9)


def test_a_file_of_another_ending_is_no_study_of_controls(tmp_path):
    (tmp_path / "normal.xls").touch()
    with pytest.raises(SchemaError, match=r"normal.xls ends in '.xls'. Save a workbook as .xlsx"):
        reference(tmp_path / "normal.xls", tmp_path / "ref")


@pytest.mark.parametrize("name", ["a.xlsx", "a.gcd"])
def test_what_is_no_normal_data_is_refused(tmp_path, name):
    (tmp_path / name).write_text("!Knee 1\n1 2\n", encoding="utf-8")
    with pytest.raises(SchemaError, match=f"{name} must"):
        read_normal_data(tmp_path / name, 3)
