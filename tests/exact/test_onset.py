"""How motions begin: first powers against closed forms, and what they tell of contacts that balls do not."""

from __future__ import annotations

from itertools import islice
from math import comb

import pytest
from flint import arb, ctx, fmpq, fmpq_poly

from tests.exact.test_contact_truth import wrong
from tests.support.touching import FIXED, body, contact, line, q, rod, seen, told
from wavesym.errors import CostError
from wavesym.exact.contacts.course import Course
from wavesym.exact.contacts.events import events
from wavesym.exact.joints.enclosure import ORDER, Onset, combine
from wavesym.exact.joints.joint_law import JointLaw
from wavesym.exact.joints.joint_series import motion_series, onsets
from wavesym.exact.reference import Reference
from wavesym.programs.pieces import pieces

LAW = JointLaw((q(1),), ((q(2),),), ((q(3),),), (None,))


def swinging(w):
    """q of q' + 2 q + 3 u = 0, u' = q, from q = 1, u = 0."""
    root = arb(2).sqrt()
    return (-w).exp() * ((root * w).cos() - (root * w).sin() / root)


def begins(length, law=LAW):
    (found,) = onsets(law, ([q(1)], [q(0)]), [Onset(fmpq_poly())], [Onset(fmpq_poly())], [arb(1)], length)
    return found


def within(onset, length):
    with ctx.workprec(200):
        places = [arb(length) * k / 16 for k in range(1, 17)]
        return all(
            abs(
                swinging(w)
                - arb(onset.powers(fmpq(0)))
                - sum(arb(c) * w**n for n, c in enumerate(onset.powers.coeffs()) if n)
            )
            <= dict(onset.rests)[ORDER] * w**ORDER
            for w in places
        )


@pytest.mark.parametrize("length", [q(1), q("1/10"), q("1/1000")])
def test_the_first_powers_are_those_of_the_closed_form_and_the_rest_is_bounded(length):
    assert within(begins(length), length)


def test_another_law_is_seen():
    assert not within(begins(q("1/10"), JointLaw((q(1),), ((q(2),),), ((q(4),),), (None,))), q("1/10"))
    good = begins(q("1/10"))
    assert not within(Onset(good.powers, ((ORDER, good.rests[0][1] / 10**4),)), q("1/10"))


PAIR = JointLaw((q(0), q(1)), ((q(2), q(-1)), (q(-1), q(1))), ((q(3), q(-3)), (q(-3), q(3))), (None, None))
"""A point without mass and a body, between them a spring and a dashpot."""
APART = JointLaw((q(0), q(0)), ((q(2), q(0)), (q(0), q(1))), ((q(3), q(-3)), (q(-3), q(3))), (None, None))
"""Two without mass, between them a spring alone."""


@pytest.mark.parametrize(
    ("law", "orders"), [(LAW, [9]), (PAIR, [8, 9]), (APART, [8, 9])], ids=["body", "pair", "apart"]
)
@pytest.mark.parametrize("length", [q(1), q("1/9")])
def test_each_mass_and_spring_makes_one_more_power_known(law, orders, length):
    """A force of which eight powers are told, and how large the eighth derivative of the others is."""
    c = [q(0)] * 6 + [q(n * n - 40) / (n + 1) for n in range(6)]
    rest = sum((abs(arb(c[n])) * comb(n, 8) * arb(length) ** (n - 8) for n in range(8, 12)), arb(0))
    size = len(law.mass)
    acting = [fmpq_poly(c), *[fmpq_poly()] * (size - 1)]
    forces = [Onset(fmpq_poly(c[:8]), ((8, rest),)), *[Onset(fmpq_poly())] * (size - 1)]
    none = [fmpq_poly()] * size
    *_, (series, _, _) = islice(motion_series(law, [q(0)] * size, [q(0)] * size, acting, none, fmpq, lambda x: x), 61)
    sizes = [sum((abs(arb(value)) * arb(length) ** n for n, value in enumerate(each)), arb(0)) for each in series]
    found = onsets(law, ([q(0)] * size, [q(0)] * size), forces, [Onset(p) for p in none], sizes, length)
    assert [each.order for each in found] == orders
    for each, known in zip(found, series, strict=True):
        ((order, beyond),) = each.rests
        for w in (length * k / 8 for k in range(1, 9)):
            assert abs(arb(fmpq_poly(known)(w) - each.powers(w))) <= beyond * arb(w) ** order + arb(2) ** -40


def equal_bodies(number, *bodies):
    """As a row of balls: the first strikes the others, which touch each other."""
    parts = []
    for k in range(number):
        parts += [*({**part, "velocity": int(k == 0)} if "spring" not in part else part for part in bodies), "contact"]
    return parts[:-1]


MASS, ROD = {"mass": 1}, {"rod": 1}


@pytest.mark.parametrize(
    ("bodies", "until", "last"),
    [
        ([MASS, ROD], "7.5", 8),
        pytest.param([ROD, MASS, ROD], "13.5", 16, marks=pytest.mark.slow),
        pytest.param([ROD, {"spring": 4}, ROD], "13.5", 16, marks=pytest.mark.slow),
    ],
    ids=["bodies", "balls", "springs"],
)
def test_a_wave_through_many_equal_bodies_comes_to_the_last_contact(bodies, until, last):
    """It begins there with the seventh power of the time: each body that it passes makes it smoother."""
    output = {"until": until, "velocity": ["1/3", f"{last}-"], "strain": [f"{last - 1}+"]}
    system = {"type": "chain", "parts": equal_bodies(8, *bodies)}
    assert wrong({"name": "equal", "system": system, "output": output}) == []


def test_signs_hold_as_far_as_is_said():
    rest = (ORDER, arb(5)), (ORDER, arb(1))
    rises = combine(
        [(q(2), Onset(fmpq_poly([0, 0, q("1/2"), -3]), rest[:1])), (q(-1), Onset(fmpq_poly([0, 0, 0, 1]), rest[1:]))]
    )
    assert rises.sign() == 1
    far = rises.positive_until(q(1))
    assert 0 < far < q("1/7")  # w^2 - 7 w^3
    w = arb(far)
    assert w**2 - 7 * w**3 - 11 * w**ORDER > 0
    assert Onset(fmpq_poly([0, -1])).positive_until(q(1)) == 0
    assert Onset(fmpq_poly([0] * ORDER + [1])).sign() == 1
    assert Onset(fmpq_poly([0] * ORDER + [1]), rest[:1]).sign() == 0


def test_a_wave_that_begins_smoothly_parts_a_contact_when_it_comes():
    """Rods at rest beside each other; a body behind the second is pulled away from tau = 0 on."""
    parts = [FIXED, rod(), body(1), contact(), rod(), body(1, force=1)]
    (event,) = [event for _, _, event in told(line(parts, 3))]
    assert event.kind == "opens"
    assert event.tau == 1  # not about 1


def mirrored(velocity):
    parts = [body(1, velocity=1), rod(velocity=1), contact("1/3"), rod(), rod(), contact("1/3")]
    return line([*parts, rod(velocity=-1), body(1, velocity=velocity)], 4, [seen(2, 0), seen(2, 0, "strain")])


def test_what_a_mirror_makes_0_has_a_program():
    model = mirrored(-1)
    still, strained = Reference(model).largest()
    assert still == 0
    assert strained > 1
    found = pieces(model, Reference(model).real, q("1e-8"))
    assert found.outputs[0].largest == 0
    assert 0 < found.outputs[0].bound < 2**-199
    shown = [piece[grid.outputs.index(0)] for grid in found.grids if 0 in grid.outputs for piece in grid.powers]
    assert {number for powers in shown for number in powers} == {0.0}


def test_what_is_only_nearly_0_has_a_size():
    moved, _ = Reference(mirrored(q(-1) + fmpq(1, 10**30))).largest()
    assert 0 < moved < fmpq(1, 10**29)


def test_the_free_side_of_a_contact_that_stays_open_is_not_strained():
    parts = [body(1, velocity=1), contact(), rod(), contact(1), rod(velocity=1)]
    assert Reference(line(parts, 2, [seen(0, 1, "strain")])).largest() == [0]


def test_light_bodies_are_moved_as_far_as_a_series_bears():
    """N = exp(-1000 tau) until the first reflection."""
    assert told(line([body("1/1000", velocity=1), contact(), rod(), FIXED], "1/20")) == []
    (event,) = events(line([rod(velocity=1), body("1/100"), contact("1/4"), rod(), FIXED], "3/2"))
    assert event.kind == "closes"


def test_what_moves_too_often_is_refused_at_once(monkeypatch):
    monkeypatch.setattr(Course, "advance", None)
    with pytest.raises(CostError, match="waves cross the shortest rod in tau = 1e-06"):
        events(line([rod("1/1000000", velocity=1), contact("1/3"), rod()], 3))
