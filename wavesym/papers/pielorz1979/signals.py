"""Formulas about waves, read once and tested twice: in exact numbers on a table, and in symbols against the derivation.

A formula is a function of a `Waves` and a place i that gives left side less right side. With `Numbers` the result is
what is left on the exact tables; with `Symbols` it is a `Line`, for symbolic i and m.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from flint import fmpq
from sympy import Expr, Integer

from wavesym.derivation.delay import COUNT, SYMBOLS
from wavesym.derivation.delay_terms import Line, Operator, Source, Wave, exact
from wavesym.exact.increments import Increment, add, trimmed
from wavesym.model.node import Quantity
from wavesym.papers.exact_tables import Exact
from wavesym.papers.record import Case

Place = Any
"""A number, or an expression in i and m."""


@dataclass(frozen=True)
class PrintedSignal:
    """Increments by the time at which they start."""

    parts: Mapping[Quantity, Increment]

    def __add__(self, other: PrintedSignal) -> PrintedSignal:
        total = {start: {rate: list(powers) for rate, powers in part.items()} for start, part in self.parts.items()}
        for start, part in other.parts.items():
            add(total.setdefault(start, {}), part)
        return PrintedSignal(total)

    def __rmul__(self, factor: Quantity) -> PrintedSignal:
        total: dict[Quantity, Increment] = {start: {} for start in self.parts}
        for start, part in self.parts.items():
            add(total[start], part, fmpq(factor))
        return PrintedSignal(total)

    def __neg__(self) -> PrintedSignal:
        return -1 * self

    def __sub__(self, other: PrintedSignal) -> PrintedSignal:
        return self + -other

    @property
    def d(self) -> PrintedSignal:
        """The derivative, between the starts."""
        return PrintedSignal(
            {
                start: {
                    rate: [
                        (k + 1) * above - rate * this
                        for k, (this, above) in enumerate(zip(powers, [*powers[1:], fmpq(0)], strict=True))
                    ]
                    for rate, powers in part.items()
                }
                for start, part in self.parts.items()
            }
        )

    def first(self, until: Quantity) -> tuple[str, fmpq] | None:
        """The first coefficient that is not 0 before `until`, with its name."""
        for start in sorted(self.parts):
            if start < until:
                for rate, powers in sorted(trimmed(self.parts[start]).items()):
                    for power, value in enumerate(powers):
                        if value != 0:
                            return f"from z = {start} on, rate {rate}, power {power}", value
        return None


@dataclass(frozen=True)
class Formal:
    """A `Line` with the operators that formulas are written in."""

    line: Line

    def __add__(self, other: Formal) -> Formal:
        return Formal(self.line + other.line)

    def __sub__(self, other: Formal) -> Formal:
        return Formal(self.line - other.line)

    def __rmul__(self, factor: Expr | int) -> Formal:
        return Formal(self.line.scaled(factor))

    def __neg__(self) -> Formal:
        return Formal(self.line.scaled(-1))

    @property
    def d(self) -> Formal:
        return Formal(self.line.differentiated())


class Waves(ABC):
    """What formulas are written in: f' and g' of a rod, `lag` earlier; loads; parameters."""

    m: Place
    piece: int | None = None
    k: Any
    J: Any
    v: Any

    @abstractmethod
    def wave(self, letter: str, rod: Place, lag: Place) -> Any:
        """The derivative of a wave function."""

    @abstractmethod
    def load(self, kind: str, number: Place, lag: int, power: int) -> Any:
        """tau**power from `lag` on."""

    def f(self, rod: Place, lag: Place = 0) -> Any:
        """f' of a rod."""
        return self.wave("f", rod, lag)

    def g(self, rod: Place, lag: Place = 0) -> Any:
        """g' of a rod."""
        return self.wave("g", rod, lag)

    def M(self, number: Place, lag: int = 0, last: Place = None) -> Any:
        """The sum of M_(s,k) H(z - lag - tau_(s,k)) up to k = `last` (all), by the unit of number `piece`."""
        missing = last is not None and self.piece is not None and self.piece > last
        return (0 if missing else 1) * self.load("M", number, lag, 0)

    @property
    def base(self) -> Any:
        """The sum of [a_k + b_k (z - tau_k)] H(z - tau_k), by its units."""
        return self.load("a", None, 0, 0) + self.load("b", None, 0, 1)

    def constant(self, value: Any) -> Any:
        """A constant from 0 on, such as a difference of velocities."""
        return value * self.load("impact", None, 0, 0)

    def A(self, number: Place) -> Any:
        """The A_i of (4.4) in the unit of moment G J_01 theta_0 / l."""
        return self.k[1] * self.J[1] / self.J[number]


Formula = Callable[[Any, Place], Any]


@dataclass
class Numbers(Waves):
    """The exact increments of one chain for one source; `seen` tells whether anything was there."""

    exact: Exact
    source: str
    piece: int | None = 0
    seen: bool = field(default=False)

    def __post_init__(self) -> None:
        parameters = self.exact.chain.parameters
        self.m, self.k, self.J, self.v = self.exact.m, parameters.kappa, parameters.inertia, parameters.velocity
        self.intervals = len(next(iter(self.exact.responses[self.source].values())))

    def wave(self, letter: str, rod: int, lag: Quantity) -> PrintedSignal:
        if not 1 <= rod <= self.m:
            raise LookupError(f"rod {rod}")
        step = self.exact.interval
        parts = {lag + step * n: self.exact.increment(self.source, letter, rod, n + 1) for n in range(self.intervals)}
        self.seen = self.seen or any(parts.values())
        return PrintedSignal(parts)

    def load(self, kind: str, number: int | None, lag: int, power: int) -> PrintedSignal:
        name = kind if number is None else f"{kind}{number}"
        return PrintedSignal({lag: {fmpq(0): [fmpq(0)] * power + [fmpq(1)]}} if name == self.source else {})


class Symbols(Waves):
    """Symbolic i and m."""

    def __init__(self) -> None:
        self.m, self.k, self.J, self.v = COUNT, SYMBOLS.kappa, SYMBOLS.inertia, SYMBOLS.velocity

    def wave(self, letter: str, rod: Place, lag: Place) -> Formal:
        return Formal(Line({Wave(letter, exact(rod), exact(lag)): Operator(Integer(0), Integer(1))}))

    def load(self, kind: str, number: Place, lag: int, power: int) -> Formal:
        source = Source(kind, None if number is None else exact(number), exact(lag), power)
        return Formal(Line({}, {source: Integer(1)}))


class Faulty(Waves):
    """The same waves, one of them with a fault: the `nth` that a formula asks for times `factor`, or `late`r."""

    def __init__(self, inner: Waves, nth: int, factor: int, late: int) -> None:
        self._inner, self._nth, self._factor, self._late, self._asked = inner, nth, factor, late, 0
        self.m, self.piece, self.k, self.J, self.v = inner.m, inner.piece, inner.k, inner.J, inner.v

    def wave(self, letter: str, rod: Place, lag: Place) -> Any:
        return self._maybe(lambda late: self._inner.wave(letter, rod, lag + late))

    def load(self, kind: str, number: Place, lag: int, power: int) -> Any:
        return self._maybe(lambda late: self._inner.load(kind, number, lag + late, power))

    def _maybe(self, taken: Callable[[int], Any]) -> Any:
        self._asked += 1
        return self._factor * taken(self._late) if self._asked == self._nth else taken(0)


def faults(formula: Formula, terms: int, late: int = 2) -> Mapping[str, Formula]:
    """The formula with each of its waves and loads wrong once: its sign, its factor, its lag."""

    def faulty(nth: int, factor: int, late: int) -> Formula:
        return lambda waves, i: formula(Faulty(waves, nth, factor, late), i)

    result: dict[str, Formula] = {}
    for nth in range(1, terms + 1):
        result[f"sign of term {nth}"] = faulty(nth, -1, 0)
        result[f"term {nth} twice"] = faulty(nth, 2, 0)
        result[f"lag of term {nth}"] = faulty(nth, 1, late)
    return result


def residual_case(waves: Numbers, formula: Formula, i: int, short: int = 0) -> Case:
    """Left less right side on the table, `short` of where it ends, as all its functions reach; it should be nothing."""
    where: dict[str, object] = {"m": waves.m, "i": i, "source": waves.source}
    if waves.piece:
        where["k = m_s"] = waves.piece
    try:
        left = formula(waves, i).first(waves.intervals * waves.exact.interval - short)
    except LookupError as error:
        return Case(where, f"asks for {error}", "no such rod")
    if left is None:
        return Case(where, 0, 0, telling=waves.seen)
    return Case({**where, "left less right side": left[0]}, left[1], fmpq(0))
