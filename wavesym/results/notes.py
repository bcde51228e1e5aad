"""What to know of the values of a scene: what is not as one might expect, what its contacts do; a line for each."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from wavesym.exact.contacts.events import contact_ends
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import rational
from wavesym.results.link_losses import link_summaries

if TYPE_CHECKING:
    from wavesym.results.response import Response


def value_notes(model: Model) -> list[str]:
    """How the scene was read, no load, contacts that open early enough to matter to an output."""
    return [*model.labels.notes, *_load_notes(model), *_formal_notes(model)]


def _load_notes(model: Model) -> list[str]:
    """A line for a scene in which nothing happens, and where no contact is struck for each whose sides fly apart."""
    network = model.network
    if model.loads:
        return []
    if not any(bar.velocity or bar.strain for bar in network.bars) and not any(p.velocity for p in network.points):
        return ["no load, so that all outputs are 0"]
    speeds = {end: bar.velocity for bar in network.bars for end in (bar.left, bar.right)}
    speeds |= {number: point.velocity for number, point in enumerate(network.points) if point.mass}
    contacts = [link for link in network.links if link.contact]
    if any(speeds.get(link.left, 0) > speeds.get(link.right, 0) for link in contacts):
        return []
    return [
        f"contact at x = {link.place}: its two sides move apart from the start; where one strikes the other, write the "
        "velocity of the left one above that of the right one"
        for link in contacts
        if speeds.get(link.left, 0) < speeds.get(link.right, 0)
    ]


def horizon_notes(model: Model, at: Sequence[float]) -> list[str]:
    """A line where some of the instants that are asked for are not on the horizon."""
    from wavesym.results.rows import instants

    last, clock = model.horizon(), model.clock
    count = sum(not 0 <= tau <= last for _, tau in instants(model, 0, at))
    what, end = ("times", clock.format(model.until)) if clock else ("tau", str(model.until))
    return [f"{count} of {len(at)} {what} are outside 0 to {end}, where values are nan"] * bool(count)


def event_notes(response: Response) -> list[str]:
    """A line for each time that a contact opens or closes. CostError where that would take minutes to know."""
    return [
        f"{each.subject} {each.kind} at tau = {each.digits}{_in_time(response.model, each.double)}"
        for each in response.events
    ]


def link_notes(model: Model) -> list[str]:
    """A line for each spring that yields and bore no force where it was loaded; none where it would cost too much.

    A summary has the same as the `note` of each of its `links`.
    """
    limits = (model.network.links[n].limits for n in model.network.corners)
    if not any(both is not None and min(both) == 0 < max(both) for both in limits):
        return []
    return [link.note for link in link_summaries(model) or () if link.note]


def _formal_notes(model: Model) -> list[str]:
    return [
        f"contact at x = {end.x} opens at tau = {end.digits}{_in_time(model, end.double)}: what that can reach is "
        "computed as if it stayed closed"
        for end in contact_ends(model)
    ]


def _in_time(model: Model, tau: float) -> str:
    """The same instant in the unit of a physical scene, to stand behind a tau."""
    return f", {model.clock.format(rational(tau))}" if model.clock else ""
