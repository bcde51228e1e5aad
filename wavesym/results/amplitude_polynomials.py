"""Transfer functions on balls of frequency, as Taylor polynomials with proved rests, and their amplitudes squared."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import comb
from typing import Protocol

from flint import acb, acb_series, arb, arb_poly

from wavesym.exact.modes.harmonic import Quantity
from wavesym.exact.modes.lowest_terms import LowestTerms
from wavesym.results.transfer import Transfer

_TERMS = 9  # of Taylor polynomials: with the rest 10, which power series are cut at (ctx.cap)
_LOOKS = 96  # at parts of such a polynomial
_ROUNDED = arb(2) ** -20  # of a radius: what rounding adds to it, in a few products


class Transfers(Protocol):
    """Amplitudes of some outputs as functions of the frequency."""

    def __call__(self, w: Quantity) -> list[Quantity]:
        """Those at a frequency, or on all of a ball."""

    def parts(self, w: Quantity) -> tuple[list[Quantity], Quantity] | None:
        """The same as numerators and one divisor without poles, where that can be."""

    def has_pole(self, k: int, low: arb, high: arb) -> bool:
        """Whether it is proved that output k has one between two frequencies."""

    def lowest_terms(self, k: int) -> LowestTerms | None:
        """Output k without common factors, where that can be and is more than it has."""


@dataclass(frozen=True)
class TransferFractions:
    """The transfer functions on a ball: a numerator for each output and one divisor, of which none has a pole there.

    Each is a Taylor polynomial about the middle, and with its last coefficient the rest, which the next one on the
    whole ball bounds. So balls are not blown up by what cancels part by part.
    """

    numerators: list[list[acb]]
    divisor: list[acb]

    def quotients(self, reach: arb) -> list[Quantity]:
        """The transfer functions, their slopes and half their second derivatives on all of a ball, as power series."""
        divisor = _on_ball(self.divisor, reach)
        if divisor[0].contains(0):
            return [acb_series([acb("nan"), 0, 0], prec=3)] * len(self.numerators)
        return [acb_series(_on_ball(each, reach), prec=3) / acb_series(divisor, prec=3) for each in self.numerators]

    def stays_below(self, k: int, square: arb, half: arb) -> bool:
        """Whether an amplitude squared is less than so much within `half` of the middle, looked at in parts."""
        excess = _square_of(self.numerators[k]) - square * _square_of(self.divisor)
        left = [(excess, half)]
        for _ in range(_LOOKS):
            if not left:
                return True
            part, half = left.pop()
            first, *others = part.coeffs() or [arb(0)]
            if first + sum((abs(c) * half**n for n, c in enumerate(others, 1)), start=arb(0)) < 0:
                continue
            if not first < 0:
                return False
            half = half / 2
            left += [(part(arb_poly([sign * half, 1])), half) for sign in (-1, 1)]
        return False


def reaches_zero(w: arb) -> bool:
    """Whether 0 is in a ball, or so near to it that a product of the ball may have it: then it has no power series."""
    return not w > w.rad() * _ROUNDED


def _square_of(powers: Sequence[acb]) -> arb_poly:
    """The absolute value squared of a polynomial of a real number."""
    re, im = arb_poly([each.real for each in powers]), arb_poly([each.imag for each in powers])
    return re * re + im * im


def transfer_fractions(transfer: Transfers, w: arb) -> TransferFractions | None:
    """None near 0, and where transfer functions are no such fractions."""
    if reaches_zero(w):
        return None
    middle = acb_series([acb(w.mid()), 1], prec=_TERMS)
    near, around = transfer.parts(middle), transfer.parts(acb_series([acb(w), 1], prec=_TERMS + 1))
    if near is None or around is None:
        return None
    *numerators, divisor = (
        _taylor(coefficients(one, _TERMS), coefficients(all_, _TERMS + 1)[-1])
        for one, all_ in zip([*near[0], near[1]], [*around[0], around[1]], strict=True)
    )
    return TransferFractions(numerators, divisor)


def squared_amplitudes(
    transfer: Transfers, w: arb, fractions: TransferFractions | None = None
) -> list[tuple[arb, arb, arb]]:
    """Of each output the square of the amplitude, its slope, and half its second derivative, on all of a ball.

    The last two are 0 where it reaches 0: there the first alone says something.
    """
    if reaches_zero(w):
        sizes = (abs(acb(value)) for value in transfer(w))
        return [(size * size, arb(0), arb(0)) for size in sizes]
    made = []
    for value in power_series(transfer, w, fractions):
        c = coefficients(value, 3)
        re, im = [each.real for each in c], [each.imag for each in c]
        made.append(
            (
                re[0] * re[0] + im[0] * im[0],
                2 * (re[0] * re[1] + im[0] * im[1]),
                re[1] * re[1] + im[1] * im[1] + 2 * (re[0] * re[2] + im[0] * im[2]),
            )
        )
    return made


def power_series(transfer: Transfers, w: arb, fractions: TransferFractions | None) -> list[Quantity]:
    """The transfer functions, their slopes and half their second derivatives on all of a ball, as power series."""
    series = acb_series([acb(w), 1], prec=3)
    if fractions is None:
        return transfer(series)
    found = fractions.quotients(arb(0, w.rad()))
    if isinstance(transfer, Transfer) and transfer.imposed_outputs:
        direct = transfer(series)
        for k in transfer.imposed_outputs:
            found[k] = direct[k]
    return found


def _taylor(powers: Sequence[acb], following: acb) -> list[acb]:
    """A polynomial, and as its last coefficient all that the next one may be on a ball."""
    size = abs(following).upper()
    return [*powers, acb(arb(0, size), arb(0, size))]


def _on_ball(powers: Sequence[acb], reach: arb) -> list[acb]:
    """A function, its slope and half its second derivative at all distances within reach of where powers are of."""
    made = []
    for order in range(3):
        value = acb(0)
        for k in reversed(range(order, len(powers))):
            value = value * reach + powers[k] * comb(k, order)
        made.append(value)
    return made


def coefficients(value: Quantity, count: int) -> list[acb]:
    """The first coefficients of a power series, or of what does not change."""
    found = [acb(each) for each in (value.coeffs() if isinstance(value, acb_series) else [value])]
    return [*found, *[acb(0)] * (count - len(found))][:count]
