"""The law of a joint as a system of first order, in numbers or in functions of parameters.

Its state x is the velocities of points with mass, then displacements, each of them how much longer something elastic
has become. With s what acts on points (of one whose motion is prescribed its velocity), and M, C of the joint,

    M q' + C q + sum of pulls of x = s,    displacement' = growth of q    become    x' = A x + B s,    q = Q x + S s,

once points without mass are put in terms of x and s.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from flint import fmpq

from wavesym.exact.joints.joint_law import JointLaw

Rows = list[list[Any]]


@dataclass(frozen=True)
class ElasticState:
    """A displacement that grows by `growth` of the velocities of groups, and pulls on groups by `pulls` of it."""

    growth: Mapping[int, fmpq]
    pulls: Mapping[int, fmpq]


@dataclass(frozen=True)
class StateSpace:
    """Rows: A (`rates`), B (`input_rates`) of each state; Q (`state_velocities`), S (`feedthrough`) of each group."""

    rates: Rows
    input_rates: Rows
    state_velocities: Rows
    feedthrough: Rows


def state_space(law: JointLaw, elastic: Sequence[ElasticState]) -> StateSpace:
    """Put a law into the first order.

    Args:
        law: M and C; its numbers may be functions.
        elastic: the displacements among the states, in order; K of the law is in their pulls.
    """
    masses, groups = len(law.heavy), range(len(law.mass))
    states = masses + len(elastic)

    def unit(column: int) -> list[Any]:
        return [fmpq(int(n == column)) for n in range(states + len(groups))]

    def add(parts: Sequence[tuple[Any, list[Any]]]) -> list[Any]:
        counted = [(factor, row) for factor, row in parts if factor != 0]
        return [sum((factor * row[n] for factor, row in counted), fmpq(0)) for n in range(states + len(groups))]

    velocity = {a: unit(n) for n, a in enumerate(law.heavy)}
    velocity |= {a: unit(states + a) for a in groups if law.motions[a] is not None}
    pulls = {a: [(-one.pulls.get(a, fmpq(0)), unit(n)) for n, one in enumerate(elastic, masses)] for a in groups}
    acting = {a: add([(fmpq(1), unit(states + a)), *pulls[a]]) for a in groups}
    velocity |= law.light_velocities(acting, velocity, add)
    rows = [
        [x / law.mass[a] for x in add([(fmpq(1), acting[a]), *((-law.damping[a][b], q) for b, q in velocity.items())])]
        for a in law.heavy
    ]
    rows += [add([(factor, velocity[a]) for a, factor in one.growth.items()]) for one in elastic]
    return StateSpace(
        rates=[row[:states] for row in rows],
        input_rates=[row[states:] for row in rows],
        state_velocities=[velocity[a][:states] for a in groups],
        feedthrough=[velocity[a][states:] for a in groups],
    )
