"""Every module of the package has a test file at the same place under tests/."""

from __future__ import annotations

from pathlib import Path

import gaitdisc

PACKAGE = Path(gaitdisc.__file__).parent
TESTS = Path(__file__).parent


def test_every_module_has_its_test_file():
    missing = []
    for path in PACKAGE.rglob("*.py"):
        relative = path.relative_to(PACKAGE)
        if relative.name in ("__init__.py", "__main__.py") or "data_schema" in relative.parts:
            continue
        if not (TESTS / relative.parent / f"test_{relative.name}").exists():
            missing.append(str(relative))
    assert not missing, f"no test file for: {', '.join(sorted(missing))}"
