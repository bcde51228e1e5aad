"""Table 1, where and when the first disturbance reaches a rod, and how fast it moves until then."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from functools import partial

from wavesym.mechanics.chain import Chain
from wavesym.papers.entries import PaperEntry
from wavesym.papers.exact_tables import Exact
from wavesym.papers.pielorz1979.equations import covers
from wavesym.papers.pielorz1979.letters import IndexedLetters, body_velocity
from wavesym.papers.pielorz1979.scenes import example as scene
from wavesym.papers.pielorz1979.truth import EXAMPLES
from wavesym.papers.record import Case, Reading, Reproduction, Test, case
from wavesym.papers.tree import Cases

_MOST_SIZES = 3
_FIRST = "at which the first disturbance arrives, and the clock with which (4.6)-(4.8) follow"
_AGAINST = {
    "x_0": f"the end {_FIRST}",
    "tau_0": f"the time {_FIRST}",
    "v": "the velocity of the body to which the rod is fixed",
}


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


def cell(entry: PaperEntry) -> Test:
    """A cell of the columns x_0, tau_0, v, for every rod."""
    example, column = EXAMPLES[entry.about["row"]], entry.about["column"]

    def cases(reading: Reading) -> Iterator[Case]:
        formula = reading.formula
        ranges = [where for _, where in formula.branches] if isinstance(formula, Cases) else reading.ranges
        for m in example.sizes[:_MOST_SIZES]:
            chain = example.tables(m).chain
            scope = IndexedLetters({"m": m})
            scope.letters[r"\barv"] = (chain.parameters.velocity or {}).__getitem__
            yield covers({"m": m}, "rods", ranges, scope, range(1, m + 1))
            for rod in range(1, m + 1):
                scope.bound["i"] = rod
                at = {"m": m, "i": rod}
                time, ends = arrival(chain, rod)
                value = partial(scope.value, formula)
                match column:
                    case "v":
                        yield case(at, value, body_velocity(chain, rod), example=_seen(example.tables(m), rod))
                    case "tau_0":
                        yield case(at, value, chain.rod(rod).tau0)
                        yield case({**at, "front": "time"}, value, time)
                    case "x_0":
                        yield case(at, value, chain.rod(rod).x0)
                        yield case({**at, "front": "end"}, lambda: value() in ends, True)  # noqa: B023 - called here

    return Test(_AGAINST[column], cases)


def _seen(exact: Exact, rod: int) -> Callable[[], Reproduction]:
    """How a rod of a collision moves before anything reaches it."""
    middle = f"{2 * rod - 1}/2"
    look = f"velocity@{middle} at tau = 0 is how fast rod {rod} moves at first: as the body to which it is fixed"
    return scene(exact, {}, 2, {"velocity": [middle]}, "wavesym run SCENE --samples 9", look)
