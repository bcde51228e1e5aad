"""Discs on shafts by the method of characteristics, where travel times and steps are whole panels: extended precision.

Nothing of it is the package's: on a panel everything is its values at the Chebyshev points, a disc's equation

    J v' = M - C v + sum Z (2 w - v),        w the waves that arrive, v - w what goes on,

is integrated by the matrix that integrates polynomials, made with 60 digits.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from mpmath import mp, mpf
from numpy.typing import NDArray

Values = NDArray[np.longdouble]
_DEGREE = 13


class Shafts:
    """Discs of some inertias with dashpots, the shafts between them with impedances, so many panels long; at rest."""

    def __init__(
        self,
        inertia: Sequence[str],
        dashpots: Sequence[int],
        impedance: Sequence[float],
        panels: Sequence[int],
        panel: float,
    ) -> None:
        self._impedance = np.array(impedance, np.longdouble)
        beside = [[k for k in (disc - 1, disc) if 0 <= k < len(panels)] for disc in range(len(inertia))]
        with mp.workdps(60):
            damping = [
                sum((mpf(impedance[k]) for k in shafts), mpf(c)) for shafts, c in zip(beside, dashpots, strict=True)
            ]
            self._solve = np.array([_solver(mpf(j), c, mpf(panel)) for j, c in zip(inertia, damping, strict=True)])
            middle = mp.matrix(_lagrange(mpf(0)))
        self._middle = np.array([np.longdouble(str(value)) for value in middle])
        self._velocity = np.zeros(len(inertia), np.longdouble)
        self._panels, self._age = list(panels), 0
        # what was sent into each shaft at its left and right end, the last `panels` of it
        self._sent = [np.zeros((count, 2, _DEGREE + 1), np.longdouble) for count in panels]

    def go_on(self, moments: Sequence[float]) -> Values:
        """One panel under moments that are held: the velocities of discs at its end."""
        count = len(self._velocity)
        given = np.zeros((count, _DEGREE + 2), np.longdouble)
        given[:, 0] = self._velocity
        given[:, 1:] = np.array(moments, np.longdouble)[:, None]
        arrive = []
        for shaft, (sent, z) in enumerate(zip(self._sent, self._impedance, strict=True)):
            coming = sent[self._age % len(sent)].copy()
            arrive.append(coming)
            given[shaft + 1, 1:] += 2 * z * coming[0]
            given[shaft, 1:] += 2 * z * coming[1]
        moving = np.einsum("ijk,ik->ij", self._solve, given)
        for shaft, sent in enumerate(self._sent):
            sent[self._age % len(sent)] = moving[shaft] - arrive[shaft][1], moving[shaft + 1] - arrive[shaft][0]
        self._age += 1
        self._velocity = moving[:, -1]
        return self._velocity

    def moment_in_middle(self, shaft: int) -> np.longdouble:
        """Of a shaft, now: what its waves pull, each as old as half its travel time."""
        sent, count = self._sent[shaft], self._panels[shaft]
        late = (count + 1) // 2
        panel = sent[(self._age - late) % count]
        right, left = (self._middle @ panel[0], self._middle @ panel[1]) if count % 2 else (panel[0][0], panel[1][0])
        return np.longdouble(self._impedance[shaft] * (left - right))


def _points() -> list[mpf]:
    return [-mp.cos(mp.pi * k / _DEGREE) for k in range(_DEGREE + 1)]


def _lagrange(x: mpf) -> list[mpf]:
    """The polynomials that are 1 at one of the points and 0 at the others, at x."""
    points = _points()
    return [mp.fprod((x - q) / (p - q) for q in points if q is not p) for p in points]


def _solver(inertia: mpf, damping: mpf, panel: mpf) -> list[list[np.longdouble]]:
    """The velocity at the points from that at first and from the moments at the points; without inertia from these."""
    points, size = _points(), _DEGREE + 1
    if not inertia:
        return [[np.longdouble((j == k + 1) / damping) for j in range(size + 1)] for k in range(size)]
    powers = mp.matrix([[p**n for n in range(size)] for p in points])
    integrals = mp.matrix([[(p ** (n + 1) - (-1) ** (n + 1)) / (n + 1) for n in range(size)] for p in points])
    integrate = integrals * powers**-1 * (panel / 2 / inertia)
    solve = (mp.eye(size) + damping * integrate) ** -1
    by_moment = solve * integrate
    rows = [[sum(solve[k, j] for j in range(size)), *(by_moment[k, j] for j in range(size))] for k in range(size)]
    return [[np.longdouble(mp.nstr(value, 30)) for value in row] for row in rows]
