r"""c_f^2, kappa and A in terms of materials: a chain with them has to move as the bodies and rods that they stand for.

A physical system has inertias, stiffnesses, a length and a density. Its nodes without dimensions, in tau = c_f t / l,
are what the nodes of a chain with the printed constants are compared with, and their derived rates.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from math import prod
from typing import Any

from flint import fmpq

from wavesym.model.chain import Chain
from wavesym.model.node import Node, Parameters
from wavesym.papers.entries import Entry
from wavesym.papers.evaluation import MeaninglessError, Scope, given, range_of, sides, span
from wavesym.papers.pielorz1979.truth import EXAMPLES
from wavesym.papers.record import Case, Reading, Test, case
from wavesym.papers.tree import Call, Number, Symbol, Tree, latex

SIZES: Mapping[str, Sequence[int]] = {"I": (4, 6), "II": (1, 2, 3), "III": (2, 3, 4)}
_SPEED = fmpq(3, 2)
_PLAIN: Mapping[str, Mapping[str, fmpq]] = {
    "I": {"E": fmpq(33, 8), "F": fmpq(3, 8)},
    "II": {"G": fmpq(33, 8)},
    "III": {"G": fmpq(99, 20), "k'": fmpq(5, 6), "A": fmpq(2, 9), "n": fmpq(4)},
}
"""Numbers for what the text gives an example's rods, but for their density and length."""
_AREA = {"I": ("F",), "III": ("n", "A")}
_MODULUS = {"I": ("E",), "II": ("G",), "III": ("k'", "G")}


@dataclass(frozen=True)
class Physical:
    """An example of some size in physical units; `equal` drives have shafts of one section."""

    example: str
    m: int
    equal: bool = False
    rho: fmpq = field(default=fmpq(11, 6), init=False)
    l: fmpq = field(default=fmpq(13, 5), init=False)  # noqa: E741 - the paper's letter
    U_0: fmpq = field(default=fmpq(5, 7), init=False)

    def inertia(self, body: int) -> fmpq:
        """Mass M or moment of inertia J of a body, by its number."""
        return fmpq(17 + 3 * body, 7 + body)

    def section(self, rod: int) -> fmpq:
        """J_0 of a shaft."""
        return fmpq(4, 15) if self.equal else fmpq(4 + rod, 15)

    def area(self, rod: int) -> fmpq:
        """What of a rod's section resists, and is inert: F, J_0, or all columns of a storey."""
        return self.section(rod) if self.example == "II" else self._product(*_AREA[self.example])

    def stiffness(self, rod: int) -> fmpq:
        """Force in a rod for a unit of strain."""
        return self._product(*_MODULUS[self.example]) * self.area(rod)

    def _product(self, *names: str) -> fmpq:
        return prod((_PLAIN[self.example][name] for name in names), start=fmpq(1))

    def density(self, rod: int) -> fmpq:
        """Inertia of a rod for a unit of length."""
        return self.rho * self.area(rod)

    def speed_squared(self, rod: int) -> fmpq:
        """Of waves: stiffness U_xx = density U_tt."""
        return self.stiffness(rod) / self.density(rod)

    def body(self, x: int) -> int:
        """The number of the body at x = 0, 1, ...: discs are numbered from 1 on."""
        return x + 1 if self.example == "II" else x

    def node(self, x: int) -> Node:
        """The law of the body at x in tau and x / l: inertia U_tt = stiffness (dU_right/dx - dU_left/dx)."""
        alpha = 2 * self.stiffness(x) / self.l if x > 0 else fmpq(0)
        beta = 2 * self.stiffness(x + 1) / self.l if x < self.m else fmpq(0)
        return Node(None, None, self.inertia(self.body(x)) * self.speed_squared(max(x, 1)) / self.l**2, alpha, beta)

    def acceleration(self, body: int, load: fmpq) -> fmpq:
        """What a load alone gives a body, in units of U_0."""
        return fmpq(load / self.U_0 / self.node(body - 1).inertia)


class Material(Scope):
    """The letters of a physical system."""

    def __init__(self, physical: Physical, constants: Mapping[Tree, Tree] | None = None) -> None:
        c = _SPEED
        plain = {**_PLAIN[physical.example], r"\rho": physical.rho, "l": physical.l, "m": physical.m, "a": c, "C": c}
        super().__init__(plain, constants)
        self.physical = physical

    def symbol(self, symbol: Symbol) -> Any:
        match symbol:
            case Symbol("k", "", 1, ()) if "k'" in self.bound:
                return self.bound["k'"]
            case Symbol("U", "", 0, (Number("0"),)):
                return self.physical.U_0
            case Symbol("S", "", 0, (Number("0"),)):
                return fmpq(7, 3)
            case Symbol("J", "", 0, (Number("0"), rod)) if self.physical.example == "II":
                return self.physical.section(self.whole(rod))
            case Symbol(name, "", 0, (body,)) if name == ("J" if self.physical.example == "II" else "M"):
                return self.physical.inertia(self.whole(body))
        return super().symbol(symbol)

    def call(self, call: Call) -> Any:
        match call:
            case Call(Symbol("S", "", 0, (body,)), (t,)):
                return moment(self.whole(body), self.value(t))
        return super().call(call)


def moment(body: int, t: fmpq) -> fmpq:
    """Some moment on a body."""
    return t + fmpq(2 * body + 1, 3)


def speed(entry: Entry) -> Test:
    """c_f^2 in Table 1; the letter after it is a name for its root."""

    def cases(reading: Reading) -> Iterator[Case]:
        physical = Physical(entry.about["example"], SIZES[entry.about["example"]][-1])
        scope = Material(physical)
        value, name = sides(reading.formula)
        for rod in range(1, physical.m + 1):
            yield case({"i": rod}, partial(scope.value, value), physical.speed_squared(rod))
            yield case({"named": latex(name)}, partial(scope.value, name), physical.speed_squared(rod), telling=False)

    return Test("stiffness of a rod over its inertia per length", cases)


def kappa(entry: Entry) -> Test:
    """kappa under (4.3), (4.4), (4.5)."""
    example = entry.about["example"]

    def cases(reading: Reading) -> Iterator[Case]:
        letter, value = sides(reading.formula)
        numbers = range_of("i", reading.ranges)
        for m in SIZES[example]:
            for equal in (False, True) if example == "II" else (False,):
                physical = Physical(example, m, equal)
                yield from _chain_cases(physical, letter, value, numbers)

    return Test("the laws of bodies in physical units: stiffness, inertia, length; their derived rates", cases)


def _chain_cases(physical: Physical, letter: Tree, value: Tree, numbers: Tree) -> Iterator[Case]:
    example, m = physical.example, physical.m
    system, scope = EXAMPLES[example].system, Material(physical)
    at = {"m": m, **({"sections": "equal" if physical.equal else "unequal"} if example == "II" else {})}
    found: dict[int, Any] = {}
    for i in span(numbers, scope):
        scope.bound["i"] = i
        found[_number(letter, r"\kappa", "", scope)] = scope.value(value)
    wanted = tuple(system.indices(m)["kappa"])
    yield Case({**at, "kappa": latex(numbers)}, tuple(found), wanted, telling=False)
    if tuple(found) != wanted or any(number <= 0 for number in found.values()):
        raise MeaninglessError("no system has these constants")
    inertia = {body: physical.inertia(body) for body in range(1, m + 2)}
    printed = Chain(system, m, Parameters(found, inertia, dict.fromkeys(range(1, m, 2), 0)))
    for x, node in enumerate(printed.nodes):
        true = physical.node(x)
        if node.inertia:
            yield Case({**at, "x": x, "law": "rate"}, node.rate, true.rate)
            yield Case({**at, "x": x, "law": "alpha"}, node.alpha / node.inertia, true.alpha / true.inertia)
            yield Case({**at, "x": x, "law": "beta"}, node.beta / node.inertia, true.beta / true.inertia)
        elif example == "III":  # the foundation: kappa_0 is in its load
            (a, *_), _ = (load.coefficients for load in node.loads)
            yield Case({**at, "x": x, "law": "foundation"}, a / node.beta, -true.inertia / true.beta)
        if physical.equal and example == "II" and 0 < x < m:
            yield Case({**at, "x": x, "law": "rate 2 kappa"}, 2 * found[x + 1], true.rate)


def moment_factor(entry: Entry) -> Test:
    """A under (4.4)."""

    def cases(reading: Reading) -> Iterator[Case]:
        letter, value = sides(reading.formula)
        for at, scope, physical, body in _loaded(reading):
            yield Case({**at, "of": latex(letter)}, _number(letter, "A", r"\bar", scope), body, telling=False)
            unit = scope.value(Symbol("S", below=(Number("0"),)))
            yield case(at, partial(scope.value, value), physical.acceleration(body, unit))

    return Test("the acceleration that the unit of moment gives a body", cases)


def load(entry: Entry) -> Test:
    """The load without dimensions, line before Table 1."""

    def cases(reading: Reading) -> Iterator[Case]:
        left, value = sides(reading.formula)
        if not isinstance(left, Call) or left.arguments != (Symbol(r"\tau"),):
            raise MeaninglessError(f"{latex(left)} is no function of tau")
        for at, scope, physical, body in _loaded(reading):
            yield Case({**at, "of": latex(left)}, _number(left.function, "S", r"\bar", scope), body, telling=False)
            shafts = range(1, physical.m + 1)
            rates = {i: physical.node(i - 1).beta / physical.node(i - 1).inertia / 2 for i in shafts}
            inertia = {i: physical.inertia(i) for i in range(1, physical.m + 2)}
            chain = Chain(EXAMPLES["II"].system, physical.m, Parameters(rates, inertia))
            _, unit = chain.loaded[f"M{body}"]
            scope.bound["t"] = t = fmpq(5, 4)
            acceleration = physical.acceleration(body, moment(body, t))
            # the last moment counts against positive rotation, here and there
            yield case({**at, "t": t}, partial(scope.value, value), acceleration / abs(unit.coefficients[0]))

    return Test("the acceleration that a moment gives a disc, in that of the unit load of a drive", cases)


def _number(letter: Tree, name: str, accent: str, scope: Scope) -> int:
    """Of which body or rod a letter is; MeaninglessError where it is not that letter, or of none."""
    match letter:
        case Symbol(found, mark, 0, (index,)) if (found, mark) == (name, accent):
            return scope.whole(index)
    raise MeaninglessError(f"{latex(letter)} is not defined")


def _loaded(reading: Reading) -> Iterator[tuple[dict[str, object], Material, Physical, int]]:
    """Every body of some drives, where the range has it."""
    constants = given(reading.ranges)
    numbers = range_of("i", reading.ranges)
    for m in SIZES["II"]:
        physical = Physical("II", m)
        scope = Material(physical, constants)
        bodies = span(numbers, scope)
        if bodies != tuple(range(1, m + 2)):
            raise MeaninglessError(f"{latex(numbers)} are not the {m + 1} bodies")
        for body in bodies:
            scope.bound["i"] = body
            yield {"m": m, "i": body}, scope, physical, body
