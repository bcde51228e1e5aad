"""System I: m/2 rigid bodies with a rod on either side collide at tau = 0; (4.3).

Bodies sit at odd x, contacts at even x, the two ends are free.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import ClassVar, Literal

from pydantic import Field, field_validator

from wavesym.fields.numbers import Numbers, Positives
from wavesym.fields.table import shown, wrong
from wavesym.model.node import Family, Node, Parameters, Quantity, Rod, System, single
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


class Collision(Preset):
    """m rods with m/2 rigid bodies at x = 1, 3, ... m - 1 that collide at tau = 0."""

    variants: ClassVar[tuple[System, ...]] = (COLLISION,)
    counts: ClassVar[Mapping[str, str]] = {"kappa": "m/2", "velocity": "m/2"}
    no_loads: ClassVar[str] = "a collision has its velocities"

    type: Literal["collision"] = Field(description='"collision"')
    kappa: Positives = Field(description="a list of m/2 positive numbers")
    velocity: Numbers = Field(description="a list of m/2 numbers")

    @field_validator("velocity")
    @classmethod
    def _closing(cls, velocity: tuple[Fraction, ...]) -> tuple[Fraction, ...]:
        for k in range(1, len(velocity)):
            if velocity[k] > velocity[k - 1]:
                left = shown(velocity[k - 1])
                raise wrong(
                    f"{shown(velocity[k])} given, at most {left} expected, as on its left (or the bodies part)", k
                )
        return velocity
