"""The checks of chains in which fronts are followed one by one, and of what happens at contacts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from itertools import pairwise

import numpy as np

from wavesym.exact.contacts.events import events
from wavesym.mechanics.event import ContactEvent
from wavesym.numbers.doubles import rational
from wavesym.verification.graph import Array, Struck, alike, graph
from wavesym.verification.graph_fronts import SAME, Fronts, Undecided, integrate_fronts
from wavesym.verification.observed import observed, parted
from wavesym.verification.outcome import MOST_MOVED, NO_GRID, IntegratedOutput, Outcome
from wavesym.verification.reference import Known
from wavesym.verification.refinement import Solutions, shown
from wavesym.verification.spacetime import LATE, grid

# with so many points a panel, or so many; so many panels, at most
_POINTS = (8, 12)
_PANELS = 400

# a solution is not looked at where fronts are as close as this, nor told apart in time
_CLOSE = 1e-7

# where fronts are it is read so far aside, twice and three times as far
_ASIDE = 2 * _CLOSE

# panels may be as short as what is not told apart: so instants are, and values
_ROUNDED = 10 * SAME


def fronts(known: Known) -> list[Outcome]:
    """Collocation between fronts with N, 2N and 4N points a panel; N is doubled until the same happens at contacts."""
    model = known.integrated
    solved = _solved(known)
    if isinstance(solved, str):
        note = f"{model.name}: no integration between fronts, as {solved}"
        return [Outcome(output.probe.name, {"N": "refused"}, True, note) for output in known.outputs]
    outcomes = []
    taus, aside = np.array(known.taus), _aside(known)
    beside = [taus + k * aside for k in (1, 2, 3)]
    for output, view in zip(known.outputs, observed(model), strict=True):
        apart = [each.apart(probe, seen.tolist()) for seen in beside for each in solved for _, probe in view.shares]
        clear = np.all(np.array(apart) > _CLOSE, axis=0)
        instants = [seen[clear].tolist() for seen in beside]
        read = [[view.values(partial(each.at, taus=seen), seen) for seen in instants] for each in solved]
        # a straight line leads back to the front, and what is bent in it is allowed
        coarse, half, quarter = (2 * near - far for near, far, _ in read)
        near, far, farther = read[-1]
        rounding = _ROUNDED * max(view.roundoff(lambda _: 1.0), float(np.max(np.abs(quarter), initial=0.0)))
        rounding += 2 * float(np.max(np.abs(near - 2 * far + farther), initial=0.0))
        refined = Solutions((coarse, half, quarter), output.values[clear], rounding, output.scale).plain()
        integral = IntegratedOutput(taus[clear].tolist(), refined.values, refined.allowed * output.scale)
        outcomes.append(Outcome(output.probe.name, refined.cells(solved[0].points), refined.right, integral=integral))
    return outcomes


def _aside(known: Known) -> Array:
    """Which way, and how far, solutions are read beside the taus that are at fronts: they know these to rounding only.

    At a front and just after it counts what is to the right, just before it what is to the left.
    """
    starts = np.array([-np.inf, *sorted(known.starts), np.inf])
    after = known.starts | {float(np.nextafter(start, np.inf)) for start in known.starts}
    before = {float(np.nextafter(start, -np.inf)) for start in known.starts}
    aside = np.zeros(len(known.taus))
    for k, tau in enumerate(known.taus):
        place = int(np.searchsorted(starts, tau, side="right"))
        if starts[place] - starts[place - 1] > 5 * _ASIDE:
            aside[k] = _ASIDE if tau in after else -_ASIDE if tau in before else 0.0
    return aside


def happening(known: Known) -> list[Outcome]:
    """When contacts open and close, against collocation between fronts and central differences."""
    model, judged = known.model, known.integrated
    if not graph(judged).contacts:
        return []
    solved, stepped = _solved(known), grid(parted(judged)).struck(known.until, MOST_MOVED)
    methods = {
        "fronts": None if isinstance(solved, str) else _Method(_between(solved), 0.0),
        "grid": _Method(stepped[1], LATE * float(stepped[0].step)) if stepped else None,
    }
    notes = [f"{model.name}: no integration between fronts, as {solved}"] if isinstance(solved, str) else []
    notes += [] if stepped else [f"{model.name}: {NO_GRID}"]
    outcomes = [Outcome("contacts", {}, True, note) for note in notes]
    claimed = events(model)
    seen = model.contacts(rational(model.horizon()))
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
    made = graph(known.integrated)
    why = ""
    for points in _POINTS:
        try:
            found = [integrate_fronts(made, known.until + 4 * _ASIDE, k * points, _PANELS) for k in (1, 2, 4)]
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
