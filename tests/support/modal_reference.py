"""Masses on springs over a ground that is shaken, and their derivatives, by modes in 60 digits."""

from collections.abc import Sequence
from itertools import pairwise

import mpmath
import numpy as np
from mpmath import mpf
from numpy.typing import NDArray

_DIGITS, _STEP = 60, mpf(10) ** -19


def relative_motion(
    stiffness: Sequence[mpf],
    mass: Sequence[mpf],
    ratio: mpf,
    samples: Sequence[float],
    spacing: float,
    taus: list[float],
) -> list[list[mpf]]:
    """How far each mass is from the ground at each tau, which accelerates by straight lines between samples.

    Each mode answers a ramp by (t + s2/s1 (exp(s1 t) - 1)/(s1 - s2) - ...)/w^2, s1 and s2 being its two exponents.
    """
    n = len(mass)
    matrix, roots = mpmath.zeros(n), [mpmath.sqrt(m) for m in mass]
    for i in range(n):
        matrix[i, i] = (stiffness[i] + (stiffness[i + 1] if i + 1 < n else 0)) / mass[i]
        if i + 1 < n:
            matrix[i, i + 1] = matrix[i + 1, i] = -stiffness[i + 1] / (roots[i] * roots[i + 1])
    squares, shapes = mpmath.eigsy(matrix)
    slopes = [0.0, *(np.diff(samples) / spacing), 0.0]
    kinks = [(mpf(spacing) * k, mpf(after) - mpf(before)) for k, (before, after) in enumerate(pairwise(slopes))]
    moved = [[mpf(0)] * len(taus) for _ in mass]
    for mode in range(n):
        w = mpmath.sqrt(squares[mode])
        share = -sum(shapes[i, mode] * roots[i] for i in range(n))
        turning = w * mpmath.sqrt(mpmath.mpc(ratio * ratio - 1))
        one, other = -ratio * w + turning, -ratio * w - turning
        ramps: dict[mpf, mpf] = {}
        for place, tau in enumerate(taus):
            total = mpf(0)
            for start, kink in kinks:
                t = mpf(tau) - start
                if t > 0 and t not in ramps:
                    curved = other / one * mpmath.expm1(one * t) - one / other * mpmath.expm1(other * t)
                    ramps[t] = (t + curved / (one - other)).real / w**2
                total += kink * ramps[t] if t > 0 else 0
            for i in range(n):
                moved[i][place] += share * total * shapes[i, mode] / roots[i]
    return moved


def values_and_derivatives(
    numbers: Sequence[float], samples: Sequence[float], spacing: float, taus: list[float]
) -> NDArray[np.float64]:
    """Of stiffnesses, as many masses and a damping ratio: the relative motion, then its derivative by each of them, of
    shape (1 + numbers, masses, times): central differences, of which 19 digits are curvature and 41 are right."""
    with mpmath.workdps(_DIGITS):
        own, n = [mpf(number) for number in numbers], len(numbers) // 2

        def moved(given: list[mpf]) -> NDArray[np.object_]:
            return np.array(relative_motion(given[:n], given[n:-1], given[-1], samples, spacing, taus))

        found = [moved(own)]
        for k, number in enumerate(own):
            by = _STEP * (abs(number) if number else 1)
            up, down = ([*own[:k], number + side * by, *own[k + 1 :]] for side in (1, -1))
            found.append((moved(up) - moved(down)) / (2 * by))
        return np.array(found).astype(np.float64)
