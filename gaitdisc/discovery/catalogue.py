"""The catalogue of physical effects: shapes with unknown constants, read from a file that the user can extend."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from difflib import get_close_matches
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gaitdisc.discovery.result import ALPHA
from gaitdisc.errors import ReadError, SchemaError, SimulationError
from gaitdisc.regular_file import check_regular
from gaitdisc.simulation.expression import names as names_in
from gaitdisc.simulation.expression import parse
from gaitdisc.toml_text import parse_toml

if TYPE_CHECKING:
    from gaitdisc.discovery.candidate import Candidate
    from gaitdisc.discovery.result import Discovery
    from gaitdisc.discovery.scored_model import ScoredModel
    from gaitdisc.simulation.simulation import Simulation

ROLES = ("x", "v", "y", "a", "b", "u")
SIGNALS = ("t", "phase")
GRIDS = ("quantiles of x", "half widths of x", "delays", "frequencies", "phases", "phase widths")
NEEDS = ("", "angle")
LARGEST_CATALOGUE_BYTES = 2**20
_NAME = re.compile(r"[a-z_][a-z0-9_]*")
_WITHOUT_SIGN = re.compile(r"[a-z0-9_.]+(e[+-]\d+)?")  # a name or a number, which needs no brackets
_ENTRIES = ("name", "pieces", "states", "constants", "needs", "names", "means")


@dataclass(frozen=True)
class Shape:
    """A physical effect before it has a place: what it looks like and which of its numbers are unknown.

    >>> spring = Shape("one_sided_spring", ("max(0, x - x0)",), {"x0": "quantiles of x"})
    >>> spring.roles, spring.written({"x": "theta"})
    (('x',), ('max(0, theta - x0)',))
    """

    name: str  # the effect's name; several shapes may share one (a spring engaging above or below)
    # expressions of the roles x (a position-like state), v (its rate), y (another state), a and b (two states), u (an
    # input), of `t`, `phase` and the constants. Each piece has its own factor in the fit
    pieces: tuple[str, ...]
    # unknown numbers inside the shape, and the grid on which the search for each begins
    constants: Mapping[str, str] = field(default_factory=dict)
    needs: str = ""  # what the place must offer: `angle`, or nothing
    means: str = ""  # one clause that a person understands; `{x0}` in it is the constant x0
    # what a person calls its numbers: those of `factor`, `factor_1`, ... and of the constants
    names: Mapping[str, str] = field(default_factory=dict)
    # states that the effect brings along, and the time derivative of each; they may stand in the pieces
    states: Mapping[str, str] = field(default_factory=dict)

    @property
    def roles(self) -> tuple[str, ...]:
        """The roles that occur in it, in the order of ROLES."""
        texts = (*self.pieces, *self.states.values())
        seen = {word for text in texts for word in _NAME.findall(text)} - {*self.constants, *self.states}
        return tuple(role for role in ROLES if role in seen)

    @property
    def uses_phase(self) -> bool:
        """Whether the effect is locked to the stride."""
        return any("phase" in _NAME.findall(piece) for piece in self.pieces)

    def written(self, names: Mapping[str, str]) -> tuple[str, ...]:
        """Return the pieces with names or numbers put for roles and constants; what is not mentioned stays."""
        return tuple(with_names(piece, names) for piece in self.pieces)


@dataclass(frozen=True)
class Request:
    """What a user requests: effects of their own beside those that come along, or exactly some and no search.

    A door adds which explanations are possible there, how the numbers of what was found are fitted once more, and what
    it does with an answer before twins of the record are searched.
    """

    shapes: tuple[Shape, ...] = ()
    effects: tuple[str, ...] = ()  # `name@place`; nothing is searched where there are any
    catalogue: Path | None = None  # the file of the shapes
    alpha: float = ALPHA  # the greatest rate of false finds
    progress: Callable[[str], None] = field(default_factory=lambda: lambda _: None, compare=False)
    added: tuple[Candidate, ...] = ()  # explanations beside those of places, numbers and signals
    possible: Callable[[Candidate], bool] = field(default_factory=lambda: lambda _: True, compare=False)
    refitted: Callable[[ScoredModel], ScoredModel] = field(default_factory=lambda: lambda model: model, compare=False)
    twins: int = 0  # simulated records of each kind, which are searched as the record was
    answered: Callable[[Discovery, Simulation], object] = field(default_factory=lambda: lambda *_: None, compare=False)

    @classmethod
    def read(
        cls,
        catalogue: Path | None,
        effects: tuple[str, ...] = (),
        alpha: float = ALPHA,
        progress: Callable[[str], None] = lambda _: None,
        twins: int = 0,
    ) -> Request:
        """Read a catalogue, if there is one, and note the effects, the rate of false finds and the number of twins."""
        if not 0 < alpha < 1:
            raise SchemaError("alpha must lie between 0 and 1", f"found {alpha:g}", "Use 0.05, for example.")
        if twins < 0:
            raise SchemaError("the number of simulated records must be 0 or more", f"found {twins}", "Use 0 or 20.")
        return cls(read_catalogue(catalogue) if catalogue else (), effects, catalogue, alpha, progress, twins=twins)


ALL = Request()  # the effects that come along


def name_factors(pieces: Sequence[str]) -> list[str]:
    """Return the names of the factors of a shape's pieces: `factor`, `factor_1`, ..."""
    return [f"factor_{number}" if number else "factor" for number in range(len(pieces))]


def with_names(expression: str, names: Mapping[str, str]) -> str:
    """Return an expression with other names, numbers or expressions in the place of some of its names.

    >>> with_names("max(0, x - x0)", {"x": "hip - knee", "x0": "0.2"})
    'max(0, (hip - knee) - 0.2)'
    """

    def put(match: re.Match[str]) -> str:
        text = names.get(match.group(), match.group())
        return text if _WITHOUT_SIGN.fullmatch(text) else f"({text})"

    return _NAME.sub(put, expression)


@cache
def read_shapes() -> tuple[Shape, ...]:
    """Return the shapes that come with the package.

    >>> "coulomb_friction" in {shape.name for shape in read_shapes()}
    True
    """
    text = (files("gaitdisc") / "discovery" / "catalogue.toml").read_text(encoding="utf-8")
    return _shapes(parse_toml(text), "catalogue.toml")


def read_catalogue(path: Path | str) -> tuple[Shape, ...]:
    r"""Read effects of the user's own, in the form of the package's catalogue.

    >>> import tempfile
    >>> file = Path(tempfile.mkdtemp()) / "mine.toml"
    >>> _ = file.write_text('[[shape]]\nname = "quintic"\npieces = ["x**5"]\nmeans = "a very stiff spring"')
    >>> read_catalogue(file)[0].roles
    ('x',)
    """
    path = Path(path)
    try:
        check_regular(path, LARGEST_CATALOGUE_BYTES)
        content = parse_toml(path.read_text(encoding="utf-8"))
    except ReadError:
        raise
    except (OSError, ValueError) as error:
        raise SchemaError(
            "a catalogue must be a TOML file of [[shape]] entries", f"{path.name}: {error}", "Correct the file."
        ) from error
    return _shapes(content, path.name)


def _shapes(content: dict[str, Any], file: str) -> tuple[Shape, ...]:
    entries = content.get("shape")
    if not isinstance(entries, list) or not entries or set(content) != {"shape"}:
        raise SchemaError(
            "a catalogue must contain only [[shape]] entries",
            f"{file} has {', '.join(sorted(content)) or 'no entries'}",
            'Begin each effect with a line "[[shape]]", and remove all other sections.',
        )
    return tuple(_shape(entry, f"{file}, shape {number}") for number, entry in enumerate(entries, 1))


def _shape(entry: Any, where: str) -> Shape:
    if not isinstance(entry, dict):
        raise SchemaError("a shape must be a table", f"{where} is not", 'Begin each shape with a line "[[shape]]".')
    for key in entry:
        if key not in _ENTRIES:
            near = get_close_matches(key, _ENTRIES, 1)
            hint = f"Did you mean {near[0]}?" if near else "Remove the key."
            raise SchemaError(f"the keys of a shape must be among {', '.join(_ENTRIES)}", f"{where} has {key!r}", hint)
    name, pieces, constants = entry.get("name"), entry.get("pieces"), entry.get("constants", {})
    states = entry.get("states", {})
    if not isinstance(name, str) or not _NAME.fullmatch(name):
        raise SchemaError(
            "a shape's name must be lower-case words joined by _", f"{where} has {name!r}", 'Write name = "my_effect".'
        )
    if not isinstance(pieces, list) or not pieces or not all(isinstance(piece, str) for piece in pieces):
        raise SchemaError("pieces must be a list of expressions", f"{where} has {pieces!r}", 'Write pieces = ["x**2"].')
    if not isinstance(states, dict) or not all(_is_name(key) and isinstance(states[key], str) for key in states):
        raise SchemaError(
            "a shape's states must be names, each with its time derivative as an expression",
            f"{where} has {states!r}",
            'Write states = { z = "v - z/tau" }.',
        )
    for piece in (*pieces, *states.values()):
        _check_piece(piece, (*ROLES, *SIGNALS, *states, *(constants if isinstance(constants, dict) else ())), where)
    if not isinstance(constants, dict) or not all(grid in GRIDS for grid in constants.values()):
        raise SchemaError(
            f"the search grid of a constant must be one of {', '.join(GRIDS)}",
            f"{where} has {constants!r}",
            "Choose one of these.",
        )
    needs = entry.get("needs", "")
    if needs not in NEEDS:
        raise SchemaError('"needs" of a shape may be only "angle"', f"{where} has {needs!r}", "Remove the line.")
    names = entry.get("names", {})
    numbers = [*name_factors(pieces), *constants]
    if not isinstance(names, dict) or not set(names) <= set(numbers) or not all(map(_is_name, names.values())):
        raise SchemaError(
            f"a shape may give names only to its numbers: {', '.join(numbers)}",
            f"{where} has {names!r}",
            'Write names = { factor = "stiffness" }.',
        )
    means = str(entry.get("means", name.replace("_", " ")))
    return Shape(name, tuple(pieces), dict(constants), needs, means, names=dict(names), states=dict(states))


def _check_piece(piece: str, known: tuple[str, ...], where: str) -> None:
    try:
        written = set(names_in(parse(piece)))
    except SimulationError as error:
        fault = f"{where}, piece {piece[:60]!r}: {error.found}"
        raise SchemaError("pieces must be expressions, written as in a simulation file", fault, error.remedy) from error
    for name in sorted(written - set(known)):
        raise SchemaError(
            f"the expressions of a shape may use only {', '.join(known)}",
            f"{where}, piece {piece[:60]!r} has {name!r}",
            f'If {name} is a fitted constant, give it a search grid: constants = {{ {name} = "quantiles of x" }}.',
        )


def _is_name(text: Any) -> bool:
    return isinstance(text, str) and _NAME.fullmatch(text) is not None
