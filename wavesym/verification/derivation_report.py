"""What `verify --derived` shows: the derivation proved for all i, m, n and k, and its tables found by another route.

An argument is the same for every system: what is put into what, and why that is enough; what differs is told from what
a proof went through.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from textwrap import wrap
from typing import NamedTuple

from flint import fmpq
from sympy import Add, Expr, Function, Mul, Symbol, cancel, fraction, together

from wavesym.derivation.delay import delay_equations
from wavesym.derivation.recurrence import POWER, Recurrence, recurrence
from wavesym.derivation.symbolic import unlike_chain
from wavesym.derivation.table import full_table
from wavesym.documents.derivation.families import solve_at_rates
from wavesym.documents.derivation.highest_powers import INTERVAL, PowerFamily, PowerRow, plain
from wavesym.documents.derivation.highest_powers import POWERS as FAMILIES
from wavesym.documents.derivation.notation import Text
from wavesym.documents.derivation.patterns import patterns, rates
from wavesym.mechanics.node import System
from wavesym.systems import presets
from wavesym.verification.powers import NUMBERS, Step, steps
from wavesym.verification.proofs import Outgoing, node_law, with_delays
from wavesym.verification.theorem import A, B, at_front, operator_coefficient, residuals
from wavesym.verification.walks import differences

INTERVALS = 5
_WIDTH = 110
_INDENT = " " * 6
_SHOWN = 3
_TEXT = Text()
_TEXT = Text()
_NUMBERS: dict[str, Callable[[int], fmpq]] = {
    "kappa": lambda i: fmpq(2 * i + 1, i + 4),
    "inertia": lambda i: fmpq(i + 4, 2 * i + 3),
    "velocity": lambda i: fmpq(5, i + 1) - i,
    "dashpot": lambda i: fmpq(1, i + 5),
}


@dataclass(frozen=True)
class Theorem:
    """What is claimed of every system, why it holds where a proof passes, and what a proof counts."""

    claim: str
    argument: str
    count_noun: str


def _and(names: Iterable[str]) -> str:
    *first, last = dict.fromkeys(names)
    return f"{', '.join(first)} and {last}" if first else last


def _product(factors: Expr) -> str:
    return " ".join(
        f"({_TEXT.expression(factor)})" if isinstance(factor, Add) else _TEXT.expression(factor)
        for factor in Mul.make_args(factors.factor())
    )


def _operator_text() -> str:
    """What an operator leaves of coefficients, as the proof has it."""
    of = Function("F")
    form = operator_coefficient().subs({A: Symbol("a"), B: Symbol("b")})
    return " + ".join(f"{_product(form.coeff(of(POWER + n)))} F[g,{'k+1' if n else 'k'}]" for n in (0, 1))


def _jump() -> str:
    (phi,) = at_front().atoms(Function("phi"))
    return f"{_product(at_front().coeff(phi).subs(A, Symbol('a')))} sum_g F[g,0]"


NODE_LAW = Theorem(
    "The delay equations are the node law, for all i and m.",
    "No number is put in for i, m or a parameter. The delay equations, and the law of a node, (2.4) with (2.3) and "
    "(4.2), are put in Laplace images: D becomes s, a delay by one rod exp(-s), a load a power of 1/s. At a node "
    "either of them is then one linear equation for each wave that leaves it; what a free end sends back is put "
    "into the others. Both are solved for these waves: the one solution less the other is 0 as a rational function. "
    "As neither determinant is 0, neither has another solution. So each follows from the other, at every node.",
    "waves",
)
RECURRENCES = Theorem(
    "The recurrences solve the delay equations, for all i, m, n and k.",
    "By induction over the interval n. What stands on the right of a delay equation was found before: a sum over "
    "rates g of exp(-g w) F[g,k] w^k, w the time in the interval, in which every F[g,k] stays a symbol. Of such a "
    f"sum a D + b leaves {_operator_text()} at exp(-g w) w^k, and {_jump()} at the front, w = 0. For the coefficient "
    "that a recurrence gives, at k and at k+1, its right side is put in; what is then left of the delay equation is 0 "
    "as a rational function of all symbols, i, m and k among them: at every rate and power, at each load, and at the "
    "front. So interval n solves the delay equations whatever came before it, and all intervals do. The rate g is "
    "first a symbol too, then each of those that occur.",
    "residuals",
)
POWERS = Theorem(
    "No power is higher than is stated, for all i, m, n, l and s.",
    "Stated is, for the increments of interval n, the highest power of w beside exp(-g w), and a number since: "
    "while it is negative they are 0. By induction over the intervals, and within one over the functions in the "
    "order in which they are found: a law gives a function as a sum of terms, functions that are found before. With "
    "budget for the power before it is divided and rounded, the function keeps to what is stated if, for each term, "
    "since is at least that of the term, and budget at least that of the term, by the divisor more where the law "
    "adds the rate once more; if budget >= since where this may be the first time; and if both are >= 0 where a "
    "load starts the function. The places of function, body, source and end are written by numbers "
    f"{_and(map(str, NUMBERS))} = 0, 1, 2, ..., before, at and behind one another. Then every difference that is to "
    "be at least 0 is a sum of such numbers and 1 in which no coefficient is negative: it is at least 0 for all of "
    "them.",
    "inequalities",
)
WALKS = Theorem(
    "Tables are what walk polynomials give.",
    "For small chains, in exact numbers. A wave goes from node to node, and each visit to a body is a factor T = "
    "q/(s + q), q the rate of the body. Summed over all walks of some length this is a polynomial in the letters T "
    "with whole coefficients, which partial fractions turn into exponentials times powers. Only nodes and physical "
    "time are used; every increment is the same.",
    "increments",
)


class Proof(NamedTuple):
    """A theorem for a system: of what of it, what the proof went through, how many cases it has, where it fails."""

    theorem: Theorem
    subject: str
    route: str
    cases: int
    failures: tuple[str, ...]

    @property
    def holds(self) -> bool:
        """Whether there were cases, and it held in each."""
        return self.cases > 0 and not self.failures


def derivation_report(watch: Callable[[list[System]], Iterable[System]] = iter) -> tuple[str, bool]:
    """Every theorem with its argument and its proofs, and whether all hold.

    `watch` goes through the systems as they are proved.
    """
    systems = [system for preset in presets().values() for system in (*preset.variants, *preset.companions)]
    proofs = [proof for system in watch(systems) for proof in (*_proofs(system), _walks(system))]
    theorems = dict.fromkeys(proof.theorem for proof in proofs)
    lines = (line for theorem in theorems for line in _lines(theorem, [p for p in proofs if p.theorem is theorem]))
    return "\n".join(lines), all(proof.holds for proof in proofs)


def _lines(theorem: Theorem, proofs: Iterable[Proof]) -> Iterator[str]:
    yield theorem.claim
    yield from wrap(theorem.argument, _WIDTH, initial_indent="  ", subsequent_indent="  ")
    for proof in proofs:
        held = proof.cases - len(proof.failures)
        yield f"  {'PASS' if proof.holds else 'FAIL'}  {proof.subject}: {held} of {proof.cases} {theorem.count_noun}"
        yield from wrap(proof.route, _WIDTH, initial_indent=_INDENT, subsequent_indent=_INDENT)
        yield from (f"{_INDENT}Not so: {where}" for where in proof.failures[:_SHOWN])
    yield ""


def _proofs(system: System) -> Iterator[Proof]:
    """For symbolic i, m, n, k and parameters."""
    waves = list(node_law(system, delay_equations(system)))
    unlike = tuple(
        f"{wave.function} of rod {wave.rod} differs by {wave.difference}"
        for wave in waves
        if wave.difference != 0 or 0 in wave.determinants
    )
    yield Proof(NODE_LAW, system.name, determinants(waves), len(waves), unlike)
    for pattern in patterns(system):
        laws = recurrence(system, pattern.parameters)
        known = rates(laws.laws)
        left = [
            (e, residual)
            for found in (None, known)
            for e, law in zip(delay_equations(system, pattern.parameters), laws.laws, strict=True)
            for residual in residuals(e, solve_at_rates(law, found), laws.interval)
        ]
        unsolved = tuple(f"the equation of {e.function} of rod {e.rod} leaves {rest}" for e, rest in left if rest != 0)
        yield Proof(RECURRENCES, f"{system.name}, {pattern.name}", rates_met(laws, known), len(left), unsolved)
    for family in FAMILIES.get(system.name, ()):
        inequalities = list(steps(system, family))
        beyond = tuple(
            f"{step.function}, {step.because}, {step.where}: {step.slack} is not at least 0"
            for step in inequalities
            if not step.holds
        )
        of = f"{system.name}, {family.subject.replace('$', '')}"
        yield Proof(POWERS, of, arrangements(family, inequalities), len(inequalities), beyond)


def _walks(system: System) -> Proof:
    """The exact tables of small chains, from walk polynomials."""
    chains = [unlike_chain(system, m) for m in (system.smallest, system.smallest + system.step)]
    tables = [full_table(chain, INTERVALS, fmpq(0)) for chain in chains]
    gains = sum(
        len(gained) for table in tables for response in table.responses.values() for gained in response.values()
    )
    found = tuple(
        f"m = {chain.m}: {one}"
        for chain, table in zip(chains, tables, strict=True)
        for one in differences(chain, table)
    )
    return Proof(WALKS, f"{system.name}, m = {chains[0].m} and {chains[1].m}, {INTERVALS} intervals", "", gains, found)


# what proofs went through


def determinants(waves: Sequence[Outgoing]) -> str:
    """The determinants of both systems of equations, by node."""
    nodes: dict[tuple[Expr, Expr], list[str]] = {}
    for wave in waves:
        nodes.setdefault(wave.determinants, []).append(_TEXT.with_index(wave.function, wave.rod))
    texts = (f"{_and(names)}: {_image(one)} and {_image(other)}" for (one, other), names in nodes.items())
    return f"Determinants, of the delay equations and of the node law: {'; '.join(texts)}."


def _image(expression: Expr) -> str:
    above, below = map(with_delays, fraction(cancel(together(expression))))
    return _TEXT.quotient([(term, "") for term in Add.make_args(above)], below)


def rates_met(recurrence: Recurrence, rates: Iterable[Expr]) -> str:
    """The functions and the rates of a system's recurrences."""
    functions = _and(_TEXT.with_index(law.function, law.rod) for law in recurrence.laws)
    return f"Functions: {functions}. Rates: any g; {', '.join(map(_TEXT.expression, rates))}."


def arrangements(family: PowerFamily, made: Sequence[Step]) -> str:
    """What is stated of a family, and how many inequalities show it."""
    rows = "; ".join(
        f"{_kind(family, row)} {_power(family, row)}, since {_TEXT.expression(row.start)}" for row in family.rows
    )
    free = {symbol for step in made for symbol in step.slack.free_symbols}
    drops = "" if INTERVAL in free else "n drops out of the differences. "
    return (
        f"Stated for exp(-g w), g = {_TEXT.expression(family.rate)}: {rows}. {drops}"
        f"{len({step.where for step in made})} arrangements of the places; {sum(step.slack == 0 for step in made)} "
        f"of the differences are 0."
    )


def _kind(family: PowerFamily, row: PowerRow) -> str:
    name = _TEXT.with_index(row.function, row.rod)
    if row.first == row.last:
        return name
    second = row.first + row.step
    return f"{name} (i = {_TEXT.expression(row.first)}, {_TEXT.expression(second)}, ..., {_TEXT.expression(row.last)})"


def _power(family: PowerFamily, row: PowerRow) -> str:
    budget = _TEXT.expression(plain(family, row))
    return budget if family.period == 1 else f"floor(({budget})/{family.period})"
