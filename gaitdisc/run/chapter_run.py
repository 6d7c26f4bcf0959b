"""A part of a chapter: its study runs as a program of its own, as from a checkout; what is finished is kept."""

import hashlib
import os
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple

from gaitdisc.errors import SchemaError, TrainingError
from gaitdisc.own_files import claim_folder
from gaitdisc.run.chapter_parts import OUT, Part, studies_folder
from gaitdisc.saved.provenance import code_sha256
from gaitdisc.saved.unit_folder import read_sealed, seal_text
from gaitdisc.whole_file import write_whole
from gaitdisc.write_lock import write_lock

NAME = "chapter.json"  # in the folder of a part, before anything else
PRINTED = "printed.md"  # what the study prints: its table, as Markdown
SAID = "said.txt"  # where the study failed: all that it said
WAITED_S = 0.2


class Made(NamedTuple):
    """A part that stands: its folder, and whether it stood there before."""

    folder: Path
    kept: bool


def find_lack(part: Part, data: Path | None) -> SchemaError | None:
    """The refusal of a part that cannot be computed on this machine; None where it can."""
    needs = f"part {part.name} of chapter {part.chapter} must have"
    libraries = [name for name in part.needs if find_spec(name) is None]
    if libraries:
        words = " and ".join(libraries)
        return SchemaError(f"{needs} {words}", "these are not installed", "Run: pip install 'gaitdisc[chapter3]'.")
    folder = _data_folder(data)
    if part.data and not (folder / part.data).is_dir():
        do = "Name the folder of the data with --data or GAITDISC_DATA."
        return SchemaError(f"{needs} the data of {part.data}", f"{folder} has no such folder", do)
    return None


def run_part(
    part: Part, out: Path, quick: bool, data: Path | None, ticked: Callable[[float], None] = lambda _: None
) -> Made:
    """Compute a part in `out/<part>`, or keep it where the same code has computed it there; a stopped one goes on."""
    if lack := find_lack(part, data):
        raise lack
    folder = out / part.name
    digest = hashlib.sha256(code_sha256().encode())
    for path in sorted(path for path in studies_folder().rglob("*") if path.suffix in (".py", ".csv", ".toml")):
        digest.update(path.read_bytes())
    begun = {"part": part.name, "quick": quick, "code": digest.hexdigest()[:12]}
    if _stands(folder, begun):
        return Made(folder, True)
    claim_folder(folder, NAME, PRINTED, mended=(NAME,))
    with write_lock(folder, run=True):
        write_whole(folder / NAME, seal_text({**begun, "seconds": None}))
        started = time.perf_counter()
        write_whole(folder / PRINTED, _study(part, folder, quick, data, ticked))
        write_whole(folder / NAME, seal_text({**begun, "seconds": round(time.perf_counter() - started, 1)}))
    return Made(folder, False)


def _stands(folder: Path, begun: dict[str, Any]) -> bool:
    """Whether the part was finished there by this code; refused where the folder holds something else."""
    if not folder.is_dir() or not any(not path.name.startswith(".") for path in folder.iterdir()):
        return False
    if not (folder / NAME).is_file():
        raise SchemaError(
            "each part of a chapter must have its own folder",
            f"{folder} contains {', '.join(sorted(path.name for path in folder.iterdir())[:3])}, but no {NAME}",
            "Choose another folder.",
        )
    held = read_sealed(folder / NAME)
    for key, words in (
        ("quick", ("the full study", "the quick study")),
        ("code", ("another version of the code",) * 2),
    ):
        if held.get(key) != begun[key]:
            raise SchemaError(
                "all results in a folder must come from one version of the program, and all be quick or all be full",
                f"{folder} contains results of {words[bool(held.get(key))]}",
                "Choose another folder, or delete this one.",
            )
    return held["seconds"] is not None


def _study(part: Part, folder: Path, quick: bool, data: Path | None, ticked: Callable[[float], None]) -> str:
    """Run the study of a part to its end, and return what it printed."""
    called = (part.quick_words or (*part.words, "--quick")) if quick else part.words
    words = [str(folder) if word == OUT else word for word in called]
    command = [sys.executable, str(studies_folder() / f"{part.study}.py"), *words]
    package = str(Path(__file__).parents[2])
    paths = os.pathsep.join(filter(None, (package, os.environ.get("PYTHONPATH", ""))))
    environment = {**os.environ, "PYTHONPATH": paths, "PYTHONUTF8": "1", "GAITDISC_DATA": str(_data_folder(data))}
    error_log = folder / SAID
    started = time.perf_counter()
    with (folder / ".part-printed").open("wb+") as printed, error_log.open("wb") as errors:
        process = subprocess.Popen(command, stdout=printed, stderr=errors, env=environment)
        try:
            while process.poll() is None:
                with suppress(subprocess.TimeoutExpired):
                    process.wait(WAITED_S)
                ticked(time.perf_counter() - started)
        finally:
            process.kill()
            process.wait()
        printed.seek(0)
        text = printed.read().decode("utf-8")
    (folder / ".part-printed").unlink()
    if process.returncode:
        lines = error_log.read_text(encoding="utf-8").strip().splitlines()
        raise TrainingError(
            f"part {part.name} of chapter {part.chapter} cannot be computed",
            f"its study ended with {lines[-1] if lines else f'exit code {process.returncode}'}",
            f"Read its complete output in {error_log}.",
        )
    error_log.unlink()
    return text


def _data_folder(data: Path | None) -> Path:
    return data or Path(os.environ.get("GAITDISC_DATA", studies_folder().parents[1] / "shared" / "data"))
