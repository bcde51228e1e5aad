"""The formulas of an example as they are right, all on one chain: what some of them say goes into the others.

Every wave is a number times e^(s z), and H(z) is e^(s z) as well: then a derivative is a factor s, and a delay of 1 a
factor 1/E with E = e^s. The formulas are linear with constant coefficients: what follows from others of them does so
for any numbers s and E. The conditions (4.3), (4.4) or (4.5) with (4.2), Table 1 and (3.1) are as many equations as
there are waves. Their one solution has to satisfy (4.6), (4.7) or (4.8), and (2.3) and (2.4) in physical units.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import pytest
from flint import fmpq, fmpq_mat

from tests.papers.falsified import ENTRIES
from wavesym.derivation.table import Function
from wavesym.papers.evaluation import MeaninglessError, Scope, items, sides, span
from wavesym.papers.exact_numbers import Jet
from wavesym.papers.pielorz1979.chains import Exact, LoadedChain
from wavesym.papers.pielorz1979.coefficients import STEP, ListRun, right_lines, truth, unknowns
from wavesym.papers.pielorz1979.letters import Motion
from wavesym.papers.pielorz1979.transcript import right_reading
from wavesym.papers.record import Reading, reading
from wavesym.papers.tree import Call, Derivative, Progression, Symbol, Tree, latex

Formulas = Mapping[str, Reading]

SIZES = {"I": (4, 6), "II": (1, 2, 3), "III": (2, 3, 4)}
KAPPA = {"I": "(4.3).kappa", "II": "(4.4).kappa", "III": "(4.5).kappa"}
DISPLACEMENTS = {"I": r"\baru", "II": r"\bar\theta", "III": r"\bary"}
CONDITIONS = {"I": "(4.3).", "II": "(4.4).", "III": "(4.5)."}
S, E = fmpq(5, 7), fmpq(11, 4)
U_0, L, C, RHO = fmpq(3, 8), fmpq(7), fmpq(13, 6), fmpq(9, 5)
AREA = {"F": fmpq(7, 6), "n": fmpq(4), "A": fmpq(2, 9)}


def range_of(name: str, ranges: Iterable[Tree]) -> Progression:
    """The range of a variable; MeaninglessError where it has none."""
    for r in ranges:
        if isinstance(r, Progression) and r.variable == Symbol(name):
            return r
    raise MeaninglessError(f"{name} has no range")


MODEL = "(4.5).1"
"""Holds as mathematics alone."""


def _right(id: str) -> Reading:
    """A formula as it is right; of a model that the text does not mean as printed: the others go with that."""
    if id == MODEL:
        return reading(ENTRIES[id].printed, ENTRIES[id].ranges)
    return right_reading(id)


RIGHT: Formulas = {
    id: _right(id)
    for id, entry in ENTRIES.items()
    if entry.kind in ("condition", "delay", "solution", "load", "constant") or id.startswith("T1.")
}


class OneChain(Scope):
    """What all letters mean on the chain of an example."""

    def __init__(self, name: str, m: int, formulas: Formulas) -> None:
        constants = {"l": L, "C": C, r"\rho": RHO, "E": RHO * C**2, "G": RHO * C**2, **AREA}
        super().__init__({"m": m, **constants})
        self.name, self.m, self.formulas = name, m, formulas
        self.waves: dict[tuple[str, int], fmpq] = {}

    def of(self, id: str, number: int) -> Any:
        """What a formula or cell gives for an i."""
        with self.bind({"i": number}):
            formula = self.formulas[id].formula
            return self.value(formula if id.startswith("T1.") else sides(formula)[1])

    def numbers(self, id: str) -> tuple[int, ...]:
        return span(range_of("i", self.formulas[id].ranges), self)

    def inertia(self, body: int) -> fmpq:
        return fmpq(3 * body + 7, 2 * body + 5)

    def area(self, rod: int) -> fmpq:
        """What (2.4) has of a rod's section: J_0i, F, or all columns of a storey."""
        return {"I": AREA["F"], "II": fmpq(rod + 4, 3 * rod + 2), "III": AREA["n"] * AREA["A"]}[self.name]

    def pieces(self, body: int) -> int:
        return (3, 1, 2)[body % 3]

    def moment(self, body: int, tau: Any) -> Any:
        if body not in self.numbers("(3.1)"):
            raise MeaninglessError(f"there is no moment {body}")
        with self.bind({"t": Jet.from_number(tau).value}):
            return self.of("(3.1)", body)

    def displacement(self, rod: int, x: Any, tau: Any) -> Any:
        """(4.2), with what Table 1 has for the rod."""
        velocity = self.of(f"T1.{self.name}.v", rod)
        with self.bind({r"\bar{x}": x, r"\tau": tau, "velocity": velocity}):
            return self.of("(4.2)", rod)

    def body(self, number: int) -> int:
        """The number in its example of a body of (2.4), which may number bodies by their places."""
        numbering = self.variables.get("numbering")
        if numbering is None:
            return number
        with self.bind({"i": number, "numbering": None}):
            return int(self.value(numbering) / L) + (self.name == "II")

    def symbol(self, symbol: Symbol) -> Any:
        name, index, drive = symbol.accent + symbol.name, self.indices(symbol), self.name == "II"
        match name, index:
            case r"\kappa", (i,) if i in self.numbers(KAPPA[self.name]):
                return self.of(KAPPA[self.name], i)
            case (("M" | "J"), (i,)) if (name == "J") == drive:
                return self.inertia(i)
            case "J", (0, i) if drive:
                return self.area(i)
            case r"\barx", ():
                return self.variables[r"\bar{x}"]
            case ((r"\barx" | r"\tau"), (0, i)) if 1 <= i <= self.m:
                return self.of(f"T1.{self.name}.{'x' if 'x' in name else 'tau'}_0", i)
            case r"\barv", (i,):  # in (4.2) of a rod, elsewhere of a body
                return self.variables["velocity"] if "velocity" in self.variables else fmpq(17 - i * i, 3 + i)
            case r"\barA", (i,) if i in self.numbers("(4.4).A"):
                return self.of("(4.4).A", i)
            case ((r"\barM" | "M"), (i, k)) if drive and 0 <= k < self.pieces(i):
                return fmpq(i + 2 * k + 1, i + 3)
            case ((r"\tau" | "t"), (i, k)) if drive and 0 <= k < self.pieces(i):
                return 2 * i + 3 * k
            case r"\tau", (k,) if self.name == "III":
                return 2 * k
            case ((r"\bara" | "a" | r"\barb" | "b"), (k,)) if self.name == "III":
                return fmpq(k + 1, 3 if name.endswith("a") else 7)
            case "m", (i,):
                return self.pieces(i) - 1
            case "U", (0,):
                return U_0
            case "A", (rod,):
                return RHO * C**2 * self.area(rod)
            case "B", (number,):
                return self.inertia(self.body(number))
        raise MeaninglessError(f"{latex(symbol)} is not defined")

    def step(self, value: Any) -> Any:
        return _power(value)

    def call(self, call: Call) -> Any:
        name, index = call.function.accent + call.function.name, self.indices(call.function)
        match name, index, [self.value(argument) for argument in call.arguments]:
            case (("f" | "g"), (rod,), (z,)) if 1 <= rod <= self.m:
                own, order = self.waves.get((name, rod), fmpq(0)), call.function.primes
                return Jet.from_number(z).apply(
                    lambda more: own * S ** (order + more) * _power(Jet.from_number(z).value)
                )
            case _, (rod,), (x, tau) if name == DISPLACEMENTS[self.name]:
                return self.displacement(rod, x, tau)
            case r"\barM", (body,), (tau,):
                return self.moment(body, tau)
            case r"\barM", (), (tau,):
                raise MeaninglessError("a moment without a number")
            case "S", (number,), (t,):
                if self.name != "II":
                    return 0
                (unit,) = (r.first_values[0] for r in self.formulas["def.s"].ranges if latex(r.variable) == "S_{0}")
                return self.moment(self.body(number), t * C / L) * self.value(unit)
        raise MeaninglessError(f"{latex(call.function)} is not defined")

    def derivative(self, derivative: Derivative) -> Any:
        by = latex(derivative.variable)
        with self.bind({by: Jet(self.variables[by], 1)}):
            match derivative.function:
                case Symbol("U", "") as physical:
                    (rod,) = self.indices(physical)
                    moved = self.displacement(rod, self.variables["x"] / L, self.variables["t"] * C / L) * U_0
                case other:
                    moved = Jet.from_number(self.value(other))
        return moved.first if derivative.order == 1 else moved.second


def _power(exponent: Any) -> fmpq:
    """e^(s z) for a whole z."""
    whole = fmpq(exponent)
    if whole.denom() != 1:
        raise MeaninglessError(f"{exponent} is no whole number")
    return E ** int(whole.numer())


def _places(chain: OneChain, id: str) -> Iterator[tuple[Tree, dict[str, Any]]]:
    """The equations of a record, each with its i and its place."""
    read, m = chain.formulas[id], chain.m
    ranges = {latex(r.variable): r for r in read.ranges if isinstance(r, Progression)}
    if id.startswith("(2.4)"):
        ends = {"I": range(0, m + 1, m), "II": (), "III": ()}[chain.name]
        between = {"I": range(1, m, 2), "II": range(1, m), "III": range(1, m)}[chain.name]
        at = {  # x, and its i
            "1": [(x, max(x, 1)) for x in ends],
            "2": [(x, x + 1) for x in between],
            "3": [(x, x) for x in (range(2, m, 2) if chain.name == "I" else ())],
            "4": [(0, 1)] if chain.name == "II" else [],
            "5": [(m, m)] if chain.name != "I" else [],
        }[id[-1]]
        numbering = ranges["x_{i}"].first_values[0] if "x_{i}" in ranges else None
        for x, i in at:
            yield read.formula, {"i": i, "x": x * L, "t": fmpq(0), "numbering": numbering}
        return
    for i in span(ranges["i"], chain) if "i" in ranges else (1,):
        with chain.bind({"i": i}):
            found: dict[str, Any] = {"i": i, "z": 0, r"\tau": 0, "t": fmpq(0)}
            found |= {name: span(ranges[name], chain)[0] for name in (r"\bar{x}", "x") if name in ranges}
        for equation in items(read.formula):
            yield equation, found


def _left_over(chain: OneChain, id: str) -> list[fmpq]:
    """Left less right sides of the equations of a record."""
    found = []
    for equation, place in _places(chain, id):
        left, right = sides(equation)
        with chain.bind(place):
            found.append(fmpq(Jet.from_number(chain.value(left) - chain.value(right)).value))
    return found


def _solve(chain: OneChain) -> None:
    """The waves for which the conditions without dimensions hold."""
    ids = [id for id in chain.formulas if ENTRIES[id].kind == "condition" and id.startswith(CONDITIONS[chain.name])]
    names = [(letter, rod) for letter in "fg" for rod in range(1, chain.m + 1)]

    def all_left_over(waves: dict[tuple[str, int], fmpq]) -> list[fmpq]:
        chain.waves = waves
        return [value for id in ids for value in _left_over(chain, id)]

    fixed = all_left_over({})
    columns = [all_left_over({name: fmpq(1)}) for name in names]
    size = len(names)
    if len(fixed) != size:
        raise MeaninglessError(f"{len(fixed)} conditions for {size} waves")
    rows = [[column[row] - fixed[row] for column in columns] for row in range(size)]
    try:
        solved = fmpq_mat(rows).solve(fmpq_mat(size, 1, [-value for value in fixed]))
    except ZeroDivisionError:
        raise MeaninglessError("the conditions do not say what the waves are") from None
    chain.waves = dict(zip(names, solved.entries(), strict=True))


def _checked(name: str) -> list[str]:
    """What the solution has to satisfy."""
    delays = [id for id, entry in ENTRIES.items() if entry.kind == "delay" and entry.subject["example"] == name]
    return [*delays, "(2.3)", *(f"(2.4).{line}" for line in range(1, 6))]


def disagreeing(wrong: Formulas | None = None) -> set[str]:
    """The formulas that do not go with the conditions, on any chain; `wrong` are some that are taken otherwise."""
    found = set()
    for name, sizes in SIZES.items():
        for m in sizes:
            chain = OneChain(name, m, {**RIGHT, **(wrong or {})})
            try:
                _solve(chain)
            except MeaninglessError:
                return {CONDITIONS[name]}
            for id in _checked(name):
                try:
                    if any(_left_over(chain, id)):
                        found.add(id)
                except MeaninglessError:
                    found.add(id)
    return found


def _turned(id: str, term: str, instead: str) -> Formulas:
    """A formula as it is right, but for a term that counts otherwise."""
    entry = ENTRIES[id]
    text, ranges = entry.right_strings
    assert term in text
    return {id: reading(text.replace(term, instead), ranges)}


def test_all_formulas_of_an_example_hold_on_one_chain() -> None:
    assert disagreeing() == set()


@pytest.mark.quick(2)
@pytest.mark.parametrize(
    ("id", "term", "instead", "noticed"),
    [
        ("(4.4).4", r"\bar{A}_{m+1} \bar{M}", r"-\bar{A}_{m+1} \bar{M}", {"(4.7).2", "(2.4).5"}),
        ("(4.7).2", r"-\bar{A}_{m+1}", r"\bar{A}_{m+1}", {"(4.7).2"}),
        ("(2.4).5", "S_i(t)", "-S_i(t)", {"(2.4).5"}),
        ("(2.4).4", "S_i(t)", "-S_i(t)", {"(2.4).4"}),
        ("(4.5).2", r"\kappa_i", r"\kappa_1", {"(4.8).5", "(2.4).2"}),
        ("T1.I.v", r"\bar{v}_{i-1}", r"\bar{v}_{i+1}", {"(2.4).2", "(4.6).6"}),
    ],
)
def test_a_formula_that_counts_otherwise_is_noticed(id: str, term: str, instead: str, noticed: set[str]) -> None:
    assert noticed <= disagreeing(_turned(id, term, instead))


def test_the_model_of_the_text_goes_with_no_other_formula() -> None:
    """(4.5).1 as the text has it is another chain than that of (4.8)."""
    assert "(4.8).2" in disagreeing({"(4.5).1": right_reading("(4.5).1")})


def _against_the_list(lines: list[Reading]) -> set[str]:
    """The lines of (4.8) that (4.12) with these coefficients does not satisfy; g_1 is not in the list."""
    m, most = 3, 3
    known, motion = ListRun(lines, m, most), truth(m).motion
    kappa, (a, b) = motion.exact.chain.parameters.kappa, (motion.piece(source, STEP) for source in "ab")
    gains: dict[Function, list[dict[fmpq, list[fmpq]]]] = {}
    for n in range(most + 1):
        for key in sorted(key for key in unknowns(m, n) if key.k == STEP):  # powers in their order
            rate = fmpq(0) if len(key.lower) < 2 else fmpq(kappa[m]) if key.lower[0] == m else 2 * fmpq(kappa[1])
            gained = gains.setdefault(Function(key.letter, key.rod), [{} for _ in range(most + 1)])[n]
            gained.setdefault(rate, []).append(known(key) / a.weight)
    nothing = {function: [{}] * (most + 1) for function in gains}
    exact = Exact(motion.exact.chain, 2, {"a": gains, "b": nothing})
    scope = Motion(LoadedChain(exact, {"a": (a,), "b": (b,)}))
    found = set()
    for id in ("(4.8).2", "(4.8).3", "(4.8).4", "(4.8).5"):
        left, right = sides(right_reading(id).formula)
        for i in span(range_of("i", right_reading(id).ranges), scope) if right_reading(id).ranges else (0,):
            for tenth in range(0, 20 * most, 7):
                with scope.bind({"i": i, "z": fmpq(tenth, 10)}):
                    if scope.value(left) - scope.value(right) != 0:
                        found.add(id)
    return found


def test_the_list_of_coefficients_goes_with_the_equations() -> None:
    """III.1 to III.22 run by themselves, put into (4.12), and that into (4.8)."""
    assert _against_the_list(right_lines()) == set()
    assert "(4.8).5" in _against_the_list(right_lines("III.6"))
    assert "(4.8).4" in _against_the_list(right_lines("III.5"))
