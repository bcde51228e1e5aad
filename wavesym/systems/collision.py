"""System I: m/2 rigid bodies with a rod on either side collide at tau = 0; (4.3).

Bodies sit at odd x, contacts at even x, the two ends are free. In the paper's formal model contacts stay closed; as
"open" ones they open and close, which only a network knows.

In units a rod has the mass and the stiffness that it has along its axis: rho A l, and E A / l. Then
l/c = l sqrt(rho/E), and kappa = mass of one rod / mass of the body it is on. Displacements are counted in lengths of
the first rod, so that velocities are in units of c.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal

from pydantic import (
    BeforeValidator,
    FailFast,
    Field,
    SerializerFunctionWrapHandler,
    field_validator,
    model_serializer,
)

from wavesym.fields.loads import Load
from wavesym.fields.numbers import Numbers, Positives
from wavesym.fields.quantity_fields import Area, Density, Length, Mass, Modulus, Velocity, tidy
from wavesym.fields.table import SceneTable, as_list, read_choice, refusal, show, without_usual
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.length import LengthUnit
from wavesym.mechanics.network import Network, with_contacts
from wavesym.mechanics.node import Family, Node, Parameters, Quantity, Rod, System, single
from wavesym.systems.dimensionless import DimensionlessSystem, LoadUnit
from wavesym.systems.elastic import ElasticRod, Rods
from wavesym.systems.parts import Table
from wavesym.systems.place import MisplacedError, Place, Position
from wavesym.systems.preset import Preset


def _families(m: Quantity, p: Parameters) -> tuple[Family, ...]:
    # Table 1; a rod moves at first with the body it is fixed to
    def first() -> Rod:
        return Rod(tau0=1, x0=1, velocity=p.velocity[1])

    def last() -> Rod:
        return Rod(tau0=1, x0=m - 1, velocity=p.velocity[m - 1])

    def even(i: Quantity) -> Rod:
        return Rod(tau0=0, x0=i, velocity=p.velocity[i - 1])

    def odd(i: Quantity) -> Rod:
        return Rod(tau0=0, x0=i - 1, velocity=p.velocity[i])

    def body(i: Quantity, left: Rod, right: Rod) -> Node:
        return Node(left, right, inertia=1, alpha=2 * p.kappa[i], beta=2 * p.kappa[i])

    return (
        single(0, lambda: Node(None, first(), inertia=0, alpha=0, beta=2)),
        single(1, lambda: body(1, first(), even(2))),
        Family(2, m - 2, 2, lambda i: Node(even(i), odd(i + 1), inertia=0, alpha=2, beta=2, contact=True)),
        Family(3, m - 3, 2, lambda i: body(i, odd(i), even(i + 1))),
        single(m - 1, lambda: body(m - 1, odd(m - 1), last())),
        single(m, lambda: Node(last(), None, inertia=0, alpha=2, beta=0)),
    )


def _indices(m: int) -> Mapping[str, range]:
    return {"kappa": range(1, m, 2), "velocity": range(1, m, 2)}


COLLISION = System("collision", _families, _indices, smallest=4, step=2)


read_contacts = read_choice("is unknown", "closed", "open")


def collision_parts(
    rods: Sequence[Table], masses: Sequence[Fraction], velocities: Sequence[Fraction], *, opens: bool
) -> list[object]:
    """From left to right of each body a rod, a mass and a rod; rods whose contact is closed for good are joined."""
    parts: list[object] = []
    for k, (mass, velocity) in enumerate(zip(masses, velocities, strict=True)):
        left, right = (dict(rod) | {"velocity": velocity} for rod in rods[2 * k : 2 * k + 2])
        parts += [*(["contact"] if k and opens else []), left, {"mass": mass}, right]
    return parts


class Collision(Preset):
    """m rods with m/2 rigid bodies at x = 1, 3, ... m - 1 that collide at tau = 0."""

    variants: ClassVar[tuple[System, ...]] = (COLLISION,)
    counts: ClassVar[Mapping[str, str]] = {"kappa": "m/2", "velocity": "m/2"}
    no_loads: ClassVar[str] = "a collision has its velocities"

    type: Literal["collision"] = Field(description='"collision"')
    kappa: Positives = Field(description="a list of m/2 positive numbers")
    velocity: Numbers = Field(description="a list of m/2 numbers")
    contacts: Literal["closed", "open"] = "closed"

    @field_validator("contacts", mode="before")
    @classmethod
    def _check_contacts(cls, contacts: object) -> object:
        return read_contacts(contacts)

    @model_serializer(mode="wrap")
    def _serialize(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        return without_usual(handler(self), contacts="closed")

    @field_validator("velocity")
    @classmethod
    def _check_velocities(cls, velocity: tuple[Fraction, ...]) -> tuple[Fraction, ...]:
        for k in range(1, len(velocity)):
            if velocity[k] > velocity[k - 1]:
                left = show(velocity[k - 1])
                raise refusal(
                    f"{show(velocity[k])} is more than the {left} on its left, and the bodies would part; write "
                    "that or less",
                    k,
                )
        return velocity

    @property
    def choices(self) -> Mapping[str, str]:
        """Whether contacts open."""
        return {"contacts": "open"} if self.contacts == "open" else {}

    def locate(self, position: Position, quantity: str, loads: Sequence[Load]) -> Place:
        """The place of an output. MisplacedError."""
        place = super().locate(position, quantity, loads)
        touching = 0 < place.x < self.m and place.x % 2 == 0
        if self.contacts == "closed" or quantity in ("strain", "force") or not touching:
            return place
        if not position.side:
            at = position.text
            raise MisplacedError(f'{at} has two sides, where bodies touch; write "{at}-" or "{at}+"')
        beyond = position.side > 0
        return replace(place, side=position.side, rod=place.rod + beyond, part=Fraction(1 - beyond))

    def named_chain(self, loads: Sequence[Load]) -> Chain | None:
        """The chain as the paper has it: contacts stay closed."""
        return self.chain if self.contacts == "closed" else None

    def network(self, loads: Sequence[Load], length: LengthUnit | None = None) -> Network:
        """The bodies and rods, with contacts that open where these do."""
        network = super().network(loads, length)
        return network if self.contacts == "closed" else with_contacts(network, range(2, self.m, 2))

    @property
    def tables(self) -> list[object]:
        """Its parts, in units of a rod."""
        masses = [1 / kappa for kappa in self.kappa]
        return collision_parts([{"rod": 1}] * self.m, masses, self.velocity, opens=self.contacts == "open")


class RodOfBody(SceneTable):
    """The rod on one side of a body."""

    length: Length = Field(description='a length such as "1.2 m"')
    A: Area = Field(description='an area such as "8 cm^2"')
    E: Modulus = Field(description='a modulus such as "210 GPa"')
    rho: Density = Field(description='a density such as "7850 kg/m^3"')

    def rod(self) -> ElasticRod:
        """As waves see it."""
        return ElasticRod.from_area(self.length, self.E, self.A, self.rho)


class Body(SceneTable):
    """A rigid body with its rods, and how fast they move together at first."""

    left: RodOfBody = Field(description="a rod, as a table")
    right: RodOfBody = Field(description="a rod, as a table")
    mass: Mass = Field(description='a mass such as "12 kg"')
    velocity: Velocity = Field(description='a velocity such as "5 m/s"')


class PhysicalCollision(SceneTable):
    """Bodies from left to right, which touch at t = 0."""

    type: str
    body: Annotated[tuple[Body, ...], FailFast(), BeforeValidator(as_list)] = Field(description="a list of bodies")
    contacts: Any = "closed"

    def without_units(self) -> DimensionlessSystem:
        """As a collision without units, where rods differ part by part."""
        bodies = self.body
        if len(bodies) < 2:
            raise refusal(f"{len(bodies)} bodies; write at least 2", "body")
        for k, (body, after) in enumerate(pairwise(bodies), 1):
            if after.velocity > body.velocity:
                raise refusal(
                    f"more than the {tidy(body.velocity)} m/s of the body on its left, and they would part; write that "
                    "or less",
                    "body",
                    k,
                    "velocity",
                )
        rods = Rods.from_rods([side.rod() for body in bodies for side in (body.left, body.right)])
        first = rods.first
        velocities = [body.velocity * rods.seconds / first.length for body in bodies]
        kappa = tuple(rod.mass / body.mass for body, rod in zip(bodies, rods.all[::2], strict=True))
        if rods.alike:
            table: dict[str, object] = {"type": "collision", "m": 2 * len(bodies), "kappa": kappa}
            table |= {"velocity": velocities, "contacts": self.contacts}
        else:
            masses = [body.mass / first.mass for body in bodies]
            opens = read_contacts(self.contacts) == "open"
            table = {"type": "collision", "parts": collision_parts(rods.parts, masses, velocities, opens=opens)}
        return DimensionlessSystem(
            kind="longitudinal",
            rods=rods,
            system=table,
            displacement=first.length,
            force=first.stiffness * first.length,
            lengths=tuple(rod.length for rod in rods.all),
            load_unit=_refuse_loads,
            kappa=kappa,
        )


def _refuse_loads(load: Mapping[str, Any]) -> LoadUnit:
    raise refusal(f"{Collision.no_loads}; leave [[load]] out")
