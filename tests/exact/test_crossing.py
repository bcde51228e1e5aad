"""Up to where a polynomial that turns near 0 is positive for certain: against its roots in closed form."""

from __future__ import annotations

import pytest
from flint import arb, arb_poly, ctx, fmpq

from tests.support.cornered import sliding_chain
from wavesym.exact.contacts import friction_stops
from wavesym.exact.contacts.crossing import positive_until, shortfall
from wavesym.exact.contacts.friction_stops import shortfall_integral
from wavesym.exact.contacts.guards import spread
from wavesym.exact.contacts.search import Search
from wavesym.exact.joints.enclosure import Enclosure
from wavesym.numbers.doubles import rational
from wavesym.scene import Scene, lower

RESOLUTION = fmpq(1, 2**500)


def touching(depth: arb) -> arb_poly:
    """((x - 1/3)^2 - depth) (2 - x): near 0 it is a parabola with a third power; it has no other root before 2."""
    near = arb_poly([-fmpq(1, 3), 1])
    return (near * near - depth) * arb_poly([2, -1])


@pytest.mark.parametrize("bits", [40, 100, 300])
@pytest.mark.parametrize("unknown", [0, 350, 700])
def test_what_falls_to_0_and_turns_is_followed_to_its_root(bits: int, unknown: int) -> None:
    """(x - 1/3)^2 - 2^-2k is 0 at 1/3 - 2^-k, and 2^-m of an error moves that by 2^(k - m)."""
    with ctx.workprec(900):
        error = arb(2) ** -unknown if unknown else arb(0)
        deep = (arb(2) ** (-2 * bits) + error / arb(fmpq(5, 3) - fmpq(1, 2**20))).sqrt()
        end = positive_until(touching(arb(2) ** (-2 * bits)), error, fmpq(0), fmpq(1), RESOLUTION)
        assert end is not None
        assert arb(end) <= fmpq(1, 3) - arb(2) ** -bits  # no place after the root
        assert arb(end) > fmpq(1, 3) - deep * (1 + arb(2) ** -18) - 2 * RESOLUTION


@pytest.mark.parametrize("bits", [40, 100, 300])
def test_what_turns_before_0_is_positive_all_the_way(bits: int) -> None:
    with ctx.workprec(900):
        above = touching(-(arb(2) ** (-2 * bits)))
        assert positive_until(above, arb(0), fmpq(0), fmpq(1), RESOLUTION) is None
        assert positive_until(above, arb(2) ** (-2 * bits + 4), fmpq(0), fmpq(1), RESOLUTION) < fmpq(1, 3)


def test_how_far_off_the_place_is_at_which_a_slope_is_nearly_0() -> None:
    """An error of 2^-400 moves the root of (x - 1/3)^2 by 2^-200, not by 2^-400 over the slope at 2^-400 from it."""
    with ctx.workprec(900):
        known = Enclosure(touching(arb(2) ** -800), arb(2) ** -400)
        off = spread(known, fmpq(1, 3) - fmpq(1, 2**400))
        assert fmpq(1, 2**201) < off < fmpq(1, 2**197)


@pytest.mark.parametrize("bits", [40, 100, 300])
def test_what_is_held_beyond_its_limit_counts_from_where_it_may_be(bits: int) -> None:
    """What is left, (1 - x - d)(3 + x), falls to 0 at 1 - d and is nearly -4 d at 1.

    The whole stretch would count some 1/d times as much; not to count it would be no bound.
    """
    with ctx.workprec(900):
        late = arb(2) ** -bits
        left = arb_poly([1 - late, -1]) * arb_poly([3, 1])
        beyond = (left.integral()(1 - late) - left.integral()(arb(1))).lower()
        counted = shortfall_integral(Enclosure(left, arb(2) ** -800), fmpq(1))
        assert beyond <= counted < 3 * beyond
        assert shortfall_integral(Enclosure(left, arb(2) ** -800), fmpq(1) - fmpq(1, 2 ** (bits - 1))) == 0


def test_bits_that_slips_cost(monkeypatch: pytest.MonkeyPatch) -> None:
    """Counted for the whole stretch they would take bits at each slip; not counted they take none, and are no bound."""
    model = lower(Scene(**sliding_chain(41)))
    until = rational(model.horizon())

    def known_bits() -> float:
        with ctx.workprec(448):
            search = Search(model.network, model.loads_until(until), model.joints_in_reach(until), relaxing=True)
            for _ in search.steps():
                pass
            return search.known_bits()

    known = known_bits()
    monkeypatch.setattr(
        friction_stops, "shortfall_integral", lambda each, length: shortfall(each, length) * arb(length)
    )
    assert known_bits() < known - 4
