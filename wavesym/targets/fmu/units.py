"""Units as FMI writes them: powers of SI base units, and a factor."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from wavesym.fields.quantity import base_units
from wavesym.numbers.doubles import nearest, rational
from wavesym.targets.literals import literal


@dataclass(frozen=True)
class DefinedUnit:
    """A unit's name and its attributes: powers that are not 0, and the factor where it is not 1."""

    name: str
    attributes: tuple[tuple[str, str], ...]


def define_units(names: Iterable[str]) -> tuple[DefinedUnit, ...]:
    """The units by these names, each once."""
    return tuple(map(_define_unit, sorted({name for name in names if name})))


def _define_unit(name: str) -> DefinedUnit:
    factor, powers = base_units(name)
    attributes = [(base, str(powers[base])) for base in ("kg", "m", "s", "rad") if powers.get(base)]
    if factor != 1:
        attributes.append(("factor", literal(nearest(rational(factor)))))
    return DefinedUnit(name, tuple(attributes))
