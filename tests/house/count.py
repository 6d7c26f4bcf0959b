"""What the house weighs, beside its lines: syntax, docstrings, jumps, long functions, packed arguments, numbers, ties.

    python tests/house/count.py [--json FILE] [--no-loaded]

Prints a table for docs/design.md. Rooms, and the floor each stands on, are those of budget.toml, so that imports are
judged as if files stood where the plan puts them. `--no-loaded` leaves out the two runs that count loaded modules.
"""

import argparse
import ast
import json
import re
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from fnmatch import fnmatchcase
from pathlib import Path

from budget import CHECKOUT, read_rooms

LONG_LINES, MANY_BRANCHES, MANY_ARGUMENTS, MANY_WORDS = 40, 12, 7, 6
ORDINARY = (-1, 0, 1, 2)  # numbers that need no reason
BRANCHES = (ast.If, ast.For, ast.While, ast.ExceptHandler, ast.IfExp, ast.BoolOp, ast.comprehension, ast.match_case)
FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)
PARTICIPLE = re.compile(
    r"_*([a-z]+ed|been|begun|borne|built|chosen|cut|drawn|driven|felt|found|given|gone|grown|held|kept|known|laid|left|lost|made|"
    r"met|put|read|run|said|seen|sent|set|shown|split|spread|sworn|taken|told|thrown|understood|won|worn|written)(_|$)"
)
NOT_PARTICIPLES = re.compile(
    r"_*(read|run|set|put|cut|split|spread|seed|speed|feed|need)(_|$)"
)  # verbs and nouns alike
LOADED = {  # what a user runs, from the checkout and in an empty folder, whose loaded modules are counted
    "run": "demo small --people 1 --seconds 30",
    "discover": "discover ankle.toml walk.csv --out found --no-report",
}


def list_functions(tree: ast.AST) -> Iterator[ast.FunctionDef | ast.AsyncFunctionDef]:
    """Every function and method of a file."""
    return (node for node in ast.walk(tree) if isinstance(node, FUNCTIONS))


def count_docstring_lines(tree: ast.Module) -> int:
    """Lines of all docstrings."""
    owners = [node for node in ast.walk(tree) if isinstance(node, (ast.Module, ast.ClassDef, *FUNCTIONS))]
    return sum(
        (ast.get_docstring(node, clean=False) or "").count("\n") + bool(ast.get_docstring(node)) for node in owners
    )


def count_branches(function: ast.AST) -> int:
    """Ways that a function divides."""
    return sum(isinstance(node, BRANCHES) for node in ast.walk(function))


def count_fixed_tuples(function: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    """Parameters that are annotated as a tuple of a fixed number of parts."""
    arguments = [*function.args.posonlyargs, *function.args.args, *function.args.kwonlyargs]
    noted = [ast.unparse(one.annotation) for one in arguments if one.annotation is not None]
    return sum(bool(re.search(r"\btuple\[(?!.*\.\.\.)[^\]]*,", note)) for note in noted)


def count_numbers(tree: ast.Module) -> int:
    """Numbers set by hand: every literal but -1, 0, 1, 2 and those that only index or slice."""
    indexed = {id(leaf) for node in ast.walk(tree) if isinstance(node, ast.Subscript) for leaf in ast.walk(node.slice)}
    return sum(
        isinstance(node, ast.Constant)
        and type(node.value) in (int, float)
        and node.value not in ORDINARY
        and id(node) not in indexed
        for node in ast.walk(tree)
    )


def pins_a_text(test: ast.FunctionDef | ast.AsyncFunctionDef) -> bool:
    """Whether a test holds a text of six words or more, its docstring and what it is parametrised with apart."""
    said = test.body[1:] if ast.get_docstring(test) else test.body
    leaves = (leaf for statement in said for leaf in ast.walk(statement))
    return any(isinstance(one, ast.Constant) and len(str(one.value).split()) >= MANY_WORDS for one in leaves)


def count_private_used_once(trees: list[ast.Module]) -> int:
    """Private functions of a module that one place of it uses."""
    total = 0
    for tree in trees:
        used = Counter(node.id for node in ast.walk(tree) if isinstance(node, ast.Name))
        private = [node.name for node in tree.body if isinstance(node, FUNCTIONS) and node.name.startswith("_")]
        total += sum(used[name] == 1 for name in private)
    return total


def list_imported_files(tree: ast.Module, modules: dict[str, ast.Module]) -> set[str]:
    """Files of the package that a file imports; what a room passes on is imported from where it stands."""
    files = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            wanted = [(alias.name, "") for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            wanted = [(node.module or "", alias.name) for alias in node.names]
        else:
            continue
        for module, name in wanted:
            path = module.replace(".", "/")
            own, within = f"{path}/__init__.py", f"{path}/{name}.py"
            if within in modules or f"{path}.py" in modules:
                files.add(within if within in modules else f"{path}.py")
            elif own in modules:
                passed = [
                    line.module.replace(".", "/") + ".py"
                    for line in modules[own].body
                    if isinstance(line, ast.ImportFrom) and line.module and name in [one.name for one in line.names]
                ]
                files.add(passed[0] if passed and passed[0] in modules else own)
    return files


def list_upward_imports(modules: dict[str, ast.Module], rooms: dict[str, dict]) -> list[str]:
    """Imports of a room on the same floor or a higher one."""
    owner = {pattern: name for name, room in rooms.items() for pattern in room["files"]}

    def room_of(place: str) -> str:
        return owner[max((pattern for pattern in owner if fnmatchcase(place, pattern)), key=len)]

    upward = []
    for place, tree in modules.items():
        here, files = room_of(place), list_imported_files(tree, modules) - {place}
        there = {file: room_of(file) for file in files}
        upward += [
            f"{place} ({here}) imports {file} ({room})"
            for file, room in sorted(there.items())
            if room != here and rooms[room]["floor"] >= rooms[here]["floor"]
        ]
    return upward


def count_loaded() -> dict[str, int]:
    """Modules of gaitdisc that a command has loaded when it ends."""
    counts = {}
    for name, command in LOADED.items():
        with tempfile.TemporaryDirectory() as folder:
            if name == "discover":
                subprocess.run(
                    [sys.executable, CHECKOUT / "studies/hidden_spring.py", folder], check=True, capture_output=True
                )
            program = (
                "import sys\nfrom gaitdisc.cli import main\n"
                f"sys.argv = ['gaitdisc', *{command.split()!r}]\n"
                "try:\n    main()\nexcept SystemExit:\n    pass\n"
                "print('loaded', sum(one.startswith('gaitdisc') for one in sys.modules))"
            )
            done = subprocess.run(
                [sys.executable, "-c", program], cwd=folder, check=True, capture_output=True, text=True
            )
            counts[f"modules loaded by {name}"] = int(done.stdout.rsplit("loaded ", 1)[1])
    return counts


def count_house() -> tuple[dict[str, int], list[str]]:
    """All counts of gaitdisc/ but the loaded modules, and the imports upwards in words."""
    rooms, _ = read_rooms()
    files = sorted((CHECKOUT / "gaitdisc").rglob("*.py"))
    modules = {path.relative_to(CHECKOUT).as_posix(): ast.parse(path.read_text(encoding="utf-8")) for path in files}
    trees = list(modules.values())
    functions = [function for tree in trees for function in list_functions(tree)]
    calls = [node for tree in trees for node in ast.walk(tree) if isinstance(node, ast.Call)]
    upward = list_upward_imports(modules, rooms)
    names = [function.name for function in functions]
    odd = [n for n in names if n.endswith("_of") or (PARTICIPLE.match(n) and not NOT_PARTICIPLES.match(n))]
    tests = [f for path in CHECKOUT.glob("tests/**/*.py") for f in list_functions(ast.parse(path.read_text("utf-8")))]
    tables = [path for path in CHECKOUT.joinpath("gaitdisc").rglob("*") if path.suffix in (".toml", ".csv")]
    return {
        "files": len(files),
        "lines": sum(path.read_text(encoding="utf-8").count("\n") for path in files),
        "syntax nodes": sum(1 for tree in trees for _ in ast.walk(tree)),
        "docstring lines": sum(count_docstring_lines(tree) for tree in trees),
        "functions": len(functions),
        "private functions used once": count_private_used_once(trees),
        f"functions above {LONG_LINES} lines": sum((f.end_lineno or 0) - f.lineno >= LONG_LINES for f in functions),
        "longest function [lines]": max((f.end_lineno or 0) - f.lineno + 1 for f in functions),
        f"functions above {MANY_BRANCHES} branches": sum(count_branches(f) > MANY_BRANCHES for f in functions),
        "parameters that are fixed tuples": sum(map(count_fixed_tuples, functions)),
        f"calls with {MANY_ARGUMENTS} or more by position": sum(len(call.args) >= MANY_ARGUMENTS for call in calls),
        "numbers set by hand in Python": sum(map(count_numbers, trees)),
        "numbers in tables": sum(len(re.findall(r"(?<![\w.])-?\d+(?:\.\d+)?", path.read_text())) for path in tables),
        "functions named by a participle or _of": len(odd),
        "imports upwards": len(upward),
        f"tests with a text of {MANY_WORDS} words or more": sum(
            t.name.startswith("test") and pins_a_text(t) for t in tests
        ),
    }, upward


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--json", type=Path, help="file that gets the counts too")
    parser.add_argument("--no-loaded", action="store_true", help="leave out the modules that commands load")
    given = parser.parse_args()
    counts, upward = count_house()
    counts |= {} if given.no_loaded else count_loaded()
    print("| what | gaitdisc/ |\n|---|---|", *(f"| {name} | {number:,} |" for name, number in counts.items()), sep="\n")
    print(*upward, sep="\n", file=sys.stderr)
    if given.json:
        given.json.write_text(json.dumps(counts, indent=1) + "\n")
