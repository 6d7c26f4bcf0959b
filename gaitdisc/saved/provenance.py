"""What a result rests on, and who or what is left out of it."""

import hashlib
import platform
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from gaitdisc._version import __version__

DISTRIBUTIONS = ("numpy", "scipy", "torch", "pandas", "ezc3d")


@dataclass(frozen=True)
class Provenance:
    """Settings and circumstances of a result.

    >>> Provenance({}, 0, {}, list_versions(), "4.2", "2026-01-01T00:00:00+00:00").seed
    0
    """

    settings: Mapping[str, Any]  # every setting that could change a number, as written in the study with all defaults
    seed: int
    files: Mapping[str, str]
    versions: Mapping[str, str]
    section: str  # part of the dissertation that the result follows
    created: str  # date and time, ISO 8601 with zone


def provenance_now(settings: Mapping[str, Any], seed: int, files: Mapping[str, str], section: str) -> Provenance:
    """Return what a result rests on that is computed now, by what is installed here.

    >>> provenance_now({}, 0, {}, "4.2").created[-6:]
    '+00:00'
    """
    created = datetime.now(UTC).isoformat(timespec="seconds")
    return Provenance(settings, seed, files, list_versions(), section, created)


def list_versions() -> dict[str, str]:
    """Versions of this package, of Python and of the libraries that compute the numbers."""
    package = f"{__version__} (code {code_sha256()[:12]})"
    versions = {"gaitdisc": package, "python": platform.python_version()}
    for name in DISTRIBUTIONS:
        try:
            versions[name] = version(name)
        except PackageNotFoundError:
            versions[name] = "absent"
    return versions


@cache
def code_sha256() -> str:
    """SHA-256 over the package's own source: results of other code are not taken for those of this one."""
    digest = hashlib.sha256()
    package = Path(__file__).parents[1]
    for path in sorted(package.rglob("*.py")):
        if package / "studies" not in path.parents:  # in a wheel they lie in the package, in a checkout beside it
            digest.update(path.read_bytes())
    return digest.hexdigest()


@dataclass(frozen=True)
class Refusal:
    """A participant or a trial that is not in the tables, and why."""

    participant: str
    condition: str  # condition of the trial, or empty where the participant as a whole is refused
    reason: str
