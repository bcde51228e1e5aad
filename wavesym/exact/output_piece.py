"""A piece of an output between two breakpoints, its time moved to [-1, 1]: what extremes and averages are made of.

On a piece of length l the output is p(t) + e, |e| <= r, with t from -1 to 1, so that of proved averages it adds

    integral of y   = l/2 * (integral of p   over [-1, 1]) + e,  |e| <= l r
    integral of y^2 = l/2 * (integral of p^2 over [-1, 1]) + e,  |e| <= l r (2 max |p| + r)
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from flint import arb, arb_poly, fmpq

from wavesym.exact.tables.ball import Segment


@dataclass(frozen=True)
class Piece:
    """An output from tau = `start` to `end`: a polynomial in t on [-1, 1], its coefficients exact, within `radius`.

    Whether it is exactly 0 at its start, and has a value at its end as the `last` one has.
    """

    start: fmpq
    end: fmpq
    coefficients: tuple[arb, ...]
    radius: arb
    from_zero: bool
    last: bool

    @classmethod
    def from_segment(cls, segment: Segment, end: fmpq, last: bool, negligible: arb) -> Piece:
        (polynomial,) = segment.families.values()
        half = arb((end - segment.start) / 2)
        middles, radius = split(shorten(polynomial, 2 * half, negligible)(arb_poly([half, half])))
        return cls(segment.start, end, middles, radius, segment.from_zero, last)

    @property
    def length(self) -> fmpq:
        """How long it is, in tau."""
        return self.end - self.start

    @property
    def polynomial(self) -> arb_poly:
        """Its polynomial, exact."""
        return arb_poly(list(self.coefficients))

    @property
    def largest(self) -> arb:
        """An upper bound of its absolute values."""
        return (sum(map(abs, self.coefficients), arb(0)) + self.radius).upper()

    @property
    def begin(self) -> arb:
        """The value at its start."""
        return arb(0) if self.from_zero else self.polynomial(arb(-1)) + arb(0, self.radius)


def shorten(polynomial: arb_poly, length: arb, negligible: arb) -> arb_poly:
    """Without the highest powers, as far as they are negligible on [0, length]; they are in the ball of the first."""
    powers, rest = polynomial.coeffs(), arb(0)
    while powers and (more := (rest + abs(powers[-1]) * length ** (len(powers) - 1)).upper()) <= negligible:
        rest = more
        powers.pop()
    return arb_poly([powers[0] + arb(0, rest), *powers[1:]]) if powers else arb_poly()


def split(polynomial: arb_poly) -> tuple[tuple[arb, ...], arb]:
    """The middles of the coefficients, and the sum of the radii."""
    coefficients = polynomial.coeffs() or [arb(0)]
    return tuple(c.mid() for c in coefficients), sum((c.rad() for c in coefficients), arb(0)).upper()


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
