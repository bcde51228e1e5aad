"""What methods found at links with corners, side by side with the events that are claimed: a row for each."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from wavesym.mechanics.event import ContactEvent
from wavesym.verification.outcome import Outcome, format_error
from wavesym.verification.problem import KnownChanges

CLOSE = 1e-7
"""Values are not compared where a front that a contact causes is as close as this; closer instants are the same."""


@dataclass(frozen=True)
class CornerHistory:
    """What a method found at contacts, and what it does not see as it does not last as long."""

    changes: KnownChanges
    shortest: float

    def select(self, corner: int) -> CornerHistory:
        """At one of them."""
        return CornerHistory([each for each in self.changes if each[0].corner == corner], self.shortest)

    def fit(self, claimed: Sequence[ContactEvent], until: float) -> CornerHistory:
        """Without what may come after the end, where that is not claimed."""
        for kept in (self.changes, [each for each in self.changes if each[0].tau + each[1] < until]):
            found = replace(self, changes=kept)
            if found._fits(claimed, found.visible(claimed)):
                return found
        return self

    def visible(self, claimed: Sequence[ContactEvent]) -> list[int]:
        """The numbers of events that it can have seen: without those at the start or that hardly last, if it must."""
        kept = list(range(len(claimed)))
        while len(kept) > len(self.changes) and claimed[kept[0]].double < self.shortest:
            del kept[0]
        for slide in self._short_slides(claimed, kept):
            if len(kept) - len(slide) >= len(self.changes):
                kept = [k for k in kept if k not in slide]
        while len(kept) > max(len(self.changes), 1):
            lasting = [claimed[then].double - claimed[now].double for now, then in pairwise(kept)]
            if min(lasting) >= self.shortest:
                break
            at = lasting.index(min(lasting))
            turned, neither = [*kept[:at], *kept[at + 1 :]], [*kept[:at], *kept[at + 2 :]]
            # what goes back, or comes to rest, after a moment is one event
            kept = turned if self._fits(claimed, turned) and not self._fits(claimed, neither) else neither
        return kept

    def _short_slides(self, claimed: Sequence[ContactEvent], kept: Sequence[int]) -> list[range]:
        """What slips, turns and sticks again before it is seen, the shortest first."""
        ends = [-1, *(k for k in kept if claimed[k].kind == "sticks")]
        slides = [range(before + 1, end + 1) for before, end in pairwise(ends)]
        lasting = {slide: claimed[slide[-1]].double - claimed[slide[0]].double for slide in slides if len(slide) > 2}
        return sorted((slide for slide in lasting if lasting[slide] < self.shortest), key=lasting.__getitem__)

    def _fits(self, claimed: Sequence[ContactEvent], kept: Sequence[int]) -> bool:
        """Whether what it has seen is the first of these."""
        seen = [change.kind for change, _ in self.changes]
        return [claimed[k].kind for k in kept[: len(seen)]] == seen


def compare_events(
    place: str, claimed: Sequence[ContactEvent], methods: Mapping[str, CornerHistory | None], until: float
) -> Iterator[Outcome]:
    """A row for each event of a contact, and for each that a method has besides."""
    rows: list[dict[str, str]] = [{"tau": f"{event.double:.12g}"} for event in claimed]
    passed = [True for _ in claimed]
    more = []
    for name, method in methods.items():
        if method is None:
            rows = [row | {name: "refused"} for row in rows]
            continue
        method = method.fit(claimed, until)
        visible = method.visible(claimed)
        for k, event in enumerate(claimed):
            if k not in visible:
                rows[k] |= {name: "too short"}
            elif (at := visible.index(k)) < len(method.changes):
                change, slack = method.changes[at]
                error = abs(change.tau - event.double)
                rows[k] |= {name: format_error(error), f"{name} allowed": format_error(slack)}
                passed[k] &= change.kind == event.kind and error <= slack
            else:
                rows[k] |= {name: "none"}
                passed[k] &= event.double > until - CLOSE
        for change, slack in method.changes[len(visible) :]:
            if change.tau + slack < until:
                cells = {"tau": "-", name: f"{change.tau:.6g}", f"{name} allowed": format_error(slack)}
                more.append(Outcome(f"{place} {change.kind}", cells, passed=False))
    for event, row, right in zip(claimed, rows, passed, strict=True):
        yield Outcome(f"{place} {event.kind}", row, right)
    yield from more
