"""All sets of parameters, marched to the horizon together."""

from __future__ import annotations

import numpy as np

from wavesym.programs.runtime.arrays.bodies import ArrayBodies
from wavesym.programs.runtime.arrays.cone import reached
from wavesym.programs.runtime.arrays.laws import ArrayLaws, allowed, array_laws, array_slopes
from wavesym.programs.runtime.arrays.tables import ArrayTables
from wavesym.programs.runtime.arrays.waves import ArrayWaves
from wavesym.programs.runtime.degree import raised
from wavesym.programs.runtime.engine import Array


class ArrayMarch:
    """Of the sets that are the rows of `given`: their `status` and `estimate`, and `series`, of each window an array of
    shape (strands, degree + 2, 1 + lanes, sets). There are `lanes`, derivatives by the parameters, where asked for.

    All sets have the degree of the one that needs most. One that is refused goes on with the scene's own parameters.
    """

    def __init__(self, tables: ArrayTables, given: Array, *, lanes: bool = False) -> None:
        self._tables = tables
        laws = tables.laws
        own = np.array([float(value) for field in laws.fields for value in field.values])
        with np.errstate(all="ignore"):
            own_laws = array_laws(laws, given)
            fine = (
                allowed(laws, given)
                & own_laws.finite
                & ~np.any((tables.ints("is_body")[:, None] > 0) & ~(own_laws.rate > 0), axis=0)
            )
            if lanes:
                fine &= array_slopes(laws, given).finite
        self.status = np.where(fine, 0, 1).astype(np.int32)
        given = np.where(fine[:, None], given, own)
        self._law = array_laws(laws, given)
        self._massive = self._law.rate > 0
        self._value = ArrayWaves(tables, self._law, _changes(tables, self._law, self._law))
        self._slope, self._lanes = None, None
        if lanes:
            self._slope = array_slopes(laws, given)
            change = _changes(tables, self._slope, self._law) + _changes(tables, self._law, self._slope)
            self._lanes = ArrayWaves(tables, self._slope, change)
        self._tabulate()
        self._missed, self._size = np.zeros((2, len(given)))
        with np.errstate(all="ignore"):  # sets that are refused on the way may grow beyond all numbers
            self.series = [self._window(window) for window in range(tables.sizes["windows"])]
            heard = sum(4.0 * len(each[0]) * np.abs(each).sum(axis=(0, 1, 2)) for each in self.series)
            degree = self._value.degree
            rounded = tables.unit * (degree + tables.sizes["windows"] + degree * degree / 16)
            missed = 6 * self._missed + rounded * self._size
            self.estimate = self._estimated(missed)
        self.status[(self.status == 0) & ~np.isfinite(self._size + missed + heard)] = 1
        self.estimate[self.status != 0] = np.nan

    def _tabulate(self) -> None:
        steps = (self._law.rate * (2 * half) for half in self._tables["half_length"])
        self._bodies = [ArrayBodies(step, self._value.degree) for step in steps]

    def _window(self, window: int) -> Array:
        """The series of a window, at the lowest degree, raised by quarters, that misses no more than its share."""
        half, value = window % 2, self._value
        value.press(window)
        while True:
            leak, size, velocity, moved = self._step(half)
            late = (self.status == 0) & ~(leak <= self._tables.share * size)
            if not late.any() or value.degree == self._tables.sizes["degree"]:
                break
            value.lengthen(min(raised(value.degree), self._tables.sizes["degree"]))
            self._tabulate()
        self.status[late] = np.where(np.isfinite(leak + size), 2, 1)[late]
        self._missed += leak
        self._size, value.velocity = size, velocity
        slopes = [] if self._lanes is None else [self._followed(self._lanes, window, moved)]
        return np.concatenate([value.listen(half, self._law.gain)[:, :, None], *slopes], axis=2)

    def _step(self, half: int) -> tuple[Array, Array, Array, list[tuple[Array, Array]]]:
        """One window: what its polynomials miss, the largest velocity or mean of a wave so far, the velocities at its
        end, and what pushes nodes and how they move, panel by panel.
        """
        law, value, massive = self._law, self._value, self._massive
        missed, size, velocity, moved = np.zeros_like(self._size), self._size, value.velocity, []
        for panel, bodies in enumerate(self._bodies):
            a, b = value.arriving(half, panel)
            p = law.alpha * a + law.beta * b
            value.push(p, panel)
            q, after = bodies.moved(p, velocity)
            q, velocity = np.where(massive, q, p), np.where(massive, after, 0.0)
            value.send(half, panel, q)
            missed = missed + np.sum(bodies.leak * np.abs(q[-1] - p[-1]), axis=0)
            means = value.sent[half, :, panel, 0, 1:-1]
            size = np.maximum(size, np.maximum(np.abs(velocity).max(axis=0), np.abs(means).max(axis=(0, 1))))
            moved.append((p, q))
        return missed, size, velocity, moved

    def _followed(self, lanes: ArrayWaves, window: int, moved: list[tuple[Array, Array]]) -> Array:
        """The series of derivatives on a window. With q'/rate + q = p,

        dq'/rate + dq = dp + drate/rate (p - q).
        """
        half, value, law, slope, massive = window % 2, self._value, self._law, self._slope, self._massive
        assert slope
        lanes.lengthen(value.degree)
        lanes.press(window)
        share = slope.rate / np.where(massive, law.rate, 1.0)
        for panel, (bodies, (push, q)) in enumerate(zip(self._bodies, moved, strict=True)):
            (a, b), (da, db) = value.arriving(half, panel), lanes.arriving(half, panel)
            p = law.alpha * da + law.beta * db + slope.alpha * a[:, None] + slope.beta * b[:, None]
            lanes.push(p, panel)
            p += share * (push - q)[:, None]
            dq, after = bodies.moved(p, lanes.velocity)
            lanes.send(half, panel, np.where(massive, dq, p))
            lanes.velocity = np.where(massive, after, 0.0)
        found = lanes.listen(half, law.gain)
        if slope.gain.any():  # what outputs weigh changes, too
            total = value.total.copy()
            found += value.listen(half, slope.gain)
            value.total = total
        return found

    def _estimated(self, missed: Array) -> Array:
        """Of the largest value of an output, about what `missed`, as a velocity, makes of it: relative to what is
        surely there, infinite where that is nothing though waves have reached it.
        """
        tables = self._tables
        lost = np.zeros((tables.outputs, len(missed)), bool)
        worst = np.zeros_like(missed)
        for output in range(tables.outputs):
            weight = np.abs(self._law.gain[tables.ints("heard_output") == output]).sum(axis=0)
            parts = [tables.strands(section, output) for section in range(tables.sizes["sections"])]
            means = [np.abs(series[part, 0, 0].sum(axis=0)) for series in self.series for part in parts]
            largest = np.max(means, axis=0)
            error = weight * missed
            sure = error < largest
            worst = np.maximum(worst, np.divide(error, largest - error, out=np.zeros_like(missed), where=sure))
            lost[output] = ~sure & (error > 0)
        if np.any(lost & (self.status == 0)):
            worst[np.any(lost & reached(tables, self._law), axis=0)] = np.inf
        return worst


def _changes(tables: ArrayTables, loads: ArrayLaws, strengths: ArrayLaws) -> Array:
    """What each change of a load is: an amplitude times a strength."""
    load, strength = tables.ints("event_load"), tables.ints("event_strength")
    found: Array = tables["event_weight"][:, None] * loads.load[..., load, :] * strengths.strength[..., strength, :]
    return found
