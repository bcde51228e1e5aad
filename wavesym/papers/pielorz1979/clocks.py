"""Table 1, where and when the first disturbance reaches a rod, and how fast it moves until then."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from typing import Any

from wavesym.model.chain import Chain
from wavesym.papers.entries import Entry
from wavesym.papers.evaluation import MeaninglessError, Scope, span
from wavesym.papers.exact_tables import Exact
from wavesym.papers.pielorz1979.motion import body_velocity
from wavesym.papers.pielorz1979.scenes import example as scene
from wavesym.papers.pielorz1979.truth import EXAMPLES
from wavesym.papers.record import Case, Example, Reading, Test, case
from wavesym.papers.tree import Cases, Symbol, latex

_MOST_SIZES = 3


def arrival(chain: Chain, rod: int, which: Callable[[Iterable[int]], int] = min) -> tuple[int, set[int]]:
    """When the first disturbance reaches a rod (the last one, by max), and at which of its ends.

    Disturbances come from loads, and from contacts that are struck.
    """
    struck = [
        x
        for x, node in enumerate(chain.nodes)
        if node.loads or (node.left and node.right and node.left.velocity != node.right.velocity)
    ]
    times = {end: which(abs(end - x) for x in struck) for end in (rod - 1, rod)}
    first = which(times.values())
    return first, {end for end, time in times.items() if time == first}


class _Clocks(Scope):
    """i, m, and the velocities of the bodies."""

    def __init__(self, chain: Chain) -> None:
        super().__init__({"m": chain.m})
        self._chain = chain

    def symbol(self, symbol: Symbol) -> Any:
        match symbol:
            case Symbol("v", r"\bar", 0, (index,)):
                body = self.whole(index)
                given = self._chain.parameters.velocity or {}
                if body not in given:
                    raise MeaninglessError(f"no velocity is given of a body {body}")
                return given[body]
        return super().symbol(symbol)


def cell(entry: Entry) -> Test:
    """A cell of the columns x_0, tau_0, v, for every rod."""
    example, column = EXAMPLES[entry.about["example"]], entry.about["column"]

    def cases(reading: Reading) -> Iterator[Case]:
        for m in example.sizes[:_MOST_SIZES]:
            chain = example.tables(m).chain
            scope = _Clocks(chain)
            yield _all_rods(reading, scope)
            for rod in range(1, m + 1):
                scope.bound["i"] = rod
                at = {"m": m, "i": rod}
                time, ends = arrival(chain, rod)
                value = partial(scope.value, reading.formula)
                shown = partial(_seen, example.tables(m), rod) if column == "v" else None
                yield case(at, value, _TRUE[column](chain, rod), example=shown)
                if column == "tau_0":
                    yield case({**at, "front": "time"}, value, time)
                if column == "x_0":
                    yield case({**at, "front": "end"}, partial(_among, value, ends), True)

    return Test(_AGAINST[column], cases)


def _seen(exact: Exact, rod: int) -> Example:
    """How a rod of a collision moves before anything reaches it."""
    middle = f"{2 * rod - 1}/2"
    look = f"velocity@{middle} at tau = 0 is how fast rod {rod} moves at first: as the body to which it is fixed"
    return scene(exact, {}, 2, {"velocity": [middle]}, "wavesym run SCENE --samples 9", look)()


def _among(value: Callable[[], Any], ends: set[int]) -> bool:
    return value() in ends


_TRUE: Mapping[str, Callable[[Chain, int], Any]] = {
    "x_0": lambda chain, rod: chain.rod(rod).x0,
    "tau_0": lambda chain, rod: chain.rod(rod).tau0,
    "v": body_velocity,
}
_AGAINST = {
    "x_0": "the end at which the first disturbance arrives, and the clock with which (4.6)-(4.8) follow",
    "tau_0": "the time at which the first disturbance arrives, and the clock with which (4.6)-(4.8) follow",
    "v": "the velocity of the body to which the rod is fixed",
}


def _all_rods(reading: Reading, scope: Scope) -> Case:
    """Whether the ranges have every rod once."""
    formula = reading.formula
    ranges = [where for _, where in formula.branches] if isinstance(formula, Cases) else reading.ranges
    rods = tuple(sorted(rod for where in ranges for rod in span(where, scope)))
    said = "; ".join(map(latex, ranges))
    return Case({"m": scope.bound["m"], "rods": said}, rods, tuple(range(1, scope.bound["m"] + 1)), telling=False)
