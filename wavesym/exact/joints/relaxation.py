"""The motion that is left of a stiff joint when what decays fast has died away, as a polynomial.

A light mass, or a point without mass on a spring and a dashpot, answers at a rate far above all others. With the state
x = (velocities of masses, displacements of points), inputs f (forces, or velocities that are prescribed) and the law of
the joint (`state_space`)

    x' = A x + B f,    q = Q x + S f,

let P be the spectral projector of A onto all that is slow, and R the inverse of A on the rest, 0 on the slow part. The
solution whose fast part has died away is y = z + v,

    z' = A P z + P B f,   z(0) = P x(0),        v = -(R B f + R^2 B f' + R^3 B f'' + ...),

where the sum ends, as f is a polynomial. The coefficients of z follow from lower ones and grow as the slow rates do,
those of v follow from higher ones: v_n = R ((n + 1) v_(n+1) - B f_n). So one series serves a stretch on which a Taylor
series of x would have to bear exp(fast rate x length). What y leaves out, x(0) - y(0), is still there and decays.

P is what (1 + (A/s)^k)^-1 becomes for large k = 2^j, with s between the slow and the fast rates. Nothing here is
proved: whatever y is, its defect in the law and what it leaves out bound its error (`joint`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import ceil, log2
from typing import NamedTuple, cast

from flint import acb, arb, arb_mat, ctx, fmpq, fmpq_mat

from wavesym.exact.joints.joint_law import SWING, JointLaw
from wavesym.exact.joints.joint_series import Powers
from wavesym.exact.joints.state_space import ElasticState, Rows, state_space

_APART = 8  # fast rates are so many times the slow ones, at least
_OSCILLATES = 8  # and at most so many times as fast as they decay
_FAR = 2**16  # times the slow ones: no larger gap is needed to part them
_SPARE = 64  # bits
_POINTS = 20  # of a joint, at most
_SETTLED = 710  # what has decayed to exp(-this) is below 2^-1024
_LONG = 4096  # what is fast bears so many units at least where a series without it is worth while


class RateGap(NamedTuple):
    """A gap between the rates of a law: about the largest below it, the least and the largest above it.

    What is above decays at `decay` at least.
    """

    slow: fmpq
    fast: fmpq
    fastest: fmpq
    decay: fmpq

    @property
    def settling_time(self) -> fmpq:
        """When what is fast has died away, below 2^-1024 of what it was."""
        return _SETTLED / self.decay

    @property
    def resting_time(self) -> fmpq:
        """How long a stretch without what is fast has to be to be worth while."""
        return _LONG / self.fast


def settling_gap(law: JointLaw, length: fmpq) -> RateGap | None:
    """The gap above which all has died away early on a stretch, so that one series bears the rest of it; None: none."""
    if len(law.moves) > _POINTS or not law.springs:
        return None
    return next(
        (
            gap
            for gap in reversed(_gaps(_state_space(law)[0]))
            if gap.slow * length <= SWING and gap.settling_time + gap.resting_time <= length
        ),
        None,
    )


@dataclass(frozen=True, eq=False)
class Relaxation:
    """The slow part of a joint's law, that is below a gap of its rates, at the working precision at which it was made.

    With P and R of this module's docstring these are Q and S, A P, P B, R, R B, and P.
    """

    gap: RateGap
    _law: JointLaw
    _output: arb_mat
    _feedthrough: arb_mat
    _generator: arb_mat
    _input: arb_mat
    _inverse: arb_mat
    _quasistatic: arb_mat
    _projector: arb_mat

    @property
    def slow(self) -> fmpq:
        """The largest rate of what is slow, about; 0 where nothing moves."""
        return self.gap.slow

    @property
    def fast(self) -> fmpq:
        """The least rate of what decays fast, about."""
        return self.gap.fast

    @classmethod
    def separate(cls, law: JointLaw) -> tuple[Relaxation, ...]:
        """One for each gap between rates of a law above which all decays, the one with the slowest rates first."""
        if len(law.moves) > _POINTS or not (law.heavy or law.springs):
            return ()
        system = _state_space(law)
        return tuple(cls._separate_at(gap, law, *system) for gap in reversed(_gaps(system[0])))

    @classmethod
    def _separate_at(
        cls, gap: RateGap, law: JointLaw, a: fmpq_mat, b: fmpq_mat, output: fmpq_mat, through: fmpq_mat
    ) -> Relaxation:
        """What is below a gap of a law in the first order."""
        size, bits = a.nrows(), ctx.prec + _SPARE
        low, high = log2(max(float(gap.slow), float(gap.fast) / _FAR)), log2(float(gap.fast))
        step = round((low + high) / 2)
        between = fmpq(2) ** step
        doublings = ceil(log2(bits / min(high - step, step - low)))
        with ctx.workprec(2 * bits + int(2**doublings * log2(float(gap.fastest / between)))):
            one = arb_mat(fmpq_mat(size, size, [int(i == j) for i in range(size) for j in range(size)]))
            power = arb_mat(a / between)
            for _ in range(doublings):
                power = (power * power).mid()
            # pivots fall by all of the powers of the fast rates: balls would grow by these, so rounding alone
            projector = (one + power).solve(one, algorithm="approx")
            exact = arb_mat(a)
            generator = (exact * projector).mid()
            inverse = ((exact - generator + projector).inv() * (one - projector)).mid()
            found = [generator, projector * arb_mat(b), inverse, inverse * arb_mat(b), projector]
        rounded = ((each * 1).mid() for each in found)  # at the working precision
        return cls(gap, law, arb_mat(output), arb_mat(through), *rounded)

    def serves(self, length: fmpq, terms: int) -> bool:
        """Whether what is fast is so fast that its coefficients do not grow, in so many terms on such a stretch."""
        return self.fast * length > terms

    def series(
        self,
        velocity: Sequence[arb],
        displacement: Sequence[arb],
        forces: Sequence[Powers[arb]],
        prescribed: Sequence[Powers[arb]],
        terms: int,
    ) -> tuple[list[list[arb]], list[arb]]:
        """The coefficients of the velocities of groups, and the displacements of points at the start."""
        acting = [
            force if motion is None else given
            for motion, force, given in zip(self._law.motions, forces, prescribed, strict=True)
        ]
        inputs = arb_mat([[each[n] for n in range(terms)] for each in acting])
        driven, quasistatic = (self._input * inputs).mid(), (self._quasistatic * inputs).mid()
        size = self._generator.nrows()
        heavy, elastic = self._law.heavy, self._law.springs
        state = [velocity[k] for k in heavy] + (list(displacement) if elastic else [])
        slow = [(self._projector * _column(state)).mid()]
        for n in range(terms - 1):
            slow.append(((self._generator * slow[n] + _matrix_column(driven, n)) * (arb(1) / (n + 1))).mid())
        fast = [arb_mat(size, 1)] * (terms + 1)
        for n in reversed(range(terms)):
            fast[n] = (self._inverse * fast[n + 1] * (n + 1) - _matrix_column(quasistatic, n)).mid()
        found = [(slow[n] + fast[n]).mid() for n in range(terms)]
        states = arb_mat([[each[k, 0] for each in found] for k in range(size)])
        velocities = (self._output * states + self._feedthrough * inputs).mid()
        places = [states[len(heavy) + k, 0] for k in range(len(displacement))] if elastic else displacement
        return [list(row) for row in velocities.tolist()], list(places)


def _column(values: Sequence[arb]) -> arb_mat:
    return arb_mat([[value] for value in values])


def _matrix_column(matrix: arb_mat, n: int) -> arb_mat:
    return arb_mat([[matrix[k, n]] for k in range(matrix.nrows())])


def _state_space(law: JointLaw) -> tuple[fmpq_mat, fmpq_mat, fmpq_mat, fmpq_mat]:
    """A, B, Q and S of the law, whose states are velocities of masses and, where there are springs, all places."""
    groups, places = len(law.mass), law.moves if law.springs else ()
    space = state_space(
        law,
        [
            ElasticState({group: ratio}, {a: law.stiffness[a][k] for a in range(groups)})
            for k, (group, ratio) in enumerate(places)
        ],
    )
    states = len(law.heavy) + len(places)

    def matrix(rows: Rows, columns: int) -> fmpq_mat:
        return fmpq_mat(len(rows), columns, [x for row in rows for x in row])

    return (
        matrix(space.rates, states),
        matrix(space.input_rates, groups),
        matrix(space.state_velocities, states),
        matrix(space.feedthrough, groups),
    )


def _gaps(a: fmpq_mat) -> list[RateGap]:
    """The gaps above which all decays; what is fast first."""
    roots = [z for z, _ in cast("list[tuple[acb, int]]", a.charpoly().numer().complex_roots())]
    rates = sorted(((abs(z).mid(), z.real) for z in roots), key=lambda each: -each[0])
    found = []
    decay = rates[0][0] if rates else arb(0)
    for (rate, real), (slower, _) in pairwise([*rates, (arb(0), arb(0))]):
        if not -real * _OSCILLATES > rate:
            break
        decay = decay.min((-real).mid())
        if rate > slower * _APART:
            found.append(RateGap(_short(slower), _short(rate), _short(rates[0][0]), _short(decay)))
    return found


def _short(rate: arb) -> fmpq:
    """About the same in a few bits."""
    return fmpq(*float(f"{float(rate):.2g}").as_integer_ratio())
