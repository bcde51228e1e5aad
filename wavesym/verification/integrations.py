"""The checks that integrate: outputs by collocation between fronts, the midpoint rule, differences, finite elements.

An integration is refined until it tells its own error. It judges the reference, and then programs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from math import inf

import numpy as np

from wavesym.exact.contacts.events import events
from wavesym.exact.reference import Reference
from wavesym.mechanics.model import Model
from wavesym.methods.discrete import DiscreteModel
from wavesym.methods.elements import Elements
from wavesym.methods.network_problem import linear_problem
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import fraction, rational
from wavesym.verification.collocation import Motion, UndecidedError, integrate
from wavesym.verification.corner_history import CLOSE, CornerHistory, compare_events
from wavesym.verification.link_pulls import LinkPulls
from wavesym.verification.midpoint import LATE, Instants, LinkMethod, MidpointGrid
from wavesym.verification.outcome import Integration, Outcome, Rule, Solution, Truth, refused_outcomes
from wavesym.verification.problem import Change, corner_problem, match_changes
from wavesym.verification.reference import ReferenceOutputs, sample_evenly, spread_taus
from wavesym.verification.return_mapping import REACH, ReturnMapping
from wavesym.verification.stretches import Stretch, middles

# Gauss's points of a panel at N; where contacts open and close the first number with which the same happens at them
_POINTS, _POINTS_OF_CONTACTS = 6, (8, 12)
_MOST_POINTS = 96

# integrations take no more doubles than that, and no more panels where contacts open and close
_MOST_DOUBLES, _MOST_PANELS = 4_000_000, 400

# steps are this part, at most, of the time that friction takes to stop what moves at first
_STOPPED = 1 / 8

# when a law changes is looked for on ever finer grids, until it is known to this part of all of the time
_SHARP = 1e-3

# steps move no more points than that
MOST_MOVED = 2e8

# steps lag ever further behind: beyond this tau they would have to be shorter
_LONGEST = 60.0

# of the instants away from fronts, so many are looked at
_MOST_INSTANTS = 200

# steps tell nothing of springs that swing more radians than this in one
_SWING = 0.25

# finite elements of the shortest rod, unknowns, and instants besides those at which loads change
_COARSEST_ELEMENTS, _MOST_UNKNOWNS, _ELEMENT_INSTANTS = 2, 400, 400

_NO_GRID = "on no grid that is not too fine the same happens at corners"


# collocation


def collocation(known: ReferenceOutputs) -> list[Outcome]:
    """Collocation between fronts on what is known exactly; N is doubled until errors are bounded well.

    With contacts N is one with which the same happens at them with 2N and 4N.
    """
    solved = _cached_solutions(known)
    if isinstance(solved, str):
        return refused_outcomes(known, "N", solved)
    taus = np.array(known.taus)
    instants = solved.clear(taus)
    truths = [Truth(output.values[clear], output.scale) for output, clear in zip(known.outputs, instants, strict=True)]
    method = solved.method([taus[clear].tolist() for clear in instants])
    return method.outcomes(known.whole.name, known.names, truths, {})


def collocation_beyond(known: ReferenceOutputs) -> list[Outcome]:
    """Collocation on the whole horizon, where exact values are known of its beginning only."""
    if not known.outputs or known.model.until == known.whole.until:
        return []
    until = known.whole.horizon()
    method = collocation_method(known.independent or known.whole, until, sorted({*spread_taus(until), until}))
    if isinstance(method, str):  # as of the beginning
        return []
    return method.outcomes(known.whole.name, known.names, [None] * len(known.outputs), {})


def collocation_method(model: Model, until: float, taus: Sequence[float]) -> Integration | str:
    """Collocation of a model without contacts at the same instants for every output, or why there is none."""
    solved = _solve(model, until)
    return solved if isinstance(solved, str) else solved.method([taus] * len(model.probes))


class _Solutions:
    """The motions of a model, with ever more points a panel."""

    def __init__(self, model: Model, until: float) -> None:
        """Solve it with N, 2N and 4N points.

        Raises:
            Undecided: that takes too many panels, or other things happen at contacts.
        """
        self._until, self._problem = until, corner_problem(model)
        self.has_contacts = len(self._problem.gaps) > 0
        self._motions: dict[int, Motion] = {}
        for points in _POINTS_OF_CONTACTS if self.has_contacts else (_POINTS,):
            self.points, why = points, UndecidedError("more points a panel have other things happen at contacts")
            try:
                coarse, half, quarter = (self.motion(k * points).changes for k in (1, 2, 4))
            except UndecidedError as undecided:
                why = undecided
                continue
            if (found := match_changes(quarter, half)) is not None and match_changes(half, coarse) is not None:
                self.corner_changes = [(change, slack + CLOSE) for change, slack in found]
                return
        raise why

    def motion(self, points: int) -> Motion:
        """The motion with so many points a panel."""
        if points not in self._motions:
            size = 2 * points * (len(self._problem.delays) + self._problem.points)
            most = _MOST_PANELS if self.has_contacts else _MOST_DOUBLES // size
            self._motions[points] = integrate(self._problem, self._until, points, most)
        return self._motions[points]

    def clear(self, taus: Array) -> Array:
        """Which instants are as far from fronts that contacts cause as these are known, by output: (outputs, n)."""
        problem, far = self._problem, np.full((len(self._problem.readings), len(taus)), np.inf)
        for motion in [self.motion(k * self.points) for k in (1, 2, 4)] if self.has_contacts else []:
            far = np.minimum(far, [motion.distance(reading, taus) for reading in problem.readings])
        return np.array([np.all(far[weights != 0] > CLOSE, axis=0) for weights in problem.weights])

    def method(self, instants: Sequence[Sequence[float]]) -> Integration:
        """The outputs at instants of each."""
        every = np.unique(np.concatenate([np.asarray(taus, dtype=float) for taus in instants]))
        places = [np.searchsorted(every, taus) for taus in instants]

        def solve(finer: int) -> list[Solution]:
            motion = self.motion(finer * self.points)
            outputs = zip(motion.outputs(every), motion.output_roundoff, places, strict=True)
            return [Solution(values[at], rounding) for values, rounding, at in outputs]

        def is_affordable(finer: int) -> bool:
            return not self.has_contacts and finer * self.points <= _MOST_POINTS

        return Integration("integration", self.points, solve, is_affordable, "plain", instants)


def _solve(model: Model, until: float) -> _Solutions | str:
    try:
        return _Solutions(model, until)
    except UndecidedError as undecided:
        return f"no integration between fronts, as {undecided}"


@lru_cache(maxsize=1)
def _cached_solutions(known: ReferenceOutputs) -> _Solutions | str:
    return _solve(known.integration_model, known.until)


# the midpoint rule


def midpoints(known: ReferenceOutputs) -> list[Outcome]:
    """The midpoint rule with N, 2N and 4N steps a rod, at instants away from fronts.

    Where steps stay coarse that is said, but no failure: what they allow is in the table. Where links have corners N is
    so large that the same happens at them with 2N and 4N; that is one more front.
    """
    start = coarsest_start(known, 1)
    if isinstance(start, str):
        return refused_outcomes(known, "to", start)
    rule: Rule = "extrapolated" if start.grid.is_aligned and not start.corner_changes else "wandering"
    rule = "late" if start.grid.problem.laws else rule
    return start.outcomes(known, "midpoint rule", rule, LinkPulls)


def differences(known: ReferenceOutputs) -> list[Outcome]:
    """Central differences with return mapping at links with a law; nothing where there are none, or no rods."""
    problem = corner_problem(known.integration_model)
    if not problem.laws or problem.contacts or not problem.delays:
        return []
    start = coarsest_start(known, REACH)
    if isinstance(start, str):
        return refused_outcomes(known, "to", start)
    return start.outcomes(known, "central differences", "late", ReturnMapping)


@dataclass(frozen=True)
class Start:
    """The coarsest grid, up to which tau it is taken, what happens at corners, and instants of outputs off fronts."""

    grid: MidpointGrid
    until: float
    corner_changes: Sequence[tuple[Change, float]]
    instants: Sequence[Instants]

    def outcomes(
        self,
        known: ReferenceOutputs,
        name: str,
        rule: Rule,
        links: LinkMethod,
    ) -> list[Outcome]:
        """A row for each output, by what links pull."""
        grid, problem = self.grid, self.grid.problem
        every = np.unique(np.concatenate(self.instants))
        places = [np.searchsorted(every, each) for each in self.instants]
        taus = np.array([grid.tau(k) for k in every.tolist()])
        exact = np.array(Reference(known.model).values(taus.tolist()))
        truths = [
            Truth(values[at], output.scale) for values, at, output in zip(exact, places, known.outputs, strict=True)
        ]

        def solve(finer: int) -> list[Solution]:
            values, roundoff = grid.finer(finer).integrate(finer * every, links)
            rounding = np.abs(problem.weights) @ roundoff
            outputs = zip(problem.outputs(values, taus), places, rounding, strict=True)
            return [Solution(values[at], rounded) for values, at, rounded in outputs]

        def is_affordable(finer: int) -> bool:
            return grid.finer(finer).cost(self.until) <= MOST_MOVED

        late, offset = 0.0, 0.0
        if rule == "late":
            late, offset = grid.tau(1), grid.front_offset([event.double for event in events(known.model)])
        instants = [taus[at].tolist() for at in places]
        method = Integration(name, grid.cells, solve, is_affordable, rule, instants, True, late, offset)
        found = method.outcomes(known.model.name, known.names, truths, {})
        refused = refused_outcomes(known, "to", _between_fronts(grid))
        return [
            replace(outcome, cells={"to": f"{each[-1]:.4g}", **outcome.cells}) if each else refusal
            for outcome, each, refusal in zip(found, instants, refused, strict=True)
        ]


@lru_cache(maxsize=2)
def coarsest_start(known: ReferenceOutputs, reach: int) -> Start | str:
    """The coarsest grid on which there is something to read from so many steps around, or why there is none."""
    model = known.integration_model
    first, struck = _known_grid(known), list[tuple[Change, float]]()
    until = min(known.until, _LONGEST, MOST_MOVED / first.finer(4).cost(1.0))
    while first.tau(1) > _STOPPED * first.problem.soonest:
        if first.finer(8).cost(until) > MOST_MOVED:
            return f"friction stops what moves within {first.problem.soonest:.1g}, sooner than steps that can be taken"
        first = first.finer(2)
    if model.network.corners:
        if (found := first.resolve_changes(until, MOST_MOVED)) is None:
            return _NO_GRID
        first, struck = found
    # in every stretch between what happens at corners, which is known better on finer grids, and where its fronts are
    while not first.tells(until, struck, reach) and first.finer(8).cost(until) <= MOST_MOVED:
        found = first.finer(2).resolve_changes(until, MOST_MOVED) if struck else None
        first, struck = found or (first.finer(2), struck)
    finest = first
    while finest.finer(8).cost(until) <= MOST_MOVED:
        finest = finest.finer(2)
    if (swing := first.problem.swings * finest.tau(1) / 4) > _SWING:
        return f"springs swing {swing:.2g} radians in the shortest step that can be taken"
    parts, instants = first.stretches(until, struck), first.instants(until, struck, reach)
    if not any(map(len, instants)):
        return _between_fronts(first)
    return Start(first, until, struck, [_some(each, first, parts) for each in instants])


def _some(instants: Instants, grid: MidpointGrid, parts: Sequence[Stretch]) -> Instants:
    """As many as are looked at, some in each stretch."""
    inside = instants[middles(parts, np.array([grid.tau(k) for k in instants.tolist()]))]
    return np.union1d(sample_evenly(instants, _MOST_INSTANTS), inside)


def _between_fronts(grid: MidpointGrid) -> str:
    return f"to step between the fronts would take too long (at {grid.tau(1):.1g} a step)"


@lru_cache(maxsize=2)
def _known_grid(known: ReferenceOutputs) -> MidpointGrid:
    """The coarsest one, which finer ones share with what they find."""
    return _grid(known.integration_model)


def _grid(model: Model) -> MidpointGrid:
    return MidpointGrid.coarsest(corner_problem(model), fraction(model.until))


# finite elements


def elements(known: ReferenceOutputs) -> list[Outcome]:
    """Finite elements of consistent mass, damped by the same ratios, where modes are damped; nothing else knows these.

    Their error is a series in the square of their length, but where fronts bend. There is no truth to compare with.
    """
    model = known.independent or known.whole
    if model.damping is None:
        return []
    problem = linear_problem(model)
    shortest = np.maximum(
        np.rint(_COARSEST_ELEMENTS * problem.delay / np.min(problem.delay, initial=np.inf)), 1
    ).astype(int)
    step = problem.until / _ELEMENT_INSTANTS

    @lru_cache
    def history(finer: int) -> tuple[Array, Array]:
        return DiscreteModel(Elements(problem, shortest * finer)).outputs(step)

    def is_affordable(finer: int) -> bool:
        return int(np.sum(shortest)) * finer <= _MOST_UNKNOWNS

    def solve(finer: int) -> list[Solution]:
        return [Solution(values) for values in history(finer)[1]]

    names = [probe.name for probe in model.probes]
    taus = np.minimum(history(1)[0], model.horizon()).tolist()
    method = Integration(
        "elements", _COARSEST_ELEMENTS, solve, is_affordable, "smeared", [taus] * len(names), clear=True
    )
    return method.outcomes(model.name, names, [None] * len(names), {})


# corners


def corner_changes(known: ReferenceOutputs) -> list[Outcome]:
    """When laws change at corners, against collocation between fronts and the midpoint rule."""
    model = known.model
    if not known.integration_model.network.corners:
        return []
    solved = _cached_solutions(known)
    seen: dict[str, CornerHistory | None] = {}
    if all(model.network.links[link].contact for link in model.network.corners):
        seen["fronts"] = None if isinstance(solved, str) else CornerHistory(solved.corner_changes, 0.0)
    notes = [f"{model.name}: {solved}"] if isinstance(solved, str) else []
    sharp = _SHARP if isinstance(solved, str) else inf  # nothing else is
    stepped = _known_grid(known).resolve_changes(known.until, MOST_MOVED, sharp)
    seen["midpoint"] = CornerHistory(stepped[1], LATE * float(stepped[0].step)) if stepped else None
    notes += [] if stepped else [f"{model.name}: {_NO_GRID}"]
    outcomes = [Outcome("corners", {}, True, note) for note in notes]
    claimed, reaching = events(model), model.contacts(rational(model.horizon()))
    for number, link in enumerate(model.network.corners):
        if link in reaching:
            here = {name: each and each.select(number) for name, each in seen.items()}
            happened = [event for event in claimed if event.link == link]
            outcomes += compare_events(model.network.links[link].place, happened, here, known.until)
    return outcomes
