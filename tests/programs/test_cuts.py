"""Where pieces begin and end: every number of the horizon lies on one, near its centre, and is found."""

from __future__ import annotations

from bisect import bisect_right
from itertools import pairwise

import numpy as np
import pytest
from flint import arb, arb_poly, ctx, fmpq
from hypothesis import given, settings
from hypothesis import strategies as st

from wavesym.numbers.doubles import rational
from wavesym.numbers.reals import DOUBLE, SINGLE, Real
from wavesym.programs.piece_grid import Pieces
from wavesym.programs.pieces import _Cuts

FORMATS = {DOUBLE: np.float64, SINGLE: np.float32}
both = pytest.mark.parametrize("real", FORMATS, ids=lambda real: real.name)


@st.composite
def made(draw):
    """Cuts of a horizon, at breakpoints that are no numbers, some with no number between them."""
    real = draw(st.sampled_from([DOUBLE, SINGLE]))
    until = rational(real.not_below(fmpq(draw(st.integers(1, 400)), draw(st.integers(1, 90)))))
    gap = until - rational(real.next_after(float(until), 0.0))
    parts = draw(st.sets(st.fractions(0, 1, max_denominator=9), max_size=3))
    times = {until * rational(part) for part in parts}
    shift = gap * draw(st.sampled_from([0, 1, 2, 3])) / 10
    breaks = sorted({fmpq(0)} | times | {time - shift for time in times if time > shift})
    return _Cuts(breaks, until, draw(st.sampled_from([1, 2, 8])), real), breaks, until, real


def points(cuts: _Cuts, until: fmpq, real: Real) -> list[float]:
    """Numbers of the horizon: all starts, their neighbours, centres."""
    near = {
        tau for start in cuts.starts for tau in (start, real.next_after(start, 0.0), real.next_after(start, np.inf))
    }
    return sorted(tau for tau in near | set(cuts.centres) if tau >= 0 and rational(tau) <= until)


@settings(max_examples=40)
@given(made())
def test_every_number_lies_on_a_piece_of_its_own_stretch(drawn):
    cuts, breaks, until, real = drawn
    assert cuts.starts[0] == 0.0
    assert all(low < high for low, high in pairwise(cuts.starts))
    assert len(cuts.starts) - 1 == len(cuts.exact) - 1 == len(cuts.centres) == len(cuts.middles) == len(cuts.halves)
    for tau in points(cuts, until, real):
        assert tau < cuts.starts[-1]
        piece = bisect_right(cuts.starts, tau) - 1
        low, high = cuts.exact[piece], cuts.exact[piece + 1]
        assert low <= rational(tau) < high
        assert not [time for time in breaks if low < time <= rational(tau)]
        assert abs(rational(tau) - rational(cuts.centres[piece])) <= cuts.halves[piece]


@settings(max_examples=40)
@given(made())
def test_a_centre_is_a_number_and_half_a_piece_is_no_longer_than_it_must_be(drawn):
    """1/2 at most, as |w| may be no more, but for what a number cannot be nearer to the middle."""
    cuts, _, _, real = drawn
    for (low, high), centre, middle, half in zip(
        pairwise(cuts.exact), cuts.centres, cuts.middles, cuts.halves, strict=True
    ):
        assert centre == real.nearest((low + high) / 2)
        assert middle == rational(centre)
        assert half == max(high - middle, middle - low)
        assert half * (1 - 2 * real.roundoff) <= fmpq(1, 2) + high * real.roundoff


@both
@pytest.mark.parametrize("until", [fmpq(1), fmpq(6), fmpq(16, 5), fmpq(91, 10)], ids=str)
def test_an_output_that_grows_beyond_the_horizon_is_not_looked_at_there(real, until):
    """1 at the last number of the horizon, 0 before it, and 2 just after it."""
    last = rational(real.not_below(until))
    before = rational(real.next_after(float(last), 0.0))
    cuts = _Cuts([fmpq(0), before], last, 4, real)
    with ctx.workprec(300):
        piece = bisect_right(cuts.starts, float(last)) - 1
        middle, half = cuts.middles[piece], cuts.halves[piece]
        ramp = arb_poly([arb((middle - before) / (last - before)), arb(half / (last - before))])
        assert abs(cuts.size(piece, ramp) - 1) < 1e-30


@both
def test_of_a_single_number_at_the_end_only_that_is_looked_at(real):
    """Its last bit is 1, so that the middle between it and the next one is rounded to the next."""
    last = rational(real.next_after(6.0, np.inf))
    ulp = last - 6
    cuts = _Cuts([fmpq(0), last], last, 4, real)
    assert cuts.middles[-1] == last + ulp
    with ctx.workprec(300):
        ramp = arb_poly([arb(1 + (cuts.middles[-1] - last) / ulp), arb(cuts.halves[-1] / ulp)])
        assert abs(cuts.size(len(cuts.centres) - 1, ramp) - 1) < 1e-30


@both
def test_an_output_is_not_looked_at_beyond_its_next_breakpoint(real):
    """Of a piece from 0 to 1/3 the centre and both ends are: there 3 tau is 0, 1/2 and 1."""
    cuts = _Cuts([fmpq(0), fmpq(1, 3)], fmpq(1), 1, real)
    with ctx.workprec(300):
        for zero, size in ((0, 1), (1, 1), (fmpq(1, 2), fmpq(1, 2))):
            tent = arb_poly([3 * arb(cuts.middles[0]) - arb(zero), 3 * arb(cuts.halves[0])])
            assert abs(cuts.size(0, tent) - size) < 1e-6
            assert cuts.size(0, tent) <= size
        bump = 1 - arb_poly([0, 0, 1])
        assert abs(cuts.size(0, bump) - 1) < 1e-12


@settings(max_examples=40)
@given(made())
def test_every_piece_is_found_in_a_few_steps(drawn):
    """As pieces.c looks for it: from part (int)(tau * scale) on, while the next piece starts no later."""
    cuts, _, until, real = drawn
    kind = FORMATS[real]
    pieces = len(cuts.centres)
    grid = cuts.grid([0], [[(0.0,)] * pieces])
    assert grid.starts == tuple(cuts.starts)
    assert grid.centres == tuple(cuts.centres)
    taken = 0
    for tau in points(cuts, until, real):
        part = int(kind(tau) * kind(grid.scale))
        place = bisect_right(cuts.starts, tau) - 1
        assert 0 <= part < len(grid.first)
        assert 0 <= grid.first[part] <= place
        taken = max(taken, place - grid.first[part])
    assert taken <= grid.steps


def test_a_number_that_is_rounded_into_the_next_part_is_found():
    """Part 3 begins just below the start of a piece; the last number before it, times `scale`, is 3 too."""
    start = 1.9824121244677786
    cuts = _Cuts([fmpq(0), fmpq(1, 10), rational(start)], rational(3.304020207446297), 1, DOUBLE)
    grid = cuts.grid([0], [[(0.0,)] * len(cuts.centres)])
    before = DOUBLE.next_after(start, 0.0)
    assert before * grid.scale == 3.0
    assert rational(before) * rational(grid.scale) < 3 < rational(start) * rational(grid.scale)
    assert grid.starts[grid.first[3]] <= before


def test_parts_are_as_fine_as_the_pieces():
    """Even pieces are found at once or in the next one; a crowd of them by finer parts."""
    even = _Cuts([fmpq(0)], fmpq(100), 8, DOUBLE)
    assert even.grid([0], [[(0.0,)] * len(even.centres)]).steps <= 3
    crowd = _Cuts([fmpq(k, 1000) for k in range(20)], fmpq(50), 1, DOUBLE)
    grid = crowd.grid([0], [[(0.0,)] * len(crowd.centres)])
    assert len(grid.first) > 4 * len(crowd.centres)


@both
def test_it_is_checked_at_both_ends_of_every_piece_and_at_its_centre(real):
    cuts = _Cuts([fmpq(0), fmpq(3, 2)], fmpq(5, 2), 1, real)
    grid = cuts.grid([0], [[(0.0,)] * len(cuts.centres)])
    form = Pieces((), 2.5, real, (grid,), 1)
    before = [real.next_after(end, 0.0) for end in cuts.starts[1:]]
    assert before[-1] == 2.5
    assert form.check_points == sorted({*cuts.starts[:-1], *cuts.centres, *before})
