"""The checks of chains in which fronts are followed one by one, and of what happens at contacts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from math import inf

import numpy as np

from wavesym.exact.events import events
from wavesym.model.event import ContactEvent
from wavesym.numbers.doubles import nearest
from wavesym.verification.graph import Struck, alike, graph
from wavesym.verification.graph_fronts import SAME, Fronts, Undecided, integrate_fronts
from wavesym.verification.graph_grid import graph_grid
from wavesym.verification.outcome import MOST_MOVED, NO_GRID, Outcome
from wavesym.verification.reference import Known
from wavesym.verification.refinement import Solutions, shown

# with so many points a panel at first, and at most; so many panels, at most
_FEWEST, _MOST = 8, 16
_PANELS = 1500

# a solution is not looked at where fronts are as close as this, nor told apart in time
_CLOSE = 1e-7


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
    for output in known.outputs:
        clear = np.all([each.apart(output.probe, known.taus) > _CLOSE for each in solved], axis=0)
        seen = taus[clear].tolist()
        coarse, half, quarter = (each.at(output.probe, seen) for each in solved)
        rounding = SAME * max(1.0, float(np.max(np.abs(quarter), initial=0.0)))
        refined = Solutions((coarse, half, quarter), output.values[clear], rounding, output.scale).plain()
        outcomes.append(Outcome(output.probe.name, refined.cells(solved[0].points), refined.right))
    return outcomes


def happening(known: Known) -> list[Outcome]:
    """When contacts open and close, against collocation between fronts and central differences."""
    model = known.model
    made = graph(model)
    if not made.contacts:
        return []
    solved, stepped = _solved(known), graph_grid(model).struck(known.until, MOST_MOVED)
    methods = {
        "fronts": None if isinstance(solved, str) else _between(solved),
        "grid": stepped[1] if stepped else None,
    }
    notes = [f"{model.name}: no integration between fronts, as {solved}"] if isinstance(solved, str) else []
    notes += [] if stepped else [f"{model.name}: {NO_GRID}"]
    outcomes = [Outcome("contacts", {}, True, note) for note in notes]
    claimed = events(model)
    reached = model.reached(model.until)
    for number, link in enumerate(link for link in model.network.links if link.contact):
        joint = model.network.joint_of[link.left]
        if joint in reached:
            found = {name: each and [e for e in each if e[0].contact == number] for name, each in methods.items()}
            outcomes += _compared([e for e in claimed if e.x == link.place], found, link.place, nearest(reached[joint]))
    return outcomes


def _compared(
    claimed: Sequence[ContactEvent], methods: Mapping[str, Struck | None], place: str, last: float
) -> Iterator[Outcome]:
    """A row for each event of a contact; also for those that are not claimed, but would be seen until `last`."""
    seen = [[each for each in found if each[0].tau + each[1] < last] for found in methods.values() if found]
    for k in range(max([len(claimed), *map(len, seen)])):
        event = claimed[k] if k < len(claimed) else None
        cells, passed = {"tau": f"{event.double:.12g}" if event else "-"}, event is not None
        for name, found in methods.items():
            if found is None or k >= len(found):
                cells[name] = "refused" if found is None else "none"
                passed &= found is None
                continue
            change, slack = found[k]
            error = abs(change.tau - event.double) if event else inf
            cells |= {name: shown(error) if event else f"{change.tau:.6g}", f"{name} allowed": shown(slack)}
            passed &= event is not None and change.kind == event.kind and error <= slack
        yield Outcome(f"{place} {event.kind if event else 'too much'}", cells, passed)


@lru_cache(maxsize=1)
def _solved(known: Known) -> list[Fronts] | str:
    """Three solutions in which the same happens at contacts, or why there are none."""
    made = graph(known.model)
    why = ""
    points = _FEWEST
    while points <= _MOST:
        try:
            found = [integrate_fronts(made, known.until, k * points, _PANELS) for k in (1, 2, 4)]
        except Undecided as undecided:
            why = str(undecided)
        else:
            if None not in (alike(found[2].changes, found[1].changes), alike(found[1].changes, found[0].changes)):
                return found
            why = "more points a panel have other things happen at contacts"
        points *= 2
    return why


def _between(solved: Sequence[Fronts]) -> Struck:
    found = alike(solved[2].changes, solved[1].changes)
    assert found is not None
    return [(change, slack + _CLOSE) for change, slack in found]
