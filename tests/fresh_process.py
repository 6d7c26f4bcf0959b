"""What a module loads, seen from a process that has loaded nothing else; work for processes that shall load little."""

import os
import subprocess
import sys

from gaitdisc.whole_file import write_whole


def modules_loaded_by(module: str) -> set[str]:
    """Names of all modules that a fresh Python has loaded once it has imported one."""
    code = f"import sys; sys.path[:0] = {sys.path!r}; import {module}; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-I", "-S", "-c", code], capture_output=True, text=True, check=True)
    return set(done.stdout.split())


def where(word):
    """A word, and the process that says it."""
    return word, os.getpid()


def written(folder, number, breaks, here):
    """Write a file; any process but this one breaks then."""
    write_whole(folder / f"{number}.txt", "drawn")
    if breaks and os.getpid() != here:
        os._exit(1)
