"""A line of parts as one reads it: nodes, and what is between them."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from wavesym.fields.table import shown, wrong
from wavesym.systems.parts import BETWEEN, ChainPart, ContactPart, LinkPart, MotionPart, RodPart

Keys = tuple[str | int, ...]
PlacedNode = tuple[int, ChainPart | str]
"""A node of a line, and which of the parts it is."""
PlacedBetween = tuple[int, BETWEEN]
"""What is between two nodes, and which of the parts it is."""

_TOUCHING = ContactPart(contact=Fraction(0))


def alternating(
    parts: Sequence[ChainPart | str], at: Keys, *, branch: bool
) -> tuple[list[PlacedNode | None], list[PlacedBetween]]:
    """Nodes, one more than there is between them; None for one that is not written: a joint, or a free end.

    A `branch` begins at a node that is there already. Raises the error of `table.wrong`.
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
            raise wrong("a node given beside another, a rod, a spring or a dashpot between them expected", *at, k)
        if 0 < k < len(parts) - 1 and (part in ("free", "fixed", "absorbing") or isinstance(part, MotionPart)):
            raise wrong("an end given between other parts, a mass or a joint expected", *at, k)
        nodes[-1] = k, part
    _refuse_empty(between, at, branch)
    _refuse_ends(nodes, between, at, branch)
    return nodes, between


def _refuse_loose(one: BETWEEN, other: BETWEEN, at: Keys) -> None:
    """Between two contacts nothing makes a joint of what is not written."""
    if isinstance(one, ContactPart) and isinstance(other, ContactPart):
        raise wrong("a contact beside a contact given, a rod or a mass between them expected", *at)


def _refuse_empty(between: Sequence[PlacedBetween], at: Keys, branch: bool) -> None:
    """A chain has a rod; a branch may have a spring alone, with a mass on it."""
    if branch and not between:
        raise wrong("no rod, spring or dashpot given, at least 1 expected", *at)
    if not branch and not any(isinstance(part, RodPart) for _, part in between):
        raise wrong("no rod given, at least 1 expected", *at)


def _refuse_ends(nodes: Sequence[PlacedNode | None], between: Sequence[PlacedBetween], at: Keys, branch: bool) -> None:
    """At an end something stands that can be held or touched."""
    ends = [(nodes[-1], between[-1])] if branch else [(nodes[0], between[0]), (nodes[-1], between[-1])]
    for node, (k, part) in ends:
        if node is None and isinstance(part, LinkPart):
            raise wrong("a spring or dashpot given at an end, something for it to hold expected", *at)
        if isinstance(part, ContactPart):
            if node is None:
                raise wrong("a contact given at an end, something for it to touch expected", *at, k)
            if node[1] in ("free", "absorbing"):
                expected = 'a rod, a mass, "fixed" or a motion expected'
                raise wrong(f"{shown(node[1])} given beside a contact, {expected}", *at, node[0])
