"""What the package says of a chain, held against `PiecewiseChain`: events to 18 digits, values to a bit."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from itertools import product

from flint import arb, ctx

from tests.support.piecewise import PiecewiseChain
from wavesym.exact.contacts.events import events
from wavesym.exact.reference import Reference
from wavesym.mechanics.model import Model

BITS = 300
CLOSE = arb("1e-18")
"""How near events are to the truth; what happens this near to the horizon may count or not."""


def wrong_events(
    model: Model, made: PiecewiseChain, name: Callable[[str], str] = str, first: str = "-1"
) -> Iterator[str]:
    """Where links with corners do something else than they should; those at places of one `name` are taken together.

    What happens up to the `first` tau does not count, nor in which order contacts, springs and friction of one place
    do it at one instant.
    """
    found = events(model)
    with ctx.workprec(BITS):
        last = arb(model.until) - CLOSE
        ours = [(name(e.x), e.subject.split()[0], e.kind, e.tau) for e in found if arb(first) < e.tau < last]
        true = [(name(e.place), e.subject, e.kind, arb(e.tau)) for e in made.events if arb(first) < arb(e.tau) < last]
        places = {name(model.network.links[number].place) for number in model.contacts(model.until)}
        for place, subject in product(places, ("contact", "spring", "friction")):
            here, there = ([each[2:] for each in told if each[:2] == (place, subject)] for told in (ours, true))
            kinds = [kind for kind, _ in here] == [kind for kind, _ in there]
            if not kinds or any(abs(one - other) > CLOSE for (_, one), (_, other) in zip(here, there, strict=True)):
                yield f"{subject} at {place}: {here}, not {there}"


def wrong_values(model: Model, made: PiecewiseChain, taus: Sequence[float]) -> Iterator[str]:
    """Where outputs are not the true ones, rounded once."""
    for probe, values in zip(model.probes, Reference(model).values(taus), strict=True):
        for tau, value in zip(taus, values, strict=True):
            with ctx.workprec(BITS):
                exact = made.value(*probe.name.split("@"), Fraction(tau))
                if not abs(exact - arb(value)) <= abs(arb(value)) * arb(2) ** -53 + arb("1e-24"):
                    yield f"{probe.name} at {tau}: {value}, not {exact}"
