"""What a careful engineer writes by hand for one scene whose parameters change: characteristics of order 4, in C and,
for all sets at once, in NumPy. From new parameters to equally spaced samples, or to their peaks.

Only what such a program needs: equal rods, loads that begin at whole tau, strains and velocities, and samples and
outputs on the grid. It keeps no estimate of its error.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import gcd
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavesym.errors import UnservedError
from wavesym.mechanics.model import Model
from wavesym.methods.characteristics import unlinked_problem
from wavesym.methods.problem import LoadEvent
from wavesym.methods.quadrature import gauss, lagrange
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import nearest
from wavesym.running.native import FAST, address, library

_SOURCE = Path(__file__).with_suffix(".c")
_POINTS = 24  # of Gauss
_FIRSTS = (0, -1, -2)


class Reading(NamedTuple):
    """A strain or velocity in rod 1 ... m, `offset` in [0, 1] from its left end."""

    quantity: str
    rod: int
    offset: float


@dataclass(frozen=True)
class Line:
    """m rods of length 1 with waves of speed 1 in a line, and at node x = 0 ... m

        inertia q' + gamma q = alpha a + beta b + loads,

    with a and b the waves that arrive from the left and the right. `before` are waves until tau = 0, sent to the left
    and to the right, (2, m + 1); all else has shape (m + 1,).
    """

    inertia: Array
    alpha: Array
    beta: Array
    gamma: Array
    velocity: Array
    before: Array
    events: tuple[LoadEvent, ...]
    readings: tuple[Reading, ...]
    until: float

    @property
    def nodes(self) -> int:
        """m + 1."""
        return len(self.inertia)


def line(model: Model) -> Line:
    """The line of a model. UnservedError where it is none of equal rods."""
    problem = unlinked_problem(model)
    ends = np.stack([np.arange(problem.points - 1), np.arange(1, problem.points)], axis=1)
    alike = all(np.all(each == 1) for each in (problem.delay, problem.speed, problem.ratios))
    if not np.array_equal(problem.ends, ends) or not alike or not problem.reads_outputs:
        raise UnservedError("system: rods that differ, branches or sums given, a line of equal rods expected")
    free = ~np.isin(np.arange(problem.points), problem.prescribed_points)
    alpha, beta = (np.where(free, 2 * each, 0.0) for each in _adjacent(problem.impedance))
    return Line(
        inertia=problem.mass,
        alpha=alpha,
        beta=beta,
        gamma=np.where(free, np.diag(problem.damping) + (alpha + beta) / 2, 1.0),
        velocity=problem.velocity,
        before=np.stack([_adjacent(problem.start_waves[:, 1])[0], _adjacent(problem.start_waves[:, 0])[1]]),
        events=problem.events,
        readings=tuple(Reading(each.quantity, each.rod, nearest(each.place)) for each in problem.readings),
        until=problem.until,
    )


def _adjacent(rods: Array) -> tuple[Array, Array]:
    """A quantity of rods (m,) at the nodes: of the rod on the left, on the right; 0 where there is none."""
    return np.append(0.0, rods), np.append(rods, 0.0)


class SampleGrid:
    """`stride` steps from each of `count` samples to the next, the last at the horizon or before; for one scene."""

    def __init__(self, problem: Line, count: int, stride: int) -> None:
        steps = stride * (count - 1) / problem.until
        if steps != round(steps) or steps < 4:
            raise UnservedError(f"samples: {steps:g} steps in a unit of tau given, a whole number from 4 on expected")
        self.steps, self.count, self.stride = round(steps), count, stride
        self.windows = int(problem.until) + 1
        self.outputs = len(problem.readings)
        self.terms = [
            (output, reading.rod - (way == 1), way, sign, round(lag * self.steps))
            for output, reading in enumerate(problem.readings)
            for way, sign, lag in (
                (1, -1.0 if reading.quantity == "strain" else 1.0, reading.offset),
                (0, 1.0, 1 - reading.offset),
            )
        ]
        self.events = sorted((int(event.time), event.point) for event in problem.events)
        for reading in problem.readings:
            if reading.quantity == "displacement" or reading.offset * self.steps % 1:
                raise UnservedError(f"{reading.quantity} given, a strain or velocity on the grid expected")
        if any(event.time % 1 for event in problem.events):
            raise UnservedError("load: an instant between whole tau given, none expected")

    @property
    def kink(self) -> int:
        """Fronts pass outputs at multiples of so many steps."""
        return gcd(self.steps, *(lag for *_, lag in self.terms))

    def arguments(self, problem: Line) -> list[Array]:
        """What changes with parameters."""
        loads = [event.coefficients for event in sorted(problem.events, key=lambda event: (event.time, event.point))]
        of = (
            problem.inertia,
            problem.alpha,
            problem.beta,
            problem.gamma,
            problem.velocity,
            problem.before,
            np.array(loads),
        )
        return [np.ascontiguousarray(each, np.float64) for each in of]


def in_c(grid: SampleGrid, problem: Line) -> Callable[[Line], Callable[[], Array]]:
    """A call that makes samples of a set of parameters, (outputs, count); compiled for the sizes of this scene."""
    out = np.empty((grid.outputs, grid.count))
    function = _compile(grid, problem).parameters_to_samples

    def sampler(chosen: Line) -> Callable[[], Array]:
        arguments = grid.arguments(chosen)
        where = [address(argument) for argument in arguments]
        call = [*map(ctypes.c_void_p, where), ctypes.c_size_t(grid.count), ctypes.c_void_p(address(out))]

        def samples() -> Array:
            _ = arguments  # C reads them, so that they must live as long as this
            function(*call)
            return out

        return samples

    return sampler


def peaks_in_c(grid: SampleGrid, problems: Sequence[Line]) -> Callable[[], Array]:
    """A call that makes the least and the greatest value of each output, (sets, outputs, 2), set by set."""
    rows, out = np.empty((grid.outputs, grid.count)), np.empty((len(problems), grid.outputs, 2))
    arguments = [np.stack(each) for each in zip(*map(grid.arguments, problems), strict=True)]
    function = _compile(grid, problems[0]).sets_to_peaks
    where = [ctypes.c_void_p(address(each)) for each in (*arguments, rows, out)]
    call = [ctypes.c_size_t(len(problems)), *where[:-2], ctypes.c_size_t(grid.count), *where[-2:]]

    def peaks() -> Array:
        _ = arguments, rows  # C reads and writes them, so that they must live as long as this
        function(*call)
        return out

    return peaks


def _compile(grid: SampleGrid, problem: Line) -> ctypes.CDLL:
    """For the sizes of a scene."""
    output, node, way, sign, lag = zip(*grid.terms, strict=True)
    windows, nodes = zip(*grid.events, strict=True) if grid.events else ((), ())
    integers = {"of_output": output, "of_node": node, "of_way": way, "of_lag": lag}
    integers |= {"event_window": windows, "event_node": nodes}
    tables = "".join(f"const int {name}[] = {{{_list_text(values)}}};\n" for name, values in integers.items())
    sizes = {
        "NODES": problem.nodes,
        "STEPS": grid.steps,
        "WINDOWS": grid.windows,
        "TERMS": len(grid.terms),
        "OUTPUTS": grid.outputs,
        "EVENTS": len(grid.events),
        "STRIDE": grid.stride,
        "KINK": grid.kink,
    }
    source = _SOURCE.read_text(encoding="utf-8") + tables + f"const double of_sign[] = {{{_list_text(sign)}}};\n"
    return library(source, (*FAST, *(f"-D{name}={value}" for name, value in sizes.items())))


def _list_text(values: Sequence[float]) -> str:
    return ", ".join(map(str, values)) or "0"


def in_numpy(grid: SampleGrid, problems: Sequence[Line]) -> Array:
    """Samples of all sets at once: (sets, outputs, count)."""
    one, steps = problems[0], grid.steps
    h, sets = 1 / steps, len(problems)
    stacked = [np.stack(values) for values in zip(*(grid.arguments(each) for each in problems), strict=True)]
    inertia, alpha, beta, gamma, velocity, before, loads = stacked
    bodies = np.where(inertia > 0, inertia, 1.0)
    z = (gamma / bodies * h)[..., np.newaxis]
    rule = gauss(_POINTS)
    s, weights = rule.nodes, rule.weights
    kernel = np.exp(-z * (1 - s)) * weights * h / bodies[..., np.newaxis]
    first, inner, last = (kernel @ lagrange(s, begin, 4) for begin in _FIRSTS)
    decay = np.exp(-z[..., 0])
    wave = np.zeros((grid.windows + 1, 2, one.nodes + 2, steps + 1, sets))
    wave[0, :, 1:-1] = np.moveaxis(before, 0, -1)[:, :, np.newaxis]
    load, at, q = np.zeros((sets, one.nodes, 3)), h * np.arange(steps + 1), velocity.copy()
    event = 0
    for window in range(grid.windows):
        load[..., 0] += load[..., 1] + load[..., 2]
        load[..., 1] += 2 * load[..., 2]
        while event < len(grid.events) and grid.events[event][0] == window:
            load[:, grid.events[event][1]] += loads[:, event]
            event += 1
        a, b = wave[window, 1, :-2], wave[window, 0, 2:]  # (nodes, steps + 1, sets)
        c = np.moveaxis(load, 0, -1)[:, :, np.newaxis]  # (nodes, 3, 1, sets)
        t = at[:, np.newaxis]
        r = alpha.T[:, np.newaxis] * a + beta.T[:, np.newaxis] * b + (c[:, 0] + t * (c[:, 1] + t * c[:, 2]))
        v = np.empty_like(r)
        for n in range(one.nodes):
            if one.inertia[n] == 0:
                v[n] = r[n] / gamma[:, n]
                continue
            v[n, 0] = q[:, n]
            v[n, 2:-1] = sum(inner[:, n, j] * r[n, j : j + steps - 2] for j in range(4))
            v[n, 1] = sum(first[:, n, j] * r[n, j] for j in range(4))
            v[n, -1] = sum(last[:, n, j] * r[n, steps - 3 + j] for j in range(4))
            for k in range(1, steps + 1):
                v[n, k] += decay[:, n] * v[n, k - 1]
            q[:, n] = v[n, -1]
        wave[window + 1, 0, 1:-1], wave[window + 1, 1, 1:-1] = v - a, v - b
    out = np.zeros((sets, grid.outputs, grid.count))
    for output, node, way, sign, lag in grid.terms:
        at, place = np.divmod(np.arange(grid.count) * grid.stride - lag + steps, steps)
        out[:, output] += sign * wave[at, way, node + 1, place].T
    return out


def peaks_in_numpy(grid: SampleGrid, problems: Sequence[Line]) -> Array:
    """The least and the greatest value of each output, (sets, outputs, 2), as `peaks_in_c` has them; all at once."""
    values = in_numpy(grid, problems)
    return np.stack([_top(grid, -values) * -1.0, _top(grid, values)], axis=-1)


def _top(grid: SampleGrid, values: Array) -> Array:
    """Of a parabola through the highest sample and its neighbours, or, where a front may pass there, through it and the
    two before or after it."""
    at = values.argmax(axis=-1)

    def rise(begin: NDArray[np.intp], way: int) -> Array:
        """How much higher a parabola from a sample on is than it."""
        places = (np.clip(begin + k * way, 0, grid.count - 1)[..., np.newaxis] for k in range(3))
        first, one, two = (np.take_along_axis(values, place, axis=-1)[..., 0] for place in places)
        bend, rise = 2 * one - two - first, (4 * one - two - 3 * first) / 2
        inside = (bend > 0) & (rise > 0) & (rise < 2 * bend)
        return first + np.where(inside, rise**2 / (2 * np.where(inside, bend, 1.0)), 0.0)

    smooth = (at * grid.stride % grid.kink != 0) & (at + 1 < grid.count)
    found = np.where(smooth, rise(at - 1, 1), np.maximum(rise(at, 1), rise(at, -1)))
    return np.asarray(np.maximum(found, values.max(axis=-1)))
