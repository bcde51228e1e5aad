"""The derived delay equations against (4.6)-(4.8) of the paper, typed in from print."""

import pytest
from sympy import Integer, Rational, sympify

from wavesym.derivation.delay import SYMBOLS, I, M, delay_equations
from wavesym.derivation.line import Line, Operator, Source, Wave
from wavesym.mechanics.building import BUILDING_FORCE, BUILDING_GROUND
from wavesym.mechanics.collision import COLLISION
from wavesym.mechanics.drive import DRIVE

K, J, V = SYMBOLS.kappa, SYMBOLS.inertia, SYMBOLS.velocity


def line(waves, loads=()):
    """{(function, rod, lag): (a, b)} and {(kind, number, lag, power): value} as a Line."""
    return Line(
        {Wave(f, sympify(i), sympify(lag)): Operator(sympify(a), sympify(b)) for (f, i, lag), (a, b) in waves.items()},
        {Source(kind, None if n is None else sympify(n), sympify(lag), p): sympify(v) for (kind, n, lag, p), v in dict(loads).items()},
    )


def ratio(i):
    return K[i - 1] * J[i - 1] / J[i]


COLLISION_46 = {
    ("f", 1): (None, line({("g", 1, 2): (0, 1)})),
    ("g", M): (None, line({("f", M, 2): (0, 1)})),
    ("g", 1): (2 * K[1], line({("g", 1, 2): (-1, 0), ("g", 2, 0): (0, 2 * K[1])})),
    ("g", I, 3): (2 * K[I], line({("f", I, 2): (-1, 0), ("g", I + 1, 2): (0, 2 * K[I])})),
    ("g", M - 1): (None, line({("f", M - 1, 2): (0, -1), ("f", M, 2): (0, 1), ("f", M, 4): (0, 1)})),
    ("g", I, 2): (None, line({("g", I + 1, 0): (0, 1)}, {("impact", None, 0, 0): -(V[I - 1] - V[I + 1]) / 2})),
    ("f", 2): (None, line({("g", 1, 2): (0, 1), ("g", 2, 2): (0, -1), ("g", 1, 4): (0, 1)})),
    ("f", I, 4): (None, line({("g", I - 1, 0): (0, 1), ("f", I - 1, 2): (0, 1), ("g", I, 2): (0, -1)})),
    ("f", I, 3): (None, line({("f", I - 1, 0): (0, 1)}, {("impact", None, 0, 0): (V[I - 2] - V[I]) / 2})),
    ("f", M): (2 * K[M - 1], line({("f", M, 2): (-1, 0), ("f", M - 1, 0): (0, 2 * K[M - 1])})),
}
# A_i of (4.4) in the interface's unit of moment, G J_01 theta_0 / l
A = {i: K[1] * J[1] / J[i] for i in (I, M + 1)} | {1: K[1]}
DRIVE_47 = {
    ("g", I, 1): (None, line({("f", I, 2): (0, -1), ("f", I + 1, 1): (0, 1), ("g", I + 1, 1): (0, 1)})),
    ("g", M): (ratio(M + 1), line({("f", M, 2): (-1, ratio(M + 1))}, {("M", M + 1, 1, 0): -A[M + 1]})),
    ("f", 1): (K[1], line({("g", 1, 0): (-1, K[1])}, {("M", 1, 0, 0): A[1]})),
    ("f", I, 2): (
        K[I] + ratio(I),
        line({("g", I, 0): (-1, K[I] - ratio(I)), ("f", I - 1, 1): (0, 2 * ratio(I))}, {("M", I, 0, 0): A[I]}),
    ),
}
FLOORS_48 = {
    ("g", I, 1): (None, line({("f", I + 1, 2): (0, 1), ("g", I + 1, 2): (0, 1), ("f", I, 2): (0, -1)})),
    ("g", M): (K[M], line({("f", M, 2): (-1, K[M])})),
    # the paper has equal floors; kappa_(i-1) is that of the floor at the foot of storey i
    ("f", I, 2): (2 * K[I - 1], line({("g", I, 0): (-1, 0), ("f", I - 1, 0): (0, 2 * K[I - 1])})),
}
FORCE_48 = FLOORS_48 | {
    ("f", 1): (None, line({("g", 1, 0): (0, 1)}, {("a", None, 0, 0): -1 / K[0], ("b", None, 0, 1): -1 / K[0]})),
}
GROUND = FLOORS_48 | {
    ("f", 1): (None, line({("g", 1, 0): (0, -1)}, {("a", None, 0, 1): 1, ("b", None, 0, 2): Rational(1, 2)})),
}


@pytest.mark.parametrize(
    ("system", "printed"),
    [(COLLISION, COLLISION_46), (DRIVE, DRIVE_47), (BUILDING_FORCE, FORCE_48), (BUILDING_GROUND, GROUND)],
    ids=lambda value: getattr(value, "name", ""),
)
def test_derived_as_printed(system, printed):
    derived = {}
    for e in delay_equations(system):
        alone = (e.first - e.last) == 0
        key = (e.function, e.rod) if alone else (e.function, e.rod, int(e.first))
        derived[key] = (e.own.b if e.own.a == 1 else None, e.right)
    assert derived.keys() == {tuple(sympify(part) if n else part for n, part in enumerate(key)) for key in printed}
    for key, (rate, right) in printed.items():
        own, found = derived[tuple(sympify(part) if n else part for n, part in enumerate(key))]
        assert (own is None) == (rate is None) and (rate is None or (own - rate).expand() == 0), key
        assert not (found - right).waves and not (found - right).loads, key


def test_a_wrong_sign_is_seen():
    """The comparison above can fail: one sign turned in (4.7) leaves a difference."""
    e = next(e for e in delay_equations(DRIVE) if e.function == "g" and e.rod == I)
    turned = line({("f", I, 2): (0, 1), ("f", I + 1, 1): (0, 1), ("g", I + 1, 1): (0, 1)})
    assert (e.right - turned).waves == {Wave("f", I, Integer(2)): Operator(Integer(0), Integer(-2))}
