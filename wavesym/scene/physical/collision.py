"""A collision in physical units: rigid bodies with an elastic rod on either side.

A rod has the mass and the stiffness that it has along its axis: rho A l, and E A / l. Then l/c = l sqrt(rho/E), and
kappa = mass of one rod / mass of the body it is on. Displacements are counted in lengths of the first rod, so that
velocities are in units of c.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from itertools import pairwise
from typing import Annotated, Any

from pydantic import BeforeValidator, FailFast, Field

from wavesym.fields.table import SceneTable, listed, wrong
from wavesym.scene.physical.elastic import ElasticRod, Rods
from wavesym.scene.physical.measured import Area, Density, Length, Mass, Modulus, Velocity, tidy
from wavesym.scene.physical.rewritten import LoadUnit, Rewritten
from wavesym.systems.collision import Collision, known_contacts


class RodOfBody(SceneTable):
    """The rod on one side of a body."""

    length: Length = Field(description='a length such as "1.2 m"')
    A: Area = Field(description='an area such as "8 cm^2"')
    E: Modulus = Field(description='a modulus such as "210 GPa"')
    rho: Density = Field(description='a density such as "7850 kg/m^3"')

    def rod(self) -> ElasticRod:
        """As waves see it."""
        return ElasticRod(self.length, self.rho * self.A * self.length, self.E * self.A / self.length, self.A)


class Body(SceneTable):
    """A rigid body with its rods, and how fast they move together at first."""

    left: RodOfBody = Field(description="a rod, as a table")
    right: RodOfBody = Field(description="a rod, as a table")
    mass: Mass = Field(description='a mass such as "12 kg"')
    velocity: Velocity = Field(description='a velocity such as "5 m/s"')


class PhysicalCollision(SceneTable):
    """Bodies from left to right, which touch at t = 0."""

    type: str
    body: Annotated[tuple[Body, ...], FailFast(), BeforeValidator(listed)] = Field(description="a list of bodies")
    contacts: Any = "closed"

    def rewritten(self) -> Rewritten:
        """As a collision without units, where rods differ part by part."""
        bodies = self.body
        if len(bodies) < 2:
            raise wrong(f"{len(bodies)} bodies; write at least 2", "body")
        for k, (body, after) in enumerate(pairwise(bodies), 1):
            if after.velocity > body.velocity:
                raise wrong(
                    f"more than the {tidy(body.velocity)} m/s of the body on its left, and they would part; write that "
                    "or less",
                    "body",
                    k,
                    "velocity",
                )
        rods = Rods.of([side.rod() for body in bodies for side in (body.left, body.right)])
        first = rods.first
        velocities = [body.velocity * rods.seconds / first.length for body in bodies]
        kappa = tuple(rod.mass / body.mass for body, rod in zip(bodies, rods.all[::2], strict=True))
        if rods.alike:
            table: dict[str, object] = {"type": "collision", "m": 2 * len(bodies), "kappa": kappa}
            table |= {"velocity": velocities, "contacts": self.contacts}
        else:
            table = {"type": "collision", "parts": self._parts(rods, velocities)}
        return Rewritten(
            kind="longitudinal",
            rods=rods,
            system=table,
            displacement=first.length,
            force=first.stiffness * first.length,
            lengths=tuple(rod.length for rod in rods.all),
            acting=_unloaded,
            kappa=kappa,
        )

    def _parts(self, rods: Rods, velocities: list[Fraction]) -> list[object]:
        """From left to right; rods whose contact is closed for good are joined."""
        touching: list[object] = ["contact"] if known_contacts(self.contacts) == "open" else []
        parts: list[object] = []
        for k, (body, velocity) in enumerate(zip(self.body, velocities, strict=True)):
            left, right = (rods.part(2 * k + n, Fraction(1)) | {"velocity": velocity} for n in (0, 1))
            parts += [*(touching if k else []), left, {"mass": body.mass / rods.first.mass}, right]
        return parts


def _unloaded(load: Mapping[str, Any]) -> LoadUnit:
    raise wrong(f"{Collision.no_loads}; leave [[load]] out")
