"""The residual of loads and outputs without the modes that are taken, where dashpots take energy: proved.

A state x is how far all points move and how fast, its norm the square root of twice its energy. x' = A x; as energy
only falls, exp(A tau) makes no norm larger, and no sum over k of d_k exp(A (tau - t_k)) makes one more than `in_step`
times as large (von Neumann's inequality). A load starts B; an output is the product with what a load in its place would
start, L. So of a load that is linear between instants, beyond what it would do if it did not change, an output has at
most

    (in_step + steepest) |A^-p (1 - P) L| |A^-q (1 - P) B|,      p + q = 3 - (order of its derivative),

where 1 - P takes away the modes that are taken. It needs none of the others, nor that they are all.

Their energies are known without integrals: that of x and y, <A x, y> + <x, A y> is minus twice what dashpots take of
their velocities. So modes X with X' = r X have <X, Y> = -2 sum c v_X conj(v_Y)/(r_X + conj(r_Y)), and with A g_q = g_(q
- 1), g_0 = B, so follow <g_q, X> from <g_(q-1), X>, and <g_q, g_q> from what the load's own point does to it.

These products are computed in balls. Most of what is started is in few slow modes. These are taken away in balls, so
that what is left is not lost in the rounding of what is not.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from flint import acb, acb_mat, arb

from wavesym.exact.modes.shape import Mode
from wavesym.exact.modes.stiffness import Quantity
from wavesym.numbers.arrays import Array, Complex
from wavesym.numbers.doubles import nearest
from wavesym.programs.modes.harmonic_response import TERMS, Dashpot, SlowPort

POWERS = 4
"""p and q are less."""
_UNIT = 2.0**-53


@dataclass(frozen=True)
class ModeEnergies:
    """Modes by columns: their `rates`, twice their energies, how fast dashpots of `size` are extended in them.

    `finer` is what imaginary parts of rates are beyond doubles, as they may differ by little. Modes that swing stand
    for themselves and their conjugates, and count twice.
    """

    rates: Complex
    finer: Array
    energy: Array
    size: Array
    extension_rates: Complex

    @property
    def twice(self) -> Array:
        """How often each counts."""
        return np.where(self.rates.imag != 0, 2.0, 1.0)

    def later_modes(self, first: int) -> ModeEnergies:
        """All but the first ones."""
        later = slice(first, None)
        return ModeEnergies(
            self.rates[later], self.finer[later], self.energy[later], self.size, self.extension_rates[:, later]
        )

    def products(self) -> tuple[Complex, Complex]:
        """<X, Y> of all modes, and <X, conj Y>, each wrong by a few roundings for each dashpot.

        Modes of equal branches that swing for ever at one frequency are at right angles.
        """
        weighted = self.size[:, None] * self.extension_rates
        rates = self.rates
        with np.errstate(divide="ignore", invalid="ignore"):
            swing = (rates.imag[:, None] - rates.imag) + (self.finer[:, None] - self.finer)
            same = -2 * (weighted.T @ self.extension_rates.conj()) / (rates.real[:, None] + rates.real + 1j * swing)
            other = -2 * (weighted.T @ self.extension_rates) / (rates[:, None] + rates)
            same[(rates.real[:, None] + rates.real == 0) & (swing == 0)] = 0.0
        np.fill_diagonal(same, self.energy)
        return same, other


@dataclass(frozen=True)
class PortResponse:
    """What a port starts, in balls or in doubles: its shares in modes; |A^-q B|^2 for each q from the `least` on, and
    the `mode_products` <A^-q B, X> of all modes, (POWERS, modes)."""

    shares: Any
    energies: Any
    mode_products: Any
    least: int

    def to_doubles(self, first: int) -> PortResponse:
        """Balls rounded, without the first modes."""
        return PortResponse(
            np.array([complex(b) for b in self.shares[first:]], complex),
            np.array([max(float(each.upper()) * _ABOVE, 0.0) for each in self.energies]),
            np.array([[complex(h) for h in row[first:]] for row in self.mode_products], complex),
            self.least,
        )


def residual_norms(energies: ModeEnergies, ports: Sequence[PortResponse]) -> Array:
    """|A^-q (1 - P) B| for q = 0, 1, ..., once the first 0, 1, 2, ... modes are taken: (ports, POWERS, modes + 1)."""
    count = len(energies.rates)
    same, other = energies.products()
    made = np.full((len(ports), POWERS, count + 1), np.inf)
    lower, lower2 = np.tril(same, -1), np.tril(other, -1)
    rough = np.abs(lower) + np.abs(lower2)
    own = np.abs(same.diagonal()) + np.abs(other.diagonal())
    roundings = _UNIT * (2 * count + 64 + 8 * len(energies.size))
    for port, row in zip(ports, made, strict=True):
        for q in range(port.least, POWERS):
            x = energies.twice * port.shares / (2 * energies.rates ** (q + 1))
            met = np.real(np.conj(x) * port.mode_products[q])
            pairs = np.real(x * (lower @ x.conj() + lower2 @ x))
            alone = np.real(np.abs(x) ** 2 * same.diagonal() + x * x * other.diagonal()) / 2
            squares = port.energies[q] + np.cumsum(np.append(0.0, alone + pairs - 2 * met))
            size = np.abs(x)
            terms = size * (rough @ size) + size**2 * own + 2 * size * np.abs(port.mode_products[q])
            wrong = roundings * (port.energies[q] + np.cumsum(np.append(0.0, terms)))
            row[q] = np.sqrt(np.maximum(squares, 0.0) + wrong)
    return made


_STILL = 2.0**-80  # of a frequency: what dies away more slowly does not in doubles
_SLOW = 32  # modes that are taken away in balls
_ABOVE = 1 + 2.0**-50


class Dissipation:
    """Modes that die away: their rates, how far dashpots are extended in them, and twice their energies."""

    def __init__(self, modes: Sequence[Mode], dashpots: Sequence[Dashpot]) -> None:
        self._dashpots, self._sizes = dashpots, [arb(dashpot.size) for dashpot in dashpots]
        self.rates = [_rate(mode.frequency) for mode in modes]
        self._extended = [[_sum(dashpot, mode.points) for dashpot in dashpots] for mode in modes]
        self._fast = [[rate * e for e in row] for rate, row in zip(self.rates, self._extended, strict=True)]
        self._energies = [self._energy(rate, fast) for rate, fast in zip(self.rates, self._fast, strict=True)]

    def residual_norms(self, ports: Sequence[SlowPort], shares: Sequence[Sequence[acb]]) -> Array:
        """What is left of ports once the first 0, 1, 2, ... modes are taken: (ports, POWERS, modes + 1)."""
        responses = [self._response(port, row) for port, row in zip(ports, shares, strict=True)]
        energies = self._energies_in_doubles()
        made = residual_norms(energies, [response.to_doubles(0) for response in responses])
        slow = min(_SLOW, len(self.rates))
        deflated = [response.to_doubles(slow) for response in self._remove_modes(responses, slow)]
        made[:, :, slow:] = np.minimum(made[:, :, slow:], residual_norms(energies.later_modes(slow), deflated))
        return made

    def _energy(self, rate: acb, fast: Sequence[acb]) -> arb:
        if not rate.real < 0:
            return 2 * abs(rate) ** 2  # that of a mass of 1
        return arb(-self._dissipation(fast, fast).real / rate.real)

    def _dissipation(self, one: Sequence[Quantity], other: Sequence[Quantity]) -> Quantity:
        """What dashpots take of two states."""
        return sum((c * a * b.conjugate() for c, a, b in zip(self._sizes, one, other, strict=True)), acb(0))

    def _product(self, k: int, n: int, conjugate: bool) -> acb:
        """That of a mode, or its conjugate, and another one."""
        if k == n and not conjugate:
            return acb(self._energies[k])
        rate, fast = self.rates[k], self._fast[k]
        if conjugate:
            rate, fast = rate.conjugate(), [v.conjugate() for v in fast]
        if (rate + self.rates[n].conjugate()).contains(0):  # equal branches that swing for ever, at right angles
            return acb(0)
        return acb(-2 * self._dissipation(fast, self._fast[n]) / (rate + self.rates[n].conjugate()))

    def _response(self, port: SlowPort, shares: Sequence[acb]) -> PortResponse:
        moved = [
            [acb(_sum(dashpot, [q[k] for q in port.point_motions])) for dashpot in self._dashpots] for k in range(TERMS)
        ]
        zero = [acb(0)] * len(self._dashpots)

        def fast(q: int) -> list[acb]:
            """How fast dashpots are extended by A^-q of what it starts."""
            k = q - 2 + port.order
            return [-each for each in moved[k]] if k >= 0 else zero

        energies = []
        for q in range(POWERS):
            if port.order:
                energy = port.reads[2 * q + 2] - 2 * self._dissipation(moved[0], moved[2 * q + 1]).real
            else:
                energy = -port.reads[2 * q - 2] if q else port.impulse_energy
            for j in range(q - 1, -1, -1):
                energy = -2 * self._dissipation(fast(q + j + 1), fast(q - j)).real - energy
            energies.append(energy)
        known = [(rate * b).conjugate() for rate, b in zip(self.rates, shares, strict=True)]
        if port.order:
            known = [h + 2 * self._dissipation(moved[0], e) for h, e in zip(known, self._extended, strict=True)]
        rows = [known]
        for q in range(1, POWERS):
            acting = fast(q)
            pairs = zip(known, self._fast, self.rates, strict=True)
            known = [-(h + 2 * self._dissipation(acting, v)) / rate.conjugate() for h, v, rate in pairs]
            rows.append(known)
        return PortResponse(shares, energies, rows, port.least)

    def _remove_modes(self, responses: Sequence[PortResponse], slow: int) -> list[PortResponse]:
        """What ports start but for their parts in the first modes."""
        if not slow:
            return list(responses)
        columns = [
            [part(rate, b) / rate ** (q + 1) for rate, b in zip(self.rates[:slow], each.shares, strict=False)]
            for each in responses
            for q in range(POWERS)
        ]
        both = [
            [*(self._product(k, n, False) for k in range(slow)), *(self._product(k, n, True) for k in range(slow))]
            for n in range(len(self.rates))
        ]
        halves = acb_mat([[x / 2 for x in column] + [x.conjugate() / 2 for x in column] for column in columns])
        parts = acb_mat(both) * halves.transpose()
        made, column = [], 0
        for each in responses:
            energies, rows = [], []
            for q in range(POWERS):
                row = [h - parts[n, column] for n, h in enumerate(each.mode_products[q])]
                mixed = zip(columns[column], each.mode_products[q], row, strict=False)
                taken = sum(((x.conjugate() * (h + rest)).real for x, h, rest in mixed), arb(0))
                energies.append(each.energies[q] - taken)
                rows.append(row)
                column += 1
            made.append(PortResponse(each.shares, energies, rows, each.least))
        return made

    def _energies_in_doubles(self) -> ModeEnergies:
        rates = np.array([complex(rate) for rate in self.rates], complex)
        return ModeEnergies(
            rates=rates,
            finer=np.array([float(a.imag - b.imag) for a, b in zip(self.rates, rates.tolist(), strict=True)]),
            energy=np.array([float(energy) for energy in self._energies]),
            size=np.array([nearest(dashpot.size) for dashpot in self._dashpots]),
            extension_rates=complexes([list(row) for row in zip(*self._fast, strict=True)], len(rates)),
        )


def complexes(rows: Sequence[Sequence[Quantity]], columns: int) -> Complex:
    """Balls rounded to doubles."""
    return np.array([[complex(value) for value in row] for row in rows], complex).reshape(len(rows), columns)


def _rate(frequency: acb) -> acb:
    """That of exp(rate tau). It is 0 but for its imaginary part where that dies away too slowly to be seen."""
    fades = frequency.imag > abs(frequency) * _STILL
    return acb(-frequency.imag if fades else 0, frequency.real)


def part(rate: acb, share: acb) -> acb:
    """A share of one mode of a pair, or of one alone, so that a share over its rate counts for all of it."""
    return share if rate.imag != 0 else share / 2


def _sum(dashpot: Dashpot, points: Sequence[Quantity]) -> Quantity:
    """How far a dashpot is extended."""
    return sum((points[point] * weight for point, weight in dashpot.points.items()), arb(0))
