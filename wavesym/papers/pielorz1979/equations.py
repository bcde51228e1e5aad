"""What all equations share: where they are said to hold, what is left of them there, and that each is said once."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Container, Iterable, Iterator, Mapping
from dataclasses import fields, is_dataclass, replace
from functools import lru_cache
from typing import Any

from flint import fmpq

from wavesym.papers.evaluation import MeaninglessError, Scope, sides, span
from wavesym.papers.pielorz1979.letters import Moving
from wavesym.papers.record import Case, Nothing, Reading, Reproduction, case, shown
from wavesym.papers.tree import Progression, Tree, latex


@lru_cache(maxsize=1000)
def within(tree: Any) -> tuple[Any, ...]:
    """A tree and all its parts."""
    values = (getattr(tree, field.name) for field in fields(tree))
    parts = (part for value in values for part in (value if isinstance(value, tuple) else (value,)))
    return (tree, *(inner for part in parts if is_dataclass(part) for inner in within(part)))  # type: ignore[arg-type]


def ranges_of(reading: Reading, letters: Container[str]) -> Mapping[str, Progression]:
    """The ranges by their variables; MeaninglessError for one of something else than these letters."""
    found = {latex(r.variable): r for r in reading.ranges if isinstance(r, Progression)}
    if len(found) < len(reading.ranges) or any(name not in letters for name in found):
        raise MeaninglessError("a range of something else")
    return found


def covers(
    at: Mapping[str, object],
    what: str,
    ranges: Iterable[Tree],
    scope: Scope,
    wanted: Iterable[int],
    telling: bool = False,
    example: Callable[[], Reproduction] | None = None,
) -> Case:
    """Whether ranges have each number that is wanted once; MeaninglessError."""
    named = tuple(ranges)
    numbers = tuple(sorted(number for progression in named for number in span(progression, scope)))
    return Case({**at, what: "; ".join(map(latex, named))}, numbers, tuple(sorted(wanted)), telling, example)


def once(at: Mapping[str, object], said: Counter[Any], beside: Counter[Any], wanted: Iterable[Any]) -> Iterator[Case]:
    """How often an equation and those beside it say what is wanted; each a tuple, such as f and the number of a rod."""
    total, needed = said + beside, set(wanted)
    for what in sorted(needed | total.keys()):
        name = "_".join(map(str, what))
        yield Case({**at, "how often it is given": name}, total[what], int(what in needed), telling=what in said)


def left_over(
    equation: Tree,
    at: Mapping[str, object],
    scope: Moving,
    clock: tuple[str, Iterable[fmpq]],
    bound: Callable[[fmpq], Mapping[str, Any]],
    seen: Callable[[fmpq, str], Callable[[], Reproduction] | None],
) -> Iterator[Case]:
    """An equation at instants of a clock, with what is bound there: what is left of it, and where that is `seen`."""
    left, right = sides(equation)
    name, instants = clock

    def less() -> Any:
        return scope.value(left) - scope.value(right)

    for instant in instants:
        scope.seen = False
        with scope.binding({**scope.bound, **bound(instant)}):
            found = case({**at, f"left less right side at {name}": instant}, less, 0)
        shows = None
        if not found.agrees and not isinstance(found.printed, Nothing):
            shows = seen(instant, f"its left side less its right side is {shown(found.printed)}")
        yield replace(found, telling=scope.seen, example=shows)
