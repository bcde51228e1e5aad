"""Outputs over time, ready to be drawn: as right as a picture can show, and broken where they jump.

Values are those of a program that `generate` can write, with a tolerance that no eye can tell from a smaller one: so
there is a picture of every scene that can be generated. When fronts can arrive is known from the loads and the
places alone; there an output is asked for its value and for the one just before.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from math import inf, nextafter

import numpy as np
from flint import fmpq

from wavesym.errors import SpacingError, ToleranceError, WavesymError
from wavesym.exact.contacts.events import ContactEnd, contact_ends
from wavesym.mechanics.model import Model
from wavesym.mechanics.probe import Probe
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import nearest, not_below
from wavesym.programs.hats import under_jumps
from wavesym.programs.making import make
from wavesym.programs.march.plan import march_plan
from wavesym.programs.program import Program
from wavesym.programs.request import Request
from wavesym.results.sampling import sampled_extremes

_TOLERANCE = fmpq(1, 10**6)
_VISIBLE = 1e-5  # smaller jumps, relative to the largest value, are no jumps
_LEAST, _PER_UNIT, _MOST = 1200, 32, 200_000  # instants
_VALUES = 400_000  # of all outputs together
# what a picture can show, of an output's largest value: modes take the more of them the less that is
_SEEN = fmpq(1, 10**4)
_QUICK = {"march": _TOLERANCE, "modes": _SEEN}
_USUAL, _SOON = Request(), Request(optimize="making")
_FEW = 12  # outputs: for more it counts how long pieces take to fit
MOST_FRONTS = 50_000  # more of them lie far closer than the dots of a picture


@dataclass(frozen=True)
class History:
    """One output over tau, dimensionless.

    `stretches` are polylines (n, 2) of tau and value, among them the least and the greatest one; from one to the next
    the output jumps. What comes after `formal` is the formal continuation of a contact that has opened.
    """

    output: Probe
    stretches: tuple[Array, ...]
    formal: float = inf

    @property
    def name(self) -> str:
        return self.output.label

    @cached_property
    def points(self) -> Array:
        """All vertices, in order."""
        return np.vstack(self.stretches)

    @cached_property
    def real(self) -> Array:
        """The vertices that are no formal continuation."""
        return self.points[self.points[:, 0] <= self.formal]

    @property
    def extremes(self) -> Array:
        """Tau and value of its least and of its greatest value, (2, 2), in which nothing is formal."""
        return self.real[[np.argmin(self.real[:, 1]), np.argmax(self.real[:, 1])]]

    @property
    def zero(self) -> bool:
        """Whether it is 0 throughout."""
        return not self.points[:, 1].any()


@dataclass(frozen=True)
class Histories:
    """The outputs of a model; contacts that open; whether fronts lie too close to be told apart; what computed them.

    Fronts are where outputs jump: none that is computed in equal steps does.
    """

    model: Model
    outputs: tuple[History, ...]
    contacts: tuple[ContactEnd, ...]
    dense: bool
    program: Program | None = None


def histories(model: Model, columns: int = 1, program: Program | None = None) -> Histories:
    """The histories of all outputs. ToleranceError, CostError where nothing can be generated either.

    Their instants lie at the edges of so many `columns` of equal width, and between them. They are those of a `program`
    that has these outputs, or of one that is made quickly.
    """
    program = program or drawable(model)
    contacts = contact_ends(model)
    formal = [_formal(model, probe, contacts) for probe in model.probes]
    dense = _dense(model)
    sudden = under_jumps(program, model)
    fronts = [[] if dense else arrivals(sudden, probe) for probe in model.probes]
    names = [output.name for output in program.outputs]
    rows = [names.index(probe.name) for probe in model.probes]
    ends = np.full(len(names), program.tau_max)
    ends[rows] = np.minimum(ends[rows], formal)
    taus, values = _with_peaks(program, _instants(program, columns, fronts, formal), ends)
    return Histories(
        model,
        tuple(
            History(probe, _split_at_fronts(np.column_stack([taus, values[row]]), own), late)
            for probe, row, own, late in zip(model.probes, rows, fronts, formal, strict=True)
        ),
        contacts,
        dense and not program.has_equal_steps,
        program,
    )


def drawable(model: Model) -> Program:
    """A program of a model for pictures: of those that will do that which is made most quickly."""
    quick = [] if model.lines else list(_QUICK.items())  # these would take shapes as thousands of lines
    for kind, least in quick if _fits(model) else reversed(quick):
        with suppress(WavesymError):
            return make(model.tolerating(max(model.tolerance, least)), Request(kind))
    try:
        return make(model.tolerating(max(model.tolerance, _TOLERANCE)), _SOON if len(model.probes) > _FEW else _USUAL)
    except ToleranceError:
        with suppress(WavesymError):  # rounding adds up over long horizons
            return make(model.tolerating(_SEEN), Request("march"))
        raise


def _fits(model: Model) -> bool:
    """Whether loads fit into the windows of a march; to march one hat instead takes longer than modes."""
    try:
        march_plan(model)
    except SpacingError:
        return False
    except WavesymError:  # as will be said
        return True
    return True


def arrivals(model: Model, probe: Probe) -> list[float]:
    """Every tau > 0 on the horizon at which a front can arrive at an output, as doubles at or just above.

    A front leaves a node whole units of tau after a load has changed, and needs the distance to the output more.
    """
    times = {part + n for part in _parts(model, probe) for n in range(int((model.until - part).floor()) + 1)}
    return sorted(not_below(time) for time in times if 0 < time <= model.until)


def _dense(model: Model) -> bool:
    """Whether there are more fronts than can be seen."""
    loads = {load.time - load.time.floor() for load in model.loads}
    if len(loads) * len(model.probes) * model.until > MOST_FRONTS:  # each output has as many at least
        return True
    return sum(len(_parts(model, probe)) for probe in model.probes) * model.until > MOST_FRONTS


def _parts(model: Model, probe: Probe) -> set[fmpq]:
    """The parts of a unit of tau at which fronts can arrive."""
    places = _places(model, probe)
    moments = (load.time + lag for load in model.loads for x in places for lag in (x, -x))
    return {moment - moment.floor() for moment in moments}


def _places(model: Model, probe: Probe) -> set[fmpq]:
    """Where an output is read."""
    return {reading.x for _, reading in model.sums[probe] if reading.moves}


def _formal(model: Model, probe: Probe, contacts: tuple[ContactEnd, ...]) -> float:
    """When what an opened contact sends can first arrive at an output."""
    places = [nearest(x) for x in _places(model, probe)]
    return min((end.double + abs(x - end.x) for end in contacts for x in places), default=inf)


def _instants(program: Program, columns: int, fronts: list[list[float]], formal: list[float]) -> Array:
    until = program.tau_max
    most = min(_MOST, max(_LEAST, _VALUES // len(formal)))
    count = columns * -(-min(max(_LEAST, int(_PER_UNIT * until)), most) // columns)
    sudden = [tau for own in fronts for tau in own]
    before = [nextafter(tau, 0) for tau in sudden]
    late = [tau for tau in formal if tau < until]
    return np.unique(np.concatenate([program.instants(until / count), sudden, before, late]))


def _with_peaks(program: Program, taus: Array, ends: Array) -> tuple[Array, Array]:
    """Tau and values (outputs, n), with those at which an output is least or greatest until it `ends` between them.

    They are looked for around the highest values at the other instants, as `summary` does.
    """
    values = program.evaluate(taus)
    last = np.searchsorted(taus, ends, side="right") - 1
    held = np.take_along_axis(values, np.minimum(np.arange(taus.size), last[:, None]), axis=1)
    _, when = sampled_extremes(taus, held, lambda tau: program.each(np.minimum(tau, ends[:, None])))
    more = np.setdiff1d(when, taus)
    place = np.searchsorted(taus, more)
    return np.insert(taus, place, more), np.insert(values, place, program.evaluate(more), axis=1)


def _split_at_fronts(points: Array, fronts: list[float]) -> tuple[Array, ...]:
    """A polyline in parts, between the fronts at which it jumps."""
    tau, value = points.T
    at = np.searchsorted(tau, fronts)
    high = np.abs(value[at] - value[at - 1]) > _VISIBLE * np.max(np.abs(value))
    return tuple(np.split(points, at[high]))
