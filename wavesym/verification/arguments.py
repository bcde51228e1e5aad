"""What `verify --derived` proves, and how, in sentences: what is put into what, and why that is enough.

An argument is the same for every system; what differs is told from what the proof went through.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from sympy import Add, Expr, Function, Mul, Symbol, cancel, fraction, together

from wavesym.derivation.recurrence import POWER, Recurrence
from wavesym.documents.derivation.highest_powers import INTERVAL, PowerFamily, PowerRow, plain
from wavesym.documents.derivation.notation import Text
from wavesym.verification.powers import NUMBERS, Step
from wavesym.verification.proofs import Outgoing, with_delays
from wavesym.verification.theorem import A, B, at_front, operator_coefficient

_TEXT = Text()


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
