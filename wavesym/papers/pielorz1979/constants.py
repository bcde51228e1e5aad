r"""c_f^2, kappa and A in terms of materials: a chain with them has to move as the bodies and rods that they stand for.

A physical system has inertias, stiffnesses, a length and a density. Its nodes without dimensions, in tau = c_f t / l,
are what the nodes of a chain with the printed constants are compared with, and their derived rates.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from math import prod
from typing import Any

from flint import fmpq

from wavesym.mechanics.chain import Chain
from wavesym.mechanics.node import Node, Parameters
from wavesym.papers.entries import PaperEntry
from wavesym.papers.evaluation import MeaninglessError, Scope, given, range_of, sides, span
from wavesym.papers.pielorz1979.letters import IndexedLetters
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
        return self.section(rod) if self.example == "II" else self._product("F", "n", "A")

    def stiffness(self, rod: int) -> fmpq:
        """Force in a rod for a unit of strain."""
        return self._product("E", "G", "k'") * self.area(rod)

    def _product(self, *names: str) -> fmpq:
        """Of those that the example has."""
        return prod((_PLAIN[self.example].get(name, fmpq(1)) for name in names), start=fmpq(1))

    def speed_squared(self, rod: int) -> fmpq:
        """Of waves: stiffness U_xx = density area U_tt."""
        return self.stiffness(rod) / (self.rho * self.area(rod))

    def node(self, x: int) -> Node:
        """The law of the body at x in tau and x / l: inertia U_tt = stiffness (dU_right/dx - dU_left/dx)."""
        alpha = 2 * self.stiffness(x) / self.l if x > 0 else fmpq(0)
        beta = 2 * self.stiffness(x + 1) / self.l if x < self.m else fmpq(0)
        body = x + 1 if self.example == "II" else x  # discs are numbered from 1 on
        return Node(None, None, self.inertia(body) * self.speed_squared(max(x, 1)) / self.l**2, alpha, beta)

    def chain(self, kappa: Mapping[int, fmpq]) -> Chain:
        """The chain without dimensions of these constants."""
        inertia = {body: self.inertia(body) for body in range(1, self.m + 2)}
        given = Parameters(kappa, inertia, dict.fromkeys(range(1, self.m, 2), 0))
        return Chain(EXAMPLES[self.example].system, self.m, given)

    def acceleration(self, body: int, load: fmpq) -> fmpq:
        """What a load alone gives a body, in units of U_0."""
        return fmpq(load / self.U_0 / self.node(body - 1).inertia)


class Material(IndexedLetters):
    """The letters of a physical system."""

    def __init__(self, physical: Physical, constants: Mapping[Tree, Tree] | None = None) -> None:
        plain = {**_PLAIN[physical.example], r"\rho": physical.rho, "l": physical.l, "m": physical.m}
        super().__init__({**plain, "a": _SPEED, "C": _SPEED}, constants)
        self.physical = physical
        self.functions["S"] = moment
        self.letters = {
            "U": {0: physical.U_0}.__getitem__,
            "S": {0: fmpq(7, 3)}.__getitem__,
            "M": physical.inertia,
        }
        if "k'" in plain:
            self.letters["k'"] = lambda: plain["k'"]
        if physical.example == "II":
            del self.letters["M"]
            self.letters["J"] = self._inertia_or_section

    def _inertia_or_section(self, *index: int) -> fmpq:
        """J_i of a body, J_(0,i) of a shaft."""
        if len(index) == 1:
            return self.physical.inertia(*index)
        zero, rod = index
        if zero != 0:
            raise LookupError(index)
        return self.physical.section(rod)


def moment(body: int, t: fmpq) -> fmpq:
    """Some moment on a body."""
    return t + fmpq(2 * body + 1, 3)


def speed(entry: PaperEntry) -> Test:
    """c_f^2 in Table 1; the letter after it is a name for its root."""

    def cases(reading: Reading) -> Iterator[Case]:
        physical = Physical(entry.about["row"], SIZES[entry.about["row"]][-1])
        scope = Material(physical)
        value, name = sides(reading.formula)
        for rod in range(1, physical.m + 1):
            yield case({"i": rod}, partial(scope.value, value), physical.speed_squared(rod))
            yield case({"named": latex(name)}, partial(scope.value, name), physical.speed_squared(rod), telling=False)

    return Test("stiffness of a rod over its inertia per length", cases)


def kappa(entry: PaperEntry) -> Test:
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
    scope = Material(physical)
    at = {"m": m, **({"sections": "equal" if physical.equal else "unequal"} if example == "II" else {})}
    found: dict[int, Any] = {}
    for i in span(numbers, scope):
        scope.bound["i"] = i
        found[_number(letter, r"\kappa", "", scope)] = scope.value(value)
    wanted = tuple(EXAMPLES[example].system.indices(m)["kappa"])
    yield Case({**at, "kappa": latex(numbers)}, tuple(found), wanted, telling=False)
    if tuple(found) != wanted or any(number <= 0 for number in found.values()):
        raise MeaninglessError("no system has these constants")
    for x, node in enumerate(physical.chain(found).nodes):
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


def moment_factor(entry: PaperEntry) -> Test:
    """A under (4.4)."""

    def true(scope: Material, body: int) -> fmpq:
        return scope.physical.acceleration(body, scope.value(Symbol("S", below=(Number("0"),))))

    return Test("the acceleration that the unit of moment gives a body", partial(_body_cases, "A", true))


def load(entry: PaperEntry) -> Test:
    """The load without dimensions, line before Table 1."""

    def true(scope: Material, body: int) -> fmpq:
        physical = scope.physical
        laws = {i: physical.node(i - 1) for i in range(1, physical.m + 1)}
        _, unit = physical.chain({i: law.beta / law.inertia / 2 for i, law in laws.items()}).loaded[f"M{body}"]
        # the last moment counts against positive rotation, here and there
        acceleration = physical.acceleration(body, moment(body, scope.bound["t"]))
        return fmpq(acceleration / abs(unit.coefficients[0]))

    against = "the acceleration that a moment gives a disc, in that of the unit load of a drive"
    return Test(against, partial(_body_cases, "S", true))


def _body_cases(name: str, true: Callable[[Material, int], fmpq], reading: Reading) -> Iterator[Case]:
    """A letter with a bar of every body of some drives; S is a function of tau."""
    left, value = sides(reading.formula)
    letter: Tree = left
    if name == "S":
        if not isinstance(left, Call) or left.arguments != (Symbol(r"\tau"),):
            raise MeaninglessError(f"{latex(left)} is no function of tau")
        letter = left.function
    numbers = range_of("i", reading.ranges)
    for m in SIZES["II"]:
        scope = Material(Physical("II", m), given(reading.ranges))
        scope.bound["t"] = fmpq(5, 4)
        if (bodies := span(numbers, scope)) != tuple(range(1, m + 2)):
            raise MeaninglessError(f"{latex(numbers)} are not the {m + 1} bodies")
        for body in bodies:
            scope.bound["i"] = body
            at = {"m": m, "i": body}
            yield Case({**at, "of": latex(left)}, _number(letter, name, r"\bar", scope), body, telling=False)
            yield case(at, partial(scope.value, value), true(scope, body))


def _number(letter: Tree, name: str, accent: str, scope: Scope) -> int:
    """Of which body or rod a letter is; MeaninglessError where it is not that letter, or of none."""
    match letter:
        case Symbol(found, mark, 0, (index,)) if (found, mark) == (name, accent):
            return scope.whole(index)
    raise MeaninglessError(f"{latex(letter)} is not defined")
