"""The branches of links whose laws have corners, and how they change.

A contact is on one of two branches: closed, while it pushes, or open, while it has a gap. What rubs is on one of three:
it sticks, or slides one way or the other. A spring on one side acts or idles; one that yields holds, or yields one way.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from flint import arb, ctx, fmpq

Closed = frozenset[int]
"""Links, by their numbers."""
_INSTANT_BITS = 320  # with which instants are had


class Branch(NamedTuple):
    """What a link does: it is closed (touches, sticks, acts or holds), or not; then it may slide or yield one way."""

    closed: bool
    sign: int = 0


@dataclass(frozen=True)
class Branches:
    """What the links with corners of a joint do on a stretch, by their numbers.

    Some are closed, some slide or yield one way; of those that are vague it is left open.
    """

    closed_links: Closed = frozenset()
    sliding: Mapping[int, int] = field(default_factory=dict)
    vague: Closed = frozenset()

    def of_link(self, link: int) -> Branch:
        """That of one which is not vague."""
        return Branch(link in self.closed_links, self.sliding.get(link, 0))


@dataclass(frozen=True)
class Change:
    """A corner (the number of its link) goes from one branch to another one between two instants, or at one."""

    link: int
    before: Branch
    after: Branch
    low: fmpq
    high: fmpq

    @property
    def closes(self) -> bool:
        """Whether it is closed then: touches, sticks, acts, holds."""
        return self.after.closed

    @property
    def instant(self) -> arb:
        """The ball between these, to as many digits as are had."""
        with ctx.workprec(_INSTANT_BITS):
            return arb(self.low) if self.low == self.high else arb(self.low).union(arb(self.high))


def lasting(changes: Iterable[Change], width: fmpq) -> list[Change]:
    """Join the changes of a link between which its branch was certain for no time, or hardly any, into one.

    Args:
        changes: in order of time.
        width: what counts as close, in tau.

    Returns:
        In order of time; nothing of a link that is back on its branch within `width`.
    """
    kept: dict[int, list[Change]] = {}
    for change in changes:
        of_link = kept.setdefault(change.link, [])
        if of_link and change.low - of_link[-1].high <= width:
            last = of_link.pop()
            change = Change(last.link, last.before, change.after, last.low, change.high)
        if change.before != change.after:
            of_link.append(change)
    return sorted((each for of_link in kept.values() for each in of_link), key=lambda each: (each.low, each.link))
