"""Equations of a kind on one chain: both sides wherever they are said to hold, and what they say once together."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import Any, ClassVar

from flint import fmpq

from wavesym.papers.entries import PaperEntry
from wavesym.papers.evaluation import MeaninglessError, constants_in, items, sides, span
from wavesym.papers.exact_numbers import Jet
from wavesym.papers.pielorz1979.chains import (
    EXAMPLES,
    UNEQUAL_COLLISION,
    LoadedChain,
    example,
)
from wavesym.papers.pielorz1979.letters import Motion, Units
from wavesym.papers.pielorz1979.transcript import others
from wavesym.papers.record import Case, Reading, Reproduction, case, format_value
from wavesym.papers.tree import Progression, Symbol, Tree, latex, parts_of

Place = Mapping[str, Any]
"""Values of running letters."""
Key = tuple[Any, ...]
"""What an equation says: a letter or a word, and a number."""

SLOW, FAST = Units(fmpq(2), fmpq(3), fmpq(5, 7)), Units(fmpq(5, 2), fmpq(1, 7), fmpq(3))
_MOVING = "the exact motion of chains with all parameters different under loads of several steps"


class EquationGroup(ABC):
    """Equations of a kind, tried on one chain: a record's, and which others there are.

    Attributes:
        reference: what they are compared with.
        letters: what a range may be of.
        sizes: the m of each example.
        units: of the chains, those of every other m.
        velocities: whether a v is that of a "body" or of a "rod".
        is_definition: whether the left side is known by the exact motion, and the right side is to be its value.
        is_alone: whether the record says by itself all that is required, or beside others of its group.
    """

    reference: ClassVar[str] = _MOVING
    letters: ClassVar[frozenset[str]] = frozenset({"i", "x_{i}", "v_{0}", "S_{0}"})
    sizes: ClassVar[Mapping[str, Iterable[int]]] = {name: example.sizes for name, example in EXAMPLES.items()}
    units: ClassVar[tuple[Units, Units]] = (SLOW, FAST)
    velocities: ClassVar[str] = "body"
    is_definition: ClassVar[bool] = False
    is_alone: ClassVar[bool] = True

    def __init__(self, entry: PaperEntry, reading: Reading, motion: LoadedChain) -> None:
        self.entry, self.reading = entry, reading
        progressions = [r for r in reading.ranges if isinstance(r, Progression)]
        self.ranges = {latex(r.variable): r for r in progressions}
        if len(self.ranges) < len(progressions) or not self.ranges.keys() <= self.letters:
            raise MeaninglessError("a range of something else")
        constants = {name: value for name, value in constants_in(reading.ranges).items() if "_" in latex(name)}
        self.scope = Motion(motion, self.units[motion.exact.m % 2], constants, self.velocities)

    # what a kind has of its own

    @classmethod
    def reference_note(cls, entry: PaperEntry) -> str:
        """What a record is compared with."""
        return cls.reference

    def places(self, equation: Tree) -> Iterator[Place]:
        """Where an equation is said to hold."""
        if "i" in self.ranges and Symbol("i") in parts_of(equation):
            yield from ({"i": i} for i in span(self.ranges["i"], self.scope))
        else:
            yield {}

    @abstractmethod
    def key(self, equation: Tree, place: Place) -> Key:
        """What an equation says at a place."""

    @abstractmethod
    def required_keys(self) -> Iterable[Key] | None:
        """All that is to be said of the chain, once; None where that is not asked."""

    def instants(self, place: Place) -> Iterator[tuple[Place, Place]]:
        """How an instant is called, and what is bound then."""
        yield {}, {}

    def sides(self, equation: Tree) -> tuple[Callable[[], Any], Callable[[], Any]]:
        """The values of both sides."""
        left, right = sides(equation)
        return partial(self.scope.value, left), partial(self.scope.value, right)

    def further_cases(self, equation: Tree, place: Place, at: Place) -> Iterator[Case]:
        """What else is said at a place."""
        yield from ()

    # the test

    def cases(self, at: Place) -> Iterator[Case]:
        """Both sides of each equation wherever it is said to hold, and what is said how often."""
        statements: Counter[Key] = Counter()
        for equation in items(self.reading.formula):
            for place in self.places(equation):
                self.scope.variables |= place
                statements[self.key(equation, place)] += 1
                here = {**at, **{name: place[name] for name in ("i", "x") if name in place}}
                yield from self.further_cases(equation, place, here)
                for name, bound in self.instants(place):
                    yield self.balance(equation, {**here, **name}, bound)
        if (needed := self.required_keys()) is None:
            return
        beside = Counter[Key]() if self.is_alone else self.statements_elsewhere()
        total, required = statements + beside, Counter(needed)
        for key in sorted(total.keys() | required.keys(), key=str):
            found = Case(
                {**at, "how often it is given": "_".join(map(str, key))}, total[key], required[key], key in statements
            )
            yield found if found.agrees else replace(found, example=self.scene(at, found))

    def balance(self, equation: Tree, at: Place, bound: Place) -> Case:
        """An equation at an instant: what is left of it, or its right side where it is a definition."""
        left, right = self.sides(equation)
        self.scope.is_seen = self.is_definition
        with self.scope.bind({**self.scope.variables, **bound}):
            if self.is_definition:
                found = case(at, lambda: Jet.from_number(right()).value, Jet.from_number(left()).value)
            else:
                found = case(at, lambda: Jet.from_number(left() - right()).value, 0)
        return replace(found, is_telling=self.scope.is_seen, example=None if found.agrees else self.scene(at, found))

    def statements_elsewhere(self) -> Counter[Key]:
        """What the other equations of the group say."""
        known, key = self.scope.motion.memory, ("beside", self.entry.kind, self.entry.id)
        if key not in known:
            known[key] = Counter[Key]()
            for reading in others(self.entry.id, self.entry.kind):
                group = type(self)(self.entry, reading, self.scope.motion)
                for equation in items(reading.formula):
                    for place in group.places(equation):
                        group.scope.variables |= place
                        known[key][group.key(equation, place)] += 1
        found: Counter[Key] = known[key]
        return found

    def scene(self, at: Place, found: Case) -> Callable[[], Reproduction] | None:
        """How a case is seen: what a scene says at its place, to be put into the equation."""
        if self.scope.chain.system is UNEQUAL_COLLISION:  # no scene has it
            return None
        where = ", ".join(f"{name} = {format_value(bound)}" for name, bound in at.items())
        value = found.printed_value
        x = min(max(fmpq(at.get("x", at.get("i", 1))), fmpq(0)), fmpq(self.scope.chain.m))
        look = f"velocity@{x} and what stands beside it in the equation; with {where}, {value} comes of it"
        motion, outputs = self.scope.motion, {"velocity": [str(x)]}
        return example(motion.exact, motion.loads, 8, outputs, "wavesym run SCENE --samples 1001", look)
