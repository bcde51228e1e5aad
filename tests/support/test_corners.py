"""The truth for links with corners against closed forms, published numbers and the balance of energy."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import pytest
from flint import arb, ctx, fmpq

from tests.support.cornered import closed_chain
from tests.support.laws import Rubbing, Yielding
from tests.support.piecewise import PiecewiseChain

DIGITS = 25
BODY = {"mass": 1, "velocity": 1, "name": "a"}


@pytest.fixture(autouse=True)
def digits():
    with ctx.workprec(200):
        yield


def chain(*parts: Any, until: object, load: Any = ()) -> PiecewiseChain:
    scene = {"system": {"type": "chain", "parts": list(parts)}, "load": list(load)}
    return PiecewiseChain(scene, Fraction(str(until)))


def near(one: arb | fmpq, other: arb | fmpq) -> bool:
    return bool(abs(arb(one) - arb(other)) < arb(10) ** -DIGITS)


def happened(made: PiecewiseChain, expected: Sequence[tuple[str, arb | fmpq]]) -> bool:
    kinds = [event.kind for event in made.events] == [kind for kind, _ in expected]
    return kinds and all(near(event.tau, tau) for event, (_, tau) in zip(made.events, expected, strict=True))


def test_a_block_on_a_spring_that_is_thrown_turns_until_it_sticks() -> None:
    """Amplitudes fall by 2 R/K each half period."""
    made = chain("fixed", {"spring": 1}, {**BODY, "velocity": 10, "friction": 1}, until=30)
    turns = [arb(10).atan() + k * arb.pi() for k in range(6)]
    assert happened(made, [*(("slips", tau) for tau in turns[:5]), ("sticks", turns[5])])
    assert near(made.value("displacement", "a", Fraction(30)), 11 - arb(101).sqrt())
    assert near(made.dissipated()[0] + made.energy(), arb(50))


@pytest.mark.parametrize("dashpot", [0, "1/2"])
def test_a_body_meets_a_spring_of_one_side_and_leaves_it(dashpot: int | str) -> None:
    """Half a period of w = sqrt(K - c^2/4), with the restitution exp(-c pi/(2 w))."""
    made = chain(BODY, {"spring": 4, "only": "push", "gap": "1/2", "dashpot": dashpot}, "fixed", until=5)
    c = arb(fmpq(*Fraction(dashpot).as_integer_ratio()))
    half = arb.pi() / (4 - c * c / 4).sqrt()
    assert happened(made, [("engages", fmpq(1, 2)), ("releases", half + fmpq(1, 2))])
    assert near(made.value("velocity", "a", Fraction(4)), -(-c * half / 2).exp())


def test_backlash_has_a_period() -> None:
    made = chain(BODY, {"spring": 4, "gap": ["-1/2", "1/4"]}, "fixed", until=6)
    half, way = arb.pi() / 2, fmpq(3, 4)
    begun = [half * k + way * k + fmpq(1, 2) for k in range(3)]
    assert happened(made, [each for tau in begun for each in (("engages", tau), ("releases", tau + half))][:5])


def test_a_spring_that_pushes_at_first_lets_go_where_it_has_no_force() -> None:
    """With gap = [A, B] and A > 0 its force is K (e - A) at e = 0: here a body that is pushed away, and caught."""
    made = chain({**BODY, "velocity": 0}, {"spring": 4, "gap": ["1/2", 1]}, "fixed", until=2)
    assert happened(made, [("releases", arb.pi() / 4), ("engages", arb.pi() / 4 + fmpq(1, 2))])
    assert near(made.energy(), fmpq(1, 2))


def test_a_spring_yields_and_keeps_a_set() -> None:
    """R/K = 3/16 is met at asin(3/8)/2 with v^2 = 1 - (3/8)^2, and the body comes to rest after v/R."""
    made = chain(BODY, {"spring": 4, "yield": "3/4"}, "fixed", until=2)
    ratio = arb(fmpq(3, 8))
    first, speed = ratio.asin() / 2, (1 - ratio**2).sqrt()
    rest = first + speed / fmpq(3, 4)
    assert happened(made, [("yields", first), ("holds", rest)])
    assert near(made.dissipated()[0], speed**2 / 2)
    assert near(made.dissipated()[0] + made.energy(), fmpq(1, 2))


@pytest.mark.parametrize("dashpot", [0, "1/3"])
def test_two_bodies_that_rub_on_each_other(dashpot: int | str) -> None:
    """They stick when (R/c) (exp(c t/mu) - 1) = v, mu the reduced mass, and go on together."""
    rub = {"friction": "1/2", "dashpot": dashpot}
    made = chain(BODY, rub, {"mass": 2, "velocity": 0, "name": "b"}, until=3)
    c, mu = fmpq(*Fraction(dashpot).as_integer_ratio()), fmpq(2, 3)
    stuck = arb(1 + 2 * c).log() * mu / c if c else arb(2 * mu)
    assert happened(made, [("sticks", stuck)])
    assert near(made.value("velocity", "a", Fraction(3)), fmpq(1, 3))
    assert near(made.value("velocity", "b", Fraction(3)), fmpq(1, 3))


def test_a_step_through_a_collar_that_rubs() -> None:
    """2 Z a - 2 Z v = R: a step of velocity 1 leaves 7/8."""
    load = [{"at": "end", "times": [0], "steps": [1]}]
    collar = {"joint": True, "name": "collar", "friction": "1/4"}
    made = chain({"joint": True, "name": "end"}, {"rod": 1}, collar, {"rod": 2}, load=load, until="3/2")
    assert happened(made, [("slips", fmpq(1))])
    assert made.value("velocity", "collar", Fraction("3/2")) == fmpq(7, 8)


def test_a_pile_without_end_on_soil_that_yields() -> None:
    """Z q + K z = Z v until z = R/K, then q = v - R/Z."""
    rod, toe = {"rod": 10, "impedance": 2, "velocity": 1}, {"joint": True, "name": "toe", "velocity": 1}
    made = chain("absorbing", rod, {**toe, "spring": 4, "yield": 1}, until=4)
    first = arb(2).log() / 2
    assert happened(made, [("yields", first)])
    assert near(made.value("displacement", "toe", Fraction(4)), (arb(4) - first) / 2 + fmpq(1, 4))
    assert near(made.dissipated()[0], (arb(4) - first) / 2)


@pytest.mark.parametrize(("resistance", "pulse"), [("1/4", "1/2"), ("1/10", "2/3")])
def test_newmarks_sliding_block(resistance: str, pulse: str) -> None:
    """Newmark 1965: after a rectangular pulse A g, a block of resistance N g has slid V^2/(2 g N) (1 - N/A)."""
    a, n, t = Fraction(1), Fraction(resistance), Fraction(pulse)
    load = [{"at": "a", "times": [0, pulse], "steps": [1, -1]}]
    made = chain({**BODY, "velocity": 0, "friction": resistance}, until=20, load=load)
    v = a * t
    assert happened(made, [("slips", arb(0)), ("sticks", fmpq(*(v / n).as_integer_ratio()))])
    slip = v**2 / (2 * n) * (1 - n / a)
    assert near(made.value("displacement", "a", Fraction(20)), fmpq(*slip.as_integer_ratio()))


@pytest.mark.parametrize("force", ["2/3", "3/4", "4/5"])
def test_an_oscillator_that_yields_under_a_force_that_stays(force: str) -> None:
    """Biggs 1964: a force F that comes at once takes it to 1/(2 (1 - F/R)) times the stretch at which it yields."""
    load = [{"at": "a", "times": [0], "steps": [force]}]
    made = chain({**BODY, "velocity": 0}, {"spring": 4, "yield": 1}, "fixed", until=4, load=load)
    assert [event.kind for event in made.events] == ["yields", "holds"]
    largest = made.value("displacement", "a", Fraction(str(made.events[1].tau)))
    assert near(largest, fmpq(*(1 / (2 * (1 - Fraction(force))) / 4).as_integer_ratio()))


@pytest.mark.parametrize("stiffness", [1, 4, 9])
def test_a_ram_on_a_cushion_and_a_pile_without_end(stiffness: int) -> None:
    """Deeks and Randolph 1993, without an anvil: the force is v k/w exp(-k t/(2 Z)) sin(w t), w^2 = k/m - (k/(2 Z))^2.

    The cushion pulls nothing: at pi/w the ram leaves it, with the restitution exp(-k pi/(2 Z w)).
    """
    pile = [{"joint": True, "name": "head"}, {"rod": 10, "impedance": 2, "velocity": 0}, "absorbing"]
    made = chain(BODY, {"spring": stiffness, "only": "push"}, *pile, until=9)
    slow = arb(stiffness) / 4
    w = (stiffness - slow**2).sqrt()
    assert happened(made, [("releases", arb.pi() / w)])
    assert near(made.value("velocity", "a", Fraction(9)), -(-slow * arb.pi() / w).exp())
    half = Fraction(1, 2)
    force = stiffness / w * (-slow * arb(half.numerator) / half.denominator).exp() * (w / 2).sin()
    assert near(made.value("velocity", "head", half), force / 2)


@pytest.mark.quick(2)
@pytest.mark.parametrize("seed", range(6))
def test_what_sliding_and_yielding_takes_is_what_energy_is_lost(seed: int) -> None:
    table = closed_chain(seed)
    begun, made = PiecewiseChain(table, 0), PiecewiseChain(table, 3)
    assert near(begun.energy(), made.energy() + sum(made.dissipated(), arb(0)))


def test_a_spring_that_forgets_what_has_yielded_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Yielding, "keep", lambda *_: None)
    with pytest.raises(AssertionError):
        test_a_spring_yields_and_keeps_a_set()


def test_friction_of_half_its_limit_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    half = property(lambda rub: vars(rub)["limit"] / 2, lambda rub, size: vars(rub).update(limit=size))
    monkeypatch.setattr(Rubbing, "limit", half, raising=False)
    with pytest.raises(AssertionError):
        test_newmarks_sliding_block("1/4", "1/2")
