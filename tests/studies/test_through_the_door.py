"""Studies are written against `import gaitdisc as gd`; those of chapters 3 and 5 have their own room besides."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import gaitdisc

STUDIES = {path.stem: path for path in sorted((Path(__file__).parents[2] / "studies").glob("*.py"))}
MOST_LINES = 120
ROOF = "gaitdisc.chapters."  # what chapter 3 and the fields of chapter 5 need: a second door, for their studies alone
OF_CHAPTERS = re.compile(r"ch[35]_|further$")
# All others import the package through the door alone, but for these, each for a reason.
INSIDE = {
    "people of the embedded cohort with their true moments and contacts, which no recording holds": {
        "ankle_records", "cohort_muscles", "cohort_norms", "cohort_pictures", "device_from_files",
        "hidden_effects_in_gait", "hidden_spring", "no_discrepancy",
    },
    "one step of what the door joins: poses, moments of given segments, one detector, one turn of the search": {
        "emps", "gait10dof_segments", "marker_noise", "markers_to_angles", "moments",
        "plug_in_gait_bones", "pooled_cycles", "real_strides",
    },
    "what a command does with a whole study, beside its inner numbers": {
        "ch4_ankle_exo", "ch4_ours", "ch5_gait", "ch5_gait_individual", "ch5_gait_population", "clinic_rules",
        "compare_exo_emg", "engines", "planted_faults",
    },
    "fits and windows of one kind set beside others of the literature": {
        "ch4_further", "ch4_outcomes", "ch5_beyond", "ch5_further",
    },
}  # fmt: skip
LONG = {
    "ankle_exo_emg": 200,
    "ch3_further": 228,
    "ch3_seeds": 176,
    "ch4_further": 251,
    "ch4_ours": 131,
    "ch4_outcomes": 151,
    "ch5_beyond": 195,
    "ch5_further": 209,
    "ch5_gait_individual": 129,
    "cohort_muscles": 137,
    "cohort_norms": 160,
    "engines": 263,
    "fault_cases": 230,
    "faults_of_meaning": 145,
    "gait10dof_segments": 164,
    "hidden_effects_in_gait": 126,
    "joints_and_chains": 149,
    "marker_noise": 189,
    "markers_to_angles": 213,
    "planted_faults": 147,
    "printed_numbers": 193,
}


def imported(path: Path) -> set[tuple[str, str]]:
    """Module and name of everything that is imported from within the package."""
    return {
        (node.module, alias.name)
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("gaitdisc.")
        for alias in node.names
    }


def test_studies_import_from_the_door_alone_but_for_those_named_with_their_reason():
    deeper = {name for name, path in STUDIES.items() if not all(_of_roof(name, module) for module, _ in imported(path))}
    named = {name for names in INSIDE.values() for name in names}
    assert deeper - named == set(), "does the door have what it needs? If not: name it above, with its reason"
    assert named - deeper == set(), "goes through the door by now: take it from INSIDE"


def _of_roof(study: str, module: str) -> bool:
    return module.startswith(ROOF) and OF_CHAPTERS.match(study) is not None


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
