"""Numerical Laplace inversion: the network solved at points s of a line, then a Fourier series in tau.

With waves that need a factor exp(-delay s) over a rod, the balance of forces at the points is a linear system in what
they and the rods' ends do. On the line s = c + i k pi/T the inversion integral becomes a series (Dubner and Abate)
whose error is what the function does beyond 2 T, times exp(-2 c T). Its terms are damped towards the last one: what
their end rings with stays at fronts.
"""

from __future__ import annotations

import numpy as np

from wavesym.mechanics.gauge import Gauge
from wavesym.methods.network_problem import undamped_problem
from wavesym.methods.problem import Evaluate, Method, Problem
from wavesym.numbers.arrays import Array, Complex

_PERIODS = 2.0  # T, in horizons
_DAMPED = 34.0  # 2 c T: what comes back from beyond 2 T is e^-34 of it
_ORDER = 6  # of the filter: what is smooth converges as the number of terms to about this power
_LAST = 36.0  # the last term keeps e^-36
_MOST = 1 << 22  # entries of a matrix of exponentials at a time


def _transforms(problem: Problem, s: Complex) -> Complex:
    """The readings' transforms at s (complex, (k,)): shape (readings, k)."""
    block = max(1, _MOST // (2 * len(problem.delay) + problem.points) ** 2)
    return np.hstack([_block(problem, s[first : first + block]) for first in range(0, len(s), block)])


def _block(problem: Problem, s: Complex) -> Complex:
    # unknowns: what the ends of the bars send, left and right by turns, then the points' velocities
    first = problem.ends.size
    size, sent = first + problem.points, np.arange(first)
    points, opposite = np.arange(first, size), sent ^ 1
    matrix = np.zeros((len(s), size, size), dtype=complex)
    known = np.zeros((len(s), size), dtype=complex)
    impedance = np.repeat(problem.impedance, 2)
    delay = np.exp(-np.multiply.outer(s, np.repeat(problem.delay, 2)))
    # what is in the bars at tau = 0 and arrives at their ends
    earlier = problem.start_waves.ravel()[opposite] * (1 - delay) / s[:, np.newaxis]
    matrix[:, sent, sent] = 1.0
    matrix[:, sent, opposite] = delay
    matrix[:, :first, first:] = -problem.incidence.T
    known[:, :first] = -earlier
    matrix[:, first:, opposite] = -2 * problem.incidence * impedance * delay[:, np.newaxis]
    matrix[:, first:, first:] = problem.damping + problem.stiffness / s[:, np.newaxis, np.newaxis]
    matrix[:, points, points] += np.multiply.outer(s, problem.mass) + problem.incidence**2 @ impedance
    known[:, first:] = problem.mass * problem.velocity + 2 * (earlier * impedance) @ problem.incidence.T
    for point in problem.prescribed_points:  # no force acts on it
        matrix[:, first + point, :] = 0.0
        matrix[:, first + point, first + point] = 1.0
        known[:, first + point] = 0.0
    for event in problem.events:
        f0, f1, f2 = event.coefficients
        known[:, first + event.point] += np.exp(-s * float(event.time)) * (f0 / s + f1 / s**2 + 2 * f2 / s**3)
    solved = np.asarray(np.linalg.solve(matrix, known[..., np.newaxis])[..., 0].T, dtype=np.complex128)
    return np.array([_reading(problem, reading, s, solved) for reading in problem.readings])


def _reading(problem: Problem, reading: Gauge, s: Complex, solved: Complex) -> Complex:
    """The transform of a reading."""
    total = np.zeros(len(s), dtype=np.complex128)
    for end, weight, late in problem.waves(reading):
        delay = np.exp(-s * float(late))
        held = problem.start_waves.ravel()[end] * (1 - delay) / s if reading.point is None else 0.0
        total += weight * (solved[end] * delay + held)
    return total / s if reading.quantity == "displacement" else total


def _solve(problem: Problem, resolution: float) -> Evaluate:
    from scipy.signal import czt  # takes a second to import

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


METHOD = Method("Laplace inversion", "SciPy", "terms", (100, 300, 1000, 3000, 10000, 30000), undamped_problem, _solve)
