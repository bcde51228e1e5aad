"""An output as a function of tau: sums of decays that begin at given instants, evaluated in ball arithmetic."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping
from fractions import Fraction

from flint import arb, arb_poly, ctx, fmpq

from tests.support.decays import Decays

SLACK = 2.0**-9
_LONGEST = 1024  # Taylor polynomials
_QUICK = 64  # decay on half a stretch
_FEWEST = 128  # bits


def _ball(number: Fraction) -> arb:
    return arb(fmpq(number.numerator, number.denominator))


class History:
    """0 until the first of the `instants`; at each of them a sum of decays is gained."""

    def __init__(self, gains: Mapping[Fraction, Decays]) -> None:
        self.instants = sorted(instant for instant, gain in gains.items() if gain)
        self._gains = [list(gains[instant].polynomials()) for instant in self.instants]
        self._bits = [_FEWEST] * len(self.instants)  # with which a stretch was right, last time
        self._stretches: dict[int, list[dict[fmpq, arb_poly]]] = {}

    def value(self, tau: Fraction, bits: int) -> arb:
        """The value at tau, at a jump that after it."""
        return self._limit(bisect_right(self.instants, tau) - 1, tau, bits)

    def largest(self, until: Fraction) -> tuple[arb, arb]:
        """Bounds of the largest absolute value up to `until`."""
        ends = [*(instant for instant in self.instants if instant <= until), until]
        best = arb(0)
        for k in range(len(ends) - 1):
            for tau in (ends[k], (5 * ends[k] + 3 * ends[k + 1]) / 8, ends[k + 1]):
                best = best.max(self._limit(k, tau, 32).abs_lower())
        for k in range(len(ends) - 1):
            if ends[k] < ends[k + 1]:
                best = self._peak(k, Fraction(0), ends[k + 1] - ends[k], best)
        return best, (best * (1 + SLACK)).upper()

    def _limit(self, k: int, tau: Fraction, bits: int) -> arb:
        """What the first k + 1 gains make at tau."""
        if k < 0:
            return arb(0)
        w, bits_used = tau - self.instants[k], self._bits[k]
        while True:
            with ctx.workprec(bits_used):
                terms = (poly(_ball(w)) * (-rate * _ball(w)).exp() for rate, poly in self._stretch(k).items())
                value = sum(terms, arb(0))
            if value.rel_accuracy_bits() >= bits:
                self._bits[k] = bits_used
                return value
            # costly, so only what remains small is asked whether it is 0
            if bits_used == 4 * self._bits[k] and value.contains(0) and self._vanishes(k, tau):
                return arb(0)
            bits_used *= 2

    def _vanishes(self, k: int, tau: Fraction) -> bool:
        """Whether the first k + 1 gains make exactly 0 at tau.

        Exponentials of different rational exponents are linearly independent over the rationals (Lindemann,
        Weierstrass), so it is enough to add up the factors of each.
        """
        factors: dict[fmpq, fmpq] = {}
        for instant, gain in zip(self.instants[: k + 1], self._gains, strict=False):
            w = fmpq(*(tau - instant).as_integer_ratio())
            for rate, poly in gain:
                factors[rate * w] = factors.get(rate * w, fmpq(0)) + poly(w)
        return not any(factors.values())

    def _stretch(self, k: int) -> dict[fmpq, arb_poly]:
        """By rate, the factor of exp(-rate w) after the first k + 1 gains, w = tau - instants[k]."""
        made = self._stretches.setdefault(ctx.prec, [])
        while len(made) <= k:
            now = {}
            if made:
                step = _ball(self.instants[len(made)] - self.instants[len(made) - 1])
                now = {rate: poly(arb_poly([step, 1])) * (-rate * step).exp() for rate, poly in made[-1].items()}
            for rate, poly in self._gains[len(made)]:
                now[rate] = now.get(rate, 0) + arb_poly(poly)
            made.append(now)
        return made[k]

    def _peak(self, k: int, start: Fraction, end: Fraction, best: arb) -> arb:
        """The largest absolute value found where start <= w <= end, or `best`; none is more than SLACK above it."""
        order = self._bits[k] // 8  # the more cancels, the longer a remainder takes to vanish
        while order <= _LONGEST:
            with ctx.workprec(self._bits[k]):
                centre, radius = _ball((start + end) / 2), _ball((end - start) / 2)
                whole = centre + radius * arb(0, 1)
                sizes = {rate: _size(rate, poly, whole) for rate, poly in self._stretch(k).items()}
                # what has died out does not count, and what dies out quickly needs shorter stretches
                slight = {rate for rate, size in sizes.items() if size <= best * (SLACK / (64 * len(sizes)))}
                here = {rate: poly for rate, poly in self._stretch(k).items() if rate not in slight}
                if any(rate * radius > _QUICK for rate in here):
                    break
                near = _series(here, centre, order)(arb_poly([0, radius]))
                # Taylor's remainder: the next coefficient, wherever one expands
                rest = _series(here, whole, order + 1)[order].abs_upper() * radius**order
                rest = sum((sizes[rate] for rate in slight), rest)
                terms = [c.abs_upper() for c in near.coeffs()]
                if sum(terms, rest) <= best * (1 + SLACK):
                    return best
                if sum((c.rad() for c in near.coeffs()), arb(0)) > best * (SLACK / 8):
                    self._bits[k] *= 2
                    order = max(order, self._bits[k] // 8)
                elif rest > best * (SLACK / 16):
                    order *= 2
                else:
                    while rest + terms[-1] <= best * (SLACK / 8):
                        rest += terms.pop()
                    return _polynomial_peak(near.truncate(len(terms)), arb(0), arb(1), rest, best)
        middle = (start + end) / 2
        return self._peak(k, middle, end, self._peak(k, start, middle, best))


def _size(rate: fmpq, poly: arb_poly, w: arb) -> arb:
    return (poly(w) * (-rate * w).exp()).abs_upper()


def _series(terms: Mapping[fmpq, arb_poly], w: arb, order: int) -> arb_poly:
    """The Taylor polynomial about w, of less than an order, of a sum of poly exp(-rate w)."""
    total = arb_poly()
    for rate, poly in terms.items():
        decay = [(-rate * w).exp()]
        for j in range(1, order):
            decay.append(decay[-1] * -rate / j)
        total += (poly(arb_poly([w, 1])).truncate(order) * arb_poly(decay)).truncate(order)
    return total


def _polynomial_peak(poly: arb_poly, centre: arb, radius: arb, rest: arb, best: arb) -> arb:
    """As `History._peak`, of a polynomial that is off by `rest` at most."""
    near = poly(arb_poly([centre, radius]))
    best = best.max(near[0].abs_lower() - rest)
    if sum((c.abs_upper() for c in near.coeffs()), rest) <= best * (1 + SLACK):
        return best
    for sign in (-1, 1):
        best = _polynomial_peak(poly, centre + sign * radius / 2, radius / 2, rest, best)
    return best
