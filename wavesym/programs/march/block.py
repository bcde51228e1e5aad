"""The response of a joint with a state on a panel, as one matrix; computed in balls, rounded once.

With x' = rates x + pushed s (space.py) on a panel of length h, and x and s as Chebyshev series of degree d, integrated
once in coefficient space,

    x_k = h/(4k) (w_(k-1) - w_(k+1)),    w = rates x + pushed s,    k = 1 ... d,

where w_0 counts twice and what is beyond d is 0; and sum (-1)^k x_k is the state at the start. Eliminated from k = d
down, x_k = y_k - E_k x_(k-1) with matrices E_k. Stiff springs make them large, which costs bits, as all of it is done
in balls: what is rounded is the matrix of the whole answer,

    (coefficients of s at each point, x at the start) -> (coefficients of q at each point, x at the end less x).

The polynomial misses the equation by the one term that does not fit, h/(4 (d + 1)) w_d T_(d+1): the rows of `missed`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from flint import arb, arb_mat, fmpq
from numpy.typing import NDArray

from wavesym.numbers.balls import precise
from wavesym.numbers.doubles import middle, nearest
from wavesym.programs.march.space import JointSpace

Array = NDArray[np.float64]

_FIRST_BITS, _MOST_BITS = 192, 1 << 13
_RIGHT = 80  # bits of what is rounded
NEGLIGIBLE = 2.0**-100
"""Of the largest number of a matrix: what is smaller may be left out, and counts as an error."""


@dataclass(frozen=True)
class BlockResponse:
    """`matrix` as above; `missed`, in the norm of energy, from the same."""

    matrix: Array
    missed: Array


def block_response(space: JointSpace, length: fmpq, degree: int) -> BlockResponse:
    """The answer of a joint with a state on a panel. ArithmeticError where too many bits would be needed."""

    def attempt(_: int) -> BlockResponse | None:
        return _response(space, length, degree)

    return precise(attempt, _FIRST_BITS, _MOST_BITS)


def _response(space: JointSpace, length: fmpq, degree: int) -> BlockResponse | None:
    """None where the working precision does not do."""
    states, points, size = space.states, space.points, degree + 1
    columns = points * size + states
    rates, pushed = arb_mat(space.rates), arb_mat(space.pushed)
    unit = arb_mat(states, states, [arb(a == b) for a in range(states) for b in range(states)])
    # of coefficient k of `pushed s`, from the columns of the answer
    given = [_placed(pushed, columns, [p * size + k for p in range(points)]) for k in range(size)]
    nothing = arb_mat(states, columns)
    y = [nothing] * (size + 2)
    e = [arb_mat(states, states)] * (size + 2)
    for k in range(degree, 0, -1):
        step = arb(length / (4 * k))
        x = -step * rates
        solved = (unit + x * e[k + 1]).inv(nonstop=True)
        below = (2 if k == 1 else 1) * given[k - 1] - (given[k + 1] if k < degree else nothing)
        e[k] = solved * x
        y[k] = solved * (step * below + x * y[k + 1])
    # x_k = known_k + follows_k times twice the mean
    known, follows = [nothing], [unit]
    for k in range(1, size):
        known.append(y[k] - e[k] * known[-1])
        follows.append(-(e[k] * follows[-1]))
    half = arb(1) / 2
    turned, straight = half * unit, half * unit
    first, last = nothing, nothing
    for k in range(1, size):
        sign = arb((-1) ** k)
        turned, straight = turned + sign * follows[k], straight + follows[k]
        first, last = first + sign * known[k], last + known[k]
    start = _placed(unit, columns, range(points * size, columns))
    twice = turned.inv(nonstop=True) * (start - first)
    series = [half * twice, *(known[k] + follows[k] * twice for k in range(1, size))]
    shown, passed = arb_mat(space.shown), arb_mat(space.passed)
    rows = []
    velocities = [
        shown * series[k] + _placed(passed, columns, [p * size + k for p in range(points)]) for k in range(size)
    ]
    for p in range(points):
        rows += [[velocities[k][p, c] for c in range(columns)] for k in range(size)]
    gained = last + straight * twice - start
    rows += [[gained[a, c] for c in range(columns)] for a in range(states)]
    left = arb(length / (4 * size)) * (rates * series[degree] + given[degree])
    missed = [[arb(space.weights[a]).sqrt() * left[a, c] for c in range(columns)] for a in range(states)]
    matrix = _rounded(rows)
    return (
        None
        if matrix is None
        else BlockResponse(matrix, np.array([[nearest(middle(c)) for c in row] for row in missed]))
    )


def _placed(block: arb_mat, columns: int, at: list[int] | range) -> arb_mat:
    """The columns of a block at these places of a wider matrix."""
    wide = arb_mat(block.nrows(), columns)
    for n, column in enumerate(at):
        for row in range(block.nrows()):
            wide[row, column] = block[row, n]
    return wide


def _rounded(rows: list[list[arb]]) -> Array | None:
    """The middles, where they are known well enough; what is negligible is 0."""
    if not all(value.is_finite() for row in rows for value in row):
        return None
    largest = max(abs(value).upper() for row in rows for value in row)
    negligible, right = largest * NEGLIGIBLE, arb(2) ** -_RIGHT
    result = np.zeros((len(rows), len(rows[0])))
    for a, row in enumerate(rows):
        for b, value in enumerate(row):
            if abs(value) < negligible:
                continue
            if not value.rad() < right * abs(value):
                return None
            result[a, b] = nearest(middle(value))
    return result
