"""How many bodies a system has, as the text says it: "the drive has $m + 1$ rigid bodies"."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

from flint import fmpq

from wavesym.model.chain import Chain
from wavesym.model.node import Node, Parameters, System
from wavesym.papers.entries import Entry
from wavesym.papers.evaluation import MeaninglessError, Scope, holds
from wavesym.papers.mutations import ends, mutations
from wavesym.papers.reader import UnreadableError, read_formula, read_range
from wavesym.papers.record import Case, Reading, Test, case
from wavesym.papers.tree import Tree
from wavesym.systems.building import BUILDING_FORCE
from wavesym.systems.collision import COLLISION
from wavesym.systems.drive import DRIVE

_SYSTEMS: Mapping[str, System] = {"colliding system": COLLISION, "drive": DRIVE, "building": BUILDING_FORCE}
_PARTS: Mapping[str, Callable[[Sequence[Node]], int]] = {
    "rigid bodies": lambda nodes: sum(bool(node.inertia) for node in nodes),
    "floors between foundation and roof": lambda nodes: sum(bool(node.inertia) for node in nodes[1:-1]),
    "shafts": lambda nodes: sum(node.right is not None for node in nodes),
}
_SENTENCE = re.compile(rf"the ({'|'.join(_SYSTEMS)}) has \$(.+)\$ ({'|'.join(_PARTS)})")
_SIZES = range(1, 13)


@dataclass(frozen=True)
class Count:
    """A system, and how many of its parts it is said to have."""

    system: str
    count: Tree
    parts: str


def number_of_bodies(entry: Entry) -> Test:
    """A sentence of this kind."""
    return Test(
        "the nodes of the derivation, those that have inertia and those that hold a rod", _cases, _read, _faults
    )


def _read(printed: str, ranges: Iterable[str]) -> Reading:
    if not (found := _SENTENCE.fullmatch(printed)):
        raise UnreadableError(f"no pattern has the sentence: {printed}")
    system, count, parts = found.groups()
    return Reading(Count(system, read_formula(count), parts), tuple(map(read_range, ranges)))


def _faults(right: Reading) -> Iterator[tuple[str, Reading]]:
    said: Count = right.formula
    for system in _SYSTEMS:
        if system != said.system:
            yield f"{system} for {said.system}", Reading(Count(system, said.count, said.parts), right.ranges)
    for change, wrong in mutations(said.count):
        yield change, Reading(Count(said.system, wrong, said.parts), right.ranges)
    for change, wrong in ends(right.ranges[0]) if right.ranges else ():
        yield change, Reading(said, (wrong,))


def _cases(reading: Reading) -> Iterator[Case]:
    said: Count = reading.formula
    system = _SYSTEMS[said.system]
    asked = [m for m in _SIZES if all(holds(range_, Scope({"m": m})) for range_ in reading.ranges)]
    sizes = [m for m in asked if m in range(system.smallest, _SIZES.stop, system.step)]
    if not sizes:
        raise MeaninglessError(f"no {said.system} has this m")
    for m in sizes:
        yield case({"m": m}, partial(Scope({"m": m}).value, said.count), fmpq(_number(system, m, said.parts)))


def _number(system: System, m: int, parts: str) -> int:
    ones = {name: {i: fmpq(1) for i in indices} for name, indices in system.indices(m).items()}
    return _PARTS[parts](Chain(system, m, Parameters(**ones)).nodes)
