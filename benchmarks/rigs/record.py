"""Makes the record of a rig from a checkout of its source, and lays out the case for the scorer.

    python benchmarks/rigs/record.py NAME CHECKOUT OUT

CHECKOUT is a clone of the repository that the rig's recipe names; its files are read at the stated commit, and their
SHA-256 is checked, and that of the made measured.csv where the recipe states it. OUT/NAME gets measured.csv,
holdout.csv, simulation.toml, truth.json and oracle.toml (the simulation with the numbers and effects that truth.json
states).
"""

import hashlib
import io
import json
import re
import runpy
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

HERE = Path(__file__).resolve().parent


def load_files(recipe, checkout):
    """Bytes of each file of the recipe, read at its commit; an unexpected hash ends the program."""
    files = {}
    for path, expected in recipe["FILES"].items():
        files[path] = subprocess.run(
            ["git", "-C", checkout, "show", f"{recipe['COMMIT']}:{path}"], capture_output=True, check=True
        ).stdout
        found = hashlib.sha256(files[path]).hexdigest()
        if found != expected:
            sys.exit(f"{recipe['REPOSITORY']}: {path} has SHA-256 {found}, expected {expected}.")
    return files


def read_sheet(content):
    """First sheet of an .xlsx file as one dict (column letter: text) for each row."""
    space = "{http://schemas.openxmlformats.org/spreadsheetml/2006/main}"
    archive = zipfile.ZipFile(io.BytesIO(content))
    rows = ElementTree.fromstring(archive.read("xl/worksheets/sheet1.xml")).iter(space + "row")
    cells = ([(c.attrib["r"].rstrip("0123456789"), c.find(space + "v")) for c in row.iter(space + "c")] for row in rows)
    return [{column: value.text or "" for column, value in row if value is not None} for row in cells]


def write_table(path, trials):
    """The trials as one table in the contract's form, each starting at time 0."""
    names = list(trials[0])
    with path.open("w") as table:
        table.write(",".join(["trial", *names]) + "\n")
        for number, trial in enumerate(trials, 1):
            columns = np.column_stack([trial[n] - trial[n][0] if n == "time" else trial[n] for n in names])
            table.writelines(",".join([str(number), *(f"{v:.8g}" for v in row)]) + "\n" for row in columns)


def build_oracle(simulation, oracle):
    """Text of the simulation with the numbers and effects that were fitted by hand in it."""
    for name, value in oracle["parameters"].items():
        simulation = re.sub(rf"(\[parameters\.{name}\]\nvalue = )\S+", rf"\g<1>{value:.7g}", simulation)
    for signal, late in oracle.get("late", {}).items():
        head, body = simulation.split("[equations]")
        simulation = head + "[equations]" + re.sub(rf"\b{signal}\b", f"delay({signal}, {late:.4g})", body)
    for column, text in oracle.get("observations", {}).items():
        simulation = re.sub(rf'(\[observations\.{column}\]\nexpression = )".*"', rf'\g<1>"{text}"', simulation)
    effects = (
        f'\n[[effects]]\nport = "{e["port"]}"\nname = "{e["name"]}"\nterm = "{e["term"]}"\n'
        for e in oracle.get("effects", [])
    )
    return "# Oracle: fitted by hand on measured.csv; not for a tool to read.\n" + simulation + "".join(effects)


def make_case(name, checkout, out):
    """Writes the five files of one rig."""
    sets = ("open", "kept", "second", "third", "fourth", "fifth", "sixth")
    folder = next(HERE / f for f in sets if (HERE / f / f"{name}.py").exists())
    recipe = runpy.run_path(str(folder / f"{name}.py"))
    learned, unseen = recipe["read_trials"](load_files(recipe, checkout))
    case = Path(out) / name
    case.mkdir(parents=True, exist_ok=True)
    write_table(case / "measured.csv", learned)
    made = hashlib.sha256((case / "measured.csv").read_bytes()).hexdigest()
    if made != recipe.get("MEASURED", made):
        sys.exit(f"{name}: the made measured.csv has SHA-256 {made}, expected {recipe['MEASURED']}.")
    write_table(case / "holdout.csv", unseen)
    shutil.copy(folder / f"{name}.toml", case / "simulation.toml")
    if (folder / f"{name}.json").exists():
        truth = json.loads((folder / f"{name}.json").read_text())
        (case / "truth.json").write_text(json.dumps(truth, indent=1))
        (case / "oracle.toml").write_text(build_oracle((folder / f"{name}.toml").read_text(), truth["oracle"]))


if __name__ == "__main__":
    sys.path.insert(0, str(HERE))
    make_case(*sys.argv[1:4])
