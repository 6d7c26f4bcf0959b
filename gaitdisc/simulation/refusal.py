"""What is wrong with a simulation, and in which of its parts."""

from __future__ import annotations

from gaitdisc.errors import SchemaError


class SimulationError(SchemaError):
    """A simulation cannot be what it claims to be.

    place: section and key of the simulation file, `("equations", "omega")`; empty where the whole file is meant

    >>> SimulationError("every name is known", "'omgea' is not", "Write 'omega'.").at("equations", "omega").place
    ('equations', 'omega')
    """

    def __init__(self, needed: str, found: str, remedy: str, place: tuple[str, ...] = ()) -> None:
        super().__init__(needed, found, remedy)
        self.place = place

    def __str__(self) -> str:
        where = f"[{self.place[0]}] {' '.join(self.place[1:])}".rstrip() + ": " if self.place else ""
        return where + super().__str__()

    def at(self, *place: str) -> SimulationError:
        """Return the same refusal, of a part of the simulation."""
        return SimulationError(self.needed, self.found, self.remedy, place)
