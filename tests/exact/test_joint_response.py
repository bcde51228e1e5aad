"""What joints answer: partial fractions against the matrix itself, and which polynomials split."""

from __future__ import annotations

import gc
import weakref
from math import prod

import pytest
from flint import fmpq, fmpq_mat, fmpq_poly
from hypothesis import given
from hypothesis import strategies as st

from wavesym.derivation.increments import start
from wavesym.exact.joints.joint_law import JointLaw
from wavesym.exact.tables.joint_response import (
    JointResponse,
    joint_polynomial,
    joint_response,
    partial_fractions,
    polynomial_text,
    rates,
)

Q = fmpq


def law(
    mass: list[object], damping: list[list[object]], stiffness: list[list[object]], given: list[str | None]
) -> JointLaw:
    return JointLaw(
        tuple(map(fmpq, mass)),
        tuple(tuple(map(fmpq, row)) for row in damping),
        tuple(tuple(map(fmpq, row)) for row in stiffness),
        tuple(given),
    )


NO = [[0, 0], [0, 0]]
LAWS = {
    "body": law([2], [[3]], [[0]], [None]),
    "joint": law([0], [[Q(5, 2)]], [[0]], [None]),
    "spring without mass": law([0], [[2]], [[3]], [None]),
    "overdamped": law([1], [[5]], [[6]], [None]),
    "critical": law([1], [[4]], [[4]], [None]),
    "dashpot between joints": law([0, 0], [[3, -1], [-1, 2]], NO, [None, None]),
    "dashpot between joint and body": law([0, 2], [[3, -1], [-1, 2]], NO, [None, None]),
    "spring between joints": law([0, 0], [[1, 0], [0, 2]], [[3, -3], [-3, 3]], [None, None]),
    "held by a fixed end": law([1, 0], [[5, 0], [0, 1]], [[6, -6], [-6, 6]], [None, "fixed"]),
    "equal bodies": law([1, 1], [[3, -1], [-1, 3]], NO, [None, None]),
}


def at(response: JointResponse, s: fmpq) -> dict[tuple[int, int], fmpq]:
    """The answer in the variable s."""
    total = dict(response.direct)
    for pole in response.poles:
        for k, residues in enumerate(pole.residues, 1):
            for place, value in residues.items():
                total[place] = total.get(place, Q(0)) + value / (s + pole.rate) ** k
    return total


@pytest.mark.parametrize("name", LAWS)
def test_partial_fractions_are_the_inverse_of_the_matrix(name: str) -> None:
    made = LAWS[name]
    free = [k for k, motion in enumerate(made.motions) if motion is None]
    for s in (Q(1, 7), Q(2), Q(31)):
        rows = [
            [made.mass[a] * s * (a == b) + made.damping[a][b] + made.stiffness[a][b] / s for b in free] for a in free
        ]
        inverse = fmpq_mat(rows).inv()
        found = at(joint_response(made), s)
        for i, a in enumerate(free):
            for j, b in enumerate(free):
                assert found.get((a, b), Q(0)) == inverse[i, j]
        determinant = fmpq_mat(rows).det()
        cleared = joint_polynomial(made)(s) / determinant
        assert cleared in (1, s, s**2), "the determinant times what clears the fractions"


def test_rates_are_those_of_the_motion() -> None:
    assert rates(LAWS["body"]) == {Q(3, 2): 1}
    assert rates(LAWS["joint"]) == {}
    assert rates(LAWS["overdamped"]) == {2: 1, 3: 1}
    assert rates(LAWS["critical"]) == {2: 2}
    assert rates(LAWS["equal bodies"]) == {2: 1, 4: 1}
    assert rates(law([1], [[1]], [[1]], [None])) is None
    assert rates(law([1], [[2]], [[Q(1, 2)]], [None])) is None, "real, but not rational"


def test_what_does_not_split_has_no_answer() -> None:
    made = law([1], [[1]], [[1]], [None])
    assert polynomial_text(joint_polynomial(made)) == "s^2 + s + 1"
    with pytest.raises(ValueError, match="does not split"):
        joint_response(made)


def test_a_push_makes_a_body_move() -> None:
    """Its momentum over its mass, which dies away at its rate; with a spring it comes to rest and back."""
    assert joint_response(LAWS["body"]).velocities({}, {0: Q(6)}) == {0: {Q(3, 2): [3]}}
    moved = joint_response(LAWS["critical"]).velocities({}, {0: Q(1)})[0]
    assert (moved, start(moved)) == ({Q(2): [1, -2]}, 1)


ROOTS = st.lists(st.sampled_from([Q(0), Q(1), Q(1, 3), Q(1001, 1000), Q(7)]), min_size=1, max_size=4)


@given(ROOTS, st.lists(st.fractions(-3, 3, max_denominator=5), min_size=1, max_size=4), st.sampled_from([1, Q(3, 2)]))
def test_partial_fractions_add_up(roots: list[fmpq], above: list[object], leading: object) -> None:
    below = prod((fmpq_poly([root, 1]) for root in roots), start=fmpq_poly([leading]))
    top = fmpq_poly([Q(*c.as_integer_ratio()) for c in above[: len(roots) + 1]])
    whole, parts = partial_fractions(top, below)
    s = Q(5, 11)
    total = whole + sum(value / (s + rate) ** k for rate, row in parts.items() for k, value in enumerate(row, 1))
    assert total == top(s) / below(s)


@pytest.mark.parametrize(
    ("coefficients", "text"),
    [
        ([Q(3, 5), 0, 1], "s^2 + 3/5"),
        ([-1, -2], "-2 s - 1"),
        ([7], "7"),
        ([1] * 9, "s^8 + s^7 + ... (9 terms)"),
        ([Q(-1, 3 * 10**299), 10**300], "1.0000e+300 s - 3.3333e-300"),
    ],
)
def test_polynomials_are_written(coefficients: list[object], text: str) -> None:
    assert polynomial_text(fmpq_poly(coefficients), most=2) == text


def test_answers_of_laws_that_are_long_past_are_not_kept() -> None:
    """Whoever computes many scenes in one process has no use for those of the first."""
    first = law([Q(1, 10**6)], [[3]], [[0]], [None])
    rates(first), joint_response(first)
    past = weakref.ref(first)
    del first
    for k in range(600):
        joint_response(law([k + 10**6], [[3]], [[0]], [None]))
    gc.collect()
    assert past() is None
