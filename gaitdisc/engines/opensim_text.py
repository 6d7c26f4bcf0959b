"""Insertions into the text of an .osim file: a force of an expression, and numbers of the user's own elements."""

from __future__ import annotations

import re
from xml.sax.saxutils import escape, quoteattr

import numpy as np

from gaitdisc.simulation.expression import Name, Number, Tree, parsed
from gaitdisc.simulation.parts import Term

ALLOWED = ("sin", "cos", "tan", "tanh", "exp", "sqrt", "min", "max")
BINARY = {"+": "+", "-": "-", "*": "*", "/": "/", "**": "^"}


def with_effect(text: str, term: Term, names: tuple[str, str], coordinate: str) -> str | None:
    """Text with a force of an expression on a coordinate; None where the expression knows more than that coordinate.

    names: coordinate and speed as the term calls them
    coordinate: as the file calls it
    """
    expression = _translated(parsed(term.term), {names[0]: "q", names[1]: "qdot"})
    found = re.search(r"<ForceSet\b.*?</ForceSet>", text, re.DOTALL)
    if expression is None or found is None:
        return None
    own = (
        f"<ExpressionBasedCoordinateForce name={quoteattr(f'{term.name}_{coordinate}')}>"
        f"<coordinate>{escape(coordinate)}</coordinate><expression>{escape(expression)}</expression>"
        "</ExpressionBasedCoordinateForce>\n"
    )
    whole = found[0]
    empty = re.search(r"<objects\s*/>", whole)
    at = whole.rfind("</objects>")
    if at >= 0:  # the last: the first ones are those of muscles' paths
        whole = f"{whole[:at]}{own}{whole[at:]}"
    elif empty:
        whole = f"{whole[: empty.start()]}<objects>\n{own}</objects>{whole[empty.end() :]}"
    else:
        return None
    return text[: found.start()] + whole + text[found.end() :]


def with_value(text: str, name: str, value: float) -> str | None:
    """Text with a mass, an optimal force or gravity changed; None where the file does not say it."""
    if name == "gravity":
        found = re.search(r"(<gravity>)([^<]*)(</gravity>)", text)
        if not found:
            return None
        vector = np.array([float(word) for word in found[2].split()])
        return text[: found.start(2)] + _words(vector * (value / np.linalg.norm(vector))) + text[found.end(2) :]
    kind, part, word = ("Body", name.removesuffix("_mass"), "mass")
    if name.endswith("_optimal_force"):
        kind, part, word = "CoordinateActuator", name.removesuffix("_optimal_force"), "optimal_force"
    if name.endswith("_max_isometric_force"):  # of a muscle of any kind
        kind, part, word = r"\w*Muscle", name.removesuffix("_max_isometric_force"), "max_isometric_force"
    found = re.search(rf"<({kind}) name={re.escape(quoteattr(part))}>.*?</\1>", text, re.DOTALL)
    own = re.search(rf"(<{word}>)([^<]*)(</{word}>)", found[0]) if found else None
    if found is None or own is None:
        return None
    changed = f"{found[0][: own.start(2)]}{value!r}{found[0][own.end(2) :]}"
    if word == "mass":
        share = value / float(own[2])
        changed = re.sub(r"(<inertia>)([^<]*)(</inertia>)", lambda inertia: _scaled(inertia, share), changed, count=1)
    return text[: found.start()] + changed + text[found.end() :]


def _scaled(found: re.Match[str], share: float) -> str:
    return found[1] + _words(np.array([float(word) for word in found[2].split()]) * share) + found[3]


def _words(vector: np.ndarray) -> str:
    return " ".join(repr(float(each)) for each in vector)


def _translated(tree: Tree, names: dict[str, str]) -> str | None:
    """Expression as OpenSim writes it; None where it has a name or a function that OpenSim does not know there."""
    if isinstance(tree, Number):
        return repr(tree.value)
    if isinstance(tree, Name):
        return names.get(tree.name)
    parts = [_translated(one, names) for one in tree.arguments]
    if None in parts:
        return None
    return _operation(tree.symbol, [f"({part})" for part in parts])


def _operation(symbol: str, given: list[str]) -> str | None:
    if symbol in BINARY:
        return BINARY[symbol].join(given)
    written = {
        "neg": f"(-1)*{given[0]}",
        "abs": f"sqrt({given[0]}*{given[0]})",
        "sign": f"tanh({given[0]}/0.02)",  # as this package rounds its corner
    }
    return written.get(symbol) or (f"{symbol}({','.join(given)})" if symbol in ALLOWED else None)
