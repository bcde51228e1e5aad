"""A derivation as text for the terminal: boundary conditions, delay equations, coefficient recurrences."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from functools import partial

from sympy import Add, Expr, Indexed, Integer, Rational
from sympy.printing.str import StrPrinter

from wavesym.derivation.delay import COUNT, INDEX, SYMBOLS, DelayEquation, delay_equations
from wavesym.derivation.line import Source, exact
from wavesym.derivation.recurrence import RATE, CoefficientLaw, SymbolicWeights, recurrence
from wavesym.errors import WavesymError
from wavesym.mechanics.building import BUILDING_FORCE, BUILDING_GROUND
from wavesym.mechanics.collision import COLLISION
from wavesym.mechanics.drive import DRIVE
from wavesym.mechanics.node import Node, System

LARGEST_WRITTEN_OUT = 100
SYSTEMS = {"collision": (COLLISION,), "drive": (DRIVE,), "building": (BUILDING_FORCE, BUILDING_GROUND)}

Place = Callable[[Expr], Expr]


class _Printer(StrPrinter):  # type: ignore[misc]  # SymPy is untyped
    printmethod = "_wavesym"  # Indexed brings a printer of its own for the usual one

    def _print_Indexed(self, expression: Indexed) -> str:
        return f"{expression.base}_{subscript(expression.indices[0])}"

    def _print_Add(self, expression: Add, order: object = None) -> str:
        # positive terms first, so that no sum starts with a minus that it need not have
        parts = sorted(expression.as_ordered_terms(), key=Expr.could_extract_minus_sign)
        return _joined((part, "") for part in parts)

    def _print_Mul(self, expression: Expr) -> str:
        return str(super()._print_Mul(expression)).replace("*", " ")


def text(expression: Expr | int) -> str:
    """An expression, with kappa_i for kappa[i]."""
    return str(_Printer().doprint(exact(expression)))


def subscript(index: Expr | int) -> str:
    """An index, in brackets unless it is one sign."""
    written = text(index).replace(" ", "")
    return written if written.isalnum() else f"({written})"


def derivation_text(name: str, m: int | None = None) -> str:
    """The derivation of a system of the paper, for symbolic m or written out for one m.

    WavesymError for an m that the system does not have, or that is too large to read.
    """
    for system in SYSTEMS[name]:
        if m is not None and m not in range(system.smallest, LARGEST_WRITTEN_OUT + 1, system.step):
            even = "even, " if system.step == 2 else ""
            raise WavesymError(f"--m: {m} given, {even}{system.smallest} ... {LARGEST_WRITTEN_OUT} expected")
    return "\n".join(line for system in SYSTEMS[name] for line in _system(system, m))


def _system(system: System, m: int | None) -> Iterator[str]:
    yield f"{system.name}, " + (f"m = {m}" if m is not None else f"m >= {system.smallest}")
    yield ""
    yield "Boundary conditions, dimensionless (U_i: displacement of rod i)"
    for family in system.families(COUNT, SYMBOLS):
        for at in _places(family.first, family.last, family.step, m):
            alone = exact(family.first - family.last) == 0
            x = exact(family.first) if alone else INDEX
            yield f"  x = {text(at(x))}{_range(family.first, family.last, family.step, m)}:"
            yield from (f"    {line}" for line in _conditions(family.at(x), x, at))
    yield ""
    yield "Delay equations (f', g': derivatives of the waves of (4.2), z: the clock of Table 1)"
    for equation in delay_equations(system):
        for at in _places(equation.first, equation.last, equation.step, m):
            yield f"  {_equation(equation, at)}{_range(equation.first, equation.last, equation.step, m)}"
    yield ""
    laws = recurrence(system)
    start, shift = ("n - 1", "(n - 1)") if laws.interval == 1 else (f"{laws.interval}(n - 1)",) * 2
    yield "Coefficient recurrences"
    yield f"  At z = {start}, n = 1, 2, ..., f_i' gains sum_g sum_k exp(-g w) f_i^n[g,k] w^k with w = z - {shift}."
    yield "  The lines hold for every rate g (0 is a rate like the others) and every power k; ^n is 0 for n < 1."
    yield "  Where [g,k] has no factor on the left, at the body's own rate q, they give [q,k+1]; the last is [q,0]."
    for law in laws.laws:
        for at in _places(law.first, law.last, law.step, m):
            yield f"  {_name(law.function, at(law.rod))}{_range(law.first, law.last, law.step, m)}:"
            yield from (f"    {line}" for line in _law(law, at))
    yield ""


def _places(first: Expr | int, last: Expr | int, step: int, m: int | None) -> Iterable[Place]:
    """How i and m are to be written: as they are, or every i of the range for a given m."""
    if m is None:
        return [exact]
    low, high = (int(exact(bound).subs(COUNT, m)) for bound in (first, last))
    return [partial(_at, i, m) for i in range(low, high + 1, step)]


def _at(i: int, m: int, expression: Expr) -> Expr:
    return exact(expression).subs({INDEX: i, COUNT: m})


def _range(first: Expr | int, last: Expr | int, step: int, m: int | None) -> str:
    if m is not None or exact(first - last) == 0:
        return ""
    second = f" {text(first + step)}," if step > 1 else ""
    return f",  i = {text(first)},{second} ..., {text(last)}"


def _joined(terms: Iterable[tuple[Expr, str]]) -> str:
    """A sum of factor times name, with signs as people write them; 0 where it is empty."""
    written = ""
    for factor, name in terms:
        negative = not isinstance(factor, Add) and factor.could_extract_minus_sign()
        size = -factor if negative else factor
        bracketed = f"({text(size)})" if isinstance(size, Add) and name else text(size)
        term = name if size == 1 and name else f"{bracketed} {name}".rstrip()
        written += (" - " if negative else " + ") + term
    return ("-" if written.startswith(" - ") else "") + written[3:] or "0"


def _conditions(node: Node, x: Expr, at: Place) -> Iterator[str]:
    number = {"left": at(x), "right": at(x + 1)}
    own = number["right"] if node.right else number["left"]
    if node.left and node.right:
        yield f"dU_{subscript(number['left'])}/dtau = dU_{subscript(number['right'])}/dtau"
    left = [(Integer(node.inertia), f"d2U_{subscript(own)}/dtau2"), (exact(node.damping), f"dU_{subscript(own)}/dtau")]
    right = []
    if node.right:
        right.append((at(Rational(1, 2) * node.beta), f"dU_{subscript(number['right'])}/dx"))
    if node.left:
        right.append((at(-Rational(1, 2) * node.alpha), f"dU_{subscript(number['left'])}/dx"))
    for load in node.loads:
        symbol = _source(load.kind, None if load.number is None else exact(load.number), at)
        right += [(at(exact(c)), f"{symbol}{_power('tau', k)}") for k, c in enumerate(load.coefficients)]
    yield f"{_joined(t for t in left if t[0] != 0)} = {_joined(t for t in right if t[0] != 0)}"


def _power(base: str, power: int) -> str:
    return "" if power == 0 else f" {base}" if power == 1 else f" {base}^{power}"


def _name(function: str, rod: Expr) -> str:
    return f"{function}_{subscript(rod)}"


def _clock(lag: Expr) -> str:
    return "(z)" if lag == 0 else f"(z-{text(lag)})"


def _source(kind: str, number: Expr | None, at: Place) -> str:
    return kind if number is None else f"{kind}_{subscript(at(number))}"


def _load(source: Source, at: Place) -> str:
    """H(z), or what of it a load is; the velocities of an impact stand for themselves."""
    clock = _clock(source.lag)
    if source.kind == "impact":
        return f"H{clock}"
    return f"{_source(source.kind, source.number, at)} H{clock}" + _power(
        "z" if source.lag == 0 else clock, source.power
    )


def _equation(e: DelayEquation, at: Place) -> str:
    name = _name(e.function, at(e.rod))
    left = [(at(e.own.a), f"{name}''(z)"), (at(e.own.b), f"{name}'(z)")]
    right = []
    for wave, operator in e.right.waves.items():
        term = _name(wave.function, at(wave.rod))
        right += [(at(operator.a), f"{term}''{_clock(wave.lag)}"), (at(operator.b), f"{term}'{_clock(wave.lag)}")]
    for source, value in e.right.loads.items():
        right.append((at(value), _load(source, at)))
    return f"{_joined(t for t in left if t[0] != 0)} = {_joined(t for t in right if t[0] != 0)}"


def _coefficient(function: str, rod: Expr, back: int, rate: str, power: str) -> str:
    interval = "n" if back == 0 else f"(n-{back})"
    return f"{_name(function, rod)}^{interval}[{rate},{power}]"


def _weighted(w: SymbolicWeights, function: str, rod: Expr, back: int, at: Place) -> list[tuple[Expr, str]]:
    return [
        (at(w.same), _coefficient(function, rod, back, "g", "k")),
        (at(w.raised), _coefficient(function, rod, back, "g", "k+1")),
    ]


def _law(law: CoefficientLaw, at: Place) -> Iterator[str]:
    own = _weighted(law.own, law.function, at(law.rod), 0, at)
    right = [part for t in law.terms for part in _weighted(t.weights, t.function, at(t.rod), t.back, at)]
    yield f"{_joined(t for t in own if t[0] != 0)} = {_joined(t for t in right if t[0] != 0)}"
    for load in law.loads:
        source = _source(load.kind, load.number, at)
        yield f"  and {text(at(load.value))} more at [0,{load.power}] in interval {load.back + 1}, source {source}"
    if law.own.jump != 0:
        jumps = [
            (at(t.weights.jump), f"sum_g {_coefficient(t.function, at(t.rod), t.back, 'g', '0')}")
            for t in law.terms
            if t.weights.jump != 0
        ]
        start = _coefficient(law.function, at(law.rod), 0, "g", "0")
        yield f"q = {text(at(law.own.same.subs(RATE, 0)))};  [q,0] from sum_g {start} = {_joined(jumps)}"
