"""200 small mutations of functions that outlive the second half of the house: which of them do the tests see?

    python tests/house/mutants.py draw          # mutants.csv anew: function, operator, place, change
    python tests/house/mutants.py follow        # the table after a move: room, place and change of each mutant today
    python tests/house/mutants.py run FOLDER    # answers those that have none, in a copy of the checkout

A mutant is named by its function, the operator and its n-th place in that function, so that the same one is made again
where a file has moved. One whose function is gone is given one of the function that took over its work, by hand, and
no answer until it is run. Private functions of at most 12 lines may go back into their caller: none is drawn. Each
mutant is judged by the tests of its room and between rooms that call the function, the shortest first; one unchanged
pass records which. To begin anew, empty the last three columns of the table and take a new FOLDER.
"""

import ast
import copy
import csv
import os
import random
import shutil
import signal
import sys
import time
from collections import defaultdict
from contextlib import suppress
from difflib import SequenceMatcher
from importlib import import_module
from pathlib import Path
from typing import Any

CHECKOUT, TABLE = Path(__file__).parents[2], Path(__file__).with_name("mutants.csv")
COLUMNS = ("room", "function", "operator", "place", "change", "answer", "tests", "seconds")
ROOMS = ("signals", "statistics", "kinetics", "ingest", "simulation", "report")  # that mutants were drawn from
BETWEEN = ("promises", "report", "library")  # whose tests judge mutants of every room: pages, and what the door offers
GROUND = ("units.py", "words.py", "test_units.py", "test_wording.py")  # files beside the rooms, and their tests
LIBRARIES = "numpy pandas scipy.signal scipy.optimize scipy.stats torch matplotlib.pyplot numba pytest"
DRAWN, SEED, SHORT = 200, 28, 12
ALIKE = 0.6  # of the letters of a change: below, it is another mutant than the one that was answered
LIMIT_S, CHOSEN_S = 240, 40  # [s] after which a mutant counts as killed; the tests chosen take no longer unchanged
FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)
OPPOSITE = {ast.Lt: ast.GtE, ast.Gt: ast.LtE, ast.Eq: ast.NotEq, ast.Is: ast.IsNot, ast.In: ast.NotIn}
OPPOSITE |= {after: before for before, after in OPPOSITE.items()}
EDGE = {ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt}
SIGN = {ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult}
OPERATORS = ("comparison", "boundary", "sign", "constant", "logic", "return", "not", "arguments")
HIT = """import os
SEEN = set()
def hit(name):
    line = os.environ.get("PYTEST_CURRENT_TEST", "").rpartition(" ")[0] + "\\t" + name + "\\n"
    if line not in SEEN and "MUTANT_HITS" in os.environ:
        SEEN.add(line)
        open(os.environ["MUTANT_HITS"], "a").write(line)
"""


def mutate(node: Any, operator: str) -> ast.AST | None:
    """Another node for this one, or None where the operator has no place in it."""
    new, table = copy.deepcopy(node), EDGE if operator == "boundary" else OPPOSITE
    if operator in ("comparison", "boundary") and isinstance(node, ast.Compare) and type(node.ops[0]) in table:
        new.ops[0] = table[type(node.ops[0])]()
    elif operator == "sign" and isinstance(node, (ast.BinOp, ast.AugAssign)) and type(node.op) in SIGN:
        new.op = SIGN[type(node.op)]()
    elif operator == "constant" and isinstance(node, ast.Constant) and type(node.value) in (int, float):
        new.value = node.value + 1 if isinstance(node.value, int) else (1.25 * node.value or 1.0)
    elif operator == "logic" and isinstance(node, ast.BoolOp):
        new.op = ast.Or() if isinstance(node.op, ast.And) else ast.And()
    elif (
        operator == "return" and isinstance(node, ast.Return) and not isinstance(node.value, (ast.Constant, type(None)))
    ):
        new.value = ast.Constant(None)
    elif operator == "not" and isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
        new = new.operand
    elif operator == "arguments" and isinstance(node, ast.Call) and len(node.args) > 1:
        new.args[:2] = new.args[1::-1]
    else:
        return None
    return ast.copy_location(new, node)


class Mutation(ast.NodeTransformer):
    """Counts the places of an operator in the body of a function, in the order of the text, and changes the n-th."""

    def __init__(self, function: Any, operator: str, place: int = 0) -> None:
        self.operator, self.place, self.count, self.words = operator, place, 0, ""
        function.body = [self.visit(line) for line in function.body]

    def visit(self, node: Any) -> Any:
        """One node, then those within; notes of types are no calculation."""
        changed = mutate(node, self.operator)
        self.count += changed is not None
        if changed is not None and self.count == self.place:
            self.words = f"{ast.unparse(node)}  ->  {ast.unparse(changed)}"
            return changed
        if isinstance(node, ast.AnnAssign):
            node.value = self.visit(node.value) if node.value else None
            return node
        return self.generic_visit(node)


def list_functions(root: Path) -> dict[str, tuple[Path, ast.Module, Any]]:
    """Functions and methods of gaitdisc whose name occurs once: file, module, node."""
    every = defaultdict(list)
    for path in sorted((root / "gaitdisc").rglob("*.py")):
        module = ast.parse(path.read_text(encoding="utf-8"))
        owners = [("", module), *((f"{one.name}.", one) for one in module.body if isinstance(one, ast.ClassDef))]
        for prefix, owner in owners:
            for node in owner.body:
                if isinstance(node, FUNCTIONS):
                    every[prefix + node.name].append((path, module, node))
    return {name: places[0] for name, places in every.items() if len(places) == 1}


def find_room(place: str) -> str:
    """Room of a file or test by its path from the checkout."""
    room = place.split("/")[1]
    return "ground" if ".py" in room else room


def draw() -> list[dict[str, str]]:
    """The mutants: of each room in turn one of its functions, and one of the places in it."""
    generator, rows, rooms = random.Random(SEED), [], defaultdict(list)
    for name, (path, _, node) in list_functions(CHECKOUT).items():
        compiled = any(word in ast.unparse(one) for one in node.decorator_list for word in ("compiled", "fast"))
        if not compiled and not (node.name.startswith("_") and (node.end_lineno or 0) - node.lineno < SHORT):
            rooms[path.relative_to(CHECKOUT).parts[1]].append((name, node))
    while len(rows) < DRAWN:
        room = ROOMS[len(rows) % len(ROOMS)]
        name, node = generator.choice(rooms[room])
        counts = {one: Mutation(copy.deepcopy(node), one).count for one in OPERATORS}
        places = [(operator, str(n + 1)) for operator, count in counts.items() for n in range(count)]
        if places:
            row = dict.fromkeys(COLUMNS, "") | {"room": room, "function": name}
            row["operator"], row["place"] = generator.choice(places)
            row["change"] = Mutation(copy.deepcopy(node), row["operator"], int(row["place"])).words
            rows += [row] if row not in rows else []
    return sorted(rows, key=lambda row: tuple(row.values()))


def follow(rows: list[dict[str, str]]) -> list[dict[str, str]]:
    """Room, place and change of each mutant as its function is today; without the same one, no answer."""
    functions = list_functions(CHECKOUT)
    for row in rows:
        path, _, node = functions.get(row["function"], (None, None, None))
        count = Mutation(copy.deepcopy(node), row["operator"]).count if node else 0
        if not path or not count:
            row["answer"] = ""
            print("no function" if not path else "no place", *list(row.values())[:5])
            continue
        words = [Mutation(copy.deepcopy(node), row["operator"], n + 1).words for n in range(count)]
        alike = [SequenceMatcher(None, row["change"], change).ratio() for change in words]
        same = int(row["place"]) <= count and words[int(row["place"]) - 1] == row["change"]
        place = int(row["place"]) if same else alike.index(max(alike)) + 1
        answer = row["answer"] if max(alike) > ALIKE else ""
        row |= {"place": str(place), "change": words[place - 1], "answer": answer}
        row["room"] = find_room(path.relative_to(CHECKOUT).as_posix())
    return sorted(rows, key=lambda row: tuple(row.values()))


def write_table(rows: list[dict[str, str]]) -> None:
    """The table beside this file."""
    with TABLE.open("w", newline="") as file:
        table = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        table.writeheader()
        table.writerows(rows)


class Durations:
    """Writes how long each test took that passed."""

    def pytest_runtest_logreport(self, report: Any) -> None:
        """As pytest calls it."""
        if report.when == "call" and report.passed:
            with Path("../durations").open("a") as file:
                file.write(f"{report.nodeid}\t{report.duration:.3f}\n")


def run_tests(place: Path, tests: list[str], limit_s: float, plugins: tuple[Any, ...] = ()) -> int:
    """Exit code of pytest over a copy of the checkout, in a child of this process, which has loaded the libraries."""
    import pytest

    child = os.fork()
    if child == 0:
        os.setsid()
        os.chdir(place)
        os.environ |= {"PYTHONPATH": str(place), "MUTANT_HITS": str(place.parent / "hits")}
        sys.path[:] = [str(place), *(one for one in sys.path if one not in (str(CHECKOUT), str(TABLE.parent)))]
        output = os.open("../output", os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(output, 1)
        os.dup2(output, 2)
        os._exit(int(pytest.main(["-q", "-p", "no:cacheprovider", *([] if plugins else ["-x"]), *tests], plugins)))
    signal.signal(signal.SIGALRM, lambda *_: os.killpg(child, signal.SIGKILL))
    signal.alarm(int(limit_s))
    code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    signal.alarm(0)
    with suppress(ProcessLookupError):
        os.killpg(child, signal.SIGKILL)
    return code


def record_tests(folder: Path, rooms: dict[str, str]) -> None:
    """Write down which tests call which functions, and how long each test takes, in one pass over a copy."""
    place, written = folder / "tried", {}
    for name, (path, module, node) in list_functions(place).items():
        if name in rooms:
            call = ast.parse(f"__import__('mutant_hits').hit({name!r})").body[0]
            node.body.insert(bool(ast.get_docstring(node)), call)
            written[path] = module
    (place / "mutant_hits.py").write_text(HIT)
    for path, module in written.items():
        path.write_text(ast.unparse(module), encoding="utf-8")
    parts = [*rooms.values(), *BETWEEN, *(GROUND if "ground" in rooms.values() else ())]
    tests = sorted({f"{top}/{part}" for top in ("tests", "gaitdisc") for part in parts})
    run_tests(place, [one for one in tests if (place / one).exists()], 7200, (Durations(),))
    for path in written:
        shutil.copy2(folder / "clean" / path.relative_to(place), path)


def choose_tests(folder: Path) -> dict[str, list[str]]:
    """Of each function the tests that call it, the shortest first, as many as take CHOSEN_S together."""
    pairs = [line.rsplit("\t", 1) for line in (folder / "durations").read_text().splitlines()]
    seconds, calls, chosen = {test: float(took) for test, took in pairs}, defaultdict(set), defaultdict(list)
    for line in (folder / "hits").read_text().splitlines():
        calls[line.rsplit("\t", 1)[1]] |= {line.rsplit("\t", 1)[0]} & seconds.keys()
    for name, tests in calls.items():
        left = CHOSEN_S
        for test in sorted(tests, key=lambda one: (seconds[one], one)):
            left -= seconds[test]
            if left >= 0 or not chosen[name]:
                chosen[name].append(test)
    return chosen


def run(folder: Path, rows: list[dict[str, str]]) -> None:
    """Answer each mutant that has no answer."""
    for name, source in (("clean", CHECKOUT), ("tried", folder / "clean")):
        if not (folder / name).is_dir():
            shutil.copytree(source, folder / name, ignore=shutil.ignore_patterns(".git", ".venv*", "demo", "build"))
    if not (folder / "durations").exists():
        record_tests(folder, {row["function"]: row["room"] for row in rows if not row["answer"]})
    for name in LIBRARIES.split():
        import_module(name)
    functions, chosen, begun = list_functions(folder / "clean"), choose_tests(folder), time.monotonic()
    waiting = [row for row in rows if not row["answer"]]
    for number, row in enumerate(waiting, 1):
        tests, start = chosen.get(row["function"], []), time.monotonic()
        tests = [test for test in tests if find_room(test) in (row["room"], *BETWEEN)]
        row["answer"] = "no test" if row["function"] in functions else "no function"
        if row["function"] in functions and tests:
            path, module, node = functions[row["function"]]
            tried, body = folder / "tried" / path.relative_to(folder / "clean"), node.body
            node.body = copy.deepcopy(body)
            Mutation(node, row["operator"], int(row["place"]))
            tried.write_text(ast.unparse(module), encoding="utf-8")
            node.body = body
            row["answer"] = "killed" if run_tests(folder / "tried", tests, LIMIT_S) else "alive"
            shutil.copy2(path, tried)
        row |= {"tests": str(len(tests)), "seconds": f"{time.monotonic() - start:.0f}"}
        write_table(rows)
        left = (time.monotonic() - begun) / number * (len(waiting) - number) / 60
        print(f"{number}/{len(waiting)} {' '.join(list(row.values())[1:6])}; {left:.0f} min left", flush=True)


if __name__ == "__main__":
    if sys.argv[1] == "draw":
        write_table(draw())
    else:
        with TABLE.open(newline="") as table:
            lines = list(csv.DictReader(table))
        if sys.argv[1] == "follow":
            write_table(follow(lines))
        else:
            run(Path(sys.argv[2]).resolve(), lines)
