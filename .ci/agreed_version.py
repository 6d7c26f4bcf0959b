"""The version that is to be released, where pyproject.toml, the package, CITATION.cff and CHANGELOG.md agree on it.

python .ci/agreed_version.py [FOLDER]
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

PLACES = {
    "pyproject.toml": r'^version = "([^"]+)"',
    "gaitdisc/_version.py": r'^__version__ = "([^"]+)"',
    "CITATION.cff": r"^version: (\S+)",
    "CHANGELOG.md": r"^## (\S+)",  # the newest stands first
}
DATED = r"^## {} \(\d{{4}}-\d{{2}}-\d{{2}}\)$"


def disagreements(folder: Path) -> list[str]:
    """What has to be mended before a release, a sentence each; none where all agree and the changes have their date."""
    found = {}
    for name, pattern in PLACES.items():
        text = (folder / name).read_text(encoding="utf-8")
        match = re.search(pattern, text, re.MULTILINE)
        found[name] = match[1] if match else "no version"
    wanted = found["pyproject.toml"]
    wrong = [f"{name} says {said}, pyproject.toml {wanted}" for name, said in found.items() if said != wanted]
    changes = (folder / "CHANGELOG.md").read_text(encoding="utf-8")
    if not wrong and not re.search(DATED.format(re.escape(wanted)), changes, re.MULTILINE):
        wrong.append(f"CHANGELOG.md has no date: write '## {wanted} (YYYY-MM-DD)' on the day of the release")
    return wrong


def main() -> None:
    """Print the version, or what disagrees."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[1]
    wrong = disagreements(folder)
    if wrong:
        sys.exit("not to be released:\n" + "\n".join(f"  {line}" for line in wrong))
    print(re.search(PLACES["pyproject.toml"], (folder / "pyproject.toml").read_text(encoding="utf-8"), re.MULTILINE)[1])


if __name__ == "__main__":
    main()
