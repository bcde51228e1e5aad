"""The derived delay equations against (4.6)-(4.8) of the paper, typed in from print."""

import pytest
from sympy import Integer, Rational, sympify

from wavesym.derivation.delay import COUNT, INDEX, SYMBOLS, delay_equations
from wavesym.derivation.delay_terms import Line, Operator, Source, Wave
from wavesym.systems.building import BUILDING_FORCE, BUILDING_GROUND
from wavesym.systems.collision import COLLISION
from wavesym.systems.drive import DRIVE

K, J, V = SYMBOLS.kappa, SYMBOLS.inertia, SYMBOLS.velocity


def line(waves, loads=()):
    """{(function, rod, lag): (a, b)} and {(kind, number, lag, power): value} as a Line."""
    return Line(
        {Wave(f, sympify(i), sympify(lag)): Operator(sympify(a), sympify(b)) for (f, i, lag), (a, b) in waves.items()},
        {
            Source(kind, None if n is None else sympify(n), sympify(lag), p): sympify(v)
            for (kind, n, lag, p), v in dict(loads).items()
        },
    )


def ratio(i):
    return K[i - 1] * J[i - 1] / J[i]


COLLISION_46 = {
    ("f", 1): (None, line({("g", 1, 2): (0, 1)})),
    ("g", COUNT): (None, line({("f", COUNT, 2): (0, 1)})),
    ("g", 1): (2 * K[1], line({("g", 1, 2): (-1, 0), ("g", 2, 0): (0, 2 * K[1])})),
    ("g", INDEX, 3): (2 * K[INDEX], line({("f", INDEX, 2): (-1, 0), ("g", INDEX + 1, 2): (0, 2 * K[INDEX])})),
    ("g", COUNT - 1): (None, line({("f", COUNT - 1, 2): (0, -1), ("f", COUNT, 2): (0, 1), ("f", COUNT, 4): (0, 1)})),
    ("g", INDEX, 2): (
        None,
        line({("g", INDEX + 1, 0): (0, 1)}, {("impact", None, 0, 0): -(V[INDEX - 1] - V[INDEX + 1]) / 2}),
    ),
    ("f", 2): (None, line({("g", 1, 2): (0, 1), ("g", 2, 2): (0, -1), ("g", 1, 4): (0, 1)})),
    ("f", INDEX, 4): (None, line({("g", INDEX - 1, 0): (0, 1), ("f", INDEX - 1, 2): (0, 1), ("g", INDEX, 2): (0, -1)})),
    ("f", INDEX, 3): (
        None,
        line({("f", INDEX - 1, 0): (0, 1)}, {("impact", None, 0, 0): (V[INDEX - 2] - V[INDEX]) / 2}),
    ),
    ("f", COUNT): (2 * K[COUNT - 1], line({("f", COUNT, 2): (-1, 0), ("f", COUNT - 1, 0): (0, 2 * K[COUNT - 1])})),
}
# A_i of (4.4) in the interface's unit of moment, G J_01 theta_0 / l
A = {i: K[1] * J[1] / J[i] for i in (INDEX, COUNT + 1)} | {1: K[1]}
DRIVE_47 = {
    ("g", INDEX, 1): (None, line({("f", INDEX, 2): (0, -1), ("f", INDEX + 1, 1): (0, 1), ("g", INDEX + 1, 1): (0, 1)})),
    ("g", COUNT): (
        ratio(COUNT + 1),
        line({("f", COUNT, 2): (-1, ratio(COUNT + 1))}, {("M", COUNT + 1, 1, 0): -A[COUNT + 1]}),
    ),
    ("f", 1): (K[1], line({("g", 1, 0): (-1, K[1])}, {("M", 1, 0, 0): A[1]})),
    ("f", INDEX, 2): (
        K[INDEX] + ratio(INDEX),
        line(
            {("g", INDEX, 0): (-1, K[INDEX] - ratio(INDEX)), ("f", INDEX - 1, 1): (0, 2 * ratio(INDEX))},
            {("M", INDEX, 0, 0): A[INDEX]},
        ),
    ),
}
FLOORS_48 = {
    ("g", INDEX, 1): (None, line({("f", INDEX + 1, 2): (0, 1), ("g", INDEX + 1, 2): (0, 1), ("f", INDEX, 2): (0, -1)})),
    ("g", COUNT): (K[COUNT], line({("f", COUNT, 2): (-1, K[COUNT])})),
    # the paper has equal floors; kappa_(i-1) is that of the floor at the foot of storey i
    ("f", INDEX, 2): (2 * K[INDEX - 1], line({("g", INDEX, 0): (-1, 0), ("f", INDEX - 1, 0): (0, 2 * K[INDEX - 1])})),
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
        assert (own is None) == (rate is None), key
        assert rate is None or (own - rate).expand() == 0, key
        assert found - right == Line(), key


def test_a_wrong_sign_is_seen():
    """The comparison above can fail: one sign turned in (4.7) leaves a difference."""
    e = next(e for e in delay_equations(DRIVE) if e.function == "g" and e.rod == INDEX)
    turned = line({("f", INDEX, 2): (0, 1), ("f", INDEX + 1, 1): (0, 1), ("g", INDEX + 1, 1): (0, 1)})
    assert (e.right - turned).waves == {Wave("f", INDEX, Integer(2)): Operator(Integer(0), Integer(-2))}
