"""Equations as formulas in a notation: conditions, waves, delay equations, laws and their families."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial

from sympy import Expr, Integer, Rational, Symbol

from wavesym.derivation.delay import COUNT, INDEX, DelayEquation, Side, balance, side, sides
from wavesym.derivation.delay_terms import Line, Source, exact
from wavesym.derivation.node_law import node_law
from wavesym.derivation.recurrence import POWER, RATE, CoefficientLaw, SymbolicLoad, SymbolicWeights, stretch_law
from wavesym.derivation.rods import RodKind
from wavesym.documents.derivation.families import Coefficient, Recursion, solve_at_rates
from wavesym.documents.derivation.highest_powers import PowerFamily, PowerRow, plain
from wavesym.documents.derivation.notation import Text
from wavesym.documents.derivation.patterns import Equal
from wavesym.mechanics.node import Node

Place = Callable[[Expr | int], Expr]

TAU, X = Symbol("tau"), Symbol("x")
OWN = Symbol("q")


class Writer:
    """Writes a system's equations in a notation, for symbolic m or for one."""

    def __init__(self, notation: Text, m: int | None) -> None:
        self.n = notation
        self.m = m

    def places(self, first: Expr | int, last: Expr | int, step: int) -> Iterable[Place]:
        """How i and m are to be written: as they are, or every i of the range for a given m."""
        if self.m is None:
            return [exact]
        low, high = (int(exact(bound).subs(COUNT, self.m)) for bound in (first, last))
        return [partial(self._evaluate, i) for i in range(low, high + 1, step)]

    def _evaluate(self, i: int, expression: Expr | int) -> Expr:
        return exact(expression).subs({INDEX: i, COUNT: self.m})

    def range(self, first: Expr | int, last: Expr | int, step: int) -> str:
        """i = first, ..., last, where i stands for more than one."""
        if self.m is not None or exact(first - last) == 0:
            return ""
        return self.n.place(first, last, step)

    def condition(self, node: Node, x: Expr, at: Place) -> Iterator[str]:
        """Continuity and balance at the node at x."""
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
        yield self.n.balance(left, right)

    def rod(self, kind: RodKind, at: Place) -> Iterator[str]:
        """(4.2) with the constants of Table 1, and velocity and strain in the rod and at its ends."""
        number, rod = kind.number, kind.rod
        forth, back = (TAU - rod.tau0 + sign * (rod.x0 - X) for sign in (1, -1))
        terms = [
            (Integer(1), self.n.with_index("f", at(number)) + self.n.argument(at(forth))),
            (Integer(1), self.n.with_index("g", at(number)) + self.n.argument(at(back))),
            (at(rod.velocity), self.n.expression(TAU)),
        ]
        yield self.n.constants(at(number), at(rod.tau0), at(rod.x0), at(rod.velocity))
        yield self.n.balance([(Integer(1), self.n.with_index("U", at(number)))], terms)
        for x, outgoing in ((number - 1, "f"), (number, "g")):
            yield from self._end(side(rod, number, x, outgoing), self.n.where(at(x)), at)

    def _end(self, end: Side, where: str, at: Place) -> Iterator[str]:
        for by, line in (("tau", end.velocity), ("x", end.strain)):
            yield f"{self.n.motion(at(end.rod), by)} = {self._in_time(line, at)}{where}"

    def at_node(self, node: Node, x: Expr, at: Place) -> Iterator[str]:
        """Continuity and balance at the node at x with (4.2) put in, on the clock tau of the node."""
        left, right = sides(node, x)
        if left and right:
            yield f"{self._in_time(left.velocity, at)} = {self._in_time(right.velocity, at)}"
        motion, force = balance(node, x)
        yield f"{self._in_time(motion, at)} = {self._in_time(force, at)}"

    def stretch(self, node: Node, x: Expr, at: Place) -> Iterator[str]:
        """The law of the node at x on powers of time, where no front passes."""
        law = stretch_law(node_law().with_numbers(node))
        own = [(at(law.own.same), self.n.term("q", POWER)), (at(law.own.next_power), self.n.term("q", POWER + 1))]
        arriving = ((law.left, "a"), (law.right, "b"), (law.load if node.loads else Integer(0), "s"))
        right = [(at(factor), self.n.term(name, POWER)) for factor, name in arriving]
        yield self.n.balance(own, right)

    def _in_time(self, line: Line, at: Place) -> str:
        """A line in waves of tau; what a load is before tau = 0 need not be said there."""
        terms = []
        for wave, operator in line.waves.items():
            name, clock = self.n.with_index(wave.function, at(wave.rod)), self.n.argument(at(TAU - wave.lag))
            terms += [(at(operator.a), f"{name}''{clock}"), (at(operator.b), f"{name}'{clock}")]
        for source, value in line.loads.items():
            name = "" if source.kind == "impact" else self._source(source.kind, source.number, at)
            terms.append((at(value), (name + self.n.power("tau", source.power)).strip()))
        return self.n.sum_terms(term for term in terms if term[0] != 0)

    def _source(self, kind: str, number: Expr | int | None, at: Place) -> str:
        return kind if number is None else self.n.with_index(kind, at(number))

    def _load(self, source: Source, at: Place) -> str:
        """H(z), or what of it a load is; the velocities of an impact stand for themselves."""
        clock = self.n.clock(source.lag)
        if source.kind == "impact":
            return f"H{clock}"
        since = "z" if source.lag == 0 else clock
        return f"{self._source(source.kind, source.number, at)} H{clock}" + self.n.power(since, source.power)

    def equation(self, e: DelayEquation, at: Place) -> str:
        """A delay equation."""
        name = self.n.with_index(e.function, at(e.rod))
        left = [(at(e.own.a), f"{name}''(z)"), (at(e.own.b), f"{name}'(z)")]
        right = []
        for wave, operator in e.right.waves.items():
            term, clock = self.n.with_index(wave.function, at(wave.rod)), self.n.clock(wave.lag)
            right += [(at(operator.a), f"{term}''{clock}"), (at(operator.b), f"{term}'{clock}")]
        right += [(at(value), self._load(source, at)) for source, value in e.right.loads.items()]
        return self.n.balance(left, right)

    def _weight_terms(
        self, w: SymbolicWeights, function: str, rod: Expr, back: int, at: Place
    ) -> list[tuple[Expr, str]]:
        return [
            (at(w.same), self.n.coefficient(function, rod, back, RATE, POWER)),
            (at(w.next_power), self.n.coefficient(function, rod, back, RATE, POWER + 1)),
        ]

    def law(self, law: CoefficientLaw, at: Place) -> Iterator[str]:
        """A recurrence for every rate and power, its loads, and its jump."""
        own = self._weight_terms(law.own, law.function, at(law.rod), 0, at)
        right = [part for t in law.terms for part in self._weight_terms(t.weights, t.function, at(t.rod), t.back, at)]
        yield self.n.balance(own, right)
        yield from self._gains(law.loads, at)
        q = law.own_rate
        if q is not None:
            zero = Integer(0)
            start = self.n.total(self.n.coefficient(law.function, at(law.rod), 0, RATE, zero))
            jumps = (
                (at(t.weights.jump), self.n.total(self.n.coefficient(t.function, at(t.rod), t.back, RATE, zero)))
                for t in law.terms
            )
            yield f"q = {self.n.expression(at(q))}"
            yield self.n.balance([(law.own.jump, start)], jumps)

    def _gains(self, loads: Iterable[SymbolicLoad], at: Place) -> Iterator[str]:
        for load in loads:
            source = "" if load.kind == "impact" else self._source(load.kind, load.number, at)
            yield self.n.gain(load.back + 1, load.power, self.n.sum_terms([(at(load.value), source)]))

    def families(
        self, law: CoefficientLaw, rates: tuple[Expr, ...] | None, names: Mapping[Expr, Expr]
    ) -> Iterator[str]:
        """A law solved at each of `rates`, or at its own rate, told first, and at any other rate g.

        Where a coefficient says its rate `names` has a shorter word for some of them.
        """
        own = law.own_rate
        if rates is None and own is not None and own != 0:
            yield f"{self.n.expression(OWN)} = {self.n.expression(own)}"
            names = {own: OWN}
        for line in solve_at_rates(law, rates):
            yield self._solution(line, own, names)
            yield from self._gains(line.loads, exact)

    def _solution(self, line: Recursion, own: Expr | None, names: Mapping[Expr, Expr]) -> str:
        def rate_name(rate: Expr) -> Expr:
            return names.get(rate, rate)

        def coefficient(c: Coefficient) -> str:
            written = self.n.coefficient(c.function, c.rod, c.back, rate_name(c.rate), c.power)
            return self.n.total(written, rate_name(own) if c.sum_range == "other" else None) if c.sum_range else written

        among = ""
        if line.least:
            among = self.n.upwards(line.least)
        elif own is not None and line.left.rate == RATE:
            among = self.n.unless(rate_name(own))
        right = [(factor, coefficient(c)) for factor, c in line.parts]
        return f"{coefficient(line.left)} = {self.n.quotient(right, line.divisor)}{among}"

    def equal(self, pair: Equal) -> Iterator[str]:
        """Which parameters are equal."""
        where = self.range(pair.first, pair.last, pair.step)
        for at in self.places(pair.first, pair.last, pair.step):
            yield f"{self.n.expression(at(pair.left))} = {self.n.expression(at(pair.right))}{where}"

    def power(self, family: PowerFamily, row: PowerRow, at: Place) -> str:
        """The highest power that a function has beside a family's rate, and for which sources it is not 0."""
        budget = at(plain(family, row))
        power = exact(budget / family.period)
        if all(value.is_integer for value in power.as_coefficients_dict().values()):
            highest = self.n.expression(power)
        else:
            highest = self.n.fraction(self.n.expression(budget), True, Integer(family.period))
        if family.period > 2:  # there and back is even, so that half of it is whole
            highest = self.n.whole(highest)
        always = all(value % 2 == 0 for value in row.start.as_coefficients_dict().values())
        since = "" if always else self.n.even(self.n.expression(at(row.start)))
        return f"K = {highest}{since}"
