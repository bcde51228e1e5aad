"""What is left of loads and outputs without the modes that are taken, where dashpots take energy: proved.

A state x is how far all points move and how fast, its norm the square root of twice its energy. x' = A x; as energy
only falls, exp(A tau) makes no norm larger, and no sum over k of d_k exp(A (tau - t_k)) makes one more than `in_step`
times as large (von Neumann's inequality). A load starts B; an output is the product with what a load in its place would
start, L. So of a load that is linear between instants, beyond what it would do if it did not change, an output has at
most

    (in_step + steepest) |A^-p (1 - P) L| |A^-q (1 - P) B|,      p + q = 3 - (order of its derivative),

where 1 - P takes away the modes that are taken. It needs none of the others, nor that they are all.

Their energies are known without integrals: that of x and y, <A x, y> + <x, A y> is minus twice what dashpots take of
their velocities. So modes X with X' = r X have <X, Y> = -2 sum c v_X conj(v_Y)/(r_X + conj(r_Y)), and with A g_q =
g_(q - 1), g_0 = B, so follow <g_q, X> from <g_(q-1), X>, and <g_q, g_q> from what the load's own point does to it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wavesym.programs.modes.modal import Numbers

Complex = NDArray[np.complex128]

POWERS = 4
"""p and q are less."""
_UNIT = 2.0**-53


@dataclass(frozen=True)
class Taken:
    """Modes by columns: their `rates`, twice their energies, how far dashpots of `size` are `extended` by them.

    Those that swing stand for themselves and their conjugates, and count twice.
    """

    rates: Complex
    energy: Numbers
    size: Numbers
    extended: Complex

    @property
    def twice(self) -> Numbers:
        """How often each counts."""
        return np.where(self.rates.imag != 0, 2.0, 1.0)

    def products(self) -> tuple[Complex, Complex, Numbers]:
        """<X, Y> of all modes, <X, conj Y>, and in how many roundings they are wrong."""
        moved = self.rates * self.extended
        weighted = self.size[:, None] * moved
        rates = self.rates
        with np.errstate(divide="ignore", invalid="ignore"):
            same = -2 * (weighted.T @ moved.conj()) / (rates[:, None] + rates.conj())
            other = -2 * (weighted.T @ moved) / (rates[:, None] + rates)
            far = np.abs(rates)[:, None] + np.abs(rates)
            off = (
                16 + len(self.size) + far / np.abs(rates[:, None] + rates.conj()) + far / np.abs(rates[:, None] + rates)
            )
        np.fill_diagonal(same, self.energy)
        np.fill_diagonal(off, 16 + len(self.size) + 2 * np.abs(rates) / np.abs(2 * rates))
        return same, other, off


@dataclass(frozen=True)
class Started:
    """What a port starts: its shares in the modes, how far dashpots are extended by it (powers, dashpots), and the
    energies of A^-q B; those below the `least` power are infinite. `shift` is what a moving end adds to <B, X>.
    """

    shares: Complex
    extended: Numbers
    energies: Numbers
    least: int
    shift: Complex


def left(taken: Taken, ports: Sequence[Started]) -> Numbers:
    """|A^-q (1 - P) B| for q = 0, 1, ..., once the first 0, 1, 2, ... modes are taken: (ports, POWERS, modes + 1)."""
    count = len(taken.rates)
    same, other, off = taken.products()
    made = np.full((len(ports), POWERS, count + 1), np.inf)
    lower, lower2 = np.tril(same, -1), np.tril(other, -1)
    rough = (np.abs(lower) + np.abs(lower2)) * np.tril(off, -1)
    own = np.abs(same.diagonal()) + np.abs(other.diagonal())
    for port, row in zip(ports, made, strict=True):
        known = np.conj(taken.rates * port.shares) + port.shift
        size = np.abs(known)
        for q in range(POWERS):
            if q:
                slowed = 2 * (taken.size * port.extended[q]) @ np.conj(taken.rates * taken.extended)
                size = (size + np.abs(slowed)) / np.abs(taken.rates)
                known = -(known + slowed) / np.conj(taken.rates)
            if q < port.least:
                continue
            x = taken.twice * port.shares / (2 * taken.rates ** (q + 1))
            met = np.real(np.conj(x) * known)
            pairs = np.real(x * (lower @ x.conj() + lower2 @ x))
            alone = np.real(np.abs(x) ** 2 * same.diagonal() + x * x * other.diagonal()) / 2
            squares = port.energies[q] + np.cumsum(np.append(0.0, alone + pairs - 2 * met))
            terms = np.abs(x) * (rough @ np.abs(x)) + 32 * np.abs(x) ** 2 * own + 64 * np.abs(x) * size
            wrong = _UNIT * (2 * count + 64) * (port.energies[q] + np.cumsum(np.append(0.0, terms)))
            row[q] = np.sqrt(np.maximum(squares, 0.0) + wrong)
    return made
