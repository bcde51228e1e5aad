"""The derivation of a chain that is written out: the law of each kind of joint, in symbols and in its numbers."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from math import prod

from flint import fmpq, fmpq_poly
from sympy import Expr, Integer, Matrix, Poly, Symbol, fraction, together

from wavesym.derivation.delay_terms import Operator
from wavesym.derivation.node_law import node_law
from wavesym.derivation.numbers import expression
from wavesym.derivation.recurrence import POWER, RATE, joint_rule, weights
from wavesym.documents.derivation.joint_kinds import Kind, LoneJoint, describe_joint, isolate_joint, kinds, values
from wavesym.documents.derivation.notation import Text
from wavesym.exact.tables.joint_response import JointResponse, joint_polynomial, joint_response, rates
from wavesym.exact.tables.network_joints import MOST_POINTS
from wavesym.mechanics.network import Network
from wavesym.numbers.ratio import Ratio

MOST_SYMBOLIC = 2  # points of a joint whose polynomial in symbols anybody reads
_S, _Q = Symbol("s"), Symbol("q")


@dataclass(frozen=True)
class RodEntry:
    """A rod of the chain: what it is called, the nodes that it joins, and its numbers."""

    name: str
    between: str
    formulas: tuple[str, ...]


@dataclass(frozen=True)
class JointLaws:
    """A joint: what it is or where, its numbers, its law, what it sends into its rods, its polynomial, its answer.

    `answer` is what tables run: empty in symbols, and where the polynomial does not split over the rationals.
    """

    of: str
    given: tuple[str, ...]
    laws: tuple[str, ...]
    sent: tuple[str, ...]
    polynomial: tuple[str, ...]
    answer: tuple[str, ...]


@dataclass(frozen=True)
class JointKind:
    """A kind of joint in symbols, and those of the chain that are of it."""

    symbols: JointLaws
    joints: tuple[JointLaws, ...]


@dataclass(frozen=True)
class NetworkStatement:
    """templates/text/network.txt.j2 and templates/latex/network.tex.j2.

    `node` is the law that SymPy derives at a node between two rods, `factor` and `powers` what the two ansaetze make of
    D + q and of the law of a joint.
    """

    name: str
    rods: tuple[RodEntry, ...]
    node: tuple[str, ...]
    end: tuple[str, ...]
    factor: tuple[str, ...]
    powers: tuple[str, ...]
    kinds: tuple[JointKind, ...]


def network_statement(name: str, network: Network, notation: Text) -> NetworkStatement:
    """The derivation of a chain."""
    author = _Author(network, notation)
    return NetworkStatement(
        name=notation.word(name),
        rods=tuple(author.rods()),
        node=tuple(author.node()),
        end=tuple(author.end()),
        factor=tuple(author.factor()),
        powers=tuple(author.powers()),
        kinds=tuple(map(author.kind, kinds(network))),
    )


class _Author:
    def __init__(self, network: Network, notation: Text) -> None:
        self.network = network
        self.n = notation

    def rods(self) -> Iterator[RodEntry]:
        for number, bar in enumerate(self.network.bars, 1):
            names = [self._joint_name(point) for point in (bar.left, bar.right)]
            numbers = (("T", bar.delay), ("Z", bar.impedance), ("c", bar.speed), ("v", bar.velocity), ("e", bar.strain))
            shown = (f"{letter} = {self.n.expression(expression(size))}" for letter, size in numbers)
            yield RodEntry(self.n.word(bar.name or str(number)), self.n.word(" -- ".join(names)), tuple(shown))

    def node(self) -> Iterator[str]:
        law = node_law()
        own = [(law.own.a, "q'"), (law.own.b, "q")]
        yield self.n.balance(own, [(law.left, "a"), (law.right, "b"), (law.load, "S")])

    def end(self) -> Iterator[str]:
        """What a rod's end brings to a joint: the law of a node taken apart."""
        rule = joint_rule()
        for radiates, arrives in dict.fromkeys(zip(rule.radiates, rule.arrives, strict=True)):
            ratio, impedance = Symbol("n"), Symbol("Z")
            brought = [(expression(radiates) * ratio**2 * impedance, "q")]
            yield self.n.balance(brought, [(expression(arrives) * ratio * impedance, "a")])

    def factor(self) -> Iterator[str]:
        """What D + q, a factor of a polynomial, does to exponentials times powers."""
        law = weights(Operator(Integer(1), _Q))
        own = [(law.same, self.n.coefficient_name("y", "g,k")), (law.next_power, self.n.coefficient_name("y", "g,k+1"))]
        yield self.n.balance(own, [(Integer(1), self.n.coefficient_name("s", "g,k"))])

    def powers(self) -> Iterator[str]:
        """What the law of a joint does to powers alone: the ansatz at rate 0."""
        mass, damping = Symbol("M"), Symbol("C")
        law = weights(Operator(mass, damping))
        going_up = (law.next_power / mass).cancel(), f"M {self.n.term('q', POWER + 1)}"
        own = [going_up, (law.same.subs(RATE, 0), self.n.term("q", POWER))]
        yield self.n.balance([*own, (Symbol("K"), self.n.term("u", POWER))], [(Integer(1), self.n.term("s", POWER))])
        yield self.n.balance([(POWER + 1, self.n.term("u", POWER + 1))], [(Integer(1), self.n.term("q", POWER))])

    def kind(self, kind: Kind) -> JointKind:
        joints = (self._joint(number) for number in kind.numbers)
        made = kind.symbols
        words = self.n.word(" | ".join(describe_joint(made)))
        laws, sent, polynomial = (tuple(write(made)) for write in (self._laws, self._outgoing, self._symbolic))
        return JointKind(JointLaws(words, (), laws, sent, polynomial, ()), tuple(joints))

    def _joint(self, number: int) -> JointLaws:
        made = isolate_joint(self.network, number)
        given = (
            f"{self._symbol(name)} = {self.n.expression(expression(value))}" for name, value in values(made).items()
        )
        of = ", ".join(self._joint_name(point) for point in self.network.joints[number].points)
        ends = self.network.joints[number].ends
        rods = ", ".join(self.network.bars[end.bar].name or str(end.bar + 1) for end, _ in ends)
        return JointLaws(
            self.n.word(f"{of}; rods {rods}" if len(ends) > 1 else f"{of}; rod {rods}" if ends else of),
            tuple(given),
            tuple(self._laws(made)),
            tuple(self._outgoing(made)),
            tuple(self._polynomial(made)),
            tuple(self._answer(made)),
        )

    def _joint_name(self, number: int) -> str:
        point = self.network.points[number]
        return f"{point.name}, x = {point.place}" if point.name else f"x = {point.place}"

    def _laws(self, made: LoneJoint) -> Iterator[str]:
        """M q' + C q + K u = sum of 2 n Z a + F, row by row; what is prescribed, as it is."""
        law = made.law
        for i in range(len(law.mass)):
            if law.motions[i] is not None:
                prime = "'" if law.motions[i] == "acceleration" else ""
                yield self.n.balance([(Integer(1), self.n.with_index("q", i + 1) + prime)], self._force(made, i))
                continue
            own = [(_expression(law.mass[i]), self.n.with_index("q", i + 1) + "'")]
            for letter, matrix in (("q", law.damping), ("u", law.stiffness)):
                own += [(_expression(c), self.n.with_index(letter, j + 1)) for j, c in enumerate(matrix[i])]
            yield self.n.balance(own, [*self._arriving(made, i), *self._force(made, i)])

    def _arriving(self, made: LoneJoint, i: int) -> Iterator[tuple[Expr, str]]:
        """2 n Z a of the rod ends at a point."""
        rule = joint_rule()
        for e, (end, at) in enumerate(made.joint.ends, 1):
            if at == i:
                bar = made.network.bars[end.bar]
                factor = rule.arrives[1 - end.side] * bar.ratios[end.side] * bar.impedance
                yield _expression(factor), self.n.with_index("a", e)

    def _force(self, made: LoneJoint, i: int) -> list[tuple[Expr, str]]:
        return [(Integer(1), self.n.with_index("F", i + 1))] if made.network.points[i].loads else []

    def _motion_terms(self, made: LoneJoint, i: int) -> Iterator[tuple[Expr, str]]:
        """What points whose motion is prescribed do to another, through springs and dashpots."""
        law = made.law
        for letter, matrix in (("q", law.damping), ("u", law.stiffness)):
            for j, given in enumerate(law.motions):
                if given not in (None, "fixed") and matrix[i][j] != 0:
                    yield -_expression(matrix[i][j]), self.n.with_index(letter, j + 1)

    def _outgoing(self, made: LoneJoint) -> Iterator[str]:
        """n q - a into each end."""
        for e, (end, at) in enumerate(made.joint.ends, 1):
            ratio = _expression(made.network.bars[end.bar].ratios[end.side])
            terms = [(ratio, self.n.with_index("q", at + 1)), (Integer(-1), self.n.with_index("a", e))]
            yield f"{self.n.with_index('l', e)} = {self.n.sum_terms(terms)}"

    def _symbolic(self, made: LoneJoint) -> Iterator[str]:
        """The determinant of M s + C + K/s in symbols, and the rate of a joint that has one."""
        free = sorted((*made.law.heavy, *made.law.light))
        if not 0 < len(free) <= MOST_SYMBOLIC:
            return
        polynomial = symbolic_polynomial(made)
        coefficients = polynomial.all_coeffs()
        yield self._in_s(coefficients)
        if len(coefficients) == 2:
            first, last = coefficients
            rate = self.n.quotient([(part, "") for part in last.as_ordered_terms()], first)
            yield f"{self.n.expression(RATE)} = {rate}"

    def _polynomial(self, made: LoneJoint) -> Iterator[str]:
        """The same in numbers, and its factors."""
        free = len(made.law.heavy) + len(made.law.light)
        if not 0 < free <= MOST_POINTS:
            return
        polynomial = joint_polynomial(made.law)
        yield self._in_s([expression(c) for c in reversed(polynomial.coeffs())])
        content, factors = polynomial.factor()
        if polynomial.degree() > 1:
            content = prod((factor.leading_coefficient() ** power for factor, power in factors), start=fmpq(content))
            parts = ((factor / factor.leading_coefficient(), power) for factor, power in factors)
            yield self.n.sum_terms([(expression(content), " ".join(self._power(*part) for part in parts))])

    def _power(self, factor: fmpq_poly, power: int) -> str:
        within = self._in_s([expression(c) for c in reversed(factor.coeffs())])
        return f"({within})^{power}" if power > 1 else f"({within})"

    def _answer(self, made: LoneJoint) -> Iterator[str]:
        """The inverse in partial fractions where the polynomial splits; s, where it is more than waves and loads."""
        law = made.law
        if len(law.mass) > MOST_POINTS or rates(law) is None:
            return
        response: JointResponse = joint_response(law)
        for i in sorted((*law.heavy, *law.light)):
            if moved := list(self._motion_terms(made, i)):
                all_of_it = [*self._arriving(made, i), *self._force(made, i), *moved]
                yield self.n.balance([(Integer(1), self.n.with_index("s", i + 1))], all_of_it)
        for i in sorted((*law.heavy, *law.light)):
            terms = []
            for j in sorted((*law.heavy, *law.light)):
                pushed = self.n.with_index("s", j + 1)
                terms.append((expression(response.direct.get((i, j), fmpq(0))), pushed))
                for pole in response.poles:
                    for k, residues in enumerate(pole.residues, 1):
                        below = self._polynomial_text("D", [Integer(1), expression(pole.rate)])
                        terms.append(
                            (expression(residues.get((i, j), fmpq(0))), self.n.power_fraction(pushed, below, k))
                        )
            yield f"{self.n.with_index('q', i + 1)} = {self.n.sum_terms(term for term in terms if term[0] != 0)}"

    def _in_s(self, coefficients: Iterable[Expr]) -> str:
        return self._polynomial_text("s", coefficients)

    def _polynomial_text(self, variable: str, coefficients: Iterable[Expr]) -> str:
        """A polynomial, from its highest coefficient down."""
        highest_first = list(coefficients)
        powers = range(len(highest_first) - 1, -1, -1)
        names = (self.n.expression(Symbol(variable) ** k) if k else "" for k in powers)
        terms = zip(highest_first, names, strict=True)
        return self.n.sum_terms(term for term in terms if term[0] != 0)

    def _symbol(self, name: str) -> str:
        letter, _, index = name.partition("_")
        return self.n.with_index(letter, Integer(index))


def symbolic_polynomial(made: LoneJoint) -> Poly:
    """The determinant of M s + C + K/s of the free points, times the powers of s that clear it, as SymPy has it."""
    law = made.law
    free = sorted((*law.heavy, *law.light))

    def entry(a: int, b: int) -> Expr:
        inertia = _expression(law.mass[free[a]]) if a == b else Integer(0)
        damping, stiffness = (_expression(matrix[free[a]][free[b]]) for matrix in (law.damping, law.stiffness))
        return inertia * _S + damping + stiffness / _S

    determinant, _ = fraction(together(Matrix(len(free), len(free), entry).det(method="berkowitz").expand()))
    return Poly(determinant.expand(), _S)


def _expression(value: fmpq | Ratio) -> Expr:
    return expression(value).expand()
