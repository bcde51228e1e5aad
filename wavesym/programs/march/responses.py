"""The responses of joints with a state on a panel, as tables; computed in balls, rounded once.

A body is one mass without springs; its response is three short tables. On a panel of length h, u in [-1, 1], a body
obeys q' + rate q = rate p, where p is the force over the sum of its dashpots and impedances. With q and p as Chebyshev
series of degree d, integrated once in coefficient space, this reads for k = 1 ... d

    q_k + x_k (q_(k-1) - q_(k+1)) = x_k (p_(k-1) - p_(k+1)),        x_k = rate h / (4 k),

where q_0 and p_0 count twice and what is beyond d is 0; and sum (-1)^k q_k is the velocity at the start. Eliminated
from k = d down, as in Miller's algorithm,

    y_k = e_k (p_(k-1) - p_(k+1) + y_(k+1)),    q_k = y_k - e_k q_(k-1),    e_k = x_k / (1 + x_k e_(k+1)),

so that 0 < e_k < 1 (they are ratios of Bessel functions I_k / I_(k-1)) and nothing grows. The velocities at both ends
are then sums over y, known before q is:

    q_0 = (1 - slack) (start - sum_k first_k y_k),        end = (1 - loss) q_0 + sum_k last_k y_k.

Where bodies are heavy, slack and loss are small: rounded as they are, they leave no trace in 100 000 windows.

The polynomial misses the equation by the one term that does not fit, x_(d+1) (q_d - p_d) T_(d+1): the `leak`.

A block is any other joint with a state; its response is one matrix. With x' = rates x + pushed s (space.py) on a panel
of length h, and x and s as Chebyshev series of degree d, integrated once in coefficient space,

    x_k = h/(4k) (w_(k-1) - w_(k+1)),    w = rates x + pushed s,    k = 1 ... d,

where w_0 counts twice and what is beyond d is 0; and sum (-1)^k x_k is the state at the start. Eliminated from k = d
down, x_k = y_k - E_k x_(k-1) with matrices E_k. Stiff springs make them large, which costs bits, as all of it is done
in balls: what is rounded is the matrix of the whole answer,

    (coefficients of s at each point, x at the start) -> (coefficients of q at each point, x at the end less x).

The polynomial misses the equation by the one term that does not fit, h/(4 (d + 1)) w_d T_(d+1): the rows of `missed`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from math import ceil, log2

import numpy as np
from flint import arb, arb_mat, ctx, fmpq

from wavesym.numbers.arrays import Array
from wavesym.numbers.balls import precise
from wavesym.numbers.doubles import middle, midpoint, nearest
from wavesym.programs.march.space import JointSpace

_BITS = 300
SPARE = 16.0
"""Products on the way to a coefficient of p or q that may underflow, besides those of a scan."""


@dataclass(frozen=True)
class BodyOperator:
    """The tables of a rate on a panel; `ratio[k]`, `first[k]` and `last[k]` for k = 0 ... degree, entry 0 unused (0).

    All dimensionless. `step` is rate times the panel's length; `leak` is x_(degree + 1).
    """

    step: float
    ratio: tuple[float, ...]
    first: tuple[float, ...]
    last: tuple[float, ...]
    slack: float
    loss: float
    leak: float

    @cached_property
    def rows(self) -> tuple[float, ...]:
        """As programs have it: slack, loss and 0, then ratio, first and last for each degree from 1 on."""
        above = zip(self.ratio[1:], self.first[1:], self.last[1:], strict=True)
        return (self.slack, self.loss, 0.0, *chain.from_iterable(above))

    def highest(self, acting: float, start: float) -> float:
        """The highest coefficient of q where p is constant and q is `start` at the start of the panel."""
        y = 2 * acting * self.ratio[1]
        q = 2 * (1 - self.slack) * (start - self.first[1] * y)
        for k, ratio in enumerate(self.ratio[1:], 1):
            q = (y if k == 1 else 0.0) - ratio * q
        return q


def body_operator(step: fmpq, degree: int) -> BodyOperator:
    """The operator of bodies with rate * length = `step` > 0 on series of `degree`, each number rounded once."""
    with ctx.workprec(_BITS):
        x = [arb(step) / (4 * k) if k else arb(0) for k in range(degree + 2)]
        ratio = [arb(0)] * (degree + 2)
        first = [arb(0)] * (degree + 2)
        last = [arb(0)] * (degree + 2)
        for k in range(degree, 0, -1):
            ratio[k] = x[k] / (1 + x[k] * ratio[k + 1])
            first[k] = (-1) ** k - ratio[k + 1] * first[k + 1]
            last[k] = 1 - ratio[k + 1] * last[k + 1]
        doubled = 2 * ratio[1]
        return BodyOperator(
            step=midpoint(arb(step)),
            ratio=tuple(map(midpoint, ratio[:-1])),
            first=tuple(map(midpoint, first[:-1])),
            last=tuple(map(midpoint, last[:-1])),
            slack=midpoint(-doubled * first[1] / (1 - doubled * first[1])),
            loss=midpoint(doubled * last[1]),
            leak=midpoint(x[degree + 1]),
        )


def body_roundings(operator: BodyOperator, count: int) -> Array:
    """How wrong a program may make what a body sends, from absolute values; p is rounded `count` times.

    Counts the roundings of the programs in C (one after the other) and in NumPy (scans and sums in pairs).

    Returns:
        (degree + 2, degree + 3): of each coefficient of q, and of its value at the end, per u |p_k| for each k, per u
        of the value at the start, and per smallest number that may be lost by underflow.
    """
    degree = len(operator.ratio) - 1
    levels = ceil(log2(degree + 1))
    ratio, first, last = (np.abs(np.array(table)) for table in (operator.ratio, operator.first, operator.last))
    slack, loss = operator.slack, operator.loss
    # the last column is one that no value has: products that underflow
    given = np.eye(degree + 3)
    start, spare = given[-2], (SPARE + count + levels) * given[-1]
    y, y_error = np.zeros((degree + 2, degree + 3)), np.zeros((degree + 2, degree + 3))
    for k in range(degree, 0, -1):
        difference = (2 if k == 1 else 1) * given[k - 1] + (given[k + 1] if k < degree else 0)
        y[k] = ratio[k] * (difference + y[k + 1])
        y_error[k] = (count + 4) * y[k] + ratio[k] * y_error[k + 1] + spare
    y, y_error = y[:-1], y_error[:-1] + levels * y[:-1]
    counts = np.maximum(np.arange(degree + 1), levels) + 3.0
    summed = (degree + 4) * given[-1]
    begun, ended = start + first @ y, last @ y
    mean = (1 - slack) * begun
    mean_error = (1 - slack) * (first @ y_error + (first * counts) @ y + summed) + 3 * begun + spare
    end_error = abs(1 - loss) * mean_error + last @ y_error + (last * counts) @ y + 3 * ((1 + abs(loss)) * mean + ended)
    end_error += summed + spare
    wrong = np.empty((degree + 2, degree + 3))
    wrong[0], wrong[-1] = mean_error, end_error
    q, error = 2 * mean, 2 * mean_error
    for k in range(1, degree + 1):
        q = y[k] + ratio[k] * q
        error = y_error[k] + ratio[k] * error + 3 * q + spare
        wrong[k] = error + levels * q
    return wrong


_FIRST_BITS, _MOST_BITS = 192, 1 << 13
_RIGHT = 80  # bits of what is rounded
NEGLIGIBLE = 2.0**-100
"""Of the largest number of a matrix: what is smaller may be left out, and counts as an error."""


@dataclass(frozen=True)
class BlockResponse:
    """`matrix` as above; `truncation_error`, in the norm of energy, from the same."""

    matrix: Array
    truncation_error: Array


def block_response(space: JointSpace, length: fmpq, degree: int) -> BlockResponse:
    """The answer of a joint with a state on a panel. ArithmeticError where too many bits would be needed."""

    def attempt(_: int) -> BlockResponse | None:
        return _response(space, length, degree)

    return precise(attempt, _FIRST_BITS, _MOST_BITS)


def _response(space: JointSpace, length: fmpq, degree: int) -> BlockResponse | None:
    """None where the working precision does not do."""
    states, points, size = space.states, space.points, degree + 1
    columns = points * size + states
    rates, pushed = arb_mat(space.rates), arb_mat(space.input_rates)
    unit = arb_mat(states, states, [arb(a == b) for a in range(states) for b in range(states)])
    # of coefficient k of `pushed s`, from the columns of the answer
    given = [_columns_at(pushed, columns, [p * size + k for p in range(points)]) for k in range(size)]
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
    start = _columns_at(unit, columns, range(points * size, columns))
    twice = turned.inv(nonstop=True) * (start - first)
    series = [half * twice, *(known[k] + follows[k] * twice for k in range(1, size))]
    shown, passed = arb_mat(space.state_velocities), arb_mat(space.feedthrough)
    rows = []
    velocities = [
        shown * series[k] + _columns_at(passed, columns, [p * size + k for p in range(points)]) for k in range(size)
    ]
    for p in range(points):
        rows += [[velocities[k][p, c] for c in range(columns)] for k in range(size)]
    gained = last + straight * twice - start
    rows += [[gained[a, c] for c in range(columns)] for a in range(states)]
    left = arb(length / (4 * size)) * (rates * series[degree] + given[degree])
    missed = [[arb(space.weights[a]).sqrt() * left[a, c] for c in range(columns)] for a in range(states)]
    matrix = _round(rows)
    return (
        None
        if matrix is None
        else BlockResponse(matrix, np.array([[nearest(middle(c)) for c in row] for row in missed]))
    )


def _columns_at(block: arb_mat, columns: int, at: list[int] | range) -> arb_mat:
    """The columns of a block at these places of a wider matrix."""
    wide = arb_mat(block.nrows(), columns)
    for n, column in enumerate(at):
        for row in range(block.nrows()):
            wide[row, column] = block[row, n]
    return wide


def _round(rows: list[list[arb]]) -> Array | None:
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
