"""The equations of a plain Python function: called once with names in place of numbers, it writes down what it does.

Every number that the function computes is then an expression in the names of its arguments. At an `if` on such a
number the function is called once for each way it can go, and the two answers are joined by `step`.
"""

from __future__ import annotations

import builtins
import functools
import math
import sys
from collections.abc import Callable, Mapping, Sequence
from types import CellType, CodeType, FunctionType, MethodType, SimpleNamespace
from typing import Any

import numpy as np

from gaitdisc.simulation.expression import DEEPEST, LARGEST, Name, Number, Operation, Tree

MOST_WAYS = 64  # in which the function's branches can be taken
INSIDE = ("__wrapped__", "py_func")  # of what remembers its answers (functools), of what is compiled (numba)
_ZERO, _ONE = Number(0.0), Number(1.0)


class NotTraced(Exception):  # noqa: N818 no error: the function is called then
    """What a function does cannot be written as expressions."""


class _Undecided(BaseException):  # no `except Exception` of the function may take it
    """A branch on a number whose sign is not known."""

    def __init__(self, condition: Tree) -> None:
        super().__init__()
        self.condition = condition


def _called(symbol: str, swapped: bool = False) -> Callable[..., Quantity]:
    return lambda *arguments: _operation(symbol, *(arguments[::-1] if swapped else arguments))


def _comparison(of: Callable[[Any, Any], Condition]) -> Callable[[Any, Any], Any]:
    """A comparison with a number; an array does it number by number."""
    return lambda quantity, other: NotImplemented if isinstance(other, np.ndarray) else of(quantity, other)


class Quantity:
    """A number that is known by its expression alone; what is computed with it is such a number again."""

    def __init__(self, tree: Tree, ways: Mapping[Tree, bool], size: int = 1, depth: int = 1) -> None:
        self.tree, self.ways, self.size, self.depth = tree, ways, size, depth
        if size > LARGEST or depth > DEEPEST // 2:
            raise NotTraced("its expressions are too long")

    def __add__(self, other: Any) -> Quantity:
        if _is(self, 0) and isinstance(other, Quantity | int | float):
            return other if isinstance(other, Quantity) else Quantity(_tree(other), self.ways)
        return self if _is(other, 0) else _operation("+", self, other)

    def __sub__(self, other: Any) -> Quantity:
        return self if _is(other, 0) else _operation("-", self, other)

    def __mul__(self, other: Any) -> Quantity:
        return _product(self, other)

    def __truediv__(self, other: Any) -> Quantity:
        return self if _is(other, 1) else _operation("/", self, other)

    def __radd__(self, other: Any) -> Quantity:
        return self if _is(other, 0) else _operation("+", other, self)

    def __rsub__(self, other: Any) -> Quantity:
        return -self if _is(other, 0) else _operation("-", other, self)

    def __rmul__(self, other: Any) -> Quantity:
        return _product(self, other, swapped=True)

    def __pos__(self) -> Quantity:
        return self

    __rtruediv__, __pow__, __rpow__ = _called("/", swapped=True), _called("**"), _called("**", swapped=True)
    __neg__, __abs__ = _called("neg"), _called("abs")
    __gt__ = _comparison(lambda a, b: _positive(a - b))
    __lt__ = _comparison(lambda a, b: _positive(b - a))
    __ge__ = _comparison(lambda a, b: ~_positive(b - a))
    __le__ = _comparison(lambda a, b: ~_positive(a - b))
    __eq__ = _comparison(lambda a, b: ~_positive(abs(a - b)))
    __ne__ = _comparison(lambda a, b: _positive(abs(a - b)))
    __hash__ = None  # type: ignore[assignment]

    def __bool__(self) -> bool:
        return bool(self != 0)

    def __getattr__(self, name: str) -> Callable[[], Quantity]:
        """NumPy's sine of an object is its method `sin`."""
        if name not in _OF_ONE:
            raise AttributeError(name)
        return lambda: _ARITHMETIC[name](self)

    def __float__(self) -> float:
        raise NotTraced("the function converts a number into a float")


class Condition(Quantity):
    """1 where something holds, else 0."""

    def __and__(self, other: Any) -> Condition:
        return _condition(_operation("min", self, other))

    def __or__(self, other: Any) -> Condition:
        return _condition(_operation("max", self, other))

    __rand__, __ror__ = __and__, __or__

    def __invert__(self) -> Condition:
        return _condition(_operation("-", 1.0, self))

    def __bool__(self) -> bool:
        tree, holds = self.tree, True
        while isinstance(tree, Operation) and tree.symbol == "-":  # not this
            tree, holds = tree.arguments[1], not holds
        if tree not in self.ways:
            raise _Undecided(tree)
        return self.ways[tree] is holds


def trace_equations(function: Callable[..., Any], arguments: Callable[[Callable[[str], Quantity]], Any]) -> list[Tree]:
    """Expressions of what a function returns.

    arguments: given what makes a quantity of a name, returns the function's arguments (a tuple) and keywords (a
        mapping)
    raises NotTraced if the function does something that is no arithmetic, or is too long
    """
    target = function if isinstance(function, FunctionType | MethodType | functools.partial) else function.__call__
    on_quantities = _Surroundings().replaced(target if isinstance(target, MethodType) else function)
    called = 0

    def ways(decided: dict[Tree, bool]) -> list[Tree]:
        nonlocal called
        called += 1
        if called > MOST_WAYS:
            raise NotTraced(f"the function branches in more than {MOST_WAYS} ways")
        plain, named = arguments(lambda name: Quantity(Name(name), decided))
        try:
            return [_tree(rate) for rate in flat(on_quantities(*plain, **named))]
        except _Undecided as branch:
            condition = branch.condition
        yes, no = gone({**decided, condition: True}), gone({**decided, condition: False})
        if isinstance(yes, Exception) or isinstance(no, Exception):
            never, there = (Operation("-", (_ONE, condition)), no) if isinstance(yes, Exception) else (condition, yes)
            if isinstance(there, Exception):
                raise there
            return [Operation("+", (tree, Operation("log", (never,)))) for tree in there]
        if len(yes) != len(no):
            raise NotTraced("the number of returned derivatives varies")
        return [_either(condition, a, b) for a, b in zip(yes, no, strict=True)]

    def gone(decided: dict[Tree, bool]) -> list[Tree] | Exception:
        try:
            return ways(decided)
        except NotTraced:
            raise
        except Exception as error:  # whatever the function raises there: a run that goes there ends
            return error

    try:
        return ways({})
    except NotTraced:
        raise
    except Exception as error:  # whatever the function raises when it is given no numbers
        reason = (str(error).splitlines() or [""])[0][:100]
        raise NotTraced(f"{type(error).__name__}: {reason}") from error


def flat(returned: Any) -> list[Any]:
    """What a function returned, one number (or array of points) a derivative.

    >>> flat([1.0, np.array([2.0])]), flat(np.array([3.0, 4.0])), flat(5.0)
    ([1.0, 2.0], [3.0, 4.0], [5.0])
    """
    if isinstance(returned, np.ndarray):
        return flat(returned.ravel().tolist())
    return [number for part in returned for number in flat(part)] if isinstance(returned, tuple | list) else [returned]


def _tree(operand: Any) -> Tree:
    if isinstance(operand, Quantity):
        return operand.tree
    value = float(operand)
    if not math.isfinite(value):
        raise NotTraced(f"it computes with {value}")
    return Number(value)


def _is(term: Any, number: float) -> bool:
    tree = term.tree if isinstance(term, Quantity) else term
    return tree == Number(number) if isinstance(tree, Number) else isinstance(term, int | float) and term == number


def _operation(symbol: str, *arguments: Any) -> Quantity:
    if any(isinstance(argument, np.ndarray) for argument in arguments):
        return NotImplemented  # the array does it number by number
    quantities = [argument for argument in arguments if isinstance(argument, Quantity)]
    size, depth = 1 + sum(q.size for q in quantities), 1 + max(q.depth for q in quantities)
    return Quantity(Operation(symbol, tuple(map(_tree, arguments))), quantities[0].ways, size, depth)


def _product(quantity: Quantity, other: Any, swapped: bool = False) -> Quantity:
    if _is(other, 0) or (_is(quantity, 0) and not isinstance(other, np.ndarray)):
        return Quantity(_ZERO, quantity.ways)
    if _is(quantity, 1) and isinstance(other, Quantity):
        return other
    return quantity if _is(other, 1) else _operation("*", *((other, quantity) if swapped else (quantity, other)))


def _condition(quantity: Quantity) -> Condition:
    return Condition(quantity.tree, quantity.ways, quantity.size, quantity.depth)


def _positive(quantity: Quantity) -> Condition:
    return _condition(_operation("step", quantity))


def _either(condition: Tree, yes: Tree, no: Tree) -> Tree:
    """One tree where a condition holds, another where it does not."""
    if yes == no:
        return yes
    bare = condition.arguments[0] if isinstance(condition, Operation) and condition.symbol == "step" else condition
    branches = [(condition, bare, yes), (*[Operation("-", (_ONE, condition))] * 2, no)]
    there = [
        where if tree == _ONE else Operation("where", (above, tree)) for where, above, tree in branches if tree != _ZERO
    ]
    return there[0] if len(there) == 1 else Operation("+", tuple(there))


def _chosen(condition: Any, yes: Any, no: Any) -> Any:
    """`np.where` of single numbers."""
    if not isinstance(condition, Quantity):
        return yes if condition else no
    held: Any = condition if isinstance(condition, Condition) else condition != 0
    quantities = [q for q in (held, yes, no) if isinstance(q, Quantity)]
    size, depth = 3 + sum(q.size for q in quantities) + held.size, 3 + max(q.depth for q in quantities)
    return Quantity(_either(held.tree, _tree(yes), _tree(no)), held.ways, size, depth)


def _select(conditions: Sequence[Any], values: Sequence[Any], otherwise: Any = 0.0) -> Any:
    """`np.select` of single numbers."""
    for condition, value in reversed(list(zip(conditions, values, strict=True))):
        otherwise = _chosen(condition, value, otherwise)
    return otherwise


def _clip(x: Any, low: Any, high: Any) -> Quantity:
    return _operation("min", _operation("max", x, low), high)


def _arcsine(x: Quantity) -> Quantity:
    return _operation("atan", x / _operation("sqrt", 1 - x * x))


def _trace_angle(y: Any, x: Any) -> Quantity:
    """`atan2`, by the tangent of half the angle, which is infinite where x is negative and y is 0."""
    beyond = _operation("sqrt", x * x + y * y) + x
    return _chosen(beyond > 0, 2 * _operation("atan", y / beyond), math.pi * (0 - x > 0))


def _interpolate(x: Quantity, at: Sequence[float], values: Sequence[float]) -> Quantity:
    """`np.interp`: the first value, and the rise over as much of each stretch as lies before x."""
    value = 0 * x + float(values[0])
    for low, high, rise in zip(at[:-1], at[1:], np.diff(values) / np.diff(at), strict=True):
        value = value + float(rise) * (_clip(x, float(low), float(high)) - float(low))
    return value


_OF_ONE = ("sin", "cos", "tan", "tanh", "exp", "log", "sqrt", "sinh", "cosh", "arctan", "arcsin", "arccos")
_ARITHMETIC: dict[str, Callable[..., Any]] = {
    **{name: _called(name) for name in _OF_ONE[:7]},
    **dict.fromkeys(("abs", "absolute", "fabs"), abs),
    **dict.fromkeys(("max", "maximum", "fmax"), _called("max")),
    **dict.fromkeys(("min", "minimum", "fmin"), _called("min")),
    **dict.fromkeys(("pow", "power", "float_power"), lambda x, n: x**n),
    **dict.fromkeys(("radians", "deg2rad"), lambda x: x * math.radians(1.0)),
    **dict.fromkeys(("degrees", "rad2deg"), lambda x: x * math.degrees(1.0)),
    "sinh": lambda x: 0.5 * (_operation("exp", x) - _operation("exp", -x)),
    "cosh": lambda x: 0.5 * (_operation("exp", x) + _operation("exp", -x)),
    **dict.fromkeys(("atan", "arctan"), _called("atan")),
    **dict.fromkeys(("asin", "arcsin"), _arcsine),
    **dict.fromkeys(("acos", "arccos"), lambda x: math.pi / 2 - _arcsine(x)),
    **dict.fromkeys(("atan2", "arctan2"), _trace_angle),
    "hypot": lambda a, b: _operation("sqrt", a * a + b * b),
    "square": lambda x: x * x,
    "sign": lambda x: (x > 0) - (x < 0),
    "heaviside": lambda x, at_zero: (x > 0) + at_zero * (x == 0),
    "copysign": lambda a, x: abs(a) * (1 - 2 * (x < 0)),
    "clip": _clip,
    "where": _chosen,
    "select": _select,
    "isnan": lambda _: False,
    "isfinite": lambda _: True,
    "interp": _interpolate,
}


class _RealKind(type):
    """Kind of `_Real`, of which every float is one."""

    def __instancecheck__(cls, value: Any) -> bool:
        return isinstance(value, float | Quantity)


class _Real(float, metaclass=_RealKind):
    """Python's `float`, which leaves quantities as they are."""

    def __new__(cls, value: Any = 0.0) -> Any:
        """The number itself."""
        return value if isinstance(value, Quantity) else float(value)


class _Surroundings:
    """What a function finds around it, in a form that takes quantities: `math`, NumPy, built-ins, other functions."""

    def __init__(self) -> None:
        self._replaced: dict[int, Any] = {}
        for room, skipped in ((math, ()), (np, ("max", "min")), (builtins, ())):
            for name, arithmetic in _ARITHMETIC.items():
                if name not in skipped and hasattr(room, name):
                    original = getattr(room, name)
                    self._replaced[id(original)] = _number_by_number(arithmetic, original)
        for original in (np.zeros, np.ones, np.empty, np.array, np.asarray):
            self._replaced[id(original)] = _of_objects(original)
        self._replaced |= {id(float): _Real, id(np.float64): _Real}
        for original in (np.linalg.solve, np.linalg.inv):
            self._replaced[id(original)] = _of_equations(original)
        for room in (math, np.linalg, np):
            inside = {name: self._replaced.get(id(value), value) for name, value in vars(room).items()}
            self._replaced[id(room)] = SimpleNamespace(**inside)
        inside = {name: self._replaced.get(id(value), value) for name, value in vars(builtins).items()}
        self._builtins = inside | {"__import__": lambda *args, **named: self.replaced(__import__(*args, **named))}

    def replaced(self, value: Any) -> Any:
        """What stands in the place of a value; the value itself where it needs no other form."""
        if id(value) in self._replaced:
            return self._replaced[id(value)]
        if isinstance(value, MethodType):
            return MethodType(self.replaced(value.__func__), value.__self__)
        if isinstance(value, functools.partial):
            return functools.partial(self.replaced(value.func), *value.args, **value.keywords)
        if not isinstance(value, FunctionType):
            inside = [getattr(value, name) for name in INSIDE if isinstance(getattr(value, name, None), FunctionType)]
            return self.replaced(inside[0]) if inside else value
        room = (value.__module__ or "").split(".")[0]
        if (room in sys.stdlib_module_names and room != "__main__") or room in ("numpy", "scipy"):
            return value
        around: dict[str, Any] = {"__builtins__": self._builtins, "__name__": value.__module__}
        cells = tuple(CellType() for _ in value.__closure__ or ())
        copy = FunctionType(value.__code__, around, value.__name__, value.__defaults__, cells)
        copy.__kwdefaults__ = value.__kwdefaults__
        vars(copy).update(vars(value))
        self._replaced[id(value)] = copy
        used = [name for name in _names_in(value.__code__) if name in value.__globals__]
        around |= {name: self.replaced(value.__globals__[name]) for name in used}
        for cell, original in zip(cells, value.__closure__ or (), strict=True):
            cell.cell_contents = self.replaced(original.cell_contents)
        return copy


def _names_in(code: CodeType) -> set[str]:
    """Names that a function and those inside it may look up around them."""
    inside = (constant for constant in code.co_consts if isinstance(constant, CodeType))
    return set(code.co_names).union(*map(_names_in, inside))


def _holds_quantity(value: Any) -> bool:
    if isinstance(value, tuple | list):
        return any(map(_holds_quantity, value))
    return isinstance(value, Quantity) or (isinstance(value, np.ndarray) and value.dtype == object)


def _number_by_number(arithmetic: Callable[..., Any], original: Callable[..., Any]) -> Callable[..., Any]:
    """A function of numbers that takes quantities too, and arrays of them."""

    def either(*arguments: Any, **named: Any) -> Any:
        if not any(map(_holds_quantity, arguments)):
            return original(*arguments, **named)
        if len(arguments) == 1 and isinstance(arguments[0], tuple | list):  # max([a, b])
            arguments = tuple(arguments[0]) if original in (max, min) else (np.array(arguments[0], object),)
        if isinstance(arguments[0], np.ndarray) and arithmetic is _interpolate:
            return np.frompyfunc(lambda x: arithmetic(x, *arguments[1:]), 1, 1)(arguments[0])
        if any(isinstance(argument, np.ndarray) for argument in arguments) and arithmetic is not _interpolate:
            return np.frompyfunc(arithmetic, len(arguments), 1)(*arguments)
        return arithmetic(*arguments, **named)

    return either


def _of_objects(original: Callable[..., Any]) -> Callable[..., Any]:
    """A function that makes an array, which may then hold quantities."""

    def made(what: Any, *rest: Any, **named: Any) -> Any:
        if original in (np.array, np.asarray):
            return np.array(what, object) if _holds_quantity(what) else original(what, *rest, **named)
        return (np.ones if original is np.ones else np.zeros)(what, object)

    return made


def _of_equations(original: Callable[..., Any]) -> Callable[..., Any]:
    """`np.linalg.solve` and `inv` (of a mass matrix, say), which may then hold quantities."""

    def solved(matrix: Any, right: Any = None) -> Any:
        if not (_holds_quantity(matrix) or _holds_quantity(right)):
            return original(matrix) if original is np.linalg.inv else original(matrix, right)
        count = len(matrix)
        right_side = np.eye(count).astype(int) if original is np.linalg.inv else np.asarray(right)
        rows = np.hstack([np.asarray(matrix), right_side.reshape(count, -1)]).astype(object)
        for pivot in range(count):
            rows[pivot] = rows[pivot] / rows[pivot, pivot]
            for row in (row for row in range(count) if row != pivot):
                rows[row] = rows[row] - rows[row, pivot] * rows[pivot]
        return rows[:, count:].reshape(right_side.shape)

    return solved
