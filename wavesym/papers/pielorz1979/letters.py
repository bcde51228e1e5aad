"""What the letters of section 4 mean on a chain under loads: in exact numbers, and in symbols as in the derivation."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Container, Iterable, Iterator, Mapping
from dataclasses import fields, is_dataclass, replace
from functools import lru_cache, partial
from typing import Any

from flint import fmpq
from sympy import Add, Expr, Function, IndexedBase, Integer, Sum, expand, latex
from sympy import Symbol as Letter

from wavesym.derivation.delay import COUNT, INDEX, SYMBOLS
from wavesym.derivation.delay_terms import Line
from wavesym.model.node import Parameters
from wavesym.papers.evaluation import MeaninglessError, Scope, sides
from wavesym.papers.pielorz1979.truth import Driven
from wavesym.papers.record import Case, Example, Nothing, Reading, case, shown
from wavesym.papers.tree import Progression, Series, Symbol, Tree
from wavesym.papers.tree import latex as latex_of

K, Z = Letter("k"), Letter("z")
STEP = Function("H")
_M, _A, _B, _T, _LAST = (IndexedBase(name) for name in ("M", "a", "b", "tau", "m"))


class Letters(Scope):
    """Parameters and loads, by their indices as they stand."""

    parameters: Parameters

    def symbol(self, symbol: Symbol) -> Any:
        index = self.indices(symbol)
        if not (symbol.above or symbol.primes):
            match symbol.accent + symbol.name, index:
                case r"\kappa", (i,):
                    return self.parameter("kappa", i)
                case "J", (i,):
                    return self.parameter("inertia", i)
                case r"\barv", (i,):
                    return self.parameter("velocity", i)
                case r"\barA", (i,):  # in the unit of moment G J_01 theta_0 / l
                    return self.parameter("kappa", 1) * self.parameter("inertia", 1) / self.parameter("inertia", i)
                case r"\barM", (s, k):
                    return self.piece("M", s, k)
                case "a" | "b" | r"\bara" | r"\barb", (k,):
                    return self.piece(symbol.name, None, k)
                case r"\tau", (*s, k) if len(s) < 2:
                    return self.start(s[0] if s else None, k)
                case "m", (s,):
                    return self.last(s)
        return super().symbol(symbol)

    def parameter(self, name: str, index: Any) -> Any:
        """A parameter of the chain; MeaninglessError."""
        try:
            return getattr(self.parameters, name)[index]
        except (KeyError, TypeError):
            raise MeaninglessError(f"there is no {name}_{index}") from None

    @abstractmethod
    def piece(self, source: str, number: Any, k: Any) -> Any:
        """How much piece k of a load is: M of body `number`, a or b of the ground."""

    @abstractmethod
    def start(self, number: Any, k: Any) -> Any:
        """When piece k begins: of the moment on body `number`, or of the ground's acceleration."""

    @abstractmethod
    def last(self, number: Any) -> Any:
        """The number of the last piece."""


class Numbers(Letters):
    """Exact numbers on a chain under loads; `seen` tells whether anything moved where it was looked at."""

    def __init__(self, driven: Driven, bound: Mapping[str, Any] | None = None) -> None:
        super().__init__({"m": driven.exact.m, **(bound or {})})
        self.driven = driven
        self.parameters = driven.exact.chain.parameters
        self.seen = False

    def moved(self, value: Any) -> Any:
        """The value, noted as seen where it is not 0."""
        self.seen = self.seen or value != 0
        return value

    def piece(self, source: str, number: Any, k: int) -> Any:
        return self._piece(source if number is None else f"{source}{number}", k).weight

    def start(self, number: Any, k: int) -> Any:
        return self._piece("a" if number is None else f"M{number}", k).time

    def last(self, number: int) -> int:
        """(3.1) has an m_i for every moment, (3.2) an m_1."""
        source = "a" if number == 1 and "a" in self.driven.loads else f"M{number}"
        return len(self._pieces(source)) - 1

    def _piece(self, source: str, k: int) -> Any:
        pieces = self._pieces(source)
        if not 0 <= k < len(pieces):
            raise MeaninglessError(f"load {source} has no piece {k}")
        return pieces[k]

    def _pieces(self, source: str) -> Any:
        if source not in self.driven.loads:
            raise MeaninglessError(f"there is no load {source}")
        return self.driven.loads[source]


class Symbols(Letters):
    """Expressions in symbolic i and m; z is the clock."""

    parameters = SYMBOLS

    def __init__(self, bound: Mapping[str, Any] | None = None) -> None:
        super().__init__({"i": INDEX, "m": COUNT, "z": Z, r"\tau": Z, "t": Z, "l": Integer(1), **(bound or {})})

    def literal(self, value: Any) -> Any:
        return Integer(value)

    def series(self, series: Series) -> Any:
        with self.binding({series.variable.name: K}):
            body = self.value(series.body)
        return added(body, self.value(series.last), self.value(series.first))

    def whole(self, tree: Tree) -> Any:
        return expand(self.value(tree))

    def step(self, value: Any) -> Any:
        return STEP(expand(value))

    def piece(self, source: str, number: Any, k: Any) -> Any:
        return {"M": _M, "a": _A, "b": _B}[source][k if number is None else (number, k)]

    def start(self, number: Any, k: Any) -> Any:
        return _T[k if number is None else (number, k)]

    def last(self, number: Any) -> Any:
        return _LAST[number]


def added(body: Expr, last: Expr, first: Expr | int = 0) -> Expr:
    """A sum over k, each of its terms apart."""
    return Add(*(Sum(term, (K, first, last)) for term in Add.make_args(expand(body))))


def wave(letter: str, order: int, rod: Expr, lag: Expr) -> Expr:
    """A derivative of f or g, as one symbol."""
    late = "z" if lag == 0 else f"z-{latex(lag)}"
    return Letter(rf"{letter}{chr(39) * order}_{{{latex(rod)}}}({late})")


def expression(line: Line) -> Expr:
    """A derived line as an expression, with all pieces of its loads."""
    total = Integer(0)
    for (letter, rod, lag), (a, b) in line.waves.items():
        total += a * wave(letter, 2, rod, lag) + b * wave(letter, 1, rod, lag)
    for (kind, number, lag, power), value in line.loads.items():
        if kind == "impact":
            total += value
            continue
        weight, start = ({"a": _A, "b": _B}[kind][K], _T[K]) if number is None else (_M[number, K], _T[number, K])
        since = Z - lag - start
        total += value * added(weight * since**power * STEP(expand(since)), _LAST[1 if number is None else number])
    return total


def told(difference: Expr) -> str:
    """A difference as mathematics: each quantity with what stands before it."""
    rest = expand(difference)
    if rest == 0:
        return "0"
    parts = []
    for atom in sorted(rest.atoms(Sum) | {s for s in rest.atoms(Letter) if "(" in s.name}, key=str):
        factor = rest.coeff(atom)
        if factor != 0:
            parts.append(f"({latex(factor)}) {latex(atom)}")
            rest = expand(rest - factor * atom)
    return " + ".join(parts + ([latex(rest)] if rest != 0 else []))


@lru_cache(maxsize=1000)
def within(tree: Tree) -> tuple[Any, ...]:
    """A tree and all its parts."""
    return tuple(_within(tree))


def _within(tree: Any) -> Iterator[Any]:
    yield tree
    for field in fields(tree):
        value = getattr(tree, field.name)
        for part in value if isinstance(value, tuple) else (value,):
            if is_dataclass(part):
                yield from _within(part)


def ranges_of(reading: Reading, letters: Container[str]) -> Mapping[str, Progression]:
    """The ranges by their variables; MeaninglessError for one of something else than these letters."""
    found = {latex_of(r.variable): r for r in reading.ranges if isinstance(r, Progression)}
    if len(found) < len(reading.ranges) or any(letter not in letters for letter in found):
        raise MeaninglessError("a range of something else")
    return found


def left_over(
    equation: Tree,
    at: Mapping[str, object],
    clock: str,
    scopes: Iterable[tuple[fmpq, Numbers]],
    seen: Callable[[fmpq, str], Callable[[], Example] | None],
) -> Iterator[Case]:
    """An equation at instants: what is left of it, and where that is `seen`."""
    left, right = sides(equation)
    for instant, scope in scopes:
        tried = partial(_less, scope, left, right)
        found = case({**at, f"left less right side at {clock}": instant}, tried, 0)
        shows = None
        if not found.agrees and not isinstance(found.printed, Nothing):
            shows = seen(instant, f"its left side less its right side is {shown(found.printed)}")
        yield replace(found, telling=scope.seen, example=shows)


def _less(scope: Scope, left: Tree, right: Tree) -> Any:
    return scope.value(left) - scope.value(right)
