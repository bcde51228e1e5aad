"""A model as modes: what they are of loads and outputs, and what those that are left out can add."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import isqrt
from typing import ClassVar, Generic, Protocol, TypeVar

import numpy as np
from flint import fmpq

from wavesym.errors import CostError, UnservedError
from wavesym.exact.modes.cuts import Cut
from wavesym.mechanics.model import Model
from wavesym.numbers.reals import DOUBLE
from wavesym.programs.modes.loads import LinearLoads, linear_loads
from wavesym.programs.modes.modal import ModalSystem, Numbers
from wavesym.programs.modes.roughness import Roughness, roughness
from wavesym.programs.modes.rounding import rounded
from wavesym.programs.modes.silent import silent
from wavesym.programs.modes.tables import scheme_tables
from wavesym.programs.modes.watched import Driver, Seen, driven, seen
from wavesym.programs.schemes.modes import ModesScheme


class KnownModes(Protocol):
    """What modes are of loads and outputs, by columns."""

    @property
    def w(self) -> Numbers:
        """The absolute values of their frequencies, ascending."""


K = TypeVar("K", bound=KnownModes)


@dataclass(frozen=True)
class ModalChain(ABC, Generic[K]):
    """What is the same for any number of modes: at most `MOST`, and as many that they are `WORK` times bars."""

    model: Model

    MOST: ClassVar[int] = 4000
    WORK: ClassVar[int] = 100_000
    FIRST: ClassVar[int] = 6  # modes for a bar, for a start

    @cached_property
    def drivers(self) -> tuple[Driver, ...]:
        """The loads that act; one that moves nothing where there are none."""
        network = self.model.network
        acting = {load.source for load in self.model.acting(self.model.until)}
        every = driven(network)
        found = tuple(each for each in every if {each.step, each.ramp} & acting)
        still = next((number for number, point in enumerate(network.points) if point.motion != "fixed"), 0)
        return found or (every[0] if every else Driver(still, fmpq(0), "none:step", "none:ramp"),)

    @cached_property
    def sources(self) -> tuple[tuple[str, str], ...]:
        return tuple((each.step, each.ramp) for each in self.drivers)

    @cached_property
    def loads(self) -> LinearLoads:
        return linear_loads(self.model.loads, self.sources, self.model.until, self.model.told)

    @cached_property
    def rough(self) -> tuple[Roughness, ...]:
        return tuple(roughness(self.loads))

    @cached_property
    def silent(self) -> tuple[bool, ...]:
        return silent(self.model, self.drivers, self.loads)

    @property
    @abstractmethod
    def least(self) -> int:
        """As many modes as are taken at least."""

    @property
    def fewest(self) -> int:
        """The modes to begin with."""
        return max(self.FIRST * len(self.model.network.bars), self.least)

    @property
    def most(self) -> int:
        """More are not taken."""
        return max(min(self.MOST, self.WORK // len(self.model.network.bars)), self.fewest)

    @property
    @abstractmethod
    def cut(self) -> Cut:
        """The network with points wherever outputs are."""

    @cached_property
    def seen(self) -> list[Seen]:
        """What outputs are of a mode."""
        return [seen(self.model.network, self.cut, probe) for probe in self.model.probes]

    @abstractmethod
    def shares(self, count: int) -> K:
        """The first modes. UnservedError for what modes do not serve."""

    @abstractmethod
    def errors(self, known: K, count: int, loads: Sequence[Roughness] | None = None) -> Numbers:
        """What the modes after the first `count` can add to each output, under its own or other `loads`."""

    @abstractmethod
    def system(self, known: K, count: int) -> ModalSystem:
        """The system of the first `count` modes."""

    def refuse(self) -> None:
        """UnservedError for what no modes serve, CostError for too much."""
        network = self.model.network
        moving = any(bar.velocity != 0 or bar.strain != 0 for bar in network.bars)
        if moving or any(point.velocity != 0 for point in network.points):
            raise UnservedError(
                "system: a motion or strain at tau = 0 given, rest expected in modes (pieces and march serve it)"
            )
        if not self.drivers:
            raise UnservedError("load: none that acts by output.until given, one expected in modes (all is at rest)")
        _ = self.loads  # refused before the work
        self._refuse_many(len(network.bars))

    def _refuse_many(self, rods: int) -> None:
        most = isqrt(self.WORK // self.FIRST)
        if rods <= most:
            return
        raise CostError(f"system: {rods} rods in modes, at most {most} expected (fewer rods or march helps)")

    def reached(self, known: K, count: int) -> Numbers:
        """What each output reaches, but for what is left out."""
        system, until = self.system(known, count), self.model.horizon()
        scheme = ModesScheme(scheme_tables(system, self.loads, DOUBLE), {"loads": len(self.drivers)}, until, np.float64)
        return rounded(system, self.loads, scheme, until, DOUBLE).largest
