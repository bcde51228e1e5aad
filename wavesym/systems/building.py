"""System III: a building of m storeys under base acceleration; (4.5), and with a base that moves with the ground.

The paper's base ("force") balances the foundation's inertia M_0 a against the columns. It is not a foundation that
moves with the ground ("ground"), whose velocity is the integral of the acceleration.

In units it is written as storeys from the ground up, whose columns are rods that carry shear: they have the mass and
the stiffness of a rod, G A = stiffness times height, rho A = mass / height. Then l/c = sqrt(mass/stiffness), and
kappa = mass of the columns / mass of the floor on them, or of the foundation below.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from fractions import Fraction
from functools import partial
from typing import Annotated, Any, ClassVar, Literal

from pydantic import (
    BeforeValidator,
    FailFast,
    Field,
    PlainValidator,
    SerializerFunctionWrapHandler,
    field_validator,
    model_serializer,
)

from wavesym.fields.damping import ModalDamping, without_damping
from wavesym.fields.loads import Load, LoadKinds, SampledLoad, TimedLoad
from wavesym.fields.numbers import Integer, Numbers, Positive, Positives
from wavesym.fields.quantity_fields import (
    Area,
    Density,
    Length,
    Mass,
    Modulus,
    SecondMoment,
    Stiffness,
    one_of,
    read_quantity,
)
from wavesym.fields.shapes import ShapedLoad
from wavesym.fields.table import SceneTable, as_list, key_context, read_choice, refusal, show
from wavesym.mechanics.node import Family, Node, Parameters, Quantity, Rod, System, UnitLoad, single
from wavesym.records.load import RecordedLoad
from wavesym.systems.dimensionless import DimensionlessSystem, LoadUnit
from wavesym.systems.elastic import ElasticRod, Rods
from wavesym.systems.parts import Table
from wavesym.systems.preset import Preset
from wavesym.systems.speed_adjustment import SpeedAdjustment, adjustment_choice, without_adjustment

MOST_STOREYS = 10_000


def _force(storey: Rod, p: Parameters) -> Node:
    loads = (UnitLoad("a", None, (-1 / p.kappa[0],)), UnitLoad("b", None, (0, -1 / p.kappa[0])))
    return Node(None, storey, inertia=0, alpha=0, beta=2, loads=loads)


def _ground(storey: Rod, p: Parameters) -> Node:
    loads = (UnitLoad("a", None, (0, 1)), UnitLoad("b", None, (0, 0, Fraction(1, 2))))
    return Node(None, storey, inertia=0, alpha=0, beta=0, damping=1, loads=loads)


def _families(base: Callable[[Rod, Parameters], Node], m: Quantity, p: Parameters) -> tuple[Family, ...]:
    def storey(i: Quantity) -> Rod:
        return Rod(tau0=i - 1, x0=i - 1)

    def floor(i: Quantity) -> Node:
        return Node(storey(i), storey(i + 1), inertia=1, alpha=2 * p.kappa[i], beta=2 * p.kappa[i])

    return (
        single(0, lambda: base(storey(1), p)),
        Family(1, m - 1, 1, floor),
        single(m, lambda: Node(storey(m), None, inertia=1, alpha=2 * p.kappa[m], beta=0)),
    )


def _indices(m: int) -> Mapping[str, range]:
    return {"kappa": range(m + 1)}


BUILDING_FORCE = System("building-force", partial(_families, _force), _indices, smallest=2)
BUILDING_GROUND = System("building-ground", partial(_families, _ground), _indices, smallest=2)


class OfBase(Load):
    """The base acceleration of a building."""

    @property
    def sources(self) -> tuple[str, str]:
        """A step and a ramp of it."""
        return "a", "b"

    @property
    def action(self) -> str:
        """What it acts as, for people."""
        return "acceleration of the base"


class Acceleration(OfBase, TimedLoad):
    """(3.2): sum_k (a_k + b_k (tau - times_k)) H(tau - times_k)."""

    lists: ClassVar[tuple[str, str]] = ("a", "b")

    a: Numbers = ()
    b: Numbers = ()


class SampledAcceleration(OfBase, SampledLoad):
    """A base acceleration that is linear between its samples."""


class RecordedAcceleration(OfBase, RecordedLoad):
    """A base acceleration that is a record."""


class ShapedAcceleration(OfBase, ShapedLoad):
    """A base acceleration of one shape."""


read_base = read_choice("is not a base", "force", "ground")


def building_parts(base: str, storeys: Iterable[tuple[Table, Fraction]]) -> list[object]:
    """From the ground up the foundation, then of each storey its columns, as a rod, and the floor on them, a mass."""
    foundation: object = {"motion": "acceleration"} if base == "ground" else "free"
    return [foundation, *(part for rod, floor in storeys for part in (rod, {"mass": floor}))]


class Building(Preset):
    """m storeys between the foundation at x = 0, floors, and the roof at x = m."""

    variants: ClassVar[tuple[System, ...]] = (BUILDING_FORCE, BUILDING_GROUND)
    counts: ClassVar[Mapping[str, str]] = {"kappa": "m + 1"}
    fewest: ClassVar[int | None] = 1  # no floor, but a roof
    load_kinds: ClassVar[LoadKinds] = (Acceleration, SampledAcceleration, RecordedAcceleration, ShapedAcceleration)

    type: Literal["building"] = Field(description='"building"')
    kappa: Positives = Field(description="a list of m + 1 positive numbers")
    base: Literal["force", "ground"] = Field(description='"force" or "ground"')
    damping: ModalDamping = None
    speed_adjustment: SpeedAdjustment = Fraction(0)

    @model_serializer(mode="wrap")
    def _serialize(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        return without_adjustment(without_damping(handler(self)))

    @field_validator("base", mode="before")
    @classmethod
    def _check_base(cls, base: object) -> object:
        return read_base(base)

    @property
    def system(self) -> System:
        """The one of the two variants."""
        return BUILDING_FORCE if self.base == "force" else BUILDING_GROUND

    @property
    def places_text(self) -> str:
        """Its floors, for people."""
        return f"a position from 0, the foundation, to {self.m}, the roof"

    @property
    def choices(self) -> Mapping[str, str]:
        """Which base, how its modes are damped, and how much speeds may change."""
        damping = {"damping": self.damping.description} if self.damping else {}
        return {"base": self.base, **damping, **adjustment_choice(self.speed_adjustment)}

    @property
    def tables(self) -> list[object]:
        """Its parts, in units of the columns of a storey."""
        return building_parts(self.base, (({"rod": 1}, 1 / kappa) for kappa in self.kappa[1:]))


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
    mass = read_quantity(value, "mass", 0)
    if not mass:
        springs = 'type = "chain", parts { spring = "678 MN/m" } and { mass = "350 t" }'
        raise refusal(f"columns without mass have no waves, and are springs; write {springs}")
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
        """Its columns as one rod. Raises the error of `table.refusal`."""
        given = one_of(self, "stiffness", "columns", "shear")
        made = self.columns or self.shear
        stiffness = made.stiffness(self.height) if made else self.stiffness
        assert stiffness is not None  # one of the three is given
        depth = self.columns.depth_squared if self.columns else None
        section = self.shear.A if self.shear else None  # columns bend
        return ElasticRod(self.height, self._mass(given, made), stiffness, depth, section)

    def _mass(self, given: str, made: Columns | Shear | None) -> Fraction:
        area, rho = (made.area, made.rho) if made else (None, None)
        if made and (made.A is None) != (rho is None) and given == "columns":
            raise refusal("only one of A and rho; write both of the columns", given, "A" if made.A else "rho")
        if area is None or rho is None:
            if self.column_mass is None:
                raise refusal('missing; write a mass such as "10.9 t"', "column_mass")
            return self.column_mass
        if self.column_mass is not None:
            raise refusal(f"columns have rho of {given} already; write one of them", "column_mass")
        return rho * area * self.height


class PhysicalBuilding(SceneTable):
    """Storeys on a foundation."""

    type: str
    base: Annotated[str, PlainValidator(read_base)] = Field(description='"force" or "ground"')
    storey: Annotated[tuple[Storey, ...], FailFast(), BeforeValidator(as_list)] = Field(description="a list of storeys")
    foundation_mass: Mass | None = None
    damping: Any = None
    speed_adjustment: Any = None

    def without_units(self) -> DimensionlessSystem:
        """As a building without units, where storeys differ part by part."""
        rods, floors = self._storeys()
        foundation = self._foundation()
        scaled = Rods.from_rods(rods)
        first = scaled.first
        unit = first.length / scaled.seconds**2
        kappa = tuple(rod.mass / floor for rod, floor in zip(rods, floors, strict=True))
        if scaled.alike:
            base = kappa[0] if foundation is None else first.mass / foundation
            numbers = [base, *kappa]
            table: dict[str, object] = {"type": "building", "m": len(rods), "kappa": numbers, "base": self.base}
            acting = LoadUnit("acceleration", "jerk", unit, {}, {})
        else:
            storeys = zip(scaled.parts, (floor / first.mass for floor in floors), strict=True)
            table = {"type": "building", "base": self.base, "parts": building_parts(self.base, storeys)}
            # the foundation's inertia pushes against the columns
            size = unit if foundation is None else -first.stiffness * first.length / foundation
            acting = LoadUnit("acceleration", "jerk", size, {"a": "steps", "b": "ramps"}, {"at": 0})
        if self.damping is not None:
            table["damping"] = self.damping
        if self.speed_adjustment is not None:
            table["speed_adjustment"] = self.speed_adjustment
        return DimensionlessSystem(
            kind="shear",
            rods=scaled,
            system=table,
            displacement=first.length,
            force=first.stiffness * first.length,
            lengths=tuple(rod.length for rod in rods),
            load_unit=lambda load: acting,
            kappa=kappa,
        )

    def _storeys(self) -> tuple[list[ElasticRod], list[Fraction]]:
        """The rod of each storey, and the floor on it. Raises the error of `table.refusal`."""
        if not self.storey:
            raise refusal("no storey; write at least one [[system.storey]]", "storey")
        rods: list[ElasticRod] = []
        floors: list[Fraction] = []
        for k, storey in enumerate(self.storey):
            if not 0 < storey.count <= MOST_STOREYS - len(rods):
                most = f"{MOST_STOREYS} storeys in all"
                raise refusal(f"{show(storey.count)} is out of range; write 1 to {most}", "storey", k, "count")
            with key_context("storey", k):
                rods += [storey.rod()] * storey.count
            floors += [storey.floor_mass] * storey.count
        return rods, floors

    def _foundation(self) -> Fraction | None:
        """The mass of a foundation that is not moved with the ground. Raises the error of `table.refusal`."""
        if self.base == "ground" and self.foundation_mass is not None:
            raise refusal('base = "ground" moves the foundation, whatever its mass; leave it out', "foundation_mass")
        if self.base == "force" and self.foundation_mass is None:
            raise refusal('missing, and base = "force" needs it; write a mass such as "350 t"', "foundation_mass")
        return self.foundation_mass
