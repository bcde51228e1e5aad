"""How often waves meet a body before they run in a rod: ways counted, without any law of motion."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

from wavesym.derivation.walks import units
from wavesym.papers.exact_tables import Exact

NEVER = -(10**6)
"""The count of a wave that does not come."""


def most_meetings(exact: Exact, source: str, body: int, *, reflected_only: bool) -> Callable[[str, int, int], int]:
    """The most times that a wave of a source has met the body at a node, by function, rod and interval.

    With `reflected_only` only where it was thrown back; otherwise where it passed or started, too.
    """
    nodes = exact.chain.nodes
    starts = [unit for unit in units(exact.chain) if source in (unit.name, "impact")]

    @cache
    def sent(x: int, right: bool, tau: int) -> int:
        """The most of those that leave a node to one side at tau."""
        node = nodes[x]
        if tau < 0 or (node.right if right else node.left) is None:
            return NEVER
        here = int(x == body)
        found = [
            here * (not reflected_only)
            for unit in starts
            if unit.x == x and tau == 0 and (unit.right if right else unit.left)
        ]
        for from_left in (True, False):
            if (node.left if from_left else node.right) is None:
                continue
            thrown_back = from_left != right
            if not node.inertia and thrown_back == bool(node.left and node.right):
                continue  # without a body a wave passes between rods, and is thrown back from an end
            before = sent(x - 1, True, tau - 1) if from_left else sent(x + 1, False, tau - 1)
            found.append(before + here * (thrown_back or not reflected_only))
        return max(found, default=NEVER)

    def count(letter: str, rod: int, interval: int) -> int:
        tau = exact.chain.leaves(letter, rod, exact.interval * (interval - 1))
        return sent(rod - 1, True, tau) if letter == "f" else sent(rod, False, tau)

    return count
