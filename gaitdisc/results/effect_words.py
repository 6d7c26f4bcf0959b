"""An effect and its place as they are said."""

from __future__ import annotations


def spoken(name: str) -> str:
    """Return an effect's name as it is said.

    Parameters
    ----------
    name : str
        As in discovery.md.

    Examples
    --------
    >>> spoken("one_sided_spring"), spoken("coulomb_friction")
    ('one-sided spring', 'Coulomb friction')
    """
    return name.replace("one_sided", "one-sided").replace("coulomb", "Coulomb").replace("_", " ")


def at_place(kind: str, place: str) -> str:
    """Say where something enters.

    Parameters
    ----------
    kind, place : str
        `port` and its name, `equation` and its state, ...

    Examples
    --------
    >>> at_place("port", "ankle_moment"), at_place("equation", "v")
    ('at the ankle_moment port', 'in the equation of v')
    """
    if kind == "port":
        return f"at the {place} port"
    return f"in the {kind} {place}" if kind != "equation" else f"in the equation of {place}"
