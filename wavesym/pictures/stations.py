"""What stands at the stations of a line, however it is drawn, and when contacts there are open."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from wavesym.mechanics.event import ContactEvent
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Link, Network, Point
from wavesym.numbers.doubles import nearest
from wavesym.systems.station import Station

Opened = Mapping[str, Sequence[tuple[float, float]]]
"""When the contacts are open, by their places."""


def open_times(model: Model, events: Iterable[ContactEvent]) -> Opened:
    """From when to when each contact is open."""
    contacts = [link for link in model.network.links if link.contact]
    found: dict[str, list[tuple[float, float]]] = {link.place: [] for link in contacts}
    since = {link.place: 0.0 for link in contacts if link.gap}
    for event in events:
        if event.kind == "opens":
            since[event.x] = event.double
        elif event.kind == "closes":
            found[event.x].append((since.pop(event.x), event.double))
    for place, begun in since.items():
        found[place].append((begun, nearest(model.until)))
    return found


def standing(network: Network, station: Station) -> Iterator[Point | Link]:
    """The points and links of a station from left to right; a bare joint only where it stands alone."""
    for before, number in zip((None, *station.points), station.points, strict=False):
        yield from (link for link in network.links if (link.left, link.right) == (before, number))
        point = network.points[number]
        if point.mass or point.motion or len(station.points) == 1:
            yield point
