"""What the contacts of a chain do: when they open and close."""

from __future__ import annotations

from typing import TYPE_CHECKING

from flint import arb, fmpq

from wavesym.mechanics.event import ContactEvent
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import rational
from wavesym.numbers.reals import DOUBLE, Real

if TYPE_CHECKING:
    from wavesym.exact.contacts.schedule import Schedule


def scheduled(model: Model, until: fmpq) -> Schedule | None:
    """When what is closed, until then; None for a chain without contacts. CostError, GrazingError as in `schedule`."""
    if not model.network.contacts:
        return None
    from wavesym.exact.contacts.schedule import schedule  # how contacts touch: few scenes have any

    return schedule(model.network, model.acting(until), tuple(model.reached(until).items()))


def events(model: Model, real: Real = DOUBLE) -> tuple[ContactEvent, ...]:
    """All openings and closings of contacts that can reach an output, up to the horizon in `real` numbers, in order.

    A contact that is closed from the start is no event. CostError where there are too many, GrazingError where a
    contact touches and no number of bits tells what follows.
    """
    until = rational(model.horizon(real))
    known = scheduled(model, until)
    if known is None:
        return ()
    seen = model.contacts(until)
    return tuple(
        ContactEvent(model.network.links[each.link].place, "closes" if each.closes else "opens", each.instant)
        for each in known.found
        if each.link in seen and each.low <= until
    )


def what_helps(model: Model, real: Real = DOUBLE) -> str:
    """What would help where no number of bits does: an event that may be one of the `real` numbers is named."""
    for event in events(model, real):
        number = real.nearest(rational(event.double))
        if not event.tau.is_exact() and event.tau.contains(arb(number)):
            return (
                f"another gap, load or length at the contact at {event.x}, which {event.kind} where no bits tell it "
                f"from tau = {number:.17g},"
            )
    return "a shorter horizon"
