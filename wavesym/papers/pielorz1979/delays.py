"""(4.6), (4.7), (4.8): the delay equations, on chains under loads and against the derived ones for symbolic i and m."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from functools import cache, partial
from typing import Any

from flint import fmpq
from sympy import Integer, expand

from wavesym.derivation.delay import COUNT, INDEX, DelayEquation, delay_equations
from wavesym.derivation.delay_terms import Line, Operator, Wave, exact
from wavesym.mechanics.node import System
from wavesym.papers.entries import PaperEntry
from wavesym.papers.evaluation import MeaninglessError, Scope, items, sides, span
from wavesym.papers.pielorz1979.equations import left_over, once, ranges_of, within
from wavesym.papers.pielorz1979.forms import moved
from wavesym.papers.pielorz1979.letters import Moving
from wavesym.papers.pielorz1979.scenes import example
from wavesym.papers.pielorz1979.symbols import Symbols, expression, told
from wavesym.papers.pielorz1979.transcript import others
from wavesym.papers.pielorz1979.truth import EXAMPLES, DrivenChain, JumpingChain, driven, instants
from wavesym.papers.record import Case, Reading, Reproduction, Test
from wavesym.papers.tree import Call, Symbol, Tree

UNTIL = 8
"""How far in z equations are tried: waves have crossed the longest chain, and every load has begun."""
_SIZE = 8
"""An m at which every range has more than one member."""

Unknown = tuple[str, Any]
"""f or g, and the number of its rod."""


def test(entry: PaperEntry) -> Test:
    """How an equation is tried: both its sides at instants, and whether it gives what no other of its group gives."""
    drawn = EXAMPLES[str(entry.about["example"])]

    def cases(read: Reading, chain: Callable[[str, int], DrivenChain] = driven) -> Iterator[Case]:
        for m in drawn.sizes:
            given: Counter[Unknown] = Counter()
            motion = chain(drawn.name, m)
            scope, jumps = Moving(motion), _Jumps(JumpingChain(motion.exact, motion.loads))
            for equation, bound in _stated(read, m):
                given[_unknown(equation, Scope(bound))] += 1
                scope.bound |= bound
                jumps.bound |= bound
                yield from _balanced(scope, equation, bound)
                if any(part.primes == 2 for part in within(equation) if isinstance(part, Symbol)):
                    yield from _jumping(jumps, equation, bound)
            wanted = {(e.function, rod) for e in delay_equations(drawn.system) for rod in _rods(e, m)}
            yield from once({"m": m}, given, _others(entry.id, m), wanted)

    return Test(
        "the exact motion of chains with all parameters different under loads of several steps, "
        f"m = {drawn.sizes[0]} ... {drawn.sizes[-1]}; the derived equation for symbolic i and m",
        cases,
        difference=partial(_difference, drawn.system),
        conventions={"all floors are equal": lambda read: cases(read, moved)} if drawn.name == "III" else {},
    )


def _stated(read: Reading, m: int) -> Iterator[tuple[Tree, Mapping[str, int]]]:
    """The equations of a record, each with m and its i."""
    ranges = ranges_of(read, "i")
    for equation in items(read.formula):
        for i in span(ranges["i"], Scope({"m": m})) if ranges else (None,):
            yield equation, {"m": m} if i is None else {"m": m, "i": i}


def _balanced(scope: Moving, equation: Tree, at: Mapping[str, int]) -> Iterator[Case]:
    """The equation at instants."""
    motion = scope.motion

    def seen(z: fmpq, left: str) -> Callable[[], Reproduction]:
        look = f"put the sums of these rows, each from the start of its interval, into the equation at z = {z}: {left}"
        return example(motion.exact, motion.loads, UNTIL, {"velocity": ["1"]}, "wavesym tables SCENE", look)

    clock = "z", instants(UNTIL, between=[fmpq(5, 6)])
    return left_over(equation, at, scope, clock, lambda z: {"z": z}, seen)


class _Jumps(Moving):
    """An equation across a front: its second derivatives alone, each with the jump of the first one."""

    def step(self, value: Any) -> Any:
        return 0


def _jumping(scope: _Jumps, equation: Tree, at: Mapping[str, int]) -> Iterator[Case]:
    """The equation integrated across every front: what jumps in it adds up to nothing."""
    motion = scope.motion
    assert isinstance(motion, JumpingChain)
    clock = "a front at z", motion.fronts
    return left_over(equation, at, scope, clock, lambda z: {"z": z}, lambda z, left: None)


def _unknown(equation: Tree, scope: Scope) -> Unknown:
    """What an equation gives: the one function on its left."""
    calls = [part for part in within(sides(equation)[0]) if isinstance(part, Call)]
    found = {(call.function.name, scope.indices(call.function)) for call in calls}
    if len(found) != 1 or any(len(index) != 1 for _, index in found):
        raise MeaninglessError("its left side has not one function of one rod")
    ((name, (rod,)),) = found
    return name, rod


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


def _difference(system: System, read: Reading) -> str:
    """Printed less derived, both as left less right side, for symbolic i and m."""
    lines = []
    scope = Symbols()
    for equation in items(read.formula):
        left, right = sides(equation)
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
