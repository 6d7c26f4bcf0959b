"""What a module loads, seen from a process that has loaded nothing else."""

import subprocess
import sys


def modules_loaded_by(module: str) -> set[str]:
    """Names of all modules that a fresh Python has loaded once it has imported one."""
    code = f"import sys; sys.path[:0] = {sys.path!r}; import {module}; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-I", "-S", "-c", code], capture_output=True, text=True, check=True)
    return set(done.stdout.split())
