"""A building in physical units: storeys from the ground up, whose columns are rods that carry shear.

A storey's columns have the mass and the stiffness of a rod: G A = stiffness times height, rho A = mass / height. Then
l/c = sqrt(mass/stiffness), and kappa = mass of the columns / mass of the floor on them, or of the foundation below.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Annotated, Any

from pydantic import BeforeValidator, FailFast, Field, PlainValidator

from wavesym.fields.numbers import Integer, Positive
from wavesym.fields.table import SceneTable, listed, placed, shown, wrong
from wavesym.scene.physical.elastic import ElasticRod, Rods
from wavesym.scene.physical.measured import (
    Area,
    Density,
    Length,
    Mass,
    Modulus,
    SecondMoment,
    Stiffness,
    measured,
    one_of,
)
from wavesym.scene.physical.rewritten import LoadUnit, Rewritten
from wavesym.systems.building import known_base

MOST_STOREYS = 10_000


class Columns(SceneTable):
    """n clamped columns: stiffness 12 E I / l^3 each."""

    n: Positive = Field(description="the number of columns")
    E: Modulus = Field(description='a modulus such as "210 GPa"')
    I: SecondMoment = Field(description='a second moment of area such as "57680 cm^4"')  # noqa: E741
    A: Area | None = None
    rho: Density | None = None

    @property
    def depth_squared(self) -> Fraction | None:
        """That of a square column that has this area and second moment."""
        return self.A and 12 * self.I / self.A

    def stiffness(self, height: Fraction) -> Fraction:
        """Of all of them."""
        return 12 * self.n * self.E * self.I / height**3

    @property
    def area(self) -> Fraction | None:
        """Of all of them."""
        return self.A and self.n * self.A


class Shear(SceneTable):
    """A wall: stiffness k G A / l."""

    k: Positive = Field(description="the shear coefficient, a number")
    G: Modulus = Field(description='a modulus such as "80 GPa"')
    A: Area = Field(description='an area such as "2 m^2"')
    rho: Density | None = None

    def stiffness(self, height: Fraction) -> Fraction:
        """Of the wall."""
        return self.k * self.G * self.A / height

    @property
    def area(self) -> Fraction | None:
        """Of the wall, where it says what its mass is."""
        return self.A if self.rho else None


def _column_mass(value: object) -> Fraction:
    mass = measured(value, "mass", 0)
    if not mass:
        springs = 'type = "chain", parts { spring = "678 MN/m" } and { mass = "350 t" }'
        raise wrong(f"columns without mass have no waves, and are springs; write {springs}")
    return mass


ColumnMass = Annotated[Fraction, PlainValidator(_column_mass)]


class Storey(SceneTable):
    """One storey, or `count` that are the same."""

    count: Integer = 1
    height: Length = Field(description='a length such as "3.5 m"')
    stiffness: Stiffness | None = None
    columns: Columns | None = None
    shear: Shear | None = None
    column_mass: ColumnMass | None = None
    floor_mass: Mass = Field(description='a mass such as "350 t"')

    def rod(self) -> ElasticRod:
        """Its columns as one rod. Raises the error of `table.wrong`."""
        given = one_of(self, "stiffness", "columns", "shear")
        made = self.columns or self.shear
        stiffness = made.stiffness(self.height) if made else self.stiffness
        assert stiffness is not None  # one of the three is given
        depth = self.columns.depth_squared if self.columns else None
        return ElasticRod(self.height, self._mass(given, made), stiffness, depth)

    def _mass(self, given: str, made: Columns | Shear | None) -> Fraction:
        area, rho = (made.area, made.rho) if made else (None, None)
        if made and (made.A is None) != (rho is None) and given == "columns":
            raise wrong("only one of A and rho; write both of the columns", given, "A" if made.A else "rho")
        if area is None or rho is None:
            if self.column_mass is None:
                raise wrong('missing; write a mass such as "10.9 t"', "column_mass")
            return self.column_mass
        if self.column_mass is not None:
            raise wrong(f"columns have rho of {given} already; write one of them", "column_mass")
        return rho * area * self.height


def _base(value: object) -> str:
    return known_base(value)


class PhysicalBuilding(SceneTable):
    """Storeys on a foundation."""

    type: str
    base: Annotated[str, PlainValidator(_base)] = Field(description='"force" or "ground"')
    storey: Annotated[tuple[Storey, ...], FailFast(), BeforeValidator(listed)] = Field(description="a list of storeys")
    foundation_mass: Mass | None = None
    damping: Any = None

    def rewritten(self) -> Rewritten:
        """As a building without units, where storeys differ part by part."""
        rods, floors = self._storeys()
        foundation = self._foundation()
        scaled = Rods.of(rods)
        first = scaled.first
        unit = first.length / scaled.seconds**2
        kappa = tuple(rod.mass / floor for rod, floor in zip(rods, floors, strict=True))
        if scaled.alike:
            base = kappa[0] if foundation is None else first.mass / foundation
            numbers = [base, *kappa]
            table: dict[str, object] = {"type": "building", "m": len(rods), "kappa": numbers, "base": self.base}
            acting = LoadUnit("acceleration", "jerk", unit, {}, {})
        else:
            start: object = {"motion": "acceleration"} if foundation is None else "free"
            storeys = [
                part
                for number, floor in enumerate(floors)
                for part in (scaled.part(number, Fraction(1)), {"mass": floor / first.mass})
            ]
            table = {"type": "building", "base": self.base, "parts": [start, *storeys]}
            # the foundation's inertia pushes against the columns
            size = unit if foundation is None else -first.stiffness * first.length / foundation
            acting = LoadUnit("acceleration", "jerk", size, {"a": "steps", "b": "ramps"}, {"at": 0})
        if self.damping is not None:
            table["damping"] = self.damping
        return Rewritten(
            kind="shear",
            rods=scaled,
            system=table,
            displacement=first.length,
            force=first.stiffness * first.length,
            lengths=tuple(rod.length for rod in rods),
            acting=lambda load: acting,
            kappa=kappa,
        )

    def _storeys(self) -> tuple[list[ElasticRod], list[Fraction]]:
        """The rod of each storey, and the floor on it. Raises the error of `table.wrong`."""
        if not self.storey:
            raise wrong("no storey; write at least one [[system.storey]]", "storey")
        rods: list[ElasticRod] = []
        floors: list[Fraction] = []
        for k, storey in enumerate(self.storey):
            if not 0 < storey.count <= MOST_STOREYS - len(rods):
                most = f"{MOST_STOREYS} storeys in all"
                raise wrong(f"{shown(storey.count)} is out of range; write 1 to {most}", "storey", k, "count")
            with placed("storey", k):
                rods += [storey.rod()] * storey.count
            floors += [storey.floor_mass] * storey.count
        return rods, floors

    def _foundation(self) -> Fraction | None:
        """The mass of a foundation that is not moved with the ground. Raises the error of `table.wrong`."""
        if self.base == "ground" and self.foundation_mass is not None:
            raise wrong('base = "ground" moves the foundation, whatever its mass; leave it out', "foundation_mass")
        if self.base == "force" and self.foundation_mass is None:
            raise wrong('missing, and base = "force" needs it; write a mass such as "350 t"', "foundation_mass")
        return self.foundation_mass
