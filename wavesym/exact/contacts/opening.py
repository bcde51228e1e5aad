"""When contacts that are taken to stay closed would open: what is computed beside them later than that is formal."""

from __future__ import annotations

from dataclasses import dataclass

from flint import arb

from wavesym.mechanics.event import KnownInstant
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import parted
from wavesym.numbers.doubles import rational
from wavesym.numbers.reals import DOUBLE, Real


@dataclass(frozen=True)
class ContactEnd(KnownInstant):
    """The contact at `x` opens at `tau`, a ball; what is computed at its neighbours later than that is formal."""

    x: int
    tau: arb


def contact_ends(model: Model, real: Real = DOUBLE) -> tuple[ContactEnd, ...]:
    """The contacts whose opening can reach an output within the horizon in `real` numbers, from left to right.

    All others are closed meanwhile. CostError where that takes more than some seconds to know, GrazingError where a
    contact touches and no number of bits tells what follows.
    """
    network, until = model.network, rational(model.horizon(real))
    glued = [number for number, point in enumerate(network.points) if point.glued]
    if not glued:
        return ()
    from wavesym.exact.contacts.schedule import first_opening  # how contacts touch: few scenes have any

    reached, ends = model.reached(until), []
    for number in glued:
        if (latest := reached.get(network.joint_of[number])) is None:
            continue
        apart = parted(network, (number,))
        (link,) = apart.links
        # what can reach the contact until its opening has the time to reach the nearest output
        distances = apart.distances((), (link.left, link.right))
        last = tuple((joint, latest - far) for joint, far in sorted(distances.items()) if far <= latest)
        found = first_opening(apart, model.acting(latest), last)
        if found and found.low <= latest:
            ends.append(ContactEnd(int(network.points[number].place), found.instant))
    return tuple(ends)
