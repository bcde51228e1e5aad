"""(4.6), (4.7), (4.8): the delay equations, on chains under loads and against the derived ones for symbolic i and m."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from typing import Any

from flint import fmpq
from sympy import Expr, Integer, expand

from wavesym.derivation.delay import COUNT, INDEX, DelayEquation, delay_equations
from wavesym.derivation.delay_terms import Line, Operator, Wave, exact
from wavesym.model.node import System
from wavesym.papers.entries import Entry
from wavesym.papers.evaluation import MeaninglessError, Scope, items, sides, span
from wavesym.papers.pielorz1979.letters import (
    Numbers,
    Symbols,
    Z,
    expression,
    left_over,
    ranges_of,
    told,
    wave,
    within,
)
from wavesym.papers.pielorz1979.scenes import example
from wavesym.papers.pielorz1979.transcript import others
from wavesym.papers.pielorz1979.truth import EXAMPLES, Driven, driven, instants
from wavesym.papers.record import Case, Example, Reading, Test
from wavesym.papers.tree import Call, Tree

UNTIL = 8
"""How far in z equations are tried: waves have crossed the longest chain, and every load has begun."""
_SIZE = 8
"""An m at which every range has more than one member."""

Unknown = tuple[str, Any]
"""f or g, and the number of its rod."""


def test(entry: Entry) -> Test:
    """How an equation is tried: both its sides at instants, and whether it gives what no other of its group gives."""
    name = str(entry.about["example"])
    sizes = EXAMPLES[name].sizes

    def cases(read: Reading) -> Iterator[Case]:
        for m in sizes:
            given: Counter[Unknown] = Counter()
            for equation, bound in _stated(read, m):
                given[_unknown(equation, Scope(bound))] += 1
                yield from _balanced(driven(name, m), equation, bound)
            yield from _once(entry.id, EXAMPLES[name].system, m, given)

    return Test(
        "the exact motion of chains with all parameters different under loads of several steps, "
        f"m = {sizes[0]} ... {sizes[-1]}; the derived equation for symbolic i and m",
        cases,
        difference=lambda read: difference(EXAMPLES[name].system, read),
    )


def _stated(read: Reading, m: int) -> Iterator[tuple[Tree, Mapping[str, int]]]:
    """The equations of a record, each with m and its i."""
    ranges = ranges_of(read, "i")
    for equation in items(read.formula):
        for i in span(ranges["i"], Scope({"m": m})) if ranges else (None,):
            yield equation, {"m": m} if i is None else {"m": m, "i": i}


class _Delayed(Numbers):
    """Derivatives of f and g at an instant."""

    def call(self, call: Call) -> Any:
        letter, index = call.function, self.indices(call.function)
        if letter.name not in ("f", "g") or letter.accent or len(index) != 1 or len(call.arguments) != 1:
            return super().call(call)
        z = fmpq(self.value(call.arguments[0]))
        return self.moved(self.driven.wave(letter.name, index[0], z, letter.primes))


def _balanced(driven: Driven, equation: Tree, bound: Mapping[str, int]) -> Iterator[Case]:
    """The equation at instants."""

    def seen(z: fmpq, left: str) -> Callable[[], Example]:
        look = f"put the sums of these rows, each from the start of its interval, into the equation at z = {z}: {left}"
        return example(driven.exact, driven.loads, UNTIL, {"velocity": ["1"]}, "wavesym tables SCENE", look)

    scopes = ((z, _Delayed(driven, {**bound, "z": z})) for z in instants(UNTIL, between=[fmpq(5, 6)]))
    return left_over(equation, bound, "z", scopes, seen)


def _unknown(equation: Tree, scope: Scope) -> Unknown:
    """What an equation gives: the one function on its left."""
    calls = [part for part in within(sides(equation)[0]) if isinstance(part, Call)]
    found = {(call.function.name, scope.indices(call.function)) for call in calls}
    if len(found) != 1:
        raise MeaninglessError("its left side has not one function")
    ((letter, index),) = found
    if len(index) != 1:
        raise MeaninglessError(f"{letter} has {len(index)} indices")
    return letter, index[0]


def _once(id: str, system: System, m: int, given: Counter[Unknown]) -> Iterator[Case]:
    """How often an equation and those beside it give every function that the derivation gives."""
    total = given + _others(id, m)
    wanted = {(e.function, rod) for e in delay_equations(system) for rod in _rods(e, m)}
    for unknown in sorted(wanted | total.keys()):
        letter, rod = unknown
        at = {"m": m, "how often it is given": f"{letter}_{rod}"}
        yield Case(at, total[unknown], int(unknown in wanted), telling=unknown in given)


@cache
def _others(id: str, m: int) -> Counter[Unknown]:
    """What the other equations of a group give."""
    stated = (pair for read in others(id, "delay") for pair in _stated(read, m))
    return Counter(_unknown(equation, Scope(bound)) for equation, bound in stated)


def given_once(number: str, m: int) -> bool:
    """Whether the equations of a group, as they are right, give each of f_1, ..., f_m, g_1, ..., g_m once."""
    try:
        return _others(number, m) == Counter((letter, rod) for letter in "fg" for rod in range(1, m + 1))
    except MeaninglessError:  # its ranges are of even m
        return False


def _rods(equation: DelayEquation, m: int) -> range:
    first, last = (int(exact(end).subs(COUNT, m)) for end in (equation.first, equation.last))
    return range(first, last + 1, equation.step)


class _Formal(Symbols):
    """Derivatives of f and g as symbols."""

    def call(self, call: Call) -> Expr:
        letter, index = call.function, self.indices(call.function)
        if letter.name not in ("f", "g") or len(index) != 1:
            return super().call(call)
        return wave(letter.name, letter.primes, index[0], expand(Z - self.value(call.arguments[0])))


def difference(system: System, read: Reading) -> str:
    """Printed less derived, both as left less right side, for symbolic i and m."""
    lines = []
    for equation in items(read.formula):
        left, right = sides(equation)
        scope = _Formal()
        unknown = _unknown(equation, scope)
        numbers = {_unknown(e, Scope(bound)) for e, bound in _stated(read, _SIZE) if e == equation}
        printed = expand(scope.value(left) - scope.value(right))
        derived = _derived(system, unknown, numbers)
        less = [expand(printed - expression(line)) for line in (derived, _put_in(system, unknown, derived))]
        lines.append(told(min(less, key=lambda over: over != 0)))
    return "; ".join(line for line in lines if line != "0") or "0"


def _derived(system: System, unknown: Unknown, numbers: set[Unknown]) -> Line:
    """The derived equation of a function, left less right side; `numbers` are its rods where m is 8."""
    letter, rod = unknown[0], exact(unknown[1])
    for e in delay_equations(system):
        if numbers <= {(e.function, number) for number in _rods(e, _SIZE)}:
            a, b = (exact(part).subs(INDEX, rod) for part in e.own)
            return Line({Wave(letter, rod, Integer(0)): Operator(a, b)}) - e.right.renumbered(INDEX, rod)
    raise MeaninglessError(f"no derived equation gives {letter} of these rods")


def _put_in(system: System, unknown: Unknown, line: Line) -> Line:
    """The same, with what other equations say of single functions at the same z, as the paper puts g_1 into f_1."""
    for letter, rod, lag in list(line.waves):
        if lag == 0 and not rod.has(INDEX) and (letter, rod) != unknown:
            other = _derived(system, (letter, rod), {(letter, int(rod.subs(COUNT, _SIZE)))})
            own = Wave(letter, rod, lag)
            if other.waves[own] == Operator(Integer(0), Integer(1)):
                line = line.substituted(letter, rod, other.without(own).scaled(-1))
    return line
