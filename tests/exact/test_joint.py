"""Joints in motion: all that the proof allows for, and little more, against closed forms and matrix exponentials."""

from __future__ import annotations

from itertools import pairwise

import pytest
from flint import arb, arb_mat, arb_poly, ctx, fmpq, fmpq_poly
from hypothesis import given, settings
from hypothesis import strategies as st

from wavesym.exact.joints.enclosure import STILL, Enclosure
from wavesym.exact.joints.joint_law import JointLaw
from wavesym.exact.joints.joint_motion import JointMotion
from wavesym.exact.joints.state_space import ElasticState, state_space
from wavesym.mechanics.network import Bar, Link, Network, Point
from wavesym.numbers.ratio import Ring

SMALL = st.fractions(0, 4, max_denominator=6).map(lambda x: fmpq(x.numerator, x.denominator))
POSITIVE = st.fractions("1/4", 4, max_denominator=6).map(lambda x: fmpq(x.numerator, x.denominator))


@pytest.fixture(autouse=True)
def _precision():
    with ctx.workprec(256):
        yield


def law(mass, damping, stiffness=None, given=None):
    size = len(mass)
    none = [[0] * size] * size
    return JointLaw(
        tuple(map(fmpq, mass)),
        tuple(tuple(map(fmpq, row)) for row in damping),
        tuple(tuple(map(fmpq, row)) for row in stiffness or none),
        tuple(given or [None] * size),
    )


def moving(joint, velocity=None, displacement=None):
    size = len(joint.mass)
    return JointMotion(joint, [arb(v) for v in velocity or [0] * size], [arb(u) for u in displacement or [0] * size])


def wave(powers, error=0):
    return Enclosure(arb_poly(powers), arb(error))


def driven(gamma, powers, start, u):
    """The q with q' + gamma q = sum_k powers[k] u**k and q(0) = start, in closed form."""
    steady = [arb(0)] * (len(powers) + 1)
    for k in reversed(range(len(powers))):
        steady[k] = (arb(powers[k]) - (k + 1) * steady[k + 1]) / gamma
    return arb_poly(steady)(arb(u)) + (start - steady[0]) * (-arb(gamma) * arb(u)).exp()


@pytest.mark.parametrize(
    ("force", "length"),
    [
        (wave([800]), 1),  # the defect alone
        (wave([0, 3]), 1),  # with a power of the right side in it
        (wave([1, 0, 80_000]), 1),  # the last power of the right side is as large as what it is to balance
        (wave([1, 0, -160_000]), 1),
        (wave([2], "1e4"), 1),
        (wave([-3], 2**14), fmpq(1, 2)),
    ],
)
def test_a_cut_off_series_is_off_by_what_is_told(force, length):
    """With three terms and a rate of 400 the defect is all there is."""
    gamma, terms = 400, 3
    (cut,) = moving(law([1], [[gamma]])).move([force], [fmpq_poly()], fmpq(length), terms)
    worst = arb(0)
    for sign in (-1, 1):
        powers = [arb(c) for c in force.polynomial.coeffs()]
        powers[0] += sign * force.error
        for k in range(201):
            u = fmpq(k, 200) * length
            error = abs(driven(gamma, powers, arb(0), u) - cut.polynomial(arb(u)))
            assert not error > cut.error
            worst = worst.max(error)
    assert worst > cut.error * fmpq(4, 10)


def test_an_error_at_the_start_goes_on():
    joint = moving(law([1], [[2]]))
    (first,) = joint.move([wave([2], fmpq(1, 5))], [fmpq_poly()], fmpq(1), 30)
    (second,) = joint.move([STILL], [fmpq_poly()], fmpq(1, 2), 30)
    for off in (-1, 0, 1):
        ended = driven(2, [2 * (1 + off * fmpq(1, 10))], arb(0), 1)
        assert first.evaluate(fmpq(1)).contains(ended)
        for u in (fmpq(0), fmpq(1, 4), fmpq(1, 2)):
            assert second.evaluate(u).contains(ended * (-2 * arb(u)).exp())
    assert second.evaluate(fmpq(0)).rad() < fmpq(11, 100)  # 1/5 over gamma = 2


def test_a_point_without_mass_follows_at_once():
    (moved,) = moving(law([0], [[4]])).move([wave([7, 14], fmpq(7, 8))], [fmpq_poly()], fmpq(1), 9)
    assert moved.polynomial(arb(1)).contains(fmpq(21, 4))
    assert moved.error >= fmpq(7, 32)
    assert moved.error < fmpq(7, 32) + fmpq(1, 2**200)


@pytest.mark.parametrize(("damping", "stiffness"), [(1, 3), (2, 1), (fmpq(1, 2), 8)])
def test_a_spring_pulls_a_point_without_mass_back_from_where_it_may_be(damping, stiffness):
    """c q + k u = s: what s may be off by is in u when it ends, and then in q, though nothing acts any more."""
    c, k, off, length = fmpq(damping), fmpq(stiffness), fmpq(1, 5), fmpq(1)
    joint = moving(law([0], [[c]], [[k]]))
    joint.move([wave([2], off)], [fmpq_poly()], length, 60)
    (later,) = joint.move([STILL], [fmpq_poly()], length, 60)
    for sign in (-1, 0, 1):
        displaced = (2 + sign * off) / k * (1 - (-arb(k / c) * arb(length)).exp())
        for u in (fmpq(0), fmpq(1, 3), length):
            assert later.evaluate(u).contains(-arb(k / c) * displaced * (-arb(k / c) * arb(u)).exp())
    assert later.error < 8 * off * k / c  # and no more than some times that


def test_what_does_not_move_is_exactly_still():
    (moved,) = moving(law([1], [[1]])).move([STILL], [fmpq_poly()], fmpq(1), 9)
    assert moved.polynomial.length() == 0
    assert moved.error == 0


def test_a_prescribed_point_moves_as_it_is_told():
    joint = moving(law([0, 1], [[1, -1], [-1, 2]], given=["velocity", None]))
    told, pulled = joint.move([STILL, STILL], [fmpq_poly([3, 1]), fmpq_poly()], fmpq(1), 40)
    assert told.polynomial(arb(1)).contains(4)
    # 1 q' + 2 q = 3 + u
    assert pulled.evaluate(fmpq(1)).overlaps(driven(2, [3, 1], arb(0), 1))


def exponential(joint, velocity, force, u):
    """The motion of points with mass under constant forces by the exponential of a matrix: (q, u)' = A (q, u) + b."""
    size = len(joint.mass)
    matrix = arb_mat(2 * size + 1, 2 * size + 1)
    for a in range(size):
        for b in range(size):
            matrix[a, b] = arb(-joint.damping[a][b] / joint.mass[a])
            matrix[a, size + b] = arb(-joint.stiffness[a][b] / joint.mass[a])
        matrix[a, 2 * size] = arb(force[a]) / arb(joint.mass[a])
        matrix[size + a, a] = arb(1)
    state = arb_mat(2 * size + 1, 1, [*velocity, *[arb(0)] * size, arb(1)])
    found = (matrix * arb(u)).exp() * state
    return [found[a, 0] for a in range(size)]


@settings(max_examples=25, deadline=None)
@given(
    st.lists(POSITIVE, min_size=2, max_size=3),
    st.lists(SMALL, min_size=3, max_size=3),
    st.lists(SMALL, min_size=3, max_size=3),
    st.sampled_from([1, 1000, 10**6]),
    st.sampled_from([4, 40, 200]),
)
def test_springs_and_dashpots_between_masses(mass, dashpots, springs, stiff, terms):
    """On two stretches, with few terms and many: what is told of the error holds, and stiffness leaves it small."""
    size = len(mass)
    points = tuple(Point(m, damping=d, stiffness=stiff * k) for m, d, k in zip(mass, dashpots, springs, strict=False))
    links = tuple(Link(a, b, stiff * springs[a], dashpots[b]) for a, b in pairwise(range(size)))
    network = Network((*points, Point(fmpq(0))), (Bar(0, size, fmpq(1), fmpq(1), fmpq(1)),), links)
    joint = JointLaw.assemble(network, network.joints[0])
    velocity, force = [arb(k + 1) for k in range(size)], [fmpq(2 - k) for k in range(size)]
    motion = moving(joint, [k + 1 for k in range(size)])
    length = fmpq(1, 200) if stiff > 1 else fmpq(1)
    for start in (fmpq(0), length):
        found = motion.move([wave([f]) for f in force], [fmpq_poly()] * size, length, terms)
        for part in (fmpq(0), fmpq(1, 3), fmpq(1)):
            exact = exponential(joint, velocity, force, start + part * length)
            for known, true in zip(found, exact, strict=True):
                assert known.evaluate(part * length).overlaps(true)
        if terms == 200:
            assert all(known.error < fmpq(1, 10**20) for known in found)


def test_a_joint_without_rod_or_dashpot_has_no_law():
    with pytest.raises(ZeroDivisionError):
        _ = law([0], [[0]]).inverse


def test_the_inverse_of_functions_is_that_of_their_numbers() -> None:
    """Numbers are inverted by FLINT, functions by elimination."""
    ring, numbers = Ring(("a", "b", "c")), {"a": fmpq(2, 3), "b": fmpq(7), "c": fmpq(1, 5)}

    def inverse(values):
        a, b, c = values["a"], values["b"], values["c"]
        rows = ((a + b, -b, 0 * a), (-b, b + c, -c), (0 * a, -c, c))
        return JointLaw((fmpq(0),) * 3, rows, ((fmpq(0),) * 3,) * 3, (None,) * 3).inverse

    of_numbers = inverse(numbers)
    assert {key: value.evaluate(numbers) for key, value in inverse(ring.symbols()).items()} == of_numbers
    for place, value in {(0, 0): fmpq(3, 2), (1, 1): fmpq(3, 2) + fmpq(1, 7), (1, 2): fmpq(3, 2) + fmpq(1, 7)}.items():
        assert of_numbers[place] == value  # dashpots in a row, one after the other to the ground


@given(st.data())
@settings(max_examples=25, deadline=None)
def test_the_first_order_form_of_a_joint_balances_the_forces_at_each_point(data: st.DataObject) -> None:
    size = data.draw(st.integers(1, 4))
    motions = [data.draw(st.sampled_from([None, None, "velocity"])) for _ in range(size)]
    mass = [data.draw(st.sampled_from([fmpq(0), fmpq(2), fmpq(5, 3)])) for _ in range(size)]
    damping = [[fmpq(0)] * size for _ in range(size)]
    for a in range(size):
        damping[a][a] += data.draw(POSITIVE)
        for b in range(a):
            c = data.draw(SMALL)
            for i, j, sign in ((a, a, 1), (b, b, 1), (a, b, -1), (b, a, -1)):
                damping[i][j] += sign * c
    joint = law(mass, damping, given=motions)
    springs = [{a: data.draw(SMALL) - 1 for a in range(size)} for _ in range(data.draw(st.integers(0, 2)))]
    space = state_space(joint, [ElasticState(row, {a: 3 * c for a, c in row.items()}) for row in springs])
    masses, states = len(joint.heavy), len(joint.heavy) + len(springs)
    for column in range(states + size):
        x, s = (
            [fmpq(int(n == column - first)) for n in range(count)] for first, count in ((0, states), (states, size))
        )
        q = [dot(space.state_velocities[a], x) + dot(space.feedthrough[a], s) for a in range(size)]
        changes = [dot(space.rates[n], x) + dot(space.input_rates[n], s) for n in range(states)]
        assert [q[a] for a in joint.heavy] == x[:masses]
        assert changes[masses:] == [dot(row.values(), q) for row in springs]
        for a in range(size):
            if motions[a] is not None:
                assert q[a] == s[a]
                continue
            inertia = mass[a] * changes[joint.heavy.index(a)] if mass[a] else fmpq(0)
            pulled = sum((3 * row[a] * z for row, z in zip(springs, x[masses:], strict=True)), fmpq(0))
            assert inertia + dot(damping[a], q) + pulled == s[a]


def dot(one, other):
    return sum((a * b for a, b in zip(one, other, strict=True)), fmpq(0))
