"""Motion of frequency 0 of a chain with dashpots, exact: none of it is searched.

Where s = i w is 0 dashpots resist nothing, so what holds points is rods and springs alone. Each group of points that
these tie to each other, and to nothing at rest, has one motion without strain. Where dashpots resist it, it is a shift
that stays: a zero of the determinant, as often as there are such motions that differ. Where they do not, as the whole
chain moves alike, its velocity lasts too: a rigid motion, and a double zero.
"""

from __future__ import annotations

from dataclasses import replace

from flint import acb, arb, fmpq

from wavesym.exact.modes.shape import Mode, rigid, rigid_mode, unstrained_groups
from wavesym.exact.modes.stiffness import Stiffness


def zero_modes(stiffness: Stiffness) -> list[Mode]:
    """Rigid motion, if there is one, and shifts, each of one group alone; their numbers are complex, as of others.

    All groups together move as rigid motion does: beside it there is one shift less. Shifts are not scaled to a mass.
    """
    network = stiffness.network
    groups = unstrained_groups(network)
    free = None
    if all(point.damping == 0 for point in network.points):
        links = tuple(replace(link, stiffness=link.stiffness + link.damping) for link in network.links)
        free = rigid(replace(network, links=links))
    found = []
    if free is not None:
        mode = rigid_mode(stiffness, free)
        found.append(replace(mode, frequency=acb(0), points=[acb(q) for q in mode.points]))
    for group in groups[len(found) :]:
        points = [acb(arb(group.get(number, fmpq(0)))) for number in range(len(network.points))]
        found.append(Mode(stiffness, acb(0), points, stays=True))
    return found
