"""Numerical Laplace inversion: the nodes' conditions solved at points s of a line, then a Fourier series in tau.

With waves that need a factor exp(-s) over a rod, (2.3) and (2.4) are a linear system in what each node sends. On the
line s = c + i k pi/T the inversion integral becomes a series (Dubner and Abate) whose error is what the function does
beyond 2 T, times exp(-2 c T). Its terms are damped towards the last one: what their end rings with stays at fronts.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.signal import czt

from wavesym.rivals.problem import Array, Evaluate, Problem, Rival

_PERIODS = 2.0  # T, in horizons
_DAMPED = 34.0  # 2 c T: what comes back from beyond 2 T is e^-34 of it
_ORDER = 6  # of the filter: what is smooth converges as the number of terms to about this power
_LAST = 36.0  # the last term keeps e^-36
_MOST = 1 << 22  # entries of a matrix of exponentials at a time


def _transforms(problem: Problem, s: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """The outputs' transforms at s (complex, (k,)): shape (outputs, k)."""
    m = problem.nodes - 1
    delay = np.exp(-s)
    left, right = problem.beside(problem.rods)
    gone = (1 - delay) / s / 2  # the wave 1/2 that is in a rod at tau = 0 and arrives until 1
    force = np.zeros((problem.nodes, len(s)), dtype=complex)
    for event in problem.events:
        f0, f1, f2 = event.coefficients
        force[event.node] += np.exp(-s * float(event.time)) * (f0 / s + f1 / s**2 + 2 * f2 / s**3)
    force += np.multiply.outer(problem.inertia * problem.velocity, np.ones_like(s))
    # unknowns: what the nodes 0 ... m send to the left, then to the right
    matrix = np.zeros((len(s), 2 * (m + 1), 2 * (m + 1)), dtype=complex)
    known = np.zeros((len(s), 2 * (m + 1)), dtype=complex)
    for x in range(m + 1):
        stiff = problem.inertia[x] * s + problem.gamma[x]
        held = (force[x] + (problem.alpha[x] * left[x] + problem.beta[x] * right[x]) * gone) / stiff
        for row, old in ((x, left[x]), (m + 1 + x, right[x])):
            matrix[:, row, row] += 1
            known[:, row] = held - old * gone
            if x > 0:  # a, from the left, was sent to the right by x - 1
                matrix[:, row, m + x] += (float(row == x) - problem.alpha[x] / stiff) * delay
            if x < m:  # b
                matrix[:, row, x + 1] += (float(row != x) - problem.beta[x] / stiff) * delay
    sent = np.linalg.solve(matrix, known[..., np.newaxis])[..., 0].T
    rows = []
    for watch in problem.watches:
        lag, v = watch.offset, problem.rods[watch.rod - 1] / 2
        to_right = sent[m + watch.rod] * np.exp(-s * lag) + v * (1 - np.exp(-s * lag)) / s
        to_left = sent[watch.rod] * np.exp(-s * (1 - lag)) + v * (1 - np.exp(-s * (1 - lag))) / s
        if watch.quantity == "strain":
            rows.append(to_left - to_right)
        else:
            rows.append((to_left + to_right) / (s if watch.quantity == "displacement" else 1))
    return np.array(rows)


def _prepare(problem: Problem, resolution: float) -> Evaluate:
    span = _PERIODS * problem.until
    c = _DAMPED / (2 * span)
    k = np.arange(int(resolution))
    filtered = np.exp(-_LAST * (k / len(k)) ** _ORDER) / span
    filtered[0] /= 2
    terms = _transforms(problem, np.asarray(c + 1j * np.pi / span * k, dtype=np.complex128)) * filtered

    def evaluate(taus: Array) -> Array:
        apart = (taus[-1] - taus[0]) / max(len(taus) - 1, 1)
        if np.allclose(np.diff(taus), apart, rtol=0, atol=1e-12 * span):
            turned = terms * np.exp(1j * np.pi / span * taus[0] * k)
            series = czt(turned, m=len(taus), w=np.exp(1j * np.pi / span * apart), axis=-1).real
        else:
            block = max(1, _MOST // len(k))
            parts = [taus[first : first + block] for first in range(0, len(taus), block)]
            series = np.hstack(
                [(terms @ np.exp(1j * np.pi / span * np.multiply.outer(k, part))).real for part in parts]
            )
        return np.asarray(np.exp(c * taus) * series)

    return evaluate


RIVAL = Rival("Laplace inversion", "SciPy", "terms", (100, 300, 1000, 3000, 10000, 30000), _prepare)
