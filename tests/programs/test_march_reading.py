"""What reading a wave costs: its weights against a count, operation by operation, of what programs do."""

import numpy as np
import pytest

from tests.support.rounded import Rounded
from wavesym.programs.march.bound import reading_weights
from wavesym.programs.schemes.march import _series

# a stretch that began with the window, one of the window before, one that begins late: start, half of its panel
STRETCHES = pytest.mark.parametrize(("start", "half"), [(0.0, 0.5), (-0.3, 0.5), (0.4, 0.15)])
DEGREE = 24


def local(w, half):
    """The program's variable on a stretch, w after its start, for all coefficients side by side.

    `start` and `excess` are together what they stand for to twice as many digits, and tau less its window is exact.
    """
    return w / Rounded.wrong(half) - Rounded(np.ones(DEGREE + 1))


def since(t, start):
    both = np.ones(DEGREE + 1)
    return (Rounded(t * both) - Rounded(start * both)) + Rounded(2.0**-55 * both)


def errors(read, start, half):
    """The largest error for each coefficient alone, in units of u and of the smallest number, over a stretch."""
    c = Rounded.array([Rounded(row) for row in np.eye(DEGREE + 1)])
    points = np.linspace(max(start, 0.0), min(start + 2 * half, 1.0), 9)
    found = [read(c, t, start, half) for t in points]
    return np.max([each.error for each in found], axis=0), max(np.max(each.underflow) for each in found)


def arrived(c, t, start, half):
    """As `arrived` in C; the sum is that of the program in NumPy."""
    u = Rounded.array([local(since(t, start), half)])
    (wave,) = _series(c[:, np.newaxis], u)
    return wave + wave._scaled(1e-9)  # with another wave


@STRETCHES
def test_reading_a_wave_costs_no_more_than_said_and_not_much_less(start, half):
    claimed = 12 * reading_weights(DEGREE, displaced=False)
    found, lost = errors(arrived, start, half)
    assert (found <= claimed).all()
    assert lost <= 4 * (DEGREE + 3) ** 2
    # the local variable is worst at the end of a panel
    assert claimed[-1] <= 1.4 * found[-1]
    assert (claimed[3:] <= 7 * found[3:]).all()


def antiderivative(c, u):
    """As in C."""
    twice, now, after = u + u, 0, 0
    for k in range(DEGREE + 1, 0, -1):
        lower, upper = (2 * c[0] if k == 1 else c[k - 1]), (c[k + 1] if k < DEGREE else 0)
        now, after = (twice * now - after) + (lower - upper) / Rounded(2.0 * k), now
    return u * now - after


def gathered(c, t, start, half):
    """As in C, from the start of a stretch on, or of the window."""
    low = local(Rounded(np.full(DEGREE + 1, max(0.0, -start))), half)
    difference = antiderivative(c, local(since(t, start), half)) - antiderivative(c, low)
    return Rounded.wrong(half) * difference


@STRETCHES
def test_integrating_a_wave_costs_no_more_than_said(start, half):
    """It costs a good deal less: an error of the local variable is not multiplied by the degree."""
    claimed = 24 * reading_weights(DEGREE, displaced=True)
    found, lost = errors(gathered, start, half)
    assert (found <= claimed).all()
    assert lost <= 4 * (DEGREE + 3) ** 2
