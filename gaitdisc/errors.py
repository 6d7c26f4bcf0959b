"""The error tree: every refusal says what was needed, what was found and what to do.

An error is raised where data enter (constructors, ingest, `train`) and never re-checked below. The command line prints
the sentence with its code and no traceback; anything that is not a `GaitdiscError` is a defect of this package.
"""

from __future__ import annotations

import logging

LOG = logging.getLogger("gaitdisc")  # progress; the command line prints it, a script attaches its own handler
LOG.addHandler(logging.NullHandler())


class GaitdiscError(ValueError):
    """A refusal that a user can act on.

    Parameters
    ----------
    needed : str
        Requirement of the operation, with the unit; empty if `found` states it.
    found : str
        Fault that was found: file, channel, frame, number, unit.
    remedy : str
        Instruction to the user, in one sentence.

    Examples
    --------
    >>> str(ChannelError("strides need a vertical force", "walk.mot has none", "Name it in [channels]."))
    'strides need a vertical force; walk.mot has none. Name it in [channels].'
    """

    def __init__(self, needed: str, found: str, remedy: str) -> None:
        super().__init__(needed, found, remedy)
        self.needed = needed
        self.found = found
        self.remedy = remedy

    def __str__(self) -> str:
        return f"{'; '.join(filter(None, (self.needed, self.found)))}. {self.remedy}"

    @property
    def code(self) -> str:
        """Short name of this kind of refusal, as explained in `docs/errors.md`."""
        return f"gd-{type(self).__name__.removesuffix('Error').lower()}"


class ReadError(GaitdiscError):
    """A file cannot be read as the recording that it claims to be."""


class MissingFileError(ReadError, FileNotFoundError):
    """There is no such file; a `FileNotFoundError` as well."""

    code = "gd-read"  # pyright: ignore


class WriteError(GaitdiscError):
    """A file cannot be written; an earlier file is unchanged."""


class SchemaError(GaitdiscError):
    """A study file, a results folder or a table does not have the required form."""


class SimulationError(SchemaError):
    """A simulation file or a model is not valid.

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


class ChannelError(GaitdiscError):
    """A channel is missing, duplicated or unknown."""


class UnitError(GaitdiscError):
    """A unit is absent, unknown, or contradicted by the magnitude of the numbers."""


class ShapeError(GaitdiscError):
    """Arrays that belong together differ in shape."""


class SamplingError(GaitdiscError):
    """Time does not advance evenly, or a recording is too short for the computation."""


class StrideError(GaitdiscError):
    """Strides cannot be cut: contacts are missing or out of order, or the trial is not a walk."""


class TrainingError(GaitdiscError):
    """A model cannot be fitted to the given samples."""


class ComparisonError(GaitdiscError):
    """Numbers cannot be compared by a test, because values are missing without a reason or pairs do not match."""
