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
    return lambda one, other: NotImplemented if isinstance(other, np.ndarray) else of(one, other)


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
    __gt__ = _comparison(lambda one, other: _positive(one - other))
    __lt__ = _comparison(lambda one, other: _positive(other - one))
    __ge__ = _comparison(lambda one, other: ~_positive(other - one))
    __le__ = _comparison(lambda one, other: ~_positive(one - other))
    __eq__ = _comparison(lambda one, other: ~_positive(abs(one - other)))
    __ne__ = _comparison(lambda one, other: _positive(abs(one - other)))
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
    own = function if isinstance(function, FunctionType | MethodType | functools.partial) else function.__call__
    on_quantities = _Surroundings().replaced(own if isinstance(own, MethodType) else function)
    called = 0

    def ways(decided: dict[Tree, bool]) -> list[Tree]:
        nonlocal called
        called += 1
        if called > MOST_WAYS:
            raise NotTraced(f"the function branches in more than {MOST_WAYS} ways")
        plain, named = arguments(lambda name: Quantity(Name(name), decided))
        try:
            return [_tree(one) for one in flat(on_quantities(*plain, **named))]
        except _Undecided as branch:
            condition = branch.condition
        yes, no = gone({**decided, condition: True}), gone({**decided, condition: False})
        if isinstance(yes, Exception) or isinstance(no, Exception):
            never, there = (Operation("-", (_ONE, condition)), no) if isinstance(yes, Exception) else (condition, yes)
            if isinstance(there, Exception):
                raise there
            return [Operation("+", (one, Operation("log", (never,)))) for one in there]
        if len(yes) != len(no):
            raise NotTraced("the number of returned derivatives varies")
        return [_either(condition, one, other) for one, other in zip(yes, no, strict=True)]

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
        said = (str(error).splitlines() or [""])[0][:100]
        raise NotTraced(f"{type(error).__name__}: {said}") from error


def flat(returned: Any) -> list[Any]:
    """What a function returned, one number (or array of points) a derivative.

    >>> flat([1.0, np.array([2.0])]), flat(np.array([3.0, 4.0])), flat(5.0)
    ([1.0, 2.0], [3.0, 4.0], [5.0])
    """
    if isinstance(returned, np.ndarray):
        return flat(returned.ravel().tolist())
    return [each for one in returned for each in flat(one)] if isinstance(returned, tuple | list) else [returned]


def _tree(one: Any) -> Tree:
    if isinstance(one, Quantity):
        return one.tree
    value = float(one)
    if not math.isfinite(value):
        raise NotTraced(f"it computes with {value}")
    return Number(value)


def _is(one: Any, number: float) -> bool:
    tree = one.tree if isinstance(one, Quantity) else one
    return tree == Number(number) if isinstance(tree, Number) else isinstance(one, int | float) and one == number


def _operation(symbol: str, *arguments: Any) -> Quantity:
    if any(isinstance(one, np.ndarray) for one in arguments):
        return NotImplemented  # the array does it number by number
    own = [one for one in arguments if isinstance(one, Quantity)]
    size, depth = 1 + sum(one.size for one in own), 1 + max(one.depth for one in own)
    return Quantity(Operation(symbol, tuple(map(_tree, arguments))), own[0].ways, size, depth)


def _product(one: Quantity, other: Any, swapped: bool = False) -> Quantity:
    if _is(other, 0) or (_is(one, 0) and not isinstance(other, np.ndarray)):
        return Quantity(_ZERO, one.ways)
    if _is(one, 1) and isinstance(other, Quantity):
        return other
    return one if _is(other, 1) else _operation("*", *((other, one) if swapped else (one, other)))


def _condition(one: Quantity) -> Condition:
    return Condition(one.tree, one.ways, one.size, one.depth)


def _positive(one: Quantity) -> Condition:
    return _condition(_operation("step", one))


def _either(condition: Tree, one: Tree, other: Tree) -> Tree:
    """One tree where a condition holds, another where it does not."""
    if one == other:
        return one
    bare = condition.arguments[0] if isinstance(condition, Operation) and condition.symbol == "step" else condition
    parts = [(condition, bare, one), (*[Operation("-", (_ONE, condition))] * 2, other)]
    there = [
        where if each == _ONE else Operation("where", (above, each)) for where, above, each in parts if each != _ZERO
    ]
    return there[0] if len(there) == 1 else Operation("+", tuple(there))


def _chosen(condition: Any, one: Any, other: Any) -> Any:
    """`np.where` of single numbers."""
    if not isinstance(condition, Quantity):
        return one if condition else other
    held: Any = condition if isinstance(condition, Condition) else condition != 0
    own = [each for each in (held, one, other) if isinstance(each, Quantity)]
    size, depth = 3 + sum(each.size for each in own) + held.size, 3 + max(each.depth for each in own)
    return Quantity(_either(held.tree, _tree(one), _tree(other)), held.ways, size, depth)


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
    found = 0 * x + float(values[0])
    for low, high, rise in zip(at[:-1], at[1:], np.diff(values) / np.diff(at), strict=True):
        found = found + float(rise) * (_clip(x, float(low), float(high)) - float(low))
    return found


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

    def __instancecheck__(cls, one: Any) -> bool:
        return isinstance(one, float | Quantity)


class _Real(float, metaclass=_RealKind):
    """Python's `float`, which leaves quantities as they are."""

    def __new__(cls, one: Any = 0.0) -> Any:
        """The number itself."""
        return one if isinstance(one, Quantity) else float(one)


class _Surroundings:
    """What a function finds around it, in a form that takes quantities: `math`, NumPy, built-ins, other functions."""

    def __init__(self) -> None:
        self._replaced: dict[int, Any] = {}
        for room, left in ((math, ()), (np, ("max", "min")), (builtins, ())):
            for name, arithmetic in _ARITHMETIC.items():
                if name not in left and hasattr(room, name):
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
        own = {name: self._replaced.get(id(value), value) for name, value in vars(builtins).items()}
        self._builtins = own | {"__import__": lambda *given, **named: self.replaced(__import__(*given, **named))}

    def replaced(self, one: Any) -> Any:
        """What stands in the place of a value; the value itself where it needs no other form."""
        if id(one) in self._replaced:
            return self._replaced[id(one)]
        if isinstance(one, MethodType):
            return MethodType(self.replaced(one.__func__), one.__self__)
        if isinstance(one, functools.partial):
            return functools.partial(self.replaced(one.func), *one.args, **one.keywords)
        if not isinstance(one, FunctionType):
            inside = [getattr(one, name) for name in INSIDE if isinstance(getattr(one, name, None), FunctionType)]
            return self.replaced(inside[0]) if inside else one
        room = (one.__module__ or "").split(".")[0]
        if (room in sys.stdlib_module_names and room != "__main__") or room in ("numpy", "scipy"):
            return one
        around: dict[str, Any] = {"__builtins__": self._builtins, "__name__": one.__module__}
        cells = tuple(CellType() for _ in one.__closure__ or ())
        copy = FunctionType(one.__code__, around, one.__name__, one.__defaults__, cells)
        copy.__kwdefaults__ = one.__kwdefaults__
        vars(copy).update(vars(one))
        self._replaced[id(one)] = copy
        used = [name for name in _names_in(one.__code__) if name in one.__globals__]
        around |= {name: self.replaced(one.__globals__[name]) for name in used}
        for cell, original in zip(cells, one.__closure__ or (), strict=True):
            cell.cell_contents = self.replaced(original.cell_contents)
        return copy


def _names_in(code: CodeType) -> set[str]:
    """Names that a function and those inside it may look up around them."""
    inside = (one for one in code.co_consts if isinstance(one, CodeType))
    return set(code.co_names).union(*map(_names_in, inside))


def _holds_quantity(one: Any) -> bool:
    if isinstance(one, tuple | list):
        return any(map(_holds_quantity, one))
    return isinstance(one, Quantity) or (isinstance(one, np.ndarray) and one.dtype == object)


def _number_by_number(arithmetic: Callable[..., Any], original: Callable[..., Any]) -> Callable[..., Any]:
    """A function of numbers that takes quantities too, and arrays of them."""

    def either(*arguments: Any, **named: Any) -> Any:
        if not any(map(_holds_quantity, arguments)):
            return original(*arguments, **named)
        if len(arguments) == 1 and isinstance(arguments[0], tuple | list):  # max([a, b])
            arguments = tuple(arguments[0]) if original in (max, min) else (np.array(arguments[0], object),)
        if isinstance(arguments[0], np.ndarray) and arithmetic is _interpolate:
            return np.frompyfunc(lambda x: arithmetic(x, *arguments[1:]), 1, 1)(arguments[0])
        if any(isinstance(one, np.ndarray) for one in arguments) and arithmetic is not _interpolate:
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
        wanted = np.eye(count).astype(int) if original is np.linalg.inv else np.asarray(right)
        rows = np.hstack([np.asarray(matrix), wanted.reshape(count, -1)]).astype(object)
        for pivot in range(count):
            rows[pivot] = rows[pivot] / rows[pivot, pivot]
            for row in (row for row in range(count) if row != pivot):
                rows[row] = rows[row] - rows[row, pivot] * rows[pivot]
        return rows[:, count:].reshape(wanted.shape)

    return solved
