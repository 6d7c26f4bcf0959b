"""The scripts of docs/library.md, run as they stand, and their pictures.

    python studies/library_pictures.py

Writes docs/pictures.
"""

from __future__ import annotations

from command_line import command_line

GIVEN = command_line(__name__, __doc__)

import re
import shutil
import tempfile
from contextlib import chdir
from pathlib import Path

DOCS = Path(__file__).parents[1] / "docs"
PICTURES = ("cycles", "discovery", "response", "reconstruction")
MOST_LINES = 10


def blocks(page: Path = DOCS / "library.md") -> list[str]:
    """All code of the page."""
    return re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)


def scripts() -> dict[str, str]:
    """Scripts of the page that draw, by the picture that each writes."""
    return {name: block for name in PICTURES for block in blocks() if f'savefig("{name}.png")' in block}


def run_script(text: str, folder: Path) -> None:
    """Run a script in a folder, as a newcomer would, without a screen."""
    import matplotlib as mpl
    import matplotlib.pyplot as plt

    mpl.use("Agg")
    plt.close("all")
    with chdir(folder):
        exec(compile(text, "docs/library.md", "exec"), {"__name__": "__main__"})


if __name__ == "__main__":
    for name, text in scripts().items():
        with tempfile.TemporaryDirectory() as folder:
            run_script(text, Path(folder))
            (DOCS / "pictures").mkdir(exist_ok=True)
            shutil.copy(Path(folder) / f"{name}.png", DOCS / "pictures" / f"{name}.png")
