"""Imports go downwards only; rooms on one floor do not import each other (docs/design.md)."""

import ast
from functools import cache
from pathlib import Path

import gaitdisc

PACKAGE = Path(gaitdisc.__file__).parent
FLOORS = (
    (
        *("errors", "units", "channel", "own_files", "whole_file", "write_lock", "regular_file", "toml_text"),
        *("spreadsheet", "compiled", "_version", "words"),
    ),
    ("recording", "model"),
    ("ingest", "signals", "kinematics", "simulation", "models", "statistics", "saved"),
    ("kinetics", "engines", "report", "cohort"),
    ("processing",),
    ("discovery", "comparison", "response", "reconstruction", "clinic"),
    ("run",),
    ("library", "commands", "studies"),
    ("cli", "__main__"),
)
FLOOR = {room: number for number, rooms in enumerate(FLOORS) for room in rooms}
SOLE_HOME = {
    "torch": {"models"},
    "pingouin": {"statistics"},
    "statsmodels": {"statistics"},
    "ezc3d": {"ingest"},
    "mujoco": {"engines"},
    "opensim": {"engines"},
    "typst": {"clinic"},
}


def _modules():
    for path in sorted(PACKAGE.rglob("*.py")):
        parts = path.relative_to(PACKAGE).with_suffix("").parts
        if parts != ("__init__",):
            yield path, parts[0]


@cache
def _imported(path: Path) -> tuple[str, ...]:
    names = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            names.append(node.module or "")
    return tuple(names)


def test_every_room_has_a_floor():
    rooms = {room for _, room in _modules()}
    assert rooms <= set(FLOOR), f"rooms without a floor: {sorted(rooms - set(FLOOR))}"


def test_imports_go_downwards():
    upwards = []
    for path, room in _modules():
        for name in _imported(path):
            parts = name.split(".")
            if parts[0] != "gaitdisc" or len(parts) < 2 or parts[1] == room:
                continue
            one_noun_of_another = FLOOR[room] == FLOOR[parts[1]] in (0, len(FLOORS) - 1)
            if FLOOR[parts[1]] >= FLOOR[room] and not one_noun_of_another:
                upwards.append(f"{path.relative_to(PACKAGE)} imports {name}")
    assert not upwards, "\n".join(upwards)


def test_nothing_in_the_package_imports_a_study():
    studies = {path.stem for path in (PACKAGE.parent / "studies").iterdir()}
    strays = [f"{path.name} imports {name}" for path, _ in _modules() for name in _imported(path) if name in studies]
    assert strays == []


def test_heavy_libraries_have_one_home():
    strays = [
        f"{path.relative_to(PACKAGE)} imports {name}"
        for path, room in _modules()
        for name in _imported(path)
        if room not in SOLE_HOME.get(name.split(".")[0], {room})
    ]
    assert not strays, "\n".join(strays)


def test_only_what_makes_figures_of_the_report_imports_matplotlib():
    strays = [
        str(path.relative_to(PACKAGE))
        for path, room in _modules()
        if any(name.split(".")[0] == "matplotlib" for name in _imported(path))
        and room not in ("report", "library")
        and not any(name.startswith("gaitdisc.report.") for name in _imported(path))
    ]
    assert not strays, "\n".join(strays)


def test_what_saves_and_what_lays_out_knows_no_kind():
    """Files that every subject saves and draws by import no noun that is saved."""
    everywhere = ("saved/kind", "saved/study_run", "saved/unit_folder")
    laid_out = ("report/page", "report/table", "report/figure", "report/panels", "report/saved_page")
    strays = [
        f"{file}.py imports {name}"
        for file in (*everywhere, *laid_out)
        for name in _imported(PACKAGE / f"{file}.py")
        if name.startswith("gaitdisc.") and FLOOR[name.split(".")[1]] > FLOOR[file.split("/")[0]]
    ]
    assert not strays, "\n".join(strays)
