"""What the contacts of a chain do: when they open and close, and when those taken for closed would open."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from flint import arb, fmpq

from wavesym.mechanics.event import ContactEvent, Happening, KnownInstant
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Link, with_contacts
from wavesym.numbers.doubles import rational
from wavesym.numbers.reals import DOUBLE, Real

if TYPE_CHECKING:
    from wavesym.exact.contacts.branches import Change
    from wavesym.exact.contacts.schedule import Schedule


@dataclass(frozen=True)
class ContactEnd(KnownInstant):
    """The contact at `x` opens at `tau`, a ball; what is computed at its neighbours later than that is formal."""

    x: int
    tau: arb


def contact_schedule(model: Model, until: fmpq) -> Schedule | None:
    """When what is closed, until then; None for a chain without contacts. CostError, GrazingError as in `schedule`."""
    if not model.network.corners:
        return None
    from wavesym.exact.contacts.schedule import schedule  # how contacts touch: few scenes have any

    return schedule(model.network, model.loads_until(until), tuple(model.joints_in_reach(until).items()))


def events(model: Model, real: Real = DOUBLE) -> tuple[ContactEvent, ...]:
    """All openings and closings of contacts that can reach an output, up to the horizon in `real` numbers, in order.

    A contact that is closed from the start is no event. CostError where there are too many, GrazingError where a
    contact touches and no number of bits tells what follows.
    """
    until = rational(model.horizon(real))
    known = contact_schedule(model, until)
    if known is None:
        return ()
    seen = model.contacts(until)
    return tuple(
        ContactEvent(link.place, _kind(link, each), each.instant, each.link)
        for each in known.changes
        if each.link in seen and each.low <= until
        for link in [model.network.links[each.link]]
    )


def _kind(link: Link, change: Change) -> Happening:
    if link.side != 0:
        return "engages" if change.closes else "releases"
    if link.limits is not None:
        return "holds" if change.closes else "yields"
    if link.friction != 0:
        return "sticks" if change.closes else "slips"
    return "closes" if change.closes else "opens"


def what_helps(model: Model, real: Real = DOUBLE) -> str:
    """What would help where no number of bits does: an event that may be one of the `real` numbers is named."""
    for event in events(model, real):
        number = real.nearest(rational(event.double))
        if not event.tau.is_exact() and event.tau.contains(arb(number)):
            return (
                f"another gap, load or length at the {event.subject}, which {event.kind} where no bits tell it "
                f"from tau = {number:.17g},"
            )
    return "a shorter horizon"


def contact_ends(model: Model, real: Real = DOUBLE) -> tuple[ContactEnd, ...]:
    """The contacts whose opening can reach an output within the horizon in `real` numbers, from left to right.

    All others are closed meanwhile. CostError where that takes more than some seconds to know, GrazingError where a
    contact touches and no number of bits tells what follows.
    """
    network, until = model.network, rational(model.horizon(real))
    glued = [number for number, point in enumerate(network.points) if point.is_glued]
    if not glued:
        return ()
    from wavesym.exact.contacts.schedule import first_opening  # how contacts touch: few scenes have any

    reached, ends = model.joints_in_reach(until), []
    for number in glued:
        if (latest := reached.get(network.joint_of[number])) is None:
            continue
        apart = with_contacts(network, (number,))
        (link,) = apart.links
        # what can reach the contact until its opening has the time to reach the nearest output
        distances = apart.distances((), (link.left, link.right))
        last = tuple((joint, latest - far) for joint, far in sorted(distances.items()) if far <= latest)
        found = first_opening(apart, model.loads_until(latest), last)
        if found and found.low <= latest:
            ends.append(ContactEnd(int(network.points[number].place), found.instant))
    return tuple(ends)
