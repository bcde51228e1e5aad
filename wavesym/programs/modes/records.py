"""Many records through one structure: its response to a load that is one sample high, and Fourier transforms.

A load that is linear between samples is a sum of hats, each 1 at its sample and 0 at all others; outputs at the samples
are the convolution of the samples with the outputs under one hat. (A ramp would do, too, and lose four digits to its
second differences.) What loads and their integrals do themselves is summed up as it is in a single run.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from flint import fmpq
from numpy.typing import NDArray

from wavesym.numbers.doubles import nearest
from wavesym.numbers.reals import DOUBLE
from wavesym.programs.modes.loads import LinearLoads
from wavesym.programs.modes.modal import ModalSystem, Numbers
from wavesym.programs.modes.tables import scheme_tables
from wavesym.programs.schemes.modes import ModesScheme


@dataclass(frozen=True)
class HatResponse:
    """A system's outputs under records of at most `count` samples that are `spacing` apart in tau, at the samples.

    `spectra` (loads, outputs, frequencies) are the transforms of the outputs under a hat, of `size` samples.
    """

    system: ModalSystem
    spacing: float
    count: int
    size: int
    spectra: NDArray[np.complex128]

    def respond(self, samples: Numbers) -> Numbers:
        """All outputs at the samples of records: (records, outputs, n).

        `samples` are (records, n), or (records, n, loads). A record rises to its first sample from 0 within the step
        before it. ValueError for one that is too long.
        """
        given = np.asarray(samples, dtype=np.float64)
        given = given.reshape(*given.shape[:2], -1)
        records, n, loads = given.shape
        if n > self.count or loads != len(self.spectra):
            raise ValueError(
                f"{n} samples of {loads} loads given, at most {self.count} of {len(self.spectra)} expected"
            )
        values = np.empty((records, len(self.system.direct), n))
        for value, record in zip(values, given, strict=True):
            spectrum = np.fft.rfft(record.T, self.size)
            value[:] = np.fft.irfft(np.einsum("jf,jof->of", spectrum, self.spectra), self.size)[:, :n]
            value += self._direct(record)
        return values

    def _direct(self, record: Numbers) -> Numbers:
        """What the loads and their integrals count in the outputs: (outputs, n)."""
        h = self.spacing
        before = np.vstack([np.zeros_like(record[:1]), record[:-1]])
        once = np.cumsum(h * (before + record) / 2, axis=0)
        begun = np.vstack([np.zeros_like(once[:1]), once[:-1]])
        twice = np.cumsum(h * begun + h * h * (2 * before + record) / 6, axis=0)
        direct = self.system.direct
        return np.asarray(sum(direct[:, :, k] @ part.T for k, part in enumerate((record, once, twice))))


def hat_response(system: ModalSystem, spacing: fmpq, count: int) -> HatResponse:
    """The response of a system to a hat of each of its loads."""
    size = _smooth(2 * count)
    modal = replace(system, direct=np.zeros_like(system.direct))
    loads = system.pushes.shape[1]
    times = tuple(spacing * k for k in range(count + 1))
    spectra = []
    for load in range(loads):
        hat = [tuple(fmpq(k == 1 and j == load) for j in range(loads)) for k in range(count + 1)]
        given = LinearLoads(times, tuple(hat), (fmpq(0),) * loads)
        last = nearest(times[-1])
        scheme = ModesScheme(scheme_tables(modal, given, DOUBLE), {"loads": loads}, last, np.float64)
        spectra.append(np.fft.rfft(scheme.evaluate(list(map(nearest, times[1:]))), size))
    return HatResponse(system, nearest(spacing), count, size, np.array(spectra))


def _smooth(least: int) -> int:
    """The smallest number from `least` on that has no prime factors but 2, 3 and 5."""
    size = least
    while True:
        rest = size
        for prime in (2, 3, 5):
            while rest % prime == 0:
                rest //= prime
        if rest == 1:
            return size
        size += 1
