"""How many rigid bodies a system has, as abstracts say it: "the drive has $m + 1$ rigid bodies"."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial

from flint import fmpq

from wavesym.model.chain import Chain
from wavesym.model.node import Parameters, System
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
_BODIES = {"rigid bodies": False, "floors between foundation and roof": True}
_SENTENCE = re.compile(rf"the ({'|'.join(_SYSTEMS)}) has \$(.+)\$ ({'|'.join(_BODIES)})")
_SIZES = range(1, 13)


@dataclass(frozen=True)
class Count:
    """The system, how many bodies it is said to have, and whether those at its ends are left out."""

    system: str
    count: Tree
    inner: bool


def number_of_bodies(entry: Entry) -> Test:
    """A sentence of this kind."""
    return Test("the nodes of the derivation that have inertia", _cases, _read, _faults)


def _read(printed: str, ranges: Iterable[str]) -> Reading:
    if not (found := _SENTENCE.fullmatch(printed)):
        raise UnreadableError(f"no pattern has the sentence: {printed}")
    system, count, bodies = found.groups()
    return Reading(Count(system, read_formula(count), _BODIES[bodies]), tuple(map(read_range, ranges)))


def _faults(right: Reading) -> Iterator[tuple[str, Reading]]:
    said: Count = right.formula
    for system in _SYSTEMS:
        if system != said.system:
            yield f"{system} for {said.system}", Reading(Count(system, said.count, said.inner), right.ranges)
    for change, wrong in mutations(said.count):
        yield change, Reading(Count(said.system, wrong, said.inner), right.ranges)
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
        yield case({"m": m}, partial(Scope({"m": m}).value, said.count), fmpq(_bodies(system, m, said.inner)))


def _bodies(system: System, m: int, inner: bool) -> int:
    """How many nodes have inertia."""
    ones = {name: {i: fmpq(1) for i in indices} for name, indices in system.indices(m).items()}
    nodes = Chain(system, m, Parameters(**ones)).nodes
    return sum(bool(node.inertia) for node in (nodes[1:-1] if inner else nodes))
