"""A derivation as people read it: boundary conditions, delay equations, coefficient recurrences of a system."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import partial

from sympy import Expr, Integer, Rational

from wavesym.derivation.delay import COUNT, INDEX, SYMBOLS, DelayEquation, delay_equations
from wavesym.derivation.line import Source, exact
from wavesym.derivation.notation import Text
from wavesym.derivation.recurrence import RATE, CoefficientLaw, SymbolicWeights, recurrence
from wavesym.errors import WavesymError
from wavesym.mechanics.building import BUILDING_FORCE, BUILDING_GROUND
from wavesym.mechanics.collision import COLLISION
from wavesym.mechanics.drive import DRIVE
from wavesym.mechanics.node import Node, System

LARGEST_WRITTEN_OUT = 100
SYSTEMS = {"collision": (COLLISION,), "drive": (DRIVE,), "building": (BUILDING_FORCE, BUILDING_GROUND)}

Place = Callable[[Expr | int], Expr]


@dataclass(frozen=True)
class Entry:
    """What is said of one kind of node or function: which, and its formulas."""

    of: str
    formulas: tuple[str, ...]


@dataclass(frozen=True)
class Statement:
    """A system's derivation in one notation; interval n of every function starts at z = `start`."""

    name: str
    size: str
    start: str
    conditions: tuple[Entry, ...]
    equations: tuple[Entry, ...]
    recurrences: tuple[Entry, ...]


def statements(name: str, m: int | None, notation: Text) -> tuple[Statement, ...]:
    """The derivation of "collision", "drive" or "building" (both bases), for symbolic m or written out for one m.

    WavesymError for an m that the system does not have, or that is too large to read.
    """
    for system in SYSTEMS[name]:
        if m is not None and m not in range(system.smallest, LARGEST_WRITTEN_OUT + 1, system.step):
            even = "even, " if system.step == 2 else ""
            raise WavesymError(f"--m: {m} given, {even}{system.smallest} ... {LARGEST_WRITTEN_OUT} expected")
    return tuple(_Writer(notation, m).statement(system) for system in SYSTEMS[name])


class _Writer:
    """Writes a system's equations in a notation, for symbolic m or for one."""

    def __init__(self, notation: Text, m: int | None) -> None:
        self.n = notation
        self.m = m

    def statement(self, system: System) -> Statement:
        laws = recurrence(system)
        return Statement(
            system.name,
            f"m = {self.m}" if self.m is not None else self.n.at_least(system.smallest),
            "(n - 1)" if laws.interval == 1 else f"{laws.interval} (n - 1)",
            tuple(self._conditions(system)),
            tuple(self._equations(system)),
            tuple(self._laws(laws.laws)),
        )

    def _conditions(self, system: System) -> Iterator[Entry]:
        for family in system.families(COUNT, SYMBOLS):
            alone = exact(family.first - family.last) == 0
            x = exact(family.first) if alone else INDEX
            where = self._range(family.first, family.last, family.step)
            for at in self._places(family.first, family.last, family.step):
                yield Entry(f"x = {self.n.expression(at(x))}{where}", tuple(self._condition(family.at(x), x, at)))

    def _equations(self, system: System) -> Iterator[Entry]:
        for equation in delay_equations(system):
            where = self._range(equation.first, equation.last, equation.step)
            for at in self._places(equation.first, equation.last, equation.step):
                yield Entry(where, (self._equation(equation, at),))

    def _laws(self, laws: Iterable[CoefficientLaw]) -> Iterator[Entry]:
        for law in laws:
            where = self._range(law.first, law.last, law.step)
            for at in self._places(law.first, law.last, law.step):
                yield Entry(f"{self.n.indexed(law.function, at(law.rod))}{where}", tuple(self._law(law, at)))

    def _places(self, first: Expr | int, last: Expr | int, step: int) -> Iterable[Place]:
        """How i and m are to be written: as they are, or every i of the range for a given m."""
        if self.m is None:
            return [exact]
        low, high = (int(exact(bound).subs(COUNT, self.m)) for bound in (first, last))
        return [partial(self._at, i) for i in range(low, high + 1, step)]

    def _at(self, i: int, expression: Expr | int) -> Expr:
        return exact(expression).subs({INDEX: i, COUNT: self.m})

    def _range(self, first: Expr | int, last: Expr | int, step: int) -> str:
        if self.m is not None or exact(first - last) == 0:
            return ""
        return self.n.place(first, first + step if step > 1 else None, last)

    def _balanced(self, left: Iterable[tuple[Expr, str]], right: Iterable[tuple[Expr, str]]) -> str:
        sides = (self.n.joined(term for term in side if term[0] != 0) for side in (left, right))
        return " = ".join(sides)

    def _condition(self, node: Node, x: Expr, at: Place) -> Iterator[str]:
        before, after = at(x), at(x + 1)
        own = after if node.right else before
        if node.left and node.right:
            yield f"{self.n.motion(before, 'tau')} = {self.n.motion(after, 'tau')}"
        left = [
            (Integer(node.inertia), self.n.motion(own, "tau2")),
            (exact(node.damping), self.n.motion(own, "tau")),
        ]
        right = []
        if node.right:
            right.append((at(Rational(1, 2) * node.beta), self.n.motion(after, "x")))
        if node.left:
            right.append((at(-Rational(1, 2) * node.alpha), self.n.motion(before, "x")))
        for load in node.loads:
            symbol = self._source(load.kind, load.number, at)
            right += [(at(c), symbol + self.n.power("tau", k)) for k, c in enumerate(load.coefficients)]
        yield self._balanced(left, right)

    def _source(self, kind: str, number: Expr | int | None, at: Place) -> str:
        return kind if number is None else self.n.indexed(kind, at(number))

    def _load(self, source: Source, at: Place) -> str:
        """H(z), or what of it a load is; the velocities of an impact stand for themselves."""
        clock = self.n.clock(source.lag)
        if source.kind == "impact":
            return f"H{clock}"
        since = "z" if source.lag == 0 else clock
        return f"{self._source(source.kind, source.number, at)} H{clock}" + self.n.power(since, source.power)

    def _equation(self, e: DelayEquation, at: Place) -> str:
        name = self.n.indexed(e.function, at(e.rod))
        left = [(at(e.own.a), f"{name}''(z)"), (at(e.own.b), f"{name}'(z)")]
        right = []
        for wave, operator in e.right.waves.items():
            term, clock = self.n.indexed(wave.function, at(wave.rod)), self.n.clock(wave.lag)
            right += [(at(operator.a), f"{term}''{clock}"), (at(operator.b), f"{term}'{clock}")]
        right += [(at(value), self._load(source, at)) for source, value in e.right.loads.items()]
        return self._balanced(left, right)

    def _weighted(self, w: SymbolicWeights, function: str, rod: Expr, back: int, at: Place) -> list[tuple[Expr, str]]:
        return [
            (at(w.same), self.n.coefficient(function, rod, back, "g", "k")),
            (at(w.raised), self.n.coefficient(function, rod, back, "g", "k+1")),
        ]

    def _law(self, law: CoefficientLaw, at: Place) -> Iterator[str]:
        own = self._weighted(law.own, law.function, at(law.rod), 0, at)
        right = [part for t in law.terms for part in self._weighted(t.weights, t.function, at(t.rod), t.back, at)]
        yield self._balanced(own, right)
        for load in law.loads:
            source = "" if load.kind == "impact" else self._source(load.kind, load.number, at)
            yield self.n.gain(load.back + 1, load.power, self.n.joined([(at(load.value), source)]))
        if law.own.jump != 0:
            start = self.n.total(self.n.coefficient(law.function, at(law.rod), 0, "g", "0"))
            jumps = (
                (at(t.weights.jump), self.n.total(self.n.coefficient(t.function, at(t.rod), t.back, "g", "0")))
                for t in law.terms
            )
            yield f"q = {self.n.expression(at(law.own.same.subs(RATE, 0)))}"
            yield self._balanced([(Integer(1), start)], jumps)
