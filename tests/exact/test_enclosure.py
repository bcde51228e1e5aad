"""Functions that are known up to an error: what sums of them are known to."""

from __future__ import annotations

from itertools import product

import pytest
from flint import arb, arb_poly, fmpq

from wavesym.exact.joints.enclosure import Enclosure, weighted_sum


@pytest.mark.parametrize("factors", list(product((fmpq(1), fmpq(-1), fmpq(-7, 3), fmpq(5, 2)), repeat=3)))
def test_what_is_not_known_of_a_sum_is_that_of_all_its_parts(factors: tuple[fmpq, ...]) -> None:
    """Each function is as far from its polynomial as it may be, all to the same side, or each to another."""
    off = (fmpq(1, 4), fmpq(1, 16), fmpq(1, 64))
    powers = ((1, 2), (3, -1, 5), (-2,))
    parts = [Enclosure(arb_poly(list(c)), arb(e)) for c, e in zip(powers, off, strict=True)]
    total = weighted_sum(list(zip(factors, parts, strict=True)))
    for signs in product((-1, 1), repeat=3):
        for w in (fmpq(0), fmpq(1, 2), fmpq(1)):
            true = sum(
                (
                    f * (sum((c * w**n for n, c in enumerate(p)), fmpq(0)) + sign * e)
                    for f, p, e, sign in zip(factors, powers, off, signs, strict=True)
                ),
                fmpq(0),
            )
            assert total.evaluate(w).contains(true)
    assert total.error <= sum((abs(f) * e for f, e in zip(factors, off, strict=True)), fmpq(0)) * fmpq(101, 100)
