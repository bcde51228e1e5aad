"""What stands at the stations of a line, however it is drawn, and when links there are loose."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from wavesym.exact.contacts.events import events
from wavesym.mechanics.event import ContactEvent
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Link, Network, Point
from wavesym.numbers.doubles import nearest
from wavesym.systems.station import Station

Loose = Mapping[Link, Sequence[tuple[float, float]]]
"""When links with corners are open, idle, slide or yield."""

_NAMED = 3  # places
_LOOSENS = ("opens", "releases", "slips", "yields")


def loose_times(model: Model, happened: Iterable[ContactEvent]) -> Loose:
    """From when to when links with corners are loose: contacts open, springs idle or yield, friction slides."""
    network = model.network
    found: dict[Link, list[tuple[float, float]]] = {network.links[number]: [] for number in network.corners}
    since = {link: 0.0 for link in found if _is_loose(network, link)}
    for event in happened:
        link = network.links[event.link]
        if event.kind in _LOOSENS:
            since.setdefault(link, event.double)
        elif link in since:
            found[link].append((since.pop(link), event.double))
    for link, start in since.items():
        found[link].append((start, nearest(model.until)))
    return found


def slip_times(model: Model) -> Loose:
    """From when to when friction slides and springs yield. Errors are those of `events`."""
    loose = loose_times(model, events(model)) if model.network.corners else {}
    return {link: times for link, times in loose.items() if times and (link.friction != 0 or link.limits is not None)}


def slip_words(links: Iterable[Link]) -> str:
    """What slides or yields, and where: "friction at 0 m slides, the spring at 6 m or 12 m yields"."""
    found: dict[str, list[str]] = {"friction at {} slides": [], "the spring at {} yields": []}
    for link in links:
        found["friction at {} slides" if link.friction != 0 else "the spring at {} yields"].append(link.place)
    places = {words: list(dict.fromkeys(at)) for words, at in found.items() if at}
    return ", ".join(
        words.format(" or ".join([*at[:_NAMED], *["elsewhere"] * (len(at) > _NAMED)])) for words, at in places.items()
    )


def _is_loose(network: Network, link: Link) -> bool:
    """At tau = 0."""
    if link.friction != 0:
        return network.points[link.right].velocity != link.ratio * network.points[link.left].velocity
    return link.gap > 0 and link.limits is None


def standing(network: Network, station: Station) -> Iterator[Point | Link]:
    """The points and links of a station from left to right; a bare joint only where it stands alone."""
    for before, number in zip((None, *station.points), station.points, strict=False):
        yield from (link for link in network.links if (link.left, link.right) == (before, number))
        point = network.points[number]
        if point.mass or point.motion or len(station.points) == 1:
            yield point


def ground_links(network: Network, point: int) -> tuple[Link, ...]:
    """Friction, and the springs with a corner that hold a point to the ground, which is a point that nothing shows."""
    held = (link for link in network.links if link.has_corner and link.right == point and link.left > point)
    return tuple(link for link in held if network.points[link.left].motion == "fixed")
