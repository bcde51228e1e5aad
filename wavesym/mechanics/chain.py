"""The nodes of a system with its numbers, written out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property

from flint import fmpq

from wavesym.errors import WavesymError
from wavesym.mechanics.node import Node, Parameters, Quantity, Rod, System, UnitLoad
from wavesym.numbers.doubles import rational

_POWERS = 3  # of tau in a unit load: a ramp of acceleration is a parabola of velocity


@dataclass(frozen=True)
class Chain:
    """m rods between m + 1 nodes; `nodes[x]` is the node at x, and rod i lies between nodes i - 1 and i.

    Every number in it is an fmpq, or a rational function of symbols.
    """

    system: System
    m: int
    parameters: Parameters

    @cached_property
    def nodes(self) -> tuple[Node, ...]:
        """The nodes at x = 0, 1, ... m. WavesymError for those that no method here serves."""
        placed = {
            x: _exact_node(family.node_at(x))
            for family in self.system.families(self.m, self.parameters)
            for x in range(family.first, family.last + 1, family.step)
        }
        nodes = tuple(placed[x] for x in range(self.m + 1))
        _refuse(nodes)
        return nodes

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
    def unit_loads(self) -> dict[str, tuple[int, UnitLoad]]:
        """The unit loads of the system by source, each with the node that it acts on."""
        return {load.source: (x, load) for x, node in enumerate(self.nodes) for load in node.loads}

    @cached_property
    def sources(self) -> tuple[str, ...]:
        """The unit loads of the system; one without any has its impact instead."""
        return tuple(self.unit_loads) or ("impact",)


def _refuse(nodes: Sequence[Node]) -> None:
    """What tables and programs would get wrong. Symbols are taken to be positive."""
    sources: set[str] = set()
    for x, node in enumerate(nodes):
        if isinstance(node.radiation, fmpq) and node.radiation <= 0:
            raise WavesymError(f"system: damping + (alpha + beta)/2 is {node.radiation} at x = {x}; write more than 0")
        for load in node.loads:
            if len(load.coefficients) > _POWERS:
                raise WavesymError(f"system: {load.source} has powers of tau above {_POWERS - 1}; write lower ones")
            if load.source in sources:
                raise WavesymError(f"system: {load.source} acts on two nodes; write one")
            sources.add(load.source)
    if sources and any(rod and rod.velocity != 0 for node in nodes for rod in (node.left, node.right)):
        raise WavesymError("system: rods that move at tau = 0 and loads exclude each other; write one of them")


def _exact_node(node: Node) -> Node:
    return replace(
        node,
        left=_exact_rod(node.left),
        right=_exact_rod(node.right),
        inertia=_exact(node.inertia),
        alpha=_exact(node.alpha),
        beta=_exact(node.beta),
        damping=_exact(node.damping),
        loads=tuple(replace(load, coefficients=tuple(map(_exact, load.coefficients))) for load in node.loads),
    )


def _exact_rod(rod: Rod | None) -> Rod | None:
    return rod and Rod(_exact(rod.tau0), _exact(rod.x0), _exact(rod.velocity))


def _exact(value: Quantity) -> Quantity:
    """An int or a Fraction as an fmpq; what is exact or symbolic already as it is."""
    return rational(value) if isinstance(value, int | Fraction) else value
