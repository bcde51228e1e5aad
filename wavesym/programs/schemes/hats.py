"""The march of a chain under records in NumPy: one hat of each load is marched, and its response added up."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from wavesym.numbers.arrays import Array
from wavesym.programs.schemes.march import Marching, MarchScheme, WindowBlock
from wavesym.programs.schemes.scheme import Scheme


class HatScheme(Scheme):
    """The march of a chain under loads that are linear between samples, however far these are apart.

        output(tau) = rest(tau) + sum over records j and samples i of sample[j, i] hat_j(tau - begin_j - i spacing_j)

    hat_j is what a load does that is 0 at 0, 1 at spacing_j, 0 from 2 spacing_j on, and linear between; `rest`, where
    there is one, is all that is no record. Each is a march of its own (MarchScheme): the numbers of the first are
    called 0.NAME, those of the next 1.NAME. A spacing is the sum of two numbers, as is the instant at which a record
    begins.
    """

    def _read(self, tables: dict[str, tuple[float, ...]], constants: dict[str, float]) -> None:
        real = self.real

        def names(all_names: list[str], march: int) -> dict[str, str]:
            """Those of the numbers of a march, by what it calls them."""
            return {name.partition(".")[2]: name for name in all_names if name.startswith(f"{march}.")}

        marches = [
            MarchScheme(
                {name: tables[full] for name, full in names([*tables], k).items()},
                {name: constants[full] for name, full in names([*constants], k).items()},
                self.tau_max,
                real,
            )
            for k in range(int(constants["marches"]))
        ]
        rest = int(constants["rest"])
        spacing, begin = (np.array(tables[name], real).reshape(-1, 2).tolist() for name in ("spacing", "begin_at"))
        sample, edges = np.array(tables["sample"], real), tables["first_sample"]
        self._records = [
            ShiftedHats(march, spacing[j], begin[j], sample[edges[j] : edges[j + 1]])
            for j, march in enumerate(marches[rest:])
        ]
        self._rest = marches[:rest]
        self.outputs = marches[0].outputs

    def _values(self, tau: Array) -> Array:
        first, *others = [*(rest.evaluate(tau) for rest in self._rest), *(hats.evaluate(tau) for hats in self._records)]
        return np.asarray(sum(others, first))

    def each(self, tau: Array) -> Array:
        """Each output at instants of its own in range: tau and values are (outputs, n)."""
        flat, back = np.unique(tau, return_inverse=True)
        own = back.reshape(tau.shape)
        out = sum((np.take_along_axis(rest.evaluate(flat), own, axis=1) for rest in self._rest), np.zeros(tau.shape))
        return np.asarray(sum((record.each(tau) for record in self._records), out))

    def evenly(self, step: float) -> Array:
        """Instants of the horizon, no more than `step` apart, that lie alike between the samples of the first record.

        There is an even number of equal steps from sample to sample, and at both ends. Values there take one march, and
        a Fourier transform for each place between samples.
        """
        return self._records[0].evenly(step)


class ShiftedHats:
    """One record: `sample[i]` times the response to a hat that begins at begin + i spacing.

    Instants are told by their `phase`, how long after the last hat has begun. At one phase hats are asked for at
    phase, phase + spacing, ..., and what they add up to at all instants of that phase is a convolution.
    """

    KEPT = 1 << 24
    """So many numbers of a march are kept; where there are more it goes on block by block, each time."""
    PAIRS = 1 << 13
    """So many values are read at once."""
    VALUES = 1 << 22
    """So many are held."""
    NEAR = 2.0**-51
    """Phases that differ by no more, in parts of the horizon, are one."""

    def __init__(self, march: MarchScheme, spacing: list[float], begin: list[float], sample: Array) -> None:
        self._march, self._begin, self._sample = march, begin, sample
        # multiples of the first part are exact
        high = spacing[0]
        cut = 2.0 ** (np.ceil(np.log2(high)) - 32)
        self._high = np.floor(high / cut) * cut
        self._low = (high - self._high) + spacing[1]
        self._spacing = high
        self._near = self.NEAR * march.tau_max
        self._windows = int(march.places(np.array([march.tau_max]))[0][0]) + 1
        self._whole: list[WindowBlock] = []

    def evenly(self, step: float) -> Array:
        """As HatScheme has it."""
        parts = 2 * int(np.ceil(self._spacing / (2 * step)))
        begin, last = self._begin[0], self._march.tau_max
        k = np.arange(-np.floor(begin / self._spacing), np.floor((last - begin) / self._spacing) + 1)
        starts = begin + k * self._spacing
        taus = starts[:-1, None] + np.arange(parts) / parts * self._spacing
        ends = (np.linspace(low, high, parts + 1) for low, high in ((0.0, starts[0]), (starts[-1], last)))
        return np.unique(np.clip(np.concatenate([*ends, taus.ravel()]), 0.0, last))

    def evaluate(self, tau: Array) -> Array:
        """All outputs at tau: (outputs, tau.size)."""
        out = np.zeros((self._march.outputs, tau.size))
        latest, phase = self._locate_hats(tau)
        order = np.argsort(phase, kind="stable")
        order = order[latest[order] >= 0]
        if not order.size:
            return out
        groups = np.split(order, self._phase_edges(phase[order]))
        alone = np.array([group[0] for group in groups if len(group) == 1], int)
        if alone.size:
            out[:, alone] = self._single(latest[alone], phase[alone])
        several = [group for group in groups if len(group) > 1]
        at_once = max(1, self.VALUES // (len(out) * len(self._sample) + 1))
        for first in range(0, len(several), at_once):
            some = several[first : first + at_once]
            last = np.array([latest[group].max() for group in some])
            responses = self._responses(last, phase[[group[0] for group in some]])
            for group, response in zip(some, responses, strict=True):
                out[:, group] = self._convolve(response)[:, latest[group]]
        return out

    def each(self, tau: Array) -> Array:
        """Each output at instants of its own: tau and values are (outputs, n). All of them take one march."""
        latest, phase = self._locate_hats(tau)
        out = np.zeros(tau.shape)
        for block in self._blocks():
            for output, row in enumerate(out):
                own = latest[output], phase[output], range(output, output + 1)
                for q, m, values in self._read(block, *own):
                    row += self._weigh(latest[output], q, m, values[0])
        return out

    def _locate_hats(self, tau: Array) -> tuple[NDArray[np.int_], Array]:
        """Of each tau the number of the hat that began last, and how long ago."""
        since, lost = _difference(tau, self._begin[0])
        lost = lost - self._begin[1]
        number = np.floor(since / self._spacing)
        number += np.floor(self._phase(since, lost, number) / self._spacing)
        phase = self._phase(since, lost, number)
        # rounding may leave an instant of a sample just before it
        after = phase > self._spacing - self._near
        return (number + after).astype(int), np.where(after, 0.0, np.maximum(phase, 0.0))

    def _phase(self, since: Array, lost: Array, number: Array) -> Array:
        """since + lost - number spacing, rounded once."""
        phase, more = _difference(since, number * self._high)
        return np.asarray(phase + ((lost + more) - number * self._low))

    def _phase_edges(self, phase: Array) -> list[int]:
        """Where, in order, a phase begins that differs from the one before by more than rounding makes of one."""
        found = []
        first = 0
        while (first := int(np.searchsorted(phase, phase[first] + self._near, side="right"))) < phase.size:
            found.append(first)
        return found

    def _blocks(self) -> "Iterator[WindowBlock]":
        """The march, block by block; all of it at once where it is not too large, and then only once."""
        if self._whole:
            yield from self._whole
            return
        each = len(self._march.held) * self._march.panels * (self._march.degree + 1)
        marching = Marching(self._march, self._windows if each * self._windows <= self.KEPT else None)
        for first in range(0, self._windows, marching.most):
            block = marching.block(first, min(marching.most, self._windows - first))
            if marching.most == self._windows:
                self._whole.append(block)
            yield block

    def _read(
        self, block: WindowBlock, latest: NDArray[np.int_], phase: Array, outputs: range | None = None
    ) -> "Iterator[tuple[NDArray[np.int_], NDArray[np.int_], Array]]":
        """What a block has of the response to one hat at phase[q] + m spacing, m = 0 ... latest[q]: q, m and all
        outputs, or some; some instants at a time."""
        step = float(self._march.step)
        until = block.first + block.count
        low = np.floor((block.first * step - phase) / self._spacing).astype(int) - 1
        high = np.ceil((until * step - phase) / self._spacing).astype(int) + 1
        low, high = np.maximum(low, 0), np.minimum(high, latest)
        counts = np.maximum(high - low + 1, 0)
        ends = np.cumsum(counts)
        for first in range(0, int(ends[-1]), self.PAIRS):
            pair = np.arange(first, min(first + self.PAIRS, int(ends[-1])))
            q = np.searchsorted(ends, pair, side="right")
            m = low[q] + (pair - (ends - counts)[q])
            window, place, t = self._places(m, phase[q])
            here = (window >= block.first) & (window < until)
            yield q[here], m[here], block.read_places(window[here], place[here], t[here], outputs)

    def _places(self, m: NDArray[np.int_], phase: Array) -> tuple[NDArray[np.int_], NDArray[np.int_], Array]:
        """Of phase + m spacing what MarchScheme.places says, without the rounding of a large number."""
        march = self._march
        far = m * self._high
        cycle = np.floor(far / march.span)
        t = (far - cycle * march.span) + (phase + m * self._low)
        more = np.floor(t / march.span)
        t, cycle = np.maximum(t - more * march.span, 0.0), cycle + more
        place = np.searchsorted(march.begin, t, side="right") - 1
        return cycle.astype(int) * len(march.begin) + place, place, t

    def _single(self, latest: NDArray[np.int_], phase: Array) -> Array:
        """Outputs at instants of different phases, added up hat by hat."""
        out = np.zeros((self._march.outputs, latest.size))
        for block in self._blocks():
            for q, m, values in self._read(block, latest, phase):
                for total, row in zip(out, values, strict=True):
                    total += self._weigh(latest, q, m, row)
        return out

    def _weigh(self, latest: NDArray[np.int_], q: NDArray[np.int_], m: NDArray[np.int_], values: Array) -> Array:
        """What hats add to instants: values to those q, each times the sample of the hat m before the latest."""
        return np.asarray(np.bincount(q, values * self._sample[latest[q] - m], minlength=latest.size), np.float64)

    def _responses(self, latest: NDArray[np.int_], phase: Array) -> Array:
        """Those to one hat at all m, for some phases: (phases, outputs, m)."""
        made = np.zeros((latest.size, self._march.outputs, int(latest.max()) + 1))
        for block in self._blocks():
            for q, m, values in self._read(block, latest, phase):
                made[q, :, m] = values.T
        return made

    def _convolve(self, response: Array) -> Array:
        """sum over i of sample[i] response[:, n - i]: (outputs, n)."""
        count = response.shape[1]
        size = 1 << (2 * count - 1).bit_length()
        spectrum = np.fft.rfft(response, size) * np.fft.rfft(self._sample[:count], size)
        return np.asarray(np.fft.irfft(spectrum, size)[:, :count])


def _difference(one: Array, other: Array | float) -> tuple[Array, Array]:
    """one - other, rounded, and what rounding has lost of it."""
    rounded = np.asarray(one - other)
    back = rounded - one
    return rounded, (one - (rounded - back)) - (other + back)
