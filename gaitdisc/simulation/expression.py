"""Expressions of a simulation file: arithmetic on names, parsed into a small tree of our own; nothing is ever executed.

Python's `ast` only splits the text; what is kept of it is numbers, names, `+ - * / **`, unary minus and calls of the
functions below. Length, nesting and size are bounded before and while the tree is built.
"""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache

from gaitdisc.channel import did_you_mean
from gaitdisc.errors import SimulationError

LONGEST, DEEPEST, LARGEST = 20_000, 250, 4_000  # characters, nesting, nodes
FUNCTIONS = {  # name: fewest and most arguments
    **dict.fromkeys(("sin", "cos", "tan", "atan", "tanh", "exp", "log", "sqrt", "abs", "sign", "step"), (1, 1)),
    **dict.fromkeys(("max", "min"), (2, 16)),
    **dict.fromkeys(("where", "delay"), (2, 2)),
}
RESERVED = frozenset({*FUNCTIONS, "t"})
_ALLOWED = f"numbers, names, + - * / ** ( ) and {' '.join(FUNCTIONS)}"
_STRANGE = re.compile(r"[^A-Za-z0-9_+\-*/(),. \t\r\n]|\b(?:0[xXbBoO]|\d+_)\w+")
_BINARY = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Pow: "**"}
_WORDS = {
    ast.Attribute: ("a dot after a name", "Names contain no dots. Write the decimal point after a digit."),
    ast.Lambda: ("a lambda", "Write only arithmetic."),
    ast.IfExp: (
        "if and else",
        "Use step(a), which is 1 if a > 0 and otherwise 0, or where(a, b), which is b if a > 0.",
    ),
    ast.BoolOp: ("'and' or 'or'", "Use products, max and min of step(...)."),
    ast.Compare: ("a comparison", "Use step(a - b) for a > b."),
    ast.FloorDiv: ("//", "Divide with /."),
    ast.Tuple: ("a comma outside a function", "Write a decimal point, not a comma."),
}
_SIGNS = {
    "^": "Write powers as x**2.",
    "=": "Write the right-hand side only.",
    ">": "Use step(a - b) for a > b.",
    "<": "Use step(b - a) for a < b.",
}
_RANK = {"+": 1, "-": 1, "*": 2, "/": 2, "neg": 3, "**": 4}


@dataclass(frozen=True, slots=True)
class Number:
    """A finite number."""

    value: float


@dataclass(frozen=True, slots=True)
class Name:
    """A name that the simulation gives a value to."""

    name: str  # state, input, parameter, port, definition or `t`


@dataclass(frozen=True, slots=True)
class Operation:
    """An operation on other expressions."""

    symbol: str  # `+ - * / **`, `neg`, or a function's name
    arguments: tuple[Tree, ...]


Tree = Number | Name | Operation


@lru_cache(maxsize=4096)
def parse(text: str) -> Tree:
    """Tree of an expression.

    >>> parse("-k*x")
    Operation(symbol='*', arguments=(Operation(symbol='neg', arguments=(Name(name='k'),)), Name(name='x')))
    """
    if len(text) > LONGEST:
        raise SimulationError(
            f"an expression may have at most {LONGEST} characters",
            f"this one has {len(text)}: {text[:30]!r}...",
            "Split it with [definitions].",
        )
    strange = _STRANGE.search(text)
    if strange:
        raise _refusal(text, strange.start(), f"{strange[0]!r}", _remedy(strange[0]))
    flat = re.sub(r"\s", " ", text)
    start = len(flat) - len(flat.lstrip())
    if start == len(flat):
        raise SimulationError("an expression must not be empty", "the text is empty", "Write 0 if nothing acts.")
    try:
        body = ast.parse(flat.strip(), mode="eval").body
        return _Conversion(text, start).tree(body, 1)
    except SyntaxError as error:
        at = start + (error.offset or 1) - 1
        raise _refusal(text, min(at, len(text) - 1), f"{error.msg}", "Correct the expression.") from None
    except (MemoryError, RecursionError, ValueError) as error:
        if isinstance(error, SimulationError):
            raise
        raise _too_large(text) from None


def names(tree: Tree) -> Iterator[str]:
    """Names in an expression, each as often as it stands there.

    >>> sorted(set(names(parse("-k*max(0, x - x0) + k"))))
    ['k', 'x', 'x0']
    """
    return (part.name for part in _each_part(tree) if isinstance(part, Name))


def delays(tree: Tree) -> Iterator[Operation]:
    """Every `delay(signal, seconds)` of an expression.

    >>> [each.arguments[0].name for each in delays(parse("1 - 2*delay(v, 0.1)"))]
    ['v']
    """
    return (part for part in _each_part(tree) if isinstance(part, Operation) and part.symbol == "delay")


def _each_part(tree: Tree) -> Iterator[Tree]:
    yield tree
    for argument in tree.arguments if isinstance(tree, Operation) else ():
        yield from _each_part(argument)


def unknown_name(text: str, name: str, known: tuple[str, ...]) -> SimulationError:
    """Refusal of a name that has no value, with the nearest one that has.

    >>> unknown_name("b*omgea", "omgea", ("omega", "b")).remedy
    "Did you mean 'omega'? Known names: omega, b."
    """
    match = re.search(rf"\b{re.escape(name)}\b", text)
    listed = ", ".join(known[:30]) + (", ..." if len(known) > 30 else "")
    remedy = f"{did_you_mean(name, known)} Known names: {listed}.".lstrip()
    return _refusal(text, match.start() if match else 0, f"the unknown name {name!r}", remedy)


class _Conversion:
    """From Python's tree to ours, counting as it goes."""

    def __init__(self, text: str, start: int) -> None:
        self._text, self._start, self._nodes = text, start, 0

    def tree(self, node: ast.expr, depth: int) -> Tree:
        self._nodes += 1
        if depth > DEEPEST or self._nodes > LARGEST:
            raise _too_large(self._text)
        if isinstance(node, ast.Constant):
            return self._number(node)
        if isinstance(node, ast.Name):
            return Name(node.id)
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.UAdd):
            inner = self.tree(node.operand, depth + 1)
            if isinstance(node.op, ast.UAdd):
                return inner
            return Number(-inner.value) if isinstance(inner, Number) else Operation("neg", (inner,))
        if isinstance(node, ast.BinOp) and type(node.op) in _BINARY:
            sides = (self.tree(node.left, depth + 1), self.tree(node.right, depth + 1))
            return Operation(_BINARY[type(node.op)], sides)
        if isinstance(node, ast.Call):
            return self._call(node, depth)
        kind = type(node.op) if isinstance(node, ast.BinOp | ast.UnaryOp) else type(node)
        piece, remedy = _WORDS.get(kind, (f"{kind.__name__}, which is not arithmetic", f"Use {_ALLOWED}."))
        raise self._refuse(node, piece, remedy)

    def _number(self, node: ast.Constant) -> Number:
        if type(node.value) not in (int, float):
            raise self._refuse(node, f"{node.value!r}, which is not a number", "Write a decimal number.")
        try:
            value = float(node.value)  # pyright: ignore[reportArgumentType]
        except OverflowError:
            value = math.inf
        if not math.isfinite(value):
            raise self._refuse(node, "a number above 1.8e308", "Write a finite number.")
        return Number(value)

    def _call(self, node: ast.Call, depth: int) -> Operation:
        if not isinstance(node.func, ast.Name) or node.keywords:
            raise self._refuse(node, "a call of something other than a named function", f"Use only {_ALLOWED}.")
        name, count = node.func.id, len(node.args)
        if name not in FUNCTIONS:
            remedy = f"{did_you_mean(name, FUNCTIONS)} Use only {_ALLOWED}.".lstrip()
            raise self._refuse(node, f"the unknown function {name!r}", remedy)
        fewest, most = FUNCTIONS[name]
        if not fewest <= count <= most:
            allowed = f"{fewest}" if fewest == most else f"{fewest} to {most}"
            raise self._refuse(node, f"{name} with {count} arguments", f"Give {name} {allowed}.")
        return Operation(name, tuple(self.tree(argument, depth + 1) for argument in node.args))

    def _refuse(self, node: ast.expr, piece: str, remedy: str) -> SimulationError:
        return _refusal(self._text, self._start + node.col_offset, piece, remedy)


def _refusal(text: str, at: int, piece: str, remedy: str) -> SimulationError:
    line, column = text.count("\n", 0, at) + 1, at - (text.rfind("\n", 0, at) + 1) + 1
    around = text[max(0, at - 20) : at + 30].replace("\n", " ")
    where = f"line {line}, column {column}" if "\n" in text else f"column {column}"
    return SimulationError("expressions must be arithmetic on names", f"at {where} ({around!r}) found {piece}", remedy)


def _remedy(strange: str) -> str:
    if strange.isdigit() or len(strange) > 1:  # full-width digits, hexadecimal ones, 1_000
        return "Write a decimal number, such as 16 or 1.6e1."
    return _SIGNS.get(strange, f"Use only {_ALLOWED}.")


def _too_large(text: str) -> SimulationError:
    return SimulationError(
        f"an expression may be nested at most {DEEPEST} deep and have at most {LARGEST} parts",
        f"this one exceeds a limit: {text[:30]!r}...",
        "Split it with [definitions].",
    )


def substitute(tree: Tree, by: Mapping[str, Tree], signals: Collection[str] = ()) -> Tree:
    """Expression with other expressions in the place of names.

    A delayed signal that is replaced becomes its replacement that many seconds ago.

    >>> written(substitute(parse("k*tau + delay(tau, d)"), {"tau": parse("g*tau")}, ["tau"]))
    'k*(g*tau) + g*delay(tau, d)'
    """
    if isinstance(tree, Name):
        return by.get(tree.name, tree)
    if isinstance(tree, Number):
        return tree
    if tree.symbol == "delay" and isinstance(tree.arguments[0], Name) and tree.arguments[0].name in by:
        signal, seconds = tree.arguments
        return _ago(substitute(signal, by, signals), substitute(seconds, by, signals), signals)
    return Operation(tree.symbol, tuple(substitute(argument, by, signals) for argument in tree.arguments))


def written(tree: Tree) -> str:
    """Text of an expression, with no more parentheses than it needs.

    >>> written(parse("-(a + b)*(c**-(2)) - ((d))"))
    '-(a + b)*c**-2 - d'
    """
    return _write_text(tree)[0]


def _ago(tree: Tree, seconds: Tree, signals: Collection[str]) -> Tree:
    """Expression as it was some seconds ago."""
    if isinstance(tree, Name):
        if tree.name == "t":
            return Operation("-", (tree, seconds))
        return Operation("delay", (tree, seconds)) if tree.name in signals else tree
    if isinstance(tree, Number):
        return tree
    if tree.symbol == "delay":
        signal, before = tree.arguments
        return Operation("delay", (signal, Operation("+", (before, seconds))))
    return Operation(tree.symbol, tuple(_ago(argument, seconds, signals) for argument in tree.arguments))


def _write_text(tree: Tree) -> tuple[str, int]:
    """Text, and how tightly it binds."""
    if isinstance(tree, Number):
        text = repr(tree.value).removesuffix(".0")
        return text, 3 if text.startswith("-") else 5
    if isinstance(tree, Name):
        return tree.name, 5
    if tree.symbol not in _RANK:
        return f"{tree.symbol}({', '.join(_write_text(argument)[0] for argument in tree.arguments)})", 5
    rank = _RANK[tree.symbol]
    if tree.symbol == "neg":
        text, inner = _write_text(tree.arguments[0])
        return (f"-{text}" if inner > rank else f"-({text})"), rank
    (left, left_rank), (right, right_rank) = map(_write_text, tree.arguments)
    if left_rank < rank or (tree.symbol == "**" and left_rank <= rank):
        left = f"({left})"
    if right_rank < (3 if tree.symbol == "**" else rank + 1):
        right = f"({right})"
    return f"{left} {tree.symbol} {right}" if rank == 1 else f"{left}{tree.symbol}{right}", rank
