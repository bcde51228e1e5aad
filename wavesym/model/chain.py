"""Scene -> Chain: the nodes of a scene, written out, every number exact."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from flint import fmpq

from wavesym.model.node import Node, Parameters, Rod, System
from wavesym.model.systems.building import BUILDING_FORCE, BUILDING_GROUND
from wavesym.model.systems.collision import COLLISION
from wavesym.model.systems.drive import DRIVE
from wavesym.scene import Building, Collision, Drive, Scene


@dataclass(frozen=True)
class Chain:
    """m rods between m + 1 nodes; `nodes[x]` is the node at x, and rod i lies between nodes i - 1 and i."""

    system: System
    m: int
    parameters: Parameters

    @cached_property
    def nodes(self) -> tuple[Node, ...]:
        """The nodes at x = 0, 1, ... m."""
        placed = {
            x: family.at(x)
            for family in self.system.families(self.m, self.parameters)
            for x in range(family.first, family.last + 1, family.step)
        }
        return tuple(placed[x] for x in range(self.m + 1))

    def rod(self, i: int) -> Rod:
        """Rod i = 1 ... m."""
        rod = self.nodes[i].left
        assert rod is not None  # every node but the first has a rod on its left
        return rod

    def leaves(self, function: str, rod: int, z: int) -> int:
        """When "f" or "g" of a rod leaves its node, x = rod - 1 or x = rod, with argument z: tau, by (4.2)."""
        clock = self.rod(rod)
        return int(z + clock.tau0 + (rod - 1 - clock.x0 if function == "f" else clock.x0 - rod))

    @cached_property
    def sources(self) -> tuple[str, ...]:
        """The unit loads of the system; a collision has its impact instead."""
        names = (f"{load.kind}{load.number or ''}" for node in self.nodes for load in node.loads)
        return tuple(names) or ("impact",)


def chain(scene: Scene) -> Chain:
    """The chain of a scene."""
    parts = scene.system
    m = parts.m
    exact = [fmpq(k.numerator, k.denominator) for k in parts.kappa]
    match parts:
        case Collision():
            velocity = [fmpq(v.numerator, v.denominator) for v in parts.velocity]
            bodies = range(1, m, 2)
            return Chain(
                COLLISION,
                m,
                Parameters(
                    kappa=dict(zip(bodies, exact, strict=True)), velocity=dict(zip(bodies, velocity, strict=True))
                ),
            )
        case Drive():
            inertia = [fmpq(j.numerator, j.denominator) for j in parts.inertia]
            return Chain(DRIVE, m, Parameters(kappa=dict(enumerate(exact, 1)), inertia=dict(enumerate(inertia, 1))))
        case Building():
            system = BUILDING_FORCE if parts.base == "force" else BUILDING_GROUND
            return Chain(system, m, Parameters(kappa=dict(enumerate(exact))))
