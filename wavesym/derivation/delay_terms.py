"""A delay equation is a small table: which wave, of which rod, how late, under which polynomial in D = d/dz."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from sympy import Expr, Integer, expand


class Wave(NamedTuple):
    """The derivative of wave function `function` ("f" or "g") of rod `rod`, taken `lag` earlier."""

    function: str
    rod: Expr
    lag: Expr


class Operator(NamedTuple):
    """a D + b."""

    a: Expr
    b: Expr


class Source(NamedTuple):
    """tau**power from tau = lag on, for the load `kind` with `number` (see `model.node.Load`)."""

    kind: str
    number: Expr | None
    lag: Expr
    power: int


@dataclass(frozen=True)
class Line:
    """A sum of waves under operators and of loads with factors. Terms that are 0 are left out."""

    waves: Mapping[Wave, Operator] = field(default_factory=dict)
    loads: Mapping[Source, Expr] = field(default_factory=dict)

    def __add__(self, other: Line) -> Line:
        waves = dict(self.waves)
        for wave, (a, b) in other.waves.items():
            old = waves.get(wave, Operator(Integer(0), Integer(0)))
            waves[wave] = Operator(expand(old.a + a), expand(old.b + b))
        loads = dict(self.loads)
        for source, value in other.loads.items():
            loads[source] = expand(loads.get(source, Integer(0)) + value)
        return Line(
            {wave: operator for wave, operator in waves.items() if any(operator)},
            {source: value for source, value in loads.items() if value != 0},
        )

    def scale(self, factor: Expr | int) -> Line:
        """Every term times a factor."""
        return Line() + Line(  # a sum leaves out what is 0
            {wave: Operator(expand(factor * a), expand(factor * b)) for wave, (a, b) in self.waves.items()},
            {source: expand(factor * value) for source, value in self.loads.items()},
        )

    def __sub__(self, other: Line) -> Line:
        return self + other.scale(-1)

    def delay(self, lag: Expr) -> Line:
        """The same line, `lag` later on every clock."""
        return Line(
            {wave._replace(lag=expand(wave.lag + lag)): operator for wave, operator in self.waves.items()},
            {source._replace(lag=expand(source.lag + lag)): value for source, value in self.loads.items()},
        )

    def differentiate(self) -> Line:
        """D of a line of plain waves. A constant start velocity goes; the D of a load is never needed."""
        assert all(a == 0 for a, _ in self.waves.values())
        assert all(s.kind == "impact" for s in self.loads)
        return Line({wave: Operator(b, Integer(0)) for wave, (_, b) in self.waves.items()})

    def drop(self, wave: Wave) -> Line:
        """The rest of the line."""
        return Line({w: operator for w, operator in self.waves.items() if w != wave}, self.loads)

    def substitute(self, function: str, rod: Expr, value: Line) -> Line:
        """The line with `value`, which has no D, in place of every function `function` of rod `rod`."""
        result = self
        for wave, (a, b) in self.waves.items():
            if (wave.function, wave.rod) == (function, rod):
                late = value.delay(wave.lag)
                result = result.drop(wave) + late.scale(b)
                if a != 0:
                    result = result + late.differentiate().scale(a)
        return result

    def replace_index(self, index: Expr, by: Expr) -> Line:
        """The line with `by` in place of the symbol `index`."""

        def replace(expression: Expr) -> Expr:
            return expand(expression.subs(index, by))

        return Line(
            {
                Wave(w.function, replace(w.rod), replace(w.lag)): Operator(replace(o.a), replace(o.b))
                for w, o in self.waves.items()
            },
            {
                Source(s.kind, None if s.number is None else replace(s.number), replace(s.lag), s.power): replace(value)
                for s, value in self.loads.items()
            },
        )


def exact(value: Expr | int) -> Expr:
    """A number or an expression, as an expression."""
    return expand(Integer(0) + value)


def wave(function: str, rod: Expr | int, lag: Expr | int) -> Line:
    """The line of one wave."""
    return Line({Wave(function, exact(rod), exact(lag)): Operator(Integer(0), Integer(1))})


def load(kind: str, number: Expr | int | None, power: int, value: Expr | int) -> Line:
    """The line of one load, `value` times tau**power."""
    source = Source(kind, None if number is None else exact(number), Integer(0), power)
    return Line({}, {source: exact(value)}) if value != 0 else Line()
