"""Contacts of a chain that is drawn: what may touch what, and what each of them is called."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from wavesym.fields.table import wrong
from wavesym.mechanics.network import Link, Point
from wavesym.systems.lines import Keys


def refuse_impacts(points: Sequence[Point], contacts: Iterable[tuple[Link, Keys]]) -> None:
    """Two rigid parts, each with where it is in a scene, must not strike each other. Raises that of `table.wrong`.

    Nor through what has no mass and touches both: all that contacts connect may have one rigid part.
    """
    leader = list(range(len(points)))
    rigid = [point.mass != 0 or point.motion is not None for point in points]

    def of(point: int) -> int:
        while leader[point] != point:
            point = leader[point]
        return point

    for link, at in contacts:
        one, other = of(link.left), of(link.right)
        if rigid[one] and rigid[other]:
            raise wrong(
                'a contact between two rigid parts ("fixed" and a motion are rigid too), which would need a law '
                "of impact; write a rod on one side of it",
                *at,
            )
        leader[other] = one
        rigid[one] = rigid[one] or rigid[other]


def told_apart(links: Sequence[Link]) -> list[Link]:
    """The same; contacts at one place are called by its sides."""
    count = Counter(link.place for link in links if link.contact)
    met: Counter[str] = Counter()
    return [_sided(link, count, met) for link in links]


def _sided(link: Link, count: Mapping[str, int], met: Counter[str]) -> Link:
    if not link.contact or count[link.place] == 1:
        return link
    met[link.place] += 1
    side = {1: "-", count[link.place]: "+"}.get(met[link.place], "")
    return replace(link, place=link.place + side)
