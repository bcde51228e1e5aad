"""Up to where a polynomial that turns near 0 is positive for certain: against its roots in closed form."""

from __future__ import annotations

import pytest
from flint import arb, arb_poly, ctx, fmpq

from wavesym.exact.contacts.crossing import positive_until
from wavesym.exact.contacts.guards import spread
from wavesym.exact.joints.enclosure import Enclosure

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
