"""What of a chain takes part in a mode: under each load, and when all supports move together."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from flint import arb, fmpq

from wavesym.exact.modes.shape import Mode
from wavesym.exact.modes.statics import Statics
from wavesym.mechanics.network import Network
from wavesym.numbers.doubles import midpoint
from wavesym.programs.modes.projection import Driver, share


@dataclass(frozen=True)
class Participation:
    """How much one load has to do with a mode.

    Attributes:
        factor: dimensionless. Of an end whose motion is prescribed G = q M r/(q M q), q the shape with its largest
            value 1 and r how all moves with the end at rest in time; of a force how far its point moves in the shape.
        effective_mass: of such an end (q M r)^2/(q M q), in parts of r M r; None of a force.
    """

    factor: float
    effective_mass: float | None


def participations(network: Network, mode: Mode, largest: arb) -> dict[str, Participation]:
    """Those of a real mode of mass 1 under all loads and prescribed motions, by the names or places of their points.

    Args:
        network: whose mode it is.
        mode: without dashpots.
        largest: how far the point moves that moves most.
    """
    found: dict[str, Participation] = {}
    for number in _driven_points(network):
        point = network.points[number]
        name = point.label
        if point.motion is None:
            moved = mode.points[number]
            found[name] = Participation(0.0 if moved.contains(0) else midpoint(moved / largest), None)
        elif not mode.frequency.contains(0):
            taken = -share(Driver(number, fmpq(1), "", ""), mode)
            statics = Statics(mode.stiffness)
            whole = statics.mass(statics.imposed_shape(number).points)
            found[name] = Participation(midpoint(taken * largest), midpoint(taken * taken / whole))
    return found


def _driven_points(network: Network) -> Iterator[int]:
    """The points that loads act on, and those whose motion is prescribed."""
    for number, point in enumerate(network.points):
        if point.motion != "fixed" and (point.motion is not None or point.loads):
            yield number


def effective_mass(network: Network, mode: Mode) -> float | None:
    """What of the mass moves with the supports: the square of the integral of mass times shape, over all of the mass.

    By Newton's law that integral is the force of all supports over -w^2. None where nothing holds the chain, or gears
    make it mean nothing.
    """
    geared = any(ratio != 1 for bar in network.bars for ratio in bar.ratios) or any(
        link.ratio != 1 for link in network.links
    )
    held = any(point.motion or point.stiffness != 0 for point in network.points)
    if geared or not held or mode.frequency.contains(0):
        return None
    cut = mode.stiffness.network
    force = arb(0)
    for number, (point, moved) in enumerate(zip(cut.points, mode.points, strict=True)):
        force -= mode.pull(number) if point.motion else point.stiffness * moved
    whole = sum((point.mass for point in cut.points if not point.motion), arb(0))
    whole += sum((bar.impedance * bar.delay for bar in cut.bars), arb(0))
    moved = force / mode.frequency**2
    return midpoint(moved * moved / whole)  # flint's power of a ball about 0 is no number
