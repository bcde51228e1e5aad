"""A joint on its way: how far its motion is known, and the breakpoints to come."""

from __future__ import annotations

from dataclasses import dataclass, field
from heapq import heappop

from flint import fmpq

from wavesym.exact.contacts.branches import Corner
from wavesym.exact.contacts.joint_stretch import JointStretch
from wavesym.exact.contacts.touching_waves import Stage


@dataclass
class Doubt:
    """Since when it is not certain what a contact of a joint does, until when that was left open; how long next.

    `first` is how long the first such stretch was.
    """

    low: fmpq
    high: fmpq
    next: fmpq
    first: fmpq


@dataclass
class Course:
    """A joint, its present stretch, which is known from its `start` to its `reach`, and the breakpoints to come.

    It is moved no further at a time than `shortest`: nobody reads what is sent before; and not beyond `end`, later than
    its `last` instant that matters: until then it is known what comes to it. `spread` is how far off the end of
    its last stretch may be, where a contact may change; that is less than `late` beyond where it does.
    """

    number: int
    last: fmpq
    end: fmpq
    shortest: fmpq
    contacts: tuple[Corner, ...]
    start: fmpq
    reach: fmpq
    stretch: JointStretch | None = None
    doubt: Doubt | None = None
    spread: fmpq | None = None
    late: fmpq = field(default_factory=fmpq)
    breakpoints: list[fmpq] = field(default_factory=list)
    stages: list[Stage] = field(default_factory=list)

    def pass_breakpoints(self, time: fmpq) -> bool:
        """Whether there is a breakpoint at an instant; it and all before are done with."""
        found = False
        while self.breakpoints and self.breakpoints[0] <= time:
            found = heappop(self.breakpoints) == time or found
        return found

    def limit(self, start: fmpq) -> fmpq:
        """How far it can be moved from an instant on."""
        far = min(start + self.shortest, self.end)
        return min(self.breakpoints[0], far) if self.breakpoints else far
