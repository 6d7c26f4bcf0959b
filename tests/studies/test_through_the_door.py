"""Studies are written against `import gaitdisc as gd`; chapters 3 and 5 have parts of pages and windows besides."""

import ast
import re
from pathlib import Path

import gaitdisc

STUDIES = {path.stem: path for path in sorted((Path(__file__).parents[2] / "studies").glob("*.py"))}
MOST_LINES = 120
# of pages and windows: chapters 3 and 5
PARTS = ("gaitdisc.report.", "gaitdisc.reconstruction.", "gaitdisc.statistics.")
OF_CHAPTERS = re.compile(r"ch[35]_|further$")
# All others import the package through the door alone, but for these, each for a reason.
INSIDE = {
    "people of the embedded cohort with their true moments and contacts, which no recording holds": {
        "ankle_records", "cohort_muscles", "cohort_norms", "cohort_pictures", "device_from_files",
        "hidden_effects_in_gait", "hidden_spring", "no_discrepancy",
    },
    "one step of what the door joins: poses, moments of given segments, one check, one turn of the search": {
        "emps", "gait10dof", "gait10dof_segments", "moments", "moved_markers", "plug_in_gait_angles",
        "plug_in_gait_bones", "pooled_cycles", "real_strides",
    },
    "what a command does with a whole study, beside its inner numbers": {
        "ch4_ankle_exo", "ch4_ours",
        "as_a_user", "compare_exo_emg", "engine_cases", "false_alarms", "planted_faults", "tracked_walks",
    },
    "fits and windows of one kind set beside others of the literature": {
        "ch5_further",
    },
}  # fmt: skip
LONG = {
    "as_a_user": 149,
    "c3d_in_place": 145,
    "ch3_systems": 144,  # three sections, with what each states
    "ch5_further": 137,  # fits and windows of nine tables
    "device_from_files": 140,
    "engine_cases": 129,  # the cases of both studies
    "engines": 147,
    "engines_with_muscles": 129,
    "false_alarms": 184,  # made people whose belts carry what they weigh
    "faults_in_people": 301,  # 33 kinds of fault
    "faults_on_pages": 222,
    "file_against_page": 134,
    "tracked_walks": 147,
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
    deeper = {name for name, path in STUDIES.items() if not all(_open_to(name, module) for module, _ in imported(path))}
    named = {name for names in INSIDE.values() for name in names}
    assert deeper - named == set()  # does the door have what it needs? If not: name it above, with its reason
    assert named - deeper == set()  # goes through the door by now: take it from INSIDE


def _open_to(study: str, module: str) -> bool:
    return module.startswith(PARTS) and OF_CHAPTERS.match(study) is not None


def test_no_study_imports_from_deeper_what_the_door_offers():
    homes = {(f"gaitdisc.{module}", name) for module, name in gaitdisc._HOME.values() if name}
    homes |= {(".".join(module.split(".")[:2]), name) for module, name in homes}
    strays = {study: sorted(imported(path) & homes) for study, path in STUDIES.items() if imported(path) & homes}
    assert strays == {}


def test_studies_are_short_and_the_long_ones_do_not_grow():
    lines = {name: len(re.findall("\n", path.read_text(encoding="utf-8"))) for name, path in STUDIES.items()}
    grown = {name: count for name, count in lines.items() if count > LONG.get(name, MOST_LINES)}
    assert grown == {}
    assert {name for name in LONG if lines.get(name, 0) <= MOST_LINES} == set()  # short by now: take it from LONG
