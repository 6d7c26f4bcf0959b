"""Studies are written against `import gaitdisc as gd` where it has what they need; the exceptions can only fall."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import gaitdisc

STUDIES = {path.stem: path for path in sorted((Path(__file__).parents[2] / "studies").glob("*.py"))}
MOST_LINES = 120
# Of the package they import the door alone. A study that joins them is added here.
DOOR_ALONE = {"ankle_exo_emg", "command_line", "compare_halves", "curves_over_each_other", "damaged_c3d",
              "driven_trials", "engines", "engines_with_muscles", "family_wise_error", "fault_cases",
              "faults_of_meaning", "joints_and_chains", "knee_with_memory", "library_pictures", "printed_numbers",
              }  # fmt: skip
INSIDE = 47  # at most so many import from deeper: of rooms that the door does not open, or tests of what lies inside
LONG = {
    "ankle_exo_emg": 200,
    "ch3_further": 228,
    "ch3_seeds": 176,
    "ch3_tables": 198,
    "ch4_further": 251,
    "ch4_ours": 131,
    "ch4_outcomes": 151,
    "ch5_beyond": 195,
    "ch5_further": 209,
    "ch5_gait_individual": 129,
    "cohort_muscles": 137,
    "cohort_norms": 160,
    "contact_bias": 126,
    "engine_cases": 124,
    "engines": 187,
    "engines_with_muscles": 137,
    "fault_cases": 230,
    "faults_of_meaning": 145,
    "gait10dof_segments": 164,
    "hidden_effects_in_gait": 126,
    "joints_and_chains": 149,
    "marker_noise": 189,
    "markers_to_angles": 213,
    "planted_faults": 147,
    "printed_numbers": 193,
    "real_files": 143,
    "real_strides": 130,
}


def imported(path: Path) -> set[tuple[str, str]]:
    """Module and name of everything that is imported from within the package."""
    return {
        (node.module, alias.name)
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("gaitdisc.")
        for alias in node.names
    }


def test_which_studies_go_through_the_door_alone_and_how_many_do_not():
    inside = {name for name, path in STUDIES.items() if imported(path)}
    assert set(STUDIES) - inside == DOOR_ALONE
    assert len(inside) <= INSIDE, "one more study imports from deeper inside: does the door have what it needs?"
    assert len(inside) >= INSIDE - 1, "fewer do by now: lower INSIDE"


def test_no_study_imports_from_deeper_what_the_door_offers():
    homes = {(f"gaitdisc.{module}", name) for module, name in gaitdisc._HOME.values() if name}
    homes |= {(".".join(module.split(".")[:2]), name) for module, name in homes}
    strays = {study: sorted(imported(path) & homes) for study, path in STUDIES.items() if imported(path) & homes}
    assert strays == {}


def test_studies_are_short_and_the_long_ones_do_not_grow():
    lines = {name: len(re.findall("\n", path.read_text(encoding="utf-8"))) for name, path in STUDIES.items()}
    grown = {name: count for name, count in lines.items() if count > LONG.get(name, MOST_LINES)}
    assert grown == {}
    assert {name for name in LONG if lines.get(name, 0) <= MOST_LINES} == set(), "short by now: take it from LONG"
