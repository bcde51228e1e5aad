"""Each term of the pieces' proof is needed: Horner's rule and NumPy's products, run with counted numbers, lose it."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from operator import add

import pytest
from flint import arb, arb_poly, ctx, fmpq

import wavesym
from tests.support.counted import Counted
from wavesym.exact.output_piece import shorten
from wavesym.exact.tables.ball import Segment
from wavesym.numbers import chebyshev
from wavesym.numbers.reals import DOUBLE, SINGLE
from wavesym.programs.piece_grid import Pieces
from wavesym.programs.pieces import _Course, _cut_off, _Cuts, _Fits, _underflow
from wavesym.programs.program import ProgramOutput
from wavesym.scene import lower

CLOSE = arb(fmpq(1002, 1000))  # the proof's second order, and a little
TINY = fmpq(1, 2**90)
both = pytest.mark.parametrize("real", [DOUBLE, SINGLE], ids=lambda real: real.name)


@pytest.fixture(autouse=True)
def _precise():
    with ctx.workprec(256):
        yield


def horner(powers: Sequence[fmpq], half: fmpq, u: fmpq | int = 0) -> Counted:
    """What pieces.c does at the end of a piece, t = 1: c_k / half**k are the powers of w."""
    w = Counted.exact(half, u) + 0
    stored = [Counted.nearest(c / half**k, u) for k, c in enumerate(powers)]
    total = stored[-1]
    for c in stored[-2::-1]:
        total = total * w + c
    return total


def product(powers: Sequence[fmpq], half: fmpq, first: int, u: fmpq | int = 0) -> Counted:
    """What pieces.py does there; a matrix product adds in any order: term `first` first of all."""
    stored = [Counted.nearest(c / half**k, u) for k, c in enumerate(powers)]
    w = Counted.exact(half, u) + 0
    terms, power = [], w
    for c in stored[1:]:
        terms.append(c * power)
        power = power * w
    terms = [terms[first - 1], *terms[: first - 1], *terms[first:]] if first else terms
    return reduce(add, [*terms, stored[0]])


def series(powers: Sequence[fmpq]) -> list[arb]:
    return chebyshev.coefficients([arb_poly([arb(c) for c in powers])], ctx.prec)[0]


@both
@pytest.mark.parametrize("degree", [1, 2, 3, 8, 20])
def test_rounding_is_what_is_counted(degree, real):
    """Of each power alone, in C or in NumPy, whichever is worse; second order included."""
    u, half = real.roundoff, fmpq(3, 7)
    for k in range(degree):
        powers = [fmpq(1) if j == k else TINY for j in range(degree + 1)]
        counts = [horner(powers, half, u), product(powers, half, k, u)]
        count = max(count.error(u, 0).mid() for count in counts)
        error, kept = _cut_off(series(powers), arb(0), real)
        assert len(kept) == degree + 1
        assert count <= error <= CLOSE * count


@both
def test_of_the_highest_power_it_is_counted_too(real):
    """There Horner's rule adds once less than the proof says."""
    for degree in (0, 1, 2, 8):
        powers = [TINY] * degree + [fmpq(1)]
        counts = [horner(powers, fmpq(1, 2), real.roundoff), product(powers, fmpq(1, 2), degree, real.roundoff)]
        error, _ = _cut_off(series(powers), arb(0), real)
        least = max(float(count.rounding) for count in counts)
        assert least <= float(error / real.roundoff) <= 1.002 * (least + 1)


@both
def test_the_shortest_series_is_taken_and_what_is_cut_off_is_all_there_is_to_it(real):
    """At t = 1 everything that is cut off adds up."""
    terms = [arb(fmpq(1, 8**n)) for n in range(12)]
    for count in range(1, 5):
        rest = sum(terms[count:], arb(0))
        error, powers = _cut_off(terms, rest * CLOSE + 60 * arb(real.roundoff), real)
        assert len(powers) == count
        assert rest + sum(map(abs, powers), arb(0)) * arb(real.roundoff) <= error <= rest * CLOSE + 60 * real.roundoff
        lost = sum(terms, arb(0)) - sum(powers, arb(0))
        assert (lost - rest).abs_upper() < 1e-60


@pytest.mark.parametrize("size", [fmpq(1, 2), fmpq(3, 5)])
def test_where_none_is_allowed_the_best_is_taken(size):
    """Powers of a long series are large, so that it rounds worse than a shorter one is cut off."""
    terms = [arb(size**n) for n in range(30)]
    errors = []
    for count in range(1, 31):
        powers = chebyshev.powers(terms[:count])
        weights = [2] + [max(3 * k + 2, 2 * k + count) for k in range(1, count)]
        lost = sum((w * abs(c) for w, c in zip(weights, powers, strict=True)), arb(0)) * SINGLE.roundoff
        errors.append(float(sum(terms[count:], lost)))
    error, powers = _cut_off(terms, arb(3 * min(errors) / 4), SINGLE)
    assert 5 < len(powers) == errors.index(min(errors)) + 1 < 30
    assert min(errors) <= float(error) <= 1.002 * min(errors)


def test_what_is_cut_off_adds_up_whatever_its_signs():
    """At t = -1 or in between; and a polynomial has one power at least."""
    for signs in ((1, 1), (1, -1), (-1, -1)):
        error, powers = _cut_off([arb(0), *(arb(sign) / 8 for sign in signs)], arb(1), DOUBLE)
        assert len(powers) == 1
        assert 0.25 <= error <= 0.26


def test_where_balls_leave_nothing_to_allow_all_terms_are_taken():
    error, powers = _cut_off([arb(1), arb(fmpq(1, 2))], arb(-1), DOUBLE)
    assert powers == [1, 0.5]
    assert error > 0


@pytest.mark.parametrize("degree", [0, 1, 2, 5, 30])
@pytest.mark.parametrize("size", [TINY, fmpq(1), fmpq(1000)], ids=float)
def test_underflow_is_what_is_counted(degree, size):
    """At |w| = 1/2; powers of w are lost as well, which matters where their coefficients are large."""
    powers = [size / 2**k for k in range(degree + 1)]
    counts = [horner(powers, fmpq(1, 2)), *(product(powers, fmpq(1, 2), k) for k in range(1, degree + 1))]
    lost = _underflow([arb(-size)] * (degree + 1), SINGLE) / SINGLE.smallest
    assert max(float(count.underflow) for count in counts) <= float(lost)


def test_of_a_ball_the_largest_number_counts():
    """In what is cut off, in what is rounded, in what underflows, and in what is negligible."""
    wide = arb(1, 0.5)
    assert _cut_off([arb(1), wide], arb(2), DOUBLE)[0] >= 1.5
    assert _cut_off([wide], arb(0), DOUBLE)[0] >= 1.5 * 2 * arb(DOUBLE.roundoff)
    assert _underflow([wide], DOUBLE) >= (2 + 2 * 1.5) * arb(DOUBLE.smallest)
    assert shorten(arb_poly([arb(1), wide * 1e-70]), arb(1), arb(1.2e-70)).length() == 2


SIMPLE = wavesym.Scene(
    name="simple",
    system={"type": "drive", "m": 1, "kappa": [1], "inertia": [1, 1]},
    load=[{"body": 1, "times": [0], "steps": [1]}],
    output={"until": 2, "strain": [0]},
)


def fitted(polynomials: Sequence[arb_poly], tolerance: fmpq, real=DOUBLE):
    """Bound, largest value and powers of what is one of these polynomials in each unit of tau."""
    segments = [Segment(fmpq(n), {fmpq(0): polynomial}) for n, polynomial in enumerate(polynomials)]
    cuts = _Cuts([segment.start for segment in segments], len(segments) - fmpq(1, 8), 1, real)
    return _Fits(lower(SIMPLE), real, tolerance)._output(_Course(segments), cuts, ctx.prec)


@pytest.mark.parametrize("power", [0, 1, 5])
@pytest.mark.parametrize("piece", [0, 1])
def test_what_is_not_known_is_in_the_bound(power, piece):
    """The radius, 1e-7, of a power of w in one of two pieces, of which all but the constant is cut off."""
    polynomials = [arb_poly([arb(2)]), arb_poly([arb(2)])]
    polynomials[piece] += arb_poly([arb(0)] * power + [arb(0, 1e-7)])
    (bound, largest), powers = fitted(polynomials, fmpq(1, 1000))
    assert 1.9999 < largest <= 2
    assert [len(each) for each in powers] == [1, 1]
    unknown = 1e-7 * (0.875 if piece else 1) ** power / 2
    assert unknown <= bound <= 1.1 * unknown


def test_balls_that_hide_a_piece_are_not_fitted():
    """A thousandth of what is allowed is what they may take."""
    for radius, enough in ((0.9e-6, True), (1e-5, False)):
        for piece in (0, 1):
            polynomials = [arb_poly([arb(1)]), arb_poly([arb(1)])]
            polynomials[piece] += arb_poly([arb(0, radius)])
            assert (fitted(polynomials, fmpq(1, 900)) is not None) == enough


def test_a_bound_is_that_of_the_worst_piece():
    """Of 1e-10 and 1 the rounding of the second counts, in front or behind."""
    small, large = arb_poly([arb(1e-10)]), arb_poly([arb(1), arb(1)])
    for order, length in (([small, large], 0.875), ([large, small], 1)):
        (bound, largest), _ = fitted(order, DOUBLE.roundoff)
        assert largest == 1 + length
        # 1 + w is (1 + length/2) + length/2 t: 2 u of the one, 5 u of the other
        expected = (2 * (1 + length / 2) + 5 * length / 2) / largest
        assert expected <= bound * 2.0**53 <= 1.1 * expected


def test_underflow_is_in_the_bound():
    """Where a value is not much larger than the smallest number."""
    tiny = arb(SINGLE.smallest) * 10**6
    (bound, _), _ = fitted([arb_poly([tiny])], fmpq(1, 100), SINGLE)
    assert bound >= 2e-6 > 4 * float(SINGLE.roundoff)


def test_what_is_left_out_as_negligible_is_in_the_balls():
    full = arb_poly([arb(1), arb(2), arb(3e-70), arb(-4e-70), arb(1e-70)])
    with ctx.workprec(512):
        found = shorten(full, arb(1), arb(6e-70))
        assert found.length() == 3
        for t in (-1, fmpq(1, 3), 1):
            assert found(arb(t)).contains(full(arb(t)))
        assert found[0].rad() >= 5e-70 * (1 - 1e-9)
        assert found[0].rad() <= 6e-70
        assert shorten(full, arb(1), arb(5e-70) * fmpq(99, 100)).length() == 4
        assert shorten(full, arb(1), arb(9e-70)).length() == 2
        assert shorten(arb_poly([arb(1e-70)]), arb(1), arb(1e-60)).length() == 0


def test_a_largest_value_is_looked_for_on_every_piece():
    """At both ends and at the centre, negative ones too, with a lower bound of it printed."""
    one, bump = arb_poly([arb(1)]), arb_poly([arb(-3), arb(2) * 7, arb(-2) * 7])
    for polynomials in ([one, bump], [bump, one], [bump, bump]):
        (_, largest), _ = fitted(polynomials, fmpq(1, 100))
        assert largest == pytest.approx(3, rel=1e-12)
        assert largest <= 3
    # 1/2 at the centre of the first piece
    (_, largest), _ = fitted([arb_poly([0, -2, 2]), arb_poly([arb(fmpq(1, 4))])], fmpq(1, 100))
    assert largest == 0.5


def test_what_is_zero_throughout_has_nothing_to_be_wrong():
    found = fitted([arb_poly(), arb_poly()], fmpq(1, 100))
    assert found == ((0.0, 0.0), [(0.0,), (0.0,)])


def test_a_program_is_as_wrong_as_its_worst_output():
    outputs = (ProgramOutput("a", 0.1, 1.0), ProgramOutput("b", 0.3, 1.0), ProgramOutput("c", 0.2, 1.0))
    assert Pieces(outputs, 1.0, DOUBLE, (), 1).error_bound == 0.3
