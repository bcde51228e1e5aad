"""A line of parts as one reads it: nodes, and what is between them."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from wavesym.fields.table import refusal, show
from wavesym.systems.parts import BETWEEN, ChainPart, ContactPart, LinkPart, MotionPart

Keys = tuple[str | int, ...]
PlacedNode = tuple[int, ChainPart | str]
"""A node of a line, and which of the parts it is."""
PlacedBetween = tuple[int, BETWEEN]
"""What is between two nodes, and which of the parts it is."""

EMPTY = "no rod, spring or dashpot; write at least one"
_TOUCHING = ContactPart(contact=Fraction(0))


def alternating(
    parts: Sequence[ChainPart | str], at: Keys, *, branch: bool
) -> tuple[list[PlacedNode | None], list[PlacedBetween]]:
    """Nodes, one more than there is between them; None for one that is not written: a joint, or a free end.

    A `branch` begins at a node that is there already. Raises the error of `table.refusal`.
    """
    nodes: list[PlacedNode | None] = [None]
    between: list[PlacedBetween] = []
    for k, each in enumerate(parts):
        part = _TOUCHING if each == "contact" else each
        if isinstance(part, BETWEEN):
            if between and nodes[-1] is None:
                _refuse_loose(between[-1][1], part, (*at, k))
            between.append((k, part))
            nodes.append(None)
            continue
        if nodes[-1] is not None:
            free = "free" in (part, nodes[-1][1])
            instead = ', or leave "free" out, as a chain may end with a node' if free else ""
            raise refusal(f"a node beside another; write a rod, a spring or a dashpot between them{instead}", *at, k)
        if 0 < k < len(parts) - 1 and (part in ("free", "fixed", "absorbing") or isinstance(part, MotionPart)):
            raise refusal("an end between other parts; write a mass or a joint", *at, k)
        nodes[-1] = k, part
    if not between and nodes[0] is None:
        raise refusal(EMPTY, *at)
    _refuse_ends(nodes, between, at, branch)
    return nodes, between


def _refuse_loose(one: BETWEEN, other: BETWEEN, at: Keys) -> None:
    """Between two contacts nothing makes a joint of what is not written."""
    if isinstance(one, ContactPart) and isinstance(other, ContactPart):
        raise refusal("a contact beside a contact; write a rod or a mass between them", *at)


def _refuse_ends(nodes: Sequence[PlacedNode | None], between: Sequence[PlacedBetween], at: Keys, branch: bool) -> None:
    """At an end something stands that can be held or touched."""
    if not between:
        return
    ends = [(nodes[-1], between[-1])] if branch else [(nodes[0], between[0]), (nodes[-1], between[-1])]
    for node, (k, part) in ends:
        if node is None and isinstance(part, LinkPart):
            raise refusal("a spring or dashpot at an end; write something for it to hold", *at)
        if isinstance(part, ContactPart):
            if node is None:
                raise refusal("a contact at an end; write something for it to touch", *at, k)
            if node[1] in ("free", "absorbing"):
                what = f'{show(node[1])} beside a contact; write a rod, a mass, "fixed" or a motion'
                raise refusal(what, *at, node[0])
