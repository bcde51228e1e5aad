"""Contacts of a chain that is drawn: what may touch what, and what each of them is called."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

from wavesym.fields.table import refusal
from wavesym.mechanics.network import Link, Network, Point
from wavesym.systems.lines import Keys


def refuse_impacts(points: Sequence[Point], contacts: Iterable[tuple[Link, Keys]]) -> None:
    """Two rigid parts, each with where it is in a scene, must not strike each other. Raises that of `table.refusal`.

    Nor through what has no mass and touches both: all that contacts connect may have one rigid part.
    """
    rigid = [point.mass != 0 or point.motion is not None for point in points]
    every = list(contacts)
    for number in _joining_two([link for link, _ in every], rigid):
        raise refusal(
            'a contact between two rigid parts ("fixed" and a motion are rigid too), which would need a law '
            "of impact; write a rod on one side of it",
            *every[number][1],
        )


def _joining_two(links: Sequence[Link], distinct: Sequence[bool]) -> Iterator[int]:
    """The links that join two `distinct` points, one after another, or what is joined already."""
    leader = {point: point for link in links for point in (link.left, link.right)}
    found = {point: distinct[point] for point in leader}

    def leader_of(point: int) -> int:
        while leader[point] != point:
            point = leader[point]
        return point

    for number, link in enumerate(links):
        one, other = leader_of(link.left), leader_of(link.right)
        if one == other or (found[one] and found[other]):
            yield number
        leader[other] = one
        found[one] = found[one] or found[other]


def refuse_joined_corners(points: Sequence[Point], links: Sequence[Link], written: Mapping[int, Keys]) -> None:
    """What rubs or touches must not be held twice, so that it is known what each takes; nor break away beside others.

    Raises that of `table.refusal`.
    """
    if not any(link.friction != 0 for link in links):
        return
    rigid = [point.mass != 0 or point.motion is not None for point in points]
    network = Network(tuple(points), (), tuple(links))
    prescribed = [point.motion is not None for point in points]
    corners_of: dict[int, list[Link]] = {}
    for link in links:
        if link.has_corner:
            corners_of.setdefault(network.joint_of[link.left], []).append(link)
    for corners in corners_of.values():
        rubbing = [link for link in corners if link.friction != 0]
        light = [link for link in rubbing if not (rigid[link.left] and rigid[link.right])]
        holding = [link for link in corners if rubbing and (link.friction != 0 or link.contact)]
        for link in rubbing:
            if link.breakaway != 0 and (light or len(corners) > 1 or not _has_motion(points, link)):
                raise refusal(
                    "of what is no mass alone on the ground or on a motion: without mass, or beside another law with a "
                    "corner, more than one thing could happen as it breaks away; write a mass, with rods to other laws",
                    *written[link.right],
                    "breakaway",
                )
        for number in _joining_two(holding, prescribed):
            raise refusal(
                "of parts that other friction, or what moves as is given, may hold as well, so that nothing says what "
                "each takes; write a rod between them",
                *written[holding[number].right],
                "friction",
            )
        for link in rubbing:
            ends = link.left, link.right
            if any(points[end].mass != 0 and _damps_massless(points, links, end) for end in ends):
                raise refusal(
                    "of a mass that a dashpot ties to a joint without mass, not proved; write a mass there too",
                    *written[link.right],
                    "friction",
                )


def _has_motion(points: Sequence[Point], link: Link) -> bool:
    """Whether one side of a link moves as is given."""
    return any(points[end].motion is not None for end in (link.left, link.right))


def _damps_massless(points: Sequence[Point], links: Iterable[Link], number: int) -> bool:
    """Whether a dashpot alone says how fast something without mass beside a point is."""
    beside = {link.left + link.right - number for link in links if link.damping and number in (link.left, link.right)}
    return any(points[other].mass == 0 and points[other].motion is None for other in beside)


def name_contacts(links: Sequence[Link]) -> list[Link]:
    """The same; contacts at one place are called by its sides."""
    count = Counter(link.place for link in links if link.contact)
    met: Counter[str] = Counter()
    return [_with_side(link, count, met) for link in links]


def _with_side(link: Link, count: Mapping[str, int], met: Counter[str]) -> Link:
    if not link.contact or count[link.place] == 1:
        return link
    met[link.place] += 1
    side = {1: "-", count[link.place]: "+"}.get(met[link.place], "")
    return replace(link, place=link.place + side)
