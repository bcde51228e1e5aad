"""A joint on a stretch of time: how its points move, what it sends, where it is at the end."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

from flint import arb, fmpq

from wavesym.exact.contacts.branches import Branches
from wavesym.exact.contacts.cluster import PointState
from wavesym.exact.joints.enclosure import Enclosure, Terms

if TYPE_CHECKING:
    from wavesym.exact.contacts.springs import SpringMotion, SpringState

MOST_SWING = fmpq(20)
"""A series is begun anew where it would have to bear more than exp(this): few bits cancel in it then."""


@dataclass
class JointStretch:
    """A joint on a stretch: the velocities of its points, what it sends, and its state at the end.

    `spring_motions` are how springs with a corner move, `springs` how they are at the end. `rates` and `pushes` are
    those of open and of closed contacts; while contacts are vague, their ranges under every choice of closed contacts.
    `bare` are the ends beside contacts on which nothing acts, `exact_contacts` the contacts whose two sides begin in a
    state that is known exactly. Its series, where it is one, bears exp(`swing` length); it is `fleeting` where what
    decays fast keeps it short, until that has died away. `rests` is when friction of masses on the ground certainly has
    stopped them, if it holds them from then on; what it bears may be beyond its limit in `excesses`. `stops` are masses
    that it stops on the ground, and which way they may be moving yet, unless it may be beyond. Where springs have
    dashpots that act with them, `acting` is what acts on points and is known, `elastic` what springs there pull back,
    and `doubts` are those that may be on their other branch.
    """

    length: fmpq
    branches: Branches
    velocities: dict[int, Terms] = field(default_factory=dict)
    sends: dict[int, Enclosure] = field(default_factory=dict)
    state: dict[int, PointState] = field(default_factory=dict)
    rates: dict[int, Enclosure] = field(default_factory=dict)
    pushes: dict[int, Enclosure] = field(default_factory=dict)
    bare: set[int] = field(default_factory=set)
    exact_contacts: set[int] = field(default_factory=set)
    spring_motions: dict[int, SpringMotion] = field(default_factory=dict)
    springs: dict[int, SpringState] = field(default_factory=dict)
    rests: dict[int, fmpq] = field(default_factory=dict)
    stops: dict[int, tuple[int, int]] = field(default_factory=dict)
    excesses: set[int] = field(default_factory=set)
    acting: list[Terms] = field(default_factory=list)
    elastic: dict[int, Enclosure] = field(default_factory=dict)
    doubts: frozenset[int] = frozenset()
    swing: fmpq = field(default_factory=fmpq)
    fleeting: bool = False

    @cached_property
    def span(self) -> arb:
        """All of its time, from 0 on."""
        return arb(0).union(arb(self.length))


class SwingError(Exception):
    """A stretch that is too long for a series, by what it is at most."""

    def __init__(self, longest: fmpq) -> None:
        super().__init__()
        self.longest = longest
