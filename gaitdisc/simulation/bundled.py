"""Simulations that come with the package, as files that a person can read and copy."""

from __future__ import annotations

from pathlib import Path

from gaitdisc.channel import nearest_word
from gaitdisc.errors import ReadError
from gaitdisc.simulation.simulation import Simulation
from gaitdisc.simulation.simulation_file import read_simulation

_FOLDER = Path(__file__).parent / "systems"


def bundled_names() -> tuple[str, ...]:
    """Names of the simulations that come with the package.

    >>> "lorenz" in bundled_names()
    True
    """
    return tuple(sorted(path.stem for path in _FOLDER.glob("*.toml")))


def bundled(name: str) -> Simulation:
    """Simulation that comes with the package.

    Parameters
    ----------
    name : str
        `pendulum`, `lorenz` and so on; one that is none of them is refused with the list.

    Raises
    ------
    ReadError
        If there is none of that name.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> gd.bundled_simulation("pendulum").values()["length"]
    0.8
    """
    if name not in bundled_names():
        nearest = nearest_word(name, bundled_names())
        hint = f"Did you mean {nearest!r}? " if nearest else ""
        raise ReadError(
            "a simulation that comes with the package",
            f"there is none called {name!r}",
            f"{hint}Known: {', '.join(bundled_names())}.",
        )
    return read_simulation(_FOLDER / f"{name}.toml")
