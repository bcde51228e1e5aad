"""What a physical system becomes: the table of a dimensionless one, and what its numbers are in SI base units."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, Literal

from wavesym.systems.elastic import Rods

Kind = Literal["longitudinal", "torsional", "shear"]
"""How waves move the rods."""


@dataclass(frozen=True)
class LoadUnit:
    """What a load is: its dimension and that of its slope, and how much in SI base units a dimensionless 1 is.

    Keys renamed by `renames` and added by `additions` make a load of a named system one of the chain that it became.
    """

    dimension: str
    slope: str
    size: Fraction
    renames: Mapping[str, str] = field(default_factory=dict)
    additions: Mapping[str, object] = field(default_factory=dict)


@dataclass(frozen=True)
class DimensionlessSystem:
    """The table of a dimensionless system; its rods; what a displacement and a force of 1 are in SI base units.

    `lengths` are the lengths of rods in units of x, in m, one alone where all are the same. `acting` says what a load's
    table is about. `kappa` are the masses of rods, each over that of what it drives. Where places are lengths, `lines`
    has how long the main line ("") and the branches are.
    """

    kind: Kind
    rods: Rods
    system: Mapping[str, object]
    displacement: Fraction
    force: Fraction
    lengths: tuple[Fraction, ...]
    load_unit: Callable[[Mapping[str, Any]], LoadUnit]
    kappa: tuple[Fraction, ...] = ()
    lines: Mapping[str, Fraction] | None = None
