"""Central differences at Courant number 1 over any network of bars, straight from the wave equation: no waves.

A bar is delay/h cells, each of which a wave crosses in a step h of tau, for an h that all delays are multiples of.
Inside a bar

    U(j, t + h) = U(j + 1, t) + U(j - 1, t) - U(j, t - h),

which is no approximation: fronts stay as sharp as they are. A point carries half a cell of each of its bars, so that

    mass (u+ - 2 u + u-)/h^2 + damping (u+ - u-)/(2 h) + stiffness (u+ + 2 u + u-)/4
        = sum over ends of ratio * impedance * ((U_beside - ratio u)/h - ratio h/2 (u+ - 2 u + u-)/h^2)
        + the loads' mean from t - h to t + h,

of order 2, and stable for any springs and dashpots. The first step is the balance of momentum from 0 to h, in which
the bars' ends feel nothing but what was in the bars at the start: a mass may be faster than its bars.

Contacts push in the mean from t - h to t + h what keeps gaps at t + h from being negative, and only where they are 0:
what opens inside a step is late by a part of it, which counts among what may be wrong.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import ceil, lcm

import numpy as np
from numpy.typing import NDArray

from wavesym.mechanics.model import Model
from wavesym.mechanics.probe import Probe
from wavesym.numbers.doubles import UNIT_ROUNDOFF, fraction
from wavesym.verification.graph import Array, Change, Graph, Struck, alike, graph

Instants = NDArray[np.int_]

COARSEST = 16
"""Cells per rod of the coarsest grid, at least."""

# load times and places with larger denominators than this do not become points of the grid
FINEST_ALIGNED = 128

# between points of the grid outputs are read off a polynomial through so many
STENCIL = 6

# a point rounds three sums, a node and what is read off a little more
ROUNDINGS = 8


# points and instants are told apart in doubles
SAME = 1e-6

Term = tuple[int, int, float]
"""A displacement that an output is read from: steps later (-1, 0, 1), the point, and its weight."""

# what a step costs besides its points, in points
_STEP = 5000

# what happens at a contact is late by so many steps at most, and what does not last as long did not happen
LATE = 4

# parts of what pushes and gaps are worth that tell whether a contact is closed, and gaps that are 0
_TOLD, _ROUNDED = 1e-9, 1e-14


@dataclass(frozen=True)
class Displaced:
    """The outputs at the instants asked for, shape (outputs, instants), what rounding may have added to each;
    and which contacts opened and closed, at the ends of steps."""

    values: Array
    roundoff: Array
    changes: tuple[Change, ...]


@dataclass(frozen=True)
class SpaceTimeGrid:
    """A network whose bars have cells of a step of tau. An instant k is tau = k * step. Everything is dimensionless."""

    graph: Graph
    probes: tuple[Probe, ...]
    step: Fraction

    @property
    def cells(self) -> int:
        """How many the shortest bar has."""
        return int(min(self.graph.delays) / self.step)

    @property
    def aligned(self) -> bool:
        """Whether all loads begin on the grid. All fronts are on it then, and errors are a series in h^2."""
        return all((event.time / self.step).denominator == 1 for event in self.graph.events)

    def finer(self, times: int) -> SpaceTimeGrid:
        """The grid with that many cells for one."""
        return SpaceTimeGrid(self.graph, self.probes, self.step / times)

    def tau(self, instant: int) -> float:
        """When an instant is."""
        return float(instant * self.step)

    def cost(self, until: float) -> float:
        """What it takes to come to tau = `until`: points moved, roughly."""
        points = float(sum(self.graph.delays) / self.step) + len(self.graph.mass) ** 2
        return until / float(self.step) * (points + _STEP)

    def instants(self, until: float, struck: Sequence[tuple[Change, float]] = ()) -> Instants:
        """Those up to `until` at which what every output is read from has no front inside.

        Fronts set out from points at multiples of the delays' common measure after 0, after every load, and after
        what happened at contacts: `struck` has when, and how well that is known.
        """
        measure, step = self.graph.measure, float(self.step)
        cuts = {event.time % measure for event in self.graph.events} | {Fraction(0)}
        reaches = [1 if whole(self._place(probe)) else STENCIL for probe in self.probes]
        instants = np.arange(1, int(until / step) - max(reaches) + 1)
        free = np.ones(len(instants), dtype=bool)
        window = float(measure / self.step)
        for probe, reach in zip(self.probes, reaches, strict=True):
            offset = fraction(probe.place) * (0 if probe.point is not None else self.graph.delays[probe.rod - 1])
            for way in (offset, -offset):
                for cut in cuts:
                    passed = (instants - float((cut + way) / self.step) + window / 2) % window - window / 2
                    free &= np.abs(passed) > reach - SAME
                for change, slack in struck:
                    passed = instants - (change.tau - slack + way) / step
                    after = passed % window
                    free &= (passed < -reach) | ((after > reach + 2 * slack / step) & (window - after > reach))
        return instants[free]

    def struck(self, until: float, most: float) -> tuple[SpaceTimeGrid, Struck] | None:
        """The coarsest grid which, halved twice, has the same happen at contacts, and that; None if it costs more."""
        grid = self
        while grid.finer(4).cost(until) <= most and until > LATE * float(grid.step):
            last = np.array([int(until / float(grid.step))])
            changes = [grid.finer(k).integrate(k * last).changes for k in (1, 2, 4)]
            first, then = alike(changes[2], changes[1]), alike(changes[1], changes[0])
            if first is not None and then is not None:
                known = [after + before for (_, after), (_, before) in zip(first, then, strict=True)]
                late = LATE * float(grid.step) / 4
                return grid, [(change, each + late) for (change, _), each in zip(first, known, strict=True)]
            grid = grid.finer(2)
        return None

    def integrate(self, instants: Instants) -> Displaced:
        """The outputs at positive instants in ascending order. At a front, the mean of what is before and after it."""
        h = float(self.step)
        times = h * np.arange(instants[-1] + 2)
        impulse = self.graph.load_integral(np.append(times, times[-1] + h), 1)
        told = self.graph.prescribed(np.append(times, times[-1] + h))
        kept = np.unique(np.add.outer(instants, (-1, 0, 1)))
        history = np.zeros((len(kept), len(self._points)))
        largest, row = 0.0, 0
        field, points = _Field(self), _Points(self)
        for step in range(int(instants[-1]) + 2):
            if step == kept[row]:
                history[row] = np.append(field.now, points.now)[self._points]
                largest = max(largest, float(np.max(np.abs(points.now))), float(np.max(np.abs(field.now))))
                row += 1
            if step == 0:
                points.begin(impulse[1] / h, told[1])
            else:
                points.move(field.beside, (impulse[step + 1] - impulse[step - 1]) / (2 * h), told[step + 1])
            field.move(points.now)
        values = np.array([np.full(len(instants), constant) for constant in self._constants])
        rows = np.searchsorted(kept, instants)
        for output, terms in zip(values, self._terms, strict=True):
            for later, point, weight in terms:
                output += weight * history[rows + later, np.searchsorted(self._points, point)]
        unsure = largest * self._roundoff(int(instants[-1])) + points.missed * self._struck
        return Displaced(values, unsure, tuple(self._lasting(points.changes)))

    @cached_property
    def _struck(self) -> Array:
        """What an impulse at a contact changes of the outputs, at most: rods' ends move, masses are faster."""
        impedance, heavy = self.graph.impedance, self.graph.mass[self.graph.mass > 0]
        slowest, lightest = float(np.min(self.graph.speed)), float(np.min(heavy, initial=np.inf))
        until = {
            "displacement": 1 / float(np.min(impedance)),
            "velocity": 1 / lightest,
            "strain": 1 / lightest / slowest,
        }
        return np.array([until[probe.quantity] for probe in self.probes])

    def _lasting(self, changes: Sequence[tuple[int, str, int]]) -> Iterator[Change]:
        """What happened at contacts and stayed so for some steps: the rest is what fronts between instants do."""
        for contact in range(len(self.graph.contacts)):
            kept: list[tuple[str, int]] = []
            for _, kind, step in (change for change in changes if change[0] == contact):
                if kept and step - kept[-1][1] < LATE:
                    kept.pop()
                else:
                    kept.append((kind, step))
            yield from (Change(contact, kind, float(step * self.step)) for kind, step in kept)

    def _roundoff(self, steps: int) -> Array:
        """What rounding adds to the outputs for displacements of 1, at most.

        What is rounded at a point goes on as a displacement of every second point between two fronts (and no node
        amplifies it): a displacement sees all those of its past, a difference those on whose fronts it lies.
        """
        unit = ROUNDINGS * float(UNIT_ROUNDOFF)
        slope = steps / float(self.step)
        sizes = []
        for probe in self.probes:
            speed = self.graph.speed[probe.rod - 1] if probe.quantity == "strain" else 1.0
            sizes.append(unit * (steps * steps if probe.quantity == "displacement" else slope / speed))
        return np.array(sizes)

    @cached_property
    def counts(self) -> NDArray[np.int_]:
        """How many cells each bar has."""
        return np.array([int(delay / self.step) for delay in self.graph.delays])

    @cached_property
    def firsts(self) -> NDArray[np.int_]:
        """Where each bar begins in the field of all bars, one after the other; and the end of the last one."""
        return np.append(0, np.cumsum(self.counts + 1))

    def _place(self, probe: Probe) -> float:
        """Where an output is, in cells from the left end of its bar."""
        if probe.point is not None:
            return 0.0
        return float(fraction(probe.place) * self.graph.delays[probe.rod - 1] / self.step)

    @cached_property
    def _terms(self) -> list[list[Term]]:
        return [list(self._read(probe)) for probe in self.probes]

    def _read(self, probe: Probe) -> Iterator[Term]:
        rate = 1.0 / float(self.step)
        if probe.point is not None:
            point = int(self.firsts[-1]) + probe.point
            yield from ((later, point, weight) for later, _, weight in read(probe.quantity, 0, 1, rate))
            return
        bar = probe.rod - 1
        slope = rate / self.graph.speed[bar] if probe.quantity == "strain" else rate
        for j, weight in between(self._place(probe), int(self.counts[bar])):
            for later, point, factor in read(probe.quantity, j, int(self.counts[bar]), slope):
                yield later, int(self.firsts[bar]) + point, weight * factor

    @cached_property
    def _constants(self) -> list[float]:
        """What the bars' strains at the start add to the outputs."""
        return [
            float(self.graph.start_strain[probe.rod - 1]) if probe.quantity == "strain" else 0.0
            for probe in self.probes
        ]

    @cached_property
    def _points(self) -> NDArray[np.int_]:
        """The points that outputs are read from."""
        return np.unique([point for terms in self._terms for _, point, _ in terms])


def grid(model: Model) -> SpaceTimeGrid:
    """The coarsest grid for a model: its loads and outputs are on it where their denominators are small."""
    made = graph(model)
    measure = made.measure
    common = 1
    offsets = (fraction(probe.place) * made.delays[probe.rod - 1] for probe in model.probes if probe.point is None)
    for time in (*(event.time for event in made.events), *offsets):
        if lcm(common, (time / measure).denominator) <= FINEST_ALIGNED:
            common = lcm(common, (time / measure).denominator)
    shortest = min(*made.delays, fraction(model.until))
    return SpaceTimeGrid(made, model.probes, measure / common / ceil(COARSEST * measure / common / shortest))


class _Field:
    """The displacements of all bars, one after the other, now and a step before."""

    def __init__(self, grid: SpaceTimeGrid) -> None:
        made = grid.graph
        self._first = float(grid.step) * np.repeat(made.start_velocity, grid.counts + 1)
        starts = grid.firsts[:-1]
        self._ends = np.stack([starts, starts + grid.counts], axis=1).ravel()
        self._beside = self._ends + np.tile([1, -1], len(starts))
        self._which, self._ratios = made.ends, made.ratios
        self.now = np.zeros(len(self._first))
        self._before: Array | None = None

    @property
    def beside(self) -> Array:
        """The displacements beside all ends, in their bars."""
        return np.asarray(self.now[self._beside])

    def move(self, points: Array) -> None:
        """One step, to where the points are already."""
        after = self._first.copy()
        if self._before is not None:
            after[1:-1] = self.now[2:] + self.now[:-2] - self._before[1:-1]
        after[self._ends] = self._ratios * points[self._which]
        self._before, self.now = self.now, after


class _Points:
    """The displacements of all points, now and a step before."""

    def __init__(self, grid: SpaceTimeGrid) -> None:
        made, h = grid.graph, float(grid.step)
        self._graph, self._h, self._free = made, h, made.free
        size = len(made.mass)
        impedance = np.repeat(made.impedance, 2)
        self._onto = np.zeros((size, len(made.ends)))  # what the ends' forces do to their points
        self._onto[made.ends, np.arange(len(made.ends))] = made.ratios
        radiated = np.diag(self._onto**2 @ impedance)
        mass = np.diag(made.mass)
        self._started = 2 * mass / h @ made.velocity
        self._start = 2 * mass / h + made.damping + radiated + h / 2 * made.stiffness
        mass = mass / h**2 + radiated / (2 * h)
        self._ahead = mass + made.damping / (2 * h) + made.stiffness / 4
        self._now = 2 * mass - radiated / h - made.stiffness / 2
        self._behind = mass - made.damping / (2 * h) + made.stiffness / 4
        tension = np.tile([1.0, -1.0], len(made.impedance)) * impedance
        self._strained = self._onto @ (tension * np.repeat(made.speed * made.start_strain, 2))
        self._beside = self._onto * impedance / h
        free = np.ix_(self._free, self._free)
        self._inverse, self._inverse_start = np.linalg.inv(self._ahead[free]), np.linalg.inv(self._start[free])
        self._parting = made.parting[:, self._free]
        self._open = made.gaps > 0
        self.changes: list[tuple[int, str, int]] = []
        self.missed, self._pushed = 0.0, np.zeros((LATE, len(made.gaps)))
        self._steps = 0
        self.now = np.zeros(size)
        self._before = self.now

    def begin(self, load: Array, told: Array) -> None:
        """The first step: mean velocities that balance momentum from 0 to h."""
        h, free = self._h, self._free
        right = self._onto @ self._graph.pull + load + self._started - self._start @ (told / h)
        told[free] = h * self._inverse_start @ right[free]
        self.now = self._kept_apart(told, np.asarray(h * self._inverse_start))

    def move(self, beside: Array, load: Array, told: Array) -> None:
        """One step more, from what is beside the ends in the bars."""
        right = self._beside @ beside + self._strained + load
        right += self._now @ self.now - self._behind @ self._before - self._ahead @ told
        told[self._free] = self._inverse @ right[self._free]
        self._before, self.now = self.now, self._kept_apart(told, np.asarray(self._inverse))

    def _kept_apart(self, after: Array, inverse: Array) -> Array:
        """Displacements with what contacts push: as little as keeps every gap from being negative."""
        self._steps += 1
        gaps = self._graph.gaps + self._graph.parting @ after
        length, force = self._graph.worth
        pushes = np.zeros(len(gaps))
        yields = self._parting @ inverse @ self._parting.T
        pushing = np.zeros(len(gaps), dtype=bool)
        while len(wrong := np.flatnonzero(np.where(pushing, pushes < 0, gaps + yields @ pushes < -_ROUNDED * length))):
            pushing[wrong[0]] ^= True  # the first of all: this comes to an end
            pushes = np.zeros(len(gaps))
            pushes[pushing] = np.linalg.solve(yields[np.ix_(pushing, pushing)], -gaps[pushing])
        after[self._free] += inverse @ self._parting.T @ pushes
        gaps += yields @ pushes
        told = np.where(self._open, pushes > _TOLD * force, gaps > _TOLD * length)
        for contact in np.flatnonzero(told):
            self._open[contact] ^= True
            self.missed += 2 * self._h * float(np.max(self._pushed[:, contact]))
            self.changes.append((int(contact), "opens" if self._open[contact] else "closes", self._steps))
        self._pushed[self._steps % LATE] = pushes
        return after


def between(place: float, cells: int) -> Iterator[tuple[int, float]]:
    """Points of a rod, and the weights with which they stand for a place between them."""
    if whole(place):
        yield round(place), 1.0
        return
    first = min(max(int(place) - STENCIL // 2 + 1, 0), cells + 1 - STENCIL)
    points = range(first, first + STENCIL)
    for j in points:
        yield j, float(np.prod([(place - k) / (j - k) for k in points if k != j]))


def read(quantity: str, j: int, cells: int, rate: float) -> list[Term]:
    """A quantity at point j of a rod of so many cells; `rate` is 1 over the step of what it is the slope in."""
    half = rate / 2
    if quantity == "displacement":
        return [(0, j, 1.0)]
    if quantity == "velocity":
        return [(1, j, half), (-1, j, -half)]
    if j == 0:
        return [(0, 1, 2 * half), (1, 0, -half), (-1, 0, -half)]
    if j == cells:
        return [(0, j - 1, -2 * half), (1, j, half), (-1, j, half)]
    return [(0, j + 1, half), (0, j - 1, -half)]


def whole(place: float) -> bool:
    return abs(place - round(place)) < SAME
