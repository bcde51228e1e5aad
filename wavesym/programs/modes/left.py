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
    """Modes by columns: their `rates`, twice their energies, how fast dashpots of `size` are `extended` in them.

    `finer` is what imaginary parts of rates are beyond doubles, as they may differ by little. Modes that swing stand
    for themselves and their conjugates, and count twice.
    """

    rates: Complex
    finer: Numbers
    energy: Numbers
    size: Numbers
    extended: Complex

    @property
    def twice(self) -> Numbers:
        """How often each counts."""
        return np.where(self.rates.imag != 0, 2.0, 1.0)

    def after(self, first: int) -> Taken:
        """All but the first ones."""
        later = slice(first, None)
        return Taken(self.rates[later], self.finer[later], self.energy[later], self.size, self.extended[:, later])

    def products(self) -> tuple[Complex, Complex]:
        """<X, Y> of all modes, and <X, conj Y>, each wrong by a few roundings for each dashpot."""
        weighted = self.size[:, None] * self.extended
        rates = self.rates
        with np.errstate(divide="ignore", invalid="ignore"):
            swing = (rates.imag[:, None] - rates.imag) + (self.finer[:, None] - self.finer)
            same = -2 * (weighted.T @ self.extended.conj()) / (rates.real[:, None] + rates.real + 1j * swing)
            other = -2 * (weighted.T @ self.extended) / (rates[:, None] + rates)
        np.fill_diagonal(same, self.energy)
        return same, other


@dataclass(frozen=True)
class Started:
    """What a port starts: its shares in modes; |A^-q B|^2 for each q from the `least` on, and <A^-q B, X> of all modes,
    (POWERS, modes)."""

    shares: Complex
    energies: Numbers
    known: Complex
    least: int


def left(taken: Taken, ports: Sequence[Started]) -> Numbers:
    """|A^-q (1 - P) B| for q = 0, 1, ..., once the first 0, 1, 2, ... modes are taken: (ports, POWERS, modes + 1)."""
    count = len(taken.rates)
    same, other = taken.products()
    made = np.full((len(ports), POWERS, count + 1), np.inf)
    lower, lower2 = np.tril(same, -1), np.tril(other, -1)
    rough = np.abs(lower) + np.abs(lower2)
    own = np.abs(same.diagonal()) + np.abs(other.diagonal())
    roundings = _UNIT * (2 * count + 64 + 8 * len(taken.size))
    for port, row in zip(ports, made, strict=True):
        for q in range(port.least, POWERS):
            x = taken.twice * port.shares / (2 * taken.rates ** (q + 1))
            met = np.real(np.conj(x) * port.known[q])
            pairs = np.real(x * (lower @ x.conj() + lower2 @ x))
            alone = np.real(np.abs(x) ** 2 * same.diagonal() + x * x * other.diagonal()) / 2
            squares = port.energies[q] + np.cumsum(np.append(0.0, alone + pairs - 2 * met))
            size = np.abs(x)
            terms = size * (rough @ size) + size**2 * own + 2 * size * np.abs(port.known[q])
            wrong = roundings * (port.energies[q] + np.cumsum(np.append(0.0, terms)))
            row[q] = np.sqrt(np.maximum(squares, 0.0) + wrong)
    return made
