"""The exact tables that published formulas are tested on, with parameters in which nothing coincides by chance."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

from flint import fmpq

from wavesym.derivation.increments import Increment
from wavesym.derivation.table import Function, Rules, unit_response
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.node import Family, Node, Parameters, Quantity, System
from wavesym.systems.building import BUILDING_FORCE, BUILDING_GROUND
from wavesym.systems.collision import COLLISION
from wavesym.systems.drive import DRIVE

INTERVALS = {"I": 9, "II": 14, "III": 9}
"""How many intervals of every function are tabulated, per example."""

Response = dict[Function, list[Increment]]


@dataclass(frozen=True)
class Exact:
    """A chain and the increments of all its functions for a unit of every source."""

    chain: Chain
    interval: int
    responses: dict[str, Response]

    @property
    def m(self) -> int:
        return self.chain.m

    def increment(self, source: str, letter: str, rod: int, interval: int) -> Increment:
        """What a function gains in interval 1, 2, ...; nothing before. KeyError, IndexError beyond the table."""
        return self.responses[source][Function(letter, rod)][interval - 1] if interval > 0 else {}

    def degree(self, letter: str, rod: int, interval: int, rate: fmpq, source: str | None = None) -> int:
        """The highest power at a rate, over all sources or for one; -1 where the rate does not occur."""
        sources = self.responses if source is None else (source,)
        return max(len(self.increment(s, letter, rod, interval).get(rate, ())) for s in sources) - 1

    @property
    def rates(self) -> dict[int, fmpq]:
        """The rates of the bodies, by the number that kappa or gamma has for them."""
        first = 1 if self.interval == 1 else 0
        return {x + first: fmpq(node.rate) for x, node in enumerate(self.chain.nodes) if node.inertia}

    def alive(self, letter: str, rod: int, interval: int) -> bool:
        """Whether a function changes at all in an interval."""
        return any(self.increment(source, letter, rod, interval) for source in self.responses)


@cache
def collision(m: int) -> Exact:
    """Example I with unequal bodies."""
    bodies = range(1, m, 2)
    kappa = {i: fmpq(i + 2, 2 * i + 5) for i in bodies}
    return _exact("I", Chain(COLLISION, m, Parameters(kappa=kappa, velocity={i: fmpq(5, i + 1) - i for i in bodies})))


@cache
def unequal_collision(m: int) -> Exact:
    """Example I with unequal rods too."""
    parameters = collision(m).chain.parameters
    areas = {i: fmpq(i + 3, 2 * i + 1) for i in range(1, m + 1)}
    return _exact("I", Chain(UNEQUAL_COLLISION, m, replace(parameters, inertia=areas)))


@cache
def meeting(velocities: tuple[int, ...]) -> Exact:
    """Example I with equal bodies that have these velocities, falling or not."""
    bodies = range(1, 2 * len(velocities), 2)
    given = Parameters(
        kappa=dict.fromkeys(bodies, fmpq(1, 2)), velocity=dict(zip(bodies, map(fmpq, velocities), strict=True))
    )
    return _exact("I", Chain(COLLISION, 2 * len(velocities), given))


@cache
def drive(m: int) -> Exact:
    """Example II with unequal shafts and discs, all rates different."""
    kappa = {i: fmpq(2 * i + 1, i + 3) for i in range(1, m + 1)}
    return _exact(
        "II", Chain(DRIVE, m, Parameters(kappa=kappa, inertia={i: fmpq(i + 4, 2 * i + 3) for i in range(1, m + 2)}))
    )


@cache
def building(m: int) -> Exact:
    """Example III with equal floors: kappa_1 = ... = kappa_(m-1), as the paper's coefficients have it."""
    return _building(m, {i: fmpq(3, 5) for i in range(1, m)})


@cache
def uneven_building(m: int) -> Exact:
    """Example III with a different mass on every floor."""
    return _building(m, {i: fmpq(2 * i + 1, i + 4) for i in range(1, m)})


@cache
def grounded_building(m: int) -> Exact:
    """The same, on a foundation that moves with the ground."""
    return _building(m, {i: fmpq(2 * i + 1, i + 4) for i in range(1, m)}, BUILDING_GROUND)


def _of_unequal_rods(m: Quantity, p: Parameters) -> tuple[Family, ...]:
    """The nodes of a collision between rods that are A_i as stiff, and as heavy, as that of kappa."""

    def unequal(family: Family) -> Family:
        def at(x: Quantity) -> Node:
            node = family.at(x)
            left = p.inertia[x] if node.left else 0
            right = p.inertia[x + 1] if node.right else 0
            return replace(node, alpha=node.alpha * left, beta=node.beta * right)

        return replace(family, at=at)

    return tuple(map(unequal, COLLISION.families(m, p)))


UNEQUAL_COLLISION = replace(COLLISION, name="collision of unequal rods", families=_of_unequal_rods)
"""Its `inertia` are the A_i of (2.4)."""


def _building(m: int, floors: dict[int, fmpq], system: System = BUILDING_FORCE) -> Exact:
    return _exact("III", Chain(system, m, Parameters(kappa={0: fmpq(2, 7), **floors, m: fmpq(4, 11)})))


def _exact(example: str, chain: Chain) -> Exact:
    rules = Rules(chain)
    wanted = {Function(letter, rod): INTERVALS[example] for letter in "fg" for rod in range(1, chain.m + 1)}
    return Exact(chain, rules.interval, {source: unit_response(rules, source, wanted) for source in chain.sources})


def with_parameters(exact: Exact, parameters: Parameters) -> Exact:
    """The same chain with other parameters."""
    system = exact.chain.system
    example = "I" if system is COLLISION else "II" if system is DRIVE else "III"
    return _exact(example, Chain(system, exact.m, parameters))
