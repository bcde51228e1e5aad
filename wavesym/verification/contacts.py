"""The checks of chains in which fronts are followed one by one, and of what happens at contacts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from itertools import pairwise

import numpy as np

from wavesym.exact.contacts.events import events
from wavesym.mechanics.event import ContactEvent
from wavesym.verification.graph import Struck, alike, graph
from wavesym.verification.graph_fronts import SAME, Fronts, Undecided, integrate_fronts
from wavesym.verification.graph_grid import LATE, graph_grid
from wavesym.verification.observed import observed, parted
from wavesym.verification.outcome import MOST_MOVED, NO_GRID, Outcome
from wavesym.verification.reference import Known
from wavesym.verification.refinement import Solutions, shown

# with so many points a panel, or so many; so many panels, at most
_POINTS = (8, 12)
_PANELS = 400

# a solution is not looked at where fronts are as close as this, nor told apart in time
_CLOSE = 1e-7

# panels may be as short as what is not told apart: so instants are, and values
_ROUNDED = 10 * SAME


def fronts(known: Known) -> list[Outcome]:
    """Collocation between fronts with N, 2N and 4N points a panel; N is doubled until the same happens at contacts."""
    model = known.model
    if model.chain is not None:
        return []
    solved = _solved(known)
    if isinstance(solved, str):
        note = f"{model.name}: no integration between fronts, as {solved}"
        return [Outcome(output.probe.name, {"N": "refused"}, True, note) for output in known.outputs]
    outcomes = []
    taus = np.array(known.taus)
    for output, view in zip(known.outputs, observed(model), strict=True):
        far = [each.apart(probe, known.taus) for each in solved for _, probe in view.shares]
        clear = np.all(np.array(far) > _CLOSE, axis=0)
        seen = taus[clear].tolist()
        coarse, half, quarter = (view.values(partial(each.at, taus=seen), seen) for each in solved)
        rounding = _ROUNDED * max(view.roundoff(lambda _: 1.0), float(np.max(np.abs(quarter), initial=0.0)))
        refined = Solutions((coarse, half, quarter), output.values[clear], rounding, output.scale).plain()
        outcomes.append(Outcome(output.probe.name, refined.cells(solved[0].points), refined.right))
    return outcomes


def happening(known: Known) -> list[Outcome]:
    """When contacts open and close, against collocation between fronts and central differences."""
    model = known.model
    made = graph(model)
    if not made.contacts:
        return []
    solved, stepped = _solved(known), graph_grid(parted(model)).struck(known.until, MOST_MOVED)
    methods = {
        "fronts": None if isinstance(solved, str) else _Method(_between(solved), 0.0),
        "grid": _Method(stepped[1], LATE * float(stepped[0].step)) if stepped else None,
    }
    notes = [f"{model.name}: no integration between fronts, as {solved}"] if isinstance(solved, str) else []
    notes += [] if stepped else [f"{model.name}: {NO_GRID}"]
    outcomes = [Outcome("contacts", {}, True, note) for note in notes]
    claimed = events(model)
    seen = model.contacts(model.until)
    for number, link in enumerate(model.network.contacts):
        if link in seen:
            place = model.network.links[link].place
            ours = [event for event in claimed if event.x == place]
            outcomes += _compared(
                place, ours, {name: each and each.at(number) for name, each in methods.items()}, known.until
            )
    return outcomes


@dataclass(frozen=True)
class _Method:
    """What a method found, and what it does not see as it does not last as long."""

    struck: Struck
    shortest: float

    def at(self, contact: int) -> _Method:
        """At one contact."""
        return _Method([each for each in self.struck if each[0].contact == contact], self.shortest)

    def visible(self, claimed: Sequence[ContactEvent]) -> list[int]:
        """The numbers of the events of a contact that it can have seen: without those that hardly last, if it must."""
        kept = list(range(len(claimed)))
        while len(kept) > max(len(self.struck), 1):
            lasting = [claimed[then].double - claimed[now].double for now, then in pairwise(kept)]
            if min(lasting) >= self.shortest:
                break
            at = lasting.index(min(lasting))
            del kept[at : at + 2]
        return kept


def _compared(
    place: str, claimed: Sequence[ContactEvent], methods: Mapping[str, _Method | None], until: float
) -> Iterator[Outcome]:
    """A row for each event of a contact, and for each that a method has besides.

    A contact that carries no force may part by nothing on a grid: collocation decides, where there is one.
    """
    rows: list[dict[str, str]] = [{"tau": f"{event.double:.12g}"} for event in claimed]
    passed = [True for _ in claimed]
    more = []
    for name, method in methods.items():
        if method is None:
            rows = [row | {name: "refused"} for row in rows]
            continue
        visible = method.visible(claimed)
        for k, event in enumerate(claimed):
            if k not in visible:
                rows[k] |= {name: "too short"}
            elif (at := visible.index(k)) < len(method.struck):
                change, slack = method.struck[at]
                error = abs(change.tau - event.double)
                rows[k] |= {name: shown(error), f"{name} allowed": shown(slack)}
                passed[k] &= change.kind == event.kind and error <= slack
            else:
                rows[k] |= {name: "none"}
                passed[k] &= event.double > until - _CLOSE
        for change, slack in method.struck[len(visible) :]:
            if change.tau + slack < until:
                cells = {"tau": "-", name: f"{change.tau:.6g}", f"{name} allowed": shown(slack)}
                parts_by_nothing = name == "grid" and methods["fronts"] is not None
                more.append(Outcome(f"{place} {change.kind}", cells, parts_by_nothing))
    for event, row, right in zip(claimed, rows, passed, strict=True):
        yield Outcome(f"{place} {event.kind}", row, right)
    yield from more


@lru_cache(maxsize=1)
def _solved(known: Known) -> list[Fronts] | str:
    """Three solutions in which the same happens at contacts, or why there are none."""
    made = graph(known.model)
    why = ""
    for points in _POINTS:
        try:
            found = [integrate_fronts(made, known.until, k * points, _PANELS) for k in (1, 2, 4)]
        except Undecided as undecided:
            why = str(undecided)
        else:
            if None not in (alike(found[2].changes, found[1].changes), alike(found[1].changes, found[0].changes)):
                return found
            why = "more points a panel have other things happen at contacts"
    return why


def _between(solved: Sequence[Fronts]) -> Struck:
    found = alike(solved[2].changes, solved[1].changes)
    assert found is not None
    return [(change, slack + _CLOSE) for change, slack in found]
