"""(3.1), (3.2) and the loads of Table 1: against what acts on a node, which its exact motion tells."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import Any

from flint import fmpq

from wavesym.papers.entries import Entry
from wavesym.papers.evaluation import MeaninglessError, Scope, range_of, sides, span
from wavesym.papers.pielorz1979.displacements import acting
from wavesym.papers.pielorz1979.scenes import example
from wavesym.papers.pielorz1979.truth import Driven, Step, driven
from wavesym.papers.reader import read_range
from wavesym.papers.record import Case, Example, Reading, Test, case
from wavesym.papers.tree import Call, Number, Symbol, Tree, latex

_RODS = read_range(r"i = 1, 2, \dots, m")
"""What the rows of Table 1 are of, where nothing else is said."""


class _Loaded(Scope):
    """The letters of (3.1) and (3.2): pieces by number, and the whole load by what it does."""

    def __init__(self, motion: Driven) -> None:
        super().__init__({"m": motion.exact.m})
        self._motion = motion

    def symbol(self, symbol: Symbol) -> Any:
        match symbol:
            case Symbol("M", "", 0, (body, k)):
                return self._piece(self._source(body), k).weight
            case Symbol("t", "", 0, (body, k)):
                return self._piece(self._source(body), k).time
            case Symbol("m", "", 0, (number,)):
                return len(self._motion.loads[self._source(number)]) - 1
            case Symbol("a" | "b", "", 0, (k,)):
                return self._piece(symbol.name, k).weight
            case Symbol("t", "", 0, (k,)):
                return self._piece("a", k).time
            case Symbol("y", r"\ddot", 0, (Number("0"),)):
                return load(self._motion, "a", self.bound["t"])
        return super().symbol(symbol)

    def call(self, call: Call) -> Any:
        match call:
            case Call(Symbol("M", "", 0, (body,)), (t,)):
                return load(self._motion, self._source(body), fmpq(self.value(t)))
        return super().call(call)

    def _source(self, number: Tree) -> str:
        """Of a drive its moment with a number; a building has load number 1 alone."""
        name = f"M{self.whole(number)}" if "a" not in self._motion.loads or self.whole(number) != 1 else "a"
        if name not in self._motion.loads:
            raise MeaninglessError(f"there is no load {self.whole(number)}")
        return name

    def _piece(self, source: str, k: Tree) -> Step:
        pieces = self._motion.loads[source]
        if not 0 <= self.whole(k) < len(pieces):
            raise MeaninglessError(f"{source} has no piece {self.whole(k)}")
        return pieces[self.whole(k)]


def load(motion: Driven, source: str, t: fmpq) -> Any:
    """What acts at the node of a source, in what its unit gives at first."""
    x, unit = motion.exact.chain.loaded[source]
    return acting(motion, x, t) / unit.coefficients[0]


def moments(entry: Entry) -> Test:
    """(3.1)."""

    def cases(reading: Reading) -> Iterator[Case]:
        bodies = range_of("i", reading.ranges)
        for m in (1, 2, 3):
            scope = _Loaded(driven("II", m))
            named = span(bodies, scope)
            true = tuple(range(1, m + 2))
            yield Case({"m": m, "bodies": latex(bodies)}, named, true, telling=False)
            for body in sorted({*named} & {*true}):
                scope.bound["i"] = body
                yield from _sides(reading, scope, {"m": m, "i": body}, partial(load, driven("II", m), f"M{body}"))

    return Test(_EXACT, cases)


def base(entry: Entry) -> Test:
    """(3.2)."""
    motion = driven("III", 2)
    return Test(_EXACT, lambda reading: _sides(reading, _Loaded(motion), {"m": 2}, partial(load, motion, "a")))


_EXACT = "what acts on the body by its exact motion, under loads with several pieces, just after any jump"


def _sides(
    reading: Reading, scope: _Loaded, at: Mapping[str, object], true: Callable[[fmpq], object]
) -> Iterator[Case]:
    """It is called what the left side says, and is the right one."""
    left, right = sides(reading.formula)
    for half in range(6):
        scope.bound["t"] = t = fmpq(half, 2)
        yield case({**at, "t": t, "side": latex(left)}, partial(scope.value, left), true(t), telling=False)
        yield case({**at, "t": t}, partial(scope.value, right), true(t))


def bodies(entry: Entry) -> Test:
    """The loads S_i of Table 1, of the body at the left end of rod i: (4.4) counts bodies so."""

    def cases(reading: Reading) -> Iterator[Case]:
        named = reading.ranges[0] if reading.ranges else _RODS
        for m in {"I": (4, 6), "II": (1, 2, 3), "III": (2, 3)}[entry.about["example"]]:
            motion = driven(entry.about["example"], m)
            scope = _Loaded(motion)
            rigid = {x + 1: bool(node.loads) for x, node in enumerate(motion.exact.chain.nodes) if node.inertia}
            for i in span(named, scope):
                t = scope.bound["t"] = fmpq(i, 2)
                scope.bound["i"] = i
                true = load(motion, f"M{i}", t) if rigid.get(i) else acting(motion, i - 1, t) if i in rigid else 0
                yield case({"m": m, "i": i, "t": t}, partial(scope.value, reading.formula), true)
            wanted = tuple(sorted({*range(1, m + 1), *(body for body, loaded in rigid.items() if loaded)}))
            numbers = {"m": m, "rods and loaded bodies": latex(named)}
            yield Case(numbers, span(named, scope), wanted, example=_last_moment(m))

    return Test("what acts on the rigid bodies by the exact motion", cases)


def _last_moment(m: int) -> Callable[[], Example]:
    look = f"velocity@{m} is not 0: M_{m + 1} moves the drive, and no cell has it for i = 1, ..., {m}"
    moment = {f"M{m + 1}": (Step(fmpq(0), fmpq(1)),)}
    command = "wavesym run SCENE --samples 7"
    return example(driven("II", m).exact, moment, 3, {"velocity": [str(m)]}, command, look)
