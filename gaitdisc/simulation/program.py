"""Expressions compiled to data: a list of register operations that the machine interprets over many rows at once.

Equal parts are computed once. What depends on parameters alone comes first and is computed once a run (`setup`).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gaitdisc.errors import SimulationError
from gaitdisc.recording.arrays import Values
from gaitdisc.simulation.expression import Name, Number, Tree, written

CODES = {
    "store": 0, "+": 1, "-": 2, "*": 3, "/": 4, "**": 5, "neg": 6, "sin": 7, "cos": 8, "tan": 9, "tanh": 10, "exp": 11,
    "log": 12, "sqrt": 13, "abs": 14, "max": 15, "min": 16, "step": 17, "where": 18, "atan": 19,
}  # fmt: skip
ROUNDED = 0.02  # sign(a) is tanh(a/0.02), so that a fixed step can cross zero
_MOST_PRODUCTS = 8  # x**n is written as products up to this power
_COMMUTES = frozenset(["+", "*", "max", "min"])


@dataclass(frozen=True, eq=False)
class Program:
    """Register operations."""

    leaves: tuple[str, ...]  # names whose values the first registers hold, in order
    delays: tuple[tuple[str, Tree], ...]  # signal and seconds of what the next registers hold
    constants: Values  # (constant,), what the registers after those hold
    code: NDArray[np.int64]  # (operation, 4), operation, register (or output) written, registers read
    setup: int  # how many operations at the head depend on parameters alone
    registers: int
    outputs: int

    def placed(self, rows: int) -> NDArray[np.uint64]:
        """Code with first places in flat memory instead of the numbers of registers, (operation, 4)."""
        return (self.code * np.array([1, rows, rows, rows])).astype(np.uint64)

    def used(self) -> NDArray[np.bool_]:
        """Whether each leaf and each delay is read, (leaf and delay,)."""
        reads = np.zeros(self.registers, bool)
        reads[self.code[:, 2:].ravel()] = True
        return reads[: len(self.leaves) + len(self.delays)]


def compile_program(
    outputs: Sequence[Tree],
    leaves: Sequence[str],
    fixed: Sequence[str] = (),
    definitions: Mapping[str, Tree] | None = None,
    values: Mapping[str, float] | None = None,
) -> Program:
    """Program of some expressions.

    fixed: those of them that do not change during a run
    definitions: further names, in order, each in terms of leaves and of those before
    values: of leaves that are never another: what is multiplied by nothing then is left out

    >>> from gaitdisc.simulation.expression import parse
    >>> program = compile_program([parse("k*x + sin(k*x)")], ["x", "k"])
    >>> len(program.code)  # one product, one sine, one sum, one store
    4
    """
    graph = _Graph(leaves, values or {})
    for name, tree in (definitions or {}).items():
        graph.scope[name] = graph.node(tree)
    nodes = [graph.node(tree) for tree in outputs]
    return _lay_out(graph, nodes, frozenset(fixed))


class _Graph:
    """Every distinct part of the expressions once."""

    def __init__(self, leaves: Sequence[str], values: Mapping[str, float]) -> None:
        self.leaves, self.known = tuple(leaves), bool(values)
        self.parts: list[tuple] = []  # ("leaf", name) | ("delay", signal, text) | ("constant", value) | (symbol, a, b)
        self.delays: dict[tuple[str, str], Tree] = {}
        self._numbers: dict[tuple, int] = {}
        self.scope = {name: self._number_node(("leaf", name)) for name in leaves}
        self.scope |= {name: self.constant(value) for name, value in values.items()}

    def node(self, tree: Tree) -> int:
        if isinstance(tree, Number):
            return self.constant(tree.value)
        if isinstance(tree, Name):
            return self.scope[tree.name]
        if tree.symbol != "delay":
            return self._operation(tree.symbol, [self.node(argument) for argument in tree.arguments])
        signal, seconds = tree.arguments
        assert isinstance(signal, Name)  # checked with the simulation
        key = (signal.name, written(seconds))
        self.delays.setdefault(key, seconds)
        return self._number_node(("delay", *key))

    def constant(self, value: float) -> int:
        return self._number_node(("constant", value, np.signbit(value)))

    def _operation(self, symbol: str, arguments: list[int]) -> int:
        if symbol == "sign":
            return self._two("tanh", self._two("/", arguments[0], self.constant(ROUNDED)))
        if symbol in ("max", "min"):
            best = arguments[0]
            for argument in arguments[1:]:
                best = self._two(symbol, best, argument)
            return best
        if symbol == "**":
            return self._power(*arguments)
        return self._two(symbol, *arguments)

    def _power(self, base: int, exponent: int) -> int:
        kind, value, *_ = self.parts[exponent]
        value = value if kind == "constant" else None
        if value is None or value != int(value) or not 1 <= abs(value) <= _MOST_PRODUCTS:
            return self._two("**", base, exponent)
        power, rest, square = None, int(abs(value)), base
        while rest:
            if rest % 2:
                power = square if power is None else self._two("*", power, square)
            rest //= 2
            square = self._two("*", square, square) if rest else square
        assert power is not None  # the exponent is at least 1
        return power if value > 0 else self._two("/", self.constant(1.0), power)

    def _two(self, symbol: str, a: int, b: int | None = None) -> int:
        b = a if b is None else b
        if self.known:
            left, right, nothing = self.parts[a][:2], self.parts[b][:2], ("constant", 0.0)
            if symbol == "-" and left[0] == right[0] == "constant":
                return self.constant(left[1] - right[1])
            if symbol == "*" and nothing in (left, right):
                return self.constant(0.0)
            if symbol == "+" and nothing in (left, right):
                return b if left == nothing else a
        return self._number_node((symbol, *sorted((a, b))) if symbol in _COMMUTES else (symbol, a, b))

    def _number_node(self, part: tuple) -> int:
        if part not in self._numbers:
            self._numbers[part] = len(self.parts)
            self.parts.append(part)
        return self._numbers[part]


def _lay_out(graph: _Graph, outputs: list[int], fixed: frozenset[str]) -> Program:
    """Registers and order: leaves, delays, constants, what is fixed, then the rest in registers used again."""
    parts = graph.parts
    needed = _list_needed(parts, outputs)
    delayed = {key: len(graph.leaves) + i for i, key in enumerate(graph.delays)}
    register = {graph.scope[name]: i for i, name in enumerate(graph.leaves)}
    constants: list[float] = []
    still: set[int] = set()
    operations = []
    for node in needed:
        kind = parts[node][0]
        if kind == "leaf":
            still |= {node} if parts[node][1] in fixed else set()
        elif kind == "delay":
            register[node] = delayed[parts[node][1:]]
        elif kind == "constant":
            register[node] = len(graph.leaves) + len(delayed) + len(constants)
            constants.append(parts[node][1])
            still.add(node)
        else:
            operations.append(node)
            still |= {node} if set(parts[node][1:]) <= still else set()
    first = [node for node in operations if node in still]
    order = _Order(register, len(graph.leaves) + len(delayed) + len(constants))
    for node in first:
        order.add(node, parts[node], keep=True)
    setup = len(order.code)
    rest = [node for node in operations if node not in still]
    order.run(rest, parts, outputs)
    code = np.array(order.code, np.int64).reshape(-1, 4)
    seconds = tuple((signal, tree) for (signal, _), tree in graph.delays.items())
    return Program(graph.leaves, seconds, np.array(constants), code, setup, max(order.most, 1), outputs=len(outputs))


def _list_needed(parts: list[tuple], outputs: list[int]) -> list[int]:
    seen, stack = set(outputs), list(outputs)
    while stack:
        part = parts[stack.pop()]
        if part[0] not in ("leaf", "delay", "constant"):
            for argument in part[1:]:
                if argument not in seen:
                    seen.add(argument)
                    stack.append(argument)
    return sorted(seen)


class _Order:
    """Operations one after the other, and the registers that are free again."""

    def __init__(self, register: dict[int, int], taken: int) -> None:
        self.code: list[tuple[int, int, int, int]] = []
        self.most = taken
        self._register, self._free = register, []

    def add(self, node: int, part: tuple, keep: bool = False) -> None:
        if self._free and not keep:
            out = self._free.pop()
        else:
            out, self.most = self.most, self.most + 1
        self._register[node] = out
        self.code.append((CODES[part[0]], out, self._register[part[1]], self._register[part[2]]))

    def run(self, nodes: list[int], parts: list[tuple], outputs: list[int]) -> None:
        places: dict[int, list[int]] = {}
        for output, node in enumerate(outputs):
            places.setdefault(node, []).append(output)
        last = {argument: step for step, node in enumerate(nodes) for argument in parts[node][1:]}
        owned = set(nodes)
        for node in places.keys() - owned:
            self._store(node, places[node])
        for step, node in enumerate(nodes):
            self.add(node, parts[node])
            self._store(node, places.get(node, []))
            for argument in {*parts[node][1:], node}:
                if argument in owned and last.get(argument, step) == step:
                    self._free.append(self._register[argument])

    def _store(self, node: int, outputs: list[int]) -> None:
        self.code += [(CODES["store"], output, self._register[node], self._register[node]) for output in outputs]


def leaf_columns(t: ArrayLike, x: Values, u: Values, values: Values) -> list[Values]:
    """Time (point,), states, inputs and parameters (point, ...), column by column, in the order of a program."""
    return [np.asarray(t, float), *np.asarray(x, float).T, *np.asarray(u, float).T, *np.asarray(values, float).T]


def at_points(program: Program, columns: Sequence[Values], late: Values | None, points: int) -> Values:
    """Outputs of a program at many points, (output, point).

    columns each (point,) or (): values of its leaves; one number serves all points
    late (point, delay): delayed signals, where the program has any
    points: how many
    """
    if program.delays and (late is None or np.shape(late)[-1] != len(program.delays)):
        raise SimulationError(
            f"delayed signals must be given at each point: {', '.join((signal for signal, _ in program.delays))}",
            "they are missing",
            "Run the simulation, or give `late`.",
        )
    from gaitdisc.simulation.machine import BLOCK, evaluate_blocks

    used = program.used()
    spread, table = np.full(program.registers, 2, np.int64), np.empty((len(used), points))
    for leaf, column in enumerate([*columns, *(np.asarray(late).T if program.delays else ())]):
        if used[leaf]:
            spread[leaf] = int(np.ndim(column) > 0)
            table[leaf, : points if np.ndim(column) else 1] = column
    into = np.empty((program.outputs, points))
    evaluate_blocks(program.placed(BLOCK), program.constants, table, spread, into)
    return into
