"""All sets of parameters, marched to the horizon together."""

from __future__ import annotations

import numpy as np
from numpy.polynomial.chebyshev import chebval

from wavesym.programs.runtime.arrays.joints import ArrayJoints
from wavesym.programs.runtime.arrays.laws import allowed, array_laws, array_slopes, finite
from wavesym.programs.runtime.arrays.nodes import ArrayNodes
from wavesym.programs.runtime.arrays.tables import ArrayTables
from wavesym.programs.runtime.degree import raised
from wavesym.programs.runtime.engine import Array

_LENIENT = 64.0  # a derivative may miss so much more of itself than a value


class ArrayMarch:
    """Of the sets that are the rows of `given`: their `status` and `estimate`, and `series`, of each window an array of
    shape (strands, degree + 2, 1 + lanes, sets). There are `lanes`, derivatives by the parameters, where asked for.

    All sets have the degree of the one that needs most. One that is refused goes on with the scene's own parameters.
    """

    def __init__(self, tables: ArrayTables, given: Array, *, lanes: bool = False) -> None:
        self._tables = tables
        motion: type[ArrayNodes | ArrayJoints] = ArrayJoints if tables.kind == "joints" else ArrayNodes
        laws = tables.laws
        own = np.array([float(value) for field in laws.fields for value in field.values])
        with np.errstate(all="ignore"):
            own_laws = array_laws(laws, given)
            fine = allowed(laws, given, laws.every) & finite(own_laws) & motion.serves(tables, own_laws)
            if lanes:
                fine &= allowed(laws, given, laws.every_slope) & finite(array_slopes(laws, given))
        self.status = np.where(fine, 0, 1).astype(np.int32)
        given = np.where(fine[:, None], given, own)
        self._law = array_laws(laws, given)
        self._motion = motion(tables, self._law, array_slopes(laws, given) if lanes else None)
        self._motion.tabulate()
        self._missed, self._size = np.zeros((2, len(given)))
        self._sizes: Array = np.zeros(1)  # of derivatives
        with np.errstate(all="ignore"):  # sets that are refused on the way may grow beyond all numbers
            self.series = [self._window(window) for window in range(tables.sizes["windows"])]
            heard = sum(4.0 * len(each[0]) * np.abs(each).sum(axis=(0, 1, 2)) for each in self.series)
            degree = self._motion.value.degree
            rounded = tables.unit * (degree + tables.sizes["windows"] + degree * degree / 16)
            missed = 6 * self._missed + rounded * self._size
            self.estimate = self._estimated(missed)
        self.status[(self.status == 0) & ~np.isfinite(self._size + missed + heard)] = 1
        self.estimate[self.status != 0] = np.nan

    def _window(self, window: int) -> Array:
        """The series of a window, at the lowest degree, raised by quarters, that misses no more than its share."""
        motion, highest = self._motion, self._tables.sizes["degree"]
        motion.press(window)
        share = self._tables.share
        while True:
            leak, here = motion.tried(window)
            size = np.maximum(self._size, here)
            late = (self.status == 0) & ~(leak <= share * size)
            if motion.value.degree == highest or not late.any():
                missed, here = motion.followed_all(window)
                sizes = np.maximum(self._sizes, here)
                behind = (self.status == 0) & ~(missed <= _LENIENT * share * sizes)
                if motion.value.degree == highest or not behind.any():
                    break
            motion.lengthen(min(raised(motion.value.degree), highest))
        self._sizes = sizes
        self.status[late] = np.where(np.isfinite(leak + size), 2, 1)[late]
        self._missed += leak
        self._size = size
        motion.settled()
        return motion.heard(window)

    def _estimated(self, missed: Array) -> Array:
        """Of the largest value of an output, about what `missed`, as a velocity, makes of it: relative to what is
        surely there, infinite where that is nothing though waves have reached it.
        """
        tables = self._tables
        lost = np.zeros((tables.outputs, len(missed)), bool)
        worst = np.zeros_like(missed)
        for output in range(tables.outputs):
            weight = np.abs(self._law["gain"][tables.ints("heard_output") == output]).sum(axis=0)
            largest = self._largest(output)
            error = (weight + tables.faint) * missed * (tables.ints("silent")[output] == 0)
            sure = error < largest
            worst = np.maximum(worst, np.divide(error, largest - error, out=np.zeros_like(missed), where=sure))
            lost[output] = ~sure & (error > 0)
        if np.any(lost & (self.status == 0)):
            worst[np.any(lost & self._motion.reached(), axis=0)] = np.inf
        return worst

    def _largest(self, output: int) -> Array:
        """The largest value in the middle of a section, as far as these lie on the horizon."""
        tables = self._tables
        largest = np.zeros_like(self._missed)
        for window, series in enumerate(self.series):
            begun = float(tables.begins(np.array(window)))
            phase = window % tables.cycle
            for section in range(tables.sizes["sections"]):
                begin, end = tables.section(phase, section)
                end = min(end, tables.tau_max - begun)
                middle = np.array(begin + (end - begin) / 2)
                if begin <= end:
                    strands = tables.strands(section, output)
                    value = sum(chebval(float(tables.on(s, middle, phase)), series[s, :, 0]) for s in strands)
                    largest = np.maximum(largest, np.abs(value))
        return largest
