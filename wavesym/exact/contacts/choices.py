"""What may be in a joint on a short stretch, and how fast its points are then: under one of a few choices at a time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from flint import arb, fmpq

from wavesym.exact.contacts.branches import Closed
from wavesym.exact.joints.enclosure import Enclosure, Terms, add_terms, one_at_each_instant, scale_terms
from wavesym.exact.joints.joint_law import JointLaw


@dataclass(frozen=True)
class Choices:
    """The law of a joint is one of some `laws`, and contacts are closed, or not, if `vague`.

    The velocities of rigid points are known, and those of others are settled that move like rigid ones. It is asked
    how fast some `springs` get longer.
    """

    laws: Sequence[JointLaw]
    points: Sequence[int]
    closed_links: Closed
    vague: Closed
    known_velocities: Mapping[int, Terms]
    settled_velocities: Mapping[int, Terms] = field(default_factory=dict)
    springs: tuple[int, ...] = ()


@dataclass
class ChoiceMotions:
    """Under each choice the velocities of points, what ends send, the rates and forces of contacts, rates of springs.

    What friction without mass `takes` is anything in a range.
    """

    velocities: dict[int, list[Terms]]
    sends: dict[int, list[Terms]]
    spring_rates: dict[int, list[Terms]]
    rates: dict[int, list[Terms]] = field(default_factory=dict)
    pushes: dict[int, list[Terms]] = field(default_factory=dict)
    takes: dict[int, arb] = field(default_factory=dict)


def any_of(ways: Mapping[int, Sequence[Terms]], span: arb) -> dict[int, Enclosure]:
    """Functions that are, at each instant, what one choice makes them."""
    return {n: one_at_each_instant([add_terms(each) for each in functions], span) for n, functions in ways.items()}


def near_first(ways: Mapping[int, Sequence[Terms]], span: arb) -> dict[int, Enclosure]:
    """The same, as what the first choice makes them with what they may differ from it: where that is little."""
    return {n: _near_first(functions, span) for n, functions in ways.items()}


def _near_first(ways: Sequence[Terms], span: arb) -> Enclosure:
    first, apart = add_terms(ways[0]), arb(0)
    for other in ways[1:]:
        apart = apart.union(add_terms([*other, *scale_terms(ways[0], fmpq(-1))]).evaluate_on(span))
    if apart == 0:
        return first
    return Enclosure(first.polynomial + apart.mid(), (first.error + apart.rad()).upper())
