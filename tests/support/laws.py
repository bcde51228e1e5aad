"""Laws of links with corners, each as branches: a linear law, what must stay positive on it, and what may follow.

Nothing of the package is used. A link pulls its ends together with a force; its stretch is the sum of factors times
displacements, and so is the rate of it.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from flint import arb, arb_poly, fmpq

from tests.support.series import is_zero

_ZERO = arb(0)


class Branch(NamedTuple):
    """Where a link is held its rate is 0, and what that takes is its pull; else that is said by these numbers."""

    name: str
    held: bool = False
    spring: fmpq = fmpq(0)
    dashpot: fmpq = fmpq(0)
    rest: arb = _ZERO
    sign: int = 0
    """The way that it slides or yields."""


@dataclass
class Law(ABC):
    """What a link does, and the name of the branch that it is on."""

    now: str

    @abstractmethod
    def branches(self, stretch: arb, rate: arb | None) -> Iterator[Branch]:
        """Those that it may be on, with a stretch and a rate; None where the rate may jump."""

    @abstractmethod
    def guards(self, branch: Branch, stretch: arb_poly, rate: arb_poly, pull: arb_poly) -> list[arb_poly]:
        """What is never negative while it is on a branch."""

    @abstractmethod
    def event(self, branch: Branch) -> str:
        """What happens where it takes another branch."""

    def keep(self, branch: Branch, stretch: arb) -> None:  # noqa: B027, only what yields has to
        """Remember what it has to, at the end of some time on a branch."""

    @property
    def stiffness(self) -> fmpq:
        """The largest of its branches."""
        return fmpq(0)

    @property
    def damping(self) -> fmpq:
        """The largest of its branches."""
        return fmpq(0)


@dataclass
class Touching(Law):
    """A contact: pushes, never pulls."""

    gap: fmpq

    def branches(self, stretch: arb, rate: arb | None) -> Iterator[Branch]:
        if is_zero(stretch + arb(self.gap)):
            yield Branch("closed", held=True)
        yield Branch("open")

    def guards(self, branch: Branch, stretch: arb_poly, rate: arb_poly, pull: arb_poly) -> list[arb_poly]:
        return [-pull if branch.held else stretch + arb(self.gap)]

    def event(self, branch: Branch) -> str:
        return "closes" if branch.held else "opens"


@dataclass
class Rubbing(Law):
    """Coulomb friction: sticks while that takes no more than a limit, else slides with it against the rate.

    Where it has `more`, it sticks while that takes no more than this.
    """

    limit: fmpq
    more: fmpq = field(default_factory=fmpq)

    def branches(self, stretch: arb, rate: arb | None) -> Iterator[Branch]:
        if rate is None or is_zero(rate):
            yield Branch("sticks", held=True)
        for sign in (1, -1):
            if rate is None or is_zero(rate) or sign * rate > 0:
                yield Branch(f"slides {sign}", rest=arb(sign * self.limit), sign=sign)

    def guards(self, branch: Branch, stretch: arb_poly, rate: arb_poly, pull: arb_poly) -> list[arb_poly]:
        if branch.held:
            most = arb(max(self.limit, self.more))
            return [most - pull, pull + most]
        return [rate * branch.sign]

    def event(self, branch: Branch) -> str:
        return "sticks" if branch.held else "slips"


@dataclass
class Sided(Law):
    """A spring, and a dashpot beside it, of one side: they act where it is longer (side 1) or shorter by a gap."""

    side: int
    gap: fmpq
    spring: fmpq
    dashpot: fmpq

    def branches(self, stretch: arb, rate: arb | None) -> Iterator[Branch]:
        over = self.side * stretch - arb(self.gap)
        if is_zero(over) or over > 0:
            yield Branch(
                "acts", spring=self.spring, dashpot=self.dashpot, rest=-arb(self.spring * self.side * self.gap)
            )
        if is_zero(over) or over < 0:
            yield Branch("idles")

    def guards(self, branch: Branch, stretch: arb_poly, rate: arb_poly, pull: arb_poly) -> list[arb_poly]:
        over = stretch * self.side - arb(self.gap)
        return [over if branch.name == "acts" else -over]

    def event(self, branch: Branch) -> str:
        return "engages" if branch.name == "acts" else "releases"

    @property
    def stiffness(self) -> fmpq:
        return self.spring

    @property
    def damping(self) -> fmpq:
        return self.dashpot


@dataclass
class Yielding(Law):
    """A spring whose force is limited: it yields at a limit as long as it goes on that way, then holds again."""

    spring: fmpq
    limits: tuple[fmpq, fmpq]
    """The largest pull, and the largest push."""
    plastic: arb = field(default_factory=lambda: arb(0))
    """The stretch at which it has no force."""

    def _pull(self, sign: int) -> arb:
        return arb(self.limits[0] if sign > 0 else -self.limits[1])

    def branches(self, stretch: arb, rate: arb | None) -> Iterator[Branch]:
        pull = self.spring * (stretch - self.plastic)
        yield Branch("holds", spring=self.spring, rest=-self.plastic * self.spring)
        for sign in (1, -1):
            if is_zero(pull - self._pull(sign)):
                yield Branch(f"yields {sign}", rest=self._pull(sign), sign=sign)

    def guards(self, branch: Branch, stretch: arb_poly, rate: arb_poly, pull: arb_poly) -> list[arb_poly]:
        if branch.sign:
            return [rate * branch.sign]
        return [self._pull(1) - pull, pull - self._pull(-1)]

    def event(self, branch: Branch) -> str:
        return "yields" if branch.sign else "holds"

    def keep(self, branch: Branch, stretch: arb) -> None:
        if branch.sign:
            self.plastic = (stretch - self._pull(branch.sign) / self.spring).mid()

    @property
    def stiffness(self) -> fmpq:
        return self.spring


@dataclass
class Corner:
    """A link between points whose law has a corner."""

    place: str
    subject: str
    """Contact, friction or spring."""
    stretch: Mapping[int, fmpq]
    law: Law
