"""Expressions from expressions: names put in place of others, everything a while ago, and back to text."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from gaitdisc.simulation.expression import Name, Number, Operation, Tree

_RANK = {"+": 1, "-": 1, "*": 2, "/": 2, "neg": 3, "**": 4}


def substituted(tree: Tree, by: Mapping[str, Tree], signals: Collection[str] = ()) -> Tree:
    """Expression with other expressions in the place of names.

    A delayed signal that is replaced becomes its replacement that many seconds ago.

    >>> from gaitdisc.simulation.expression import parsed
    >>> written(substituted(parsed("k*tau + delay(tau, d)"), {"tau": parsed("g*tau")}, ["tau"]))
    'k*(g*tau) + g*delay(tau, d)'
    """
    if isinstance(tree, Name):
        return by.get(tree.name, tree)
    if isinstance(tree, Number):
        return tree
    if tree.symbol == "delay" and isinstance(tree.arguments[0], Name) and tree.arguments[0].name in by:
        signal, seconds = tree.arguments
        return _ago(substituted(signal, by, signals), substituted(seconds, by, signals), signals)
    return Operation(tree.symbol, tuple(substituted(argument, by, signals) for argument in tree.arguments))


def written(tree: Tree) -> str:
    """Text of an expression, with no more parentheses than it needs.

    >>> from gaitdisc.simulation.expression import parsed
    >>> written(parsed("-(a + b)*(c**-(2)) - ((d))"))
    '-(a + b)*c**-2 - d'
    """
    return _written(tree)[0]


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


def _written(tree: Tree) -> tuple[str, int]:
    """Text, and how tightly it binds."""
    if isinstance(tree, Number):
        text = repr(tree.value).removesuffix(".0")
        return text, 3 if text.startswith("-") else 5
    if isinstance(tree, Name):
        return tree.name, 5
    if tree.symbol not in _RANK:
        return f"{tree.symbol}({', '.join(_written(argument)[0] for argument in tree.arguments)})", 5
    rank = _RANK[tree.symbol]
    if tree.symbol == "neg":
        text, inner = _written(tree.arguments[0])
        return (f"-{text}" if inner > rank else f"-({text})"), rank
    (left, left_rank), (right, right_rank) = map(_written, tree.arguments)
    if left_rank < rank or (tree.symbol == "**" and left_rank <= rank):
        left = f"({left})"
    if right_rank < (3 if tree.symbol == "**" else rank + 1):
        right = f"({right})"
    return f"{left} {tree.symbol} {right}" if rank == 1 else f"{left}{tree.symbol}{right}", rank
