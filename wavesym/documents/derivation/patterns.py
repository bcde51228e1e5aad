"""Which parameters are equal: the patterns that people meet. Fewer rates, the same laws."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

from sympy import Expr, IndexedBase, Integer, cancel

from wavesym.derivation.delay import COUNT, INDEX, SYMBOLS
from wavesym.derivation.recurrence import CoefficientLaw, recurrence
from wavesym.mechanics.node import Parameters, System
from wavesym.systems.building import BUILDING_FORCE, BUILDING_GROUND
from wavesym.systems.collision import COLLISION
from wavesym.systems.drive import DRIVE, DRIVE_RAMPS

K, J = SYMBOLS.kappa, SYMBOLS.inertia


@dataclass(frozen=True)
class Alike:
    """A list of parameters of which all have one `value`, but those at the indices `but`."""

    base: IndexedBase
    value: Expr
    but: tuple[Expr | int, ...] = ()

    def __getitem__(self, index: Expr | int) -> Expr:
        return self.base[index] if index in self.but else self.value


class Equal(NamedTuple):
    """left = right, for i = first, first + step, ... last."""

    left: Expr
    right: Expr
    first: Expr
    last: Expr
    step: int = 1


@dataclass(frozen=True)
class Pattern:
    """Parameters of which some are equal; `equalities` say which."""

    name: str
    equalities: tuple[Equal, ...]
    parameters: Parameters


def _floors(name: str, value: Expr) -> Pattern:
    floors = Equal(K[INDEX], value, Integer(2 if value == K[1] else 1), COUNT - 1)
    return Pattern(name, (floors,), Parameters(Alike(K, value, (0, COUNT))))


GENERIC = Pattern("all rates different", (), SYMBOLS)
_BUILDING = (
    _floors("equal floors", K[1]),
    _floors("equal floors, a roof of half a floor's mass", K[COUNT] / 2),
    GENERIC,
)
_DRIVE = (
    Pattern(
        "equal shafts, equal discs",
        (
            Equal(K[INDEX], K[1], Integer(2), COUNT),
            Equal(J[INDEX], J[1], Integer(2), COUNT + 1),
        ),
        Parameters(Alike(K, K[1]), Alike(J, J[1])),
    ),
    GENERIC,
)
_COLLISION = (
    Pattern(
        "equal bodies",
        (Equal(K[INDEX], K[1], Integer(3), COUNT - 1, 2),),
        Parameters(Alike(K, K[1]), velocity=SYMBOLS.velocity),
    ),
    GENERIC,
)


_KNOWN = {
    COLLISION: _COLLISION,
    DRIVE: _DRIVE,
    DRIVE_RAMPS: _DRIVE,
    BUILDING_FORCE: _BUILDING,
    BUILDING_GROUND: _BUILDING,
}


def patterns(system: System) -> tuple[Pattern, ...]:
    """The patterns of a system; the last one is the general case."""
    return _KNOWN.get(system, (GENERIC,))


def pattern_laws(system: System, pattern: Pattern) -> tuple[CoefficientLaw, ...]:
    """The laws of a system whose parameters are so equal, for symbolic m."""
    return recurrence(system, pattern.parameters).laws


def rates(laws: Iterable[CoefficientLaw]) -> tuple[Expr, ...]:
    """The different rates of laws that are written out, or have the same rate for every i; 0 first."""
    found: dict[Expr, Expr] = {}
    for law in laws:
        q = law.own_rate
        if q is not None:
            found.setdefault(cancel(q), q)
    return (Integer(0), *found.values())
