"""The mean, the root mean square and the last value of an output on a horizon, proved: of its pieces in balls.

On a piece from tau = a of length l the output is p(t) + e, |e| <= r, with t from -1 to 1, so

    integral of y   = l/2 * (integral of p   over [-1, 1]) + e,  |e| <= l r
    integral of y^2 = l/2 * (integral of p^2 over [-1, 1]) + e,  |e| <= l r (2 max |p| + r)
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from flint import arb, arb_poly, fmpq

from wavesym.exact.output_piece import Piece


@dataclass(frozen=True)
class Averages:
    """The `mean` and the root mean square, `rms`, over a horizon, and the value at its end, `residual`, as balls."""

    mean: arb
    rms: arb
    residual: arb

    @property
    def radius(self) -> arb:
        """How far from the middles they may be."""
        return self.mean.rad().max(self.rms.rad()).max(self.residual.rad())


NO_AVERAGES = Averages(arb(0), arb(0), arb(0))


def averages(pieces: Iterable[Piece], until: fmpq) -> Averages:
    """The averages of an output over [0, until].

    Args:
        pieces: in order of time; between them may be what holds no double, 2^-52 of the horizon at most.
        until: the end of the last one, dimensionless.
    """
    integral, squares, last = arb(0), arb(0), arb(0)
    for piece in pieces:
        polynomial, length = piece.polynomial, arb(piece.length)
        error = piece.radius
        integral += length * (_integral(polynomial) / 2 + arb(0, error.upper()))
        squares += length * (
            _integral(polynomial * polynomial) / 2 + arb(0, (error * (2 * piece.largest + error)).upper())
        )
        last = polynomial(arb(1)) + arb(0, error.upper())
    square = squares / arb(until)
    return Averages(integral / arb(until), square.max(arb(0)).sqrt(), last)


def _integral(polynomial: arb_poly) -> arb:
    """Over [-1, 1]: odd powers cancel."""
    return sum((2 * c / (k + 1) for k, c in enumerate(polynomial.coeffs()) if k % 2 == 0), arb(0))
