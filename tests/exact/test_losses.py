"""What links lose where they rub or yield, against closed forms."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest
from flint import arb, fmpq
from hypothesis import given
from hypothesis import strategies as st

import wavesym
from wavesym.exact.losses import losses
from wavesym.mechanics.model import Model
from wavesym.scene import Scene, lower

SMALL = st.fractions(Fraction(1, 4), 4, max_denominator=8)
PART = st.fractions(Fraction(1, 8), Fraction(7, 8), max_denominator=8)


def exact(value: Fraction) -> arb:
    return arb(fmpq(value.numerator, value.denominator))


def chain_scene(parts: list[Any], until: Fraction) -> Scene:
    output = {"until": until, "tolerance": 1e-9, "displacement": ["a"]}
    return Scene(name="lossy", system={"type": "chain", "parts": parts}, output=output)


def chain(parts: list[Any], until: Fraction) -> Model:
    return lower(chain_scene(parts, until))


@given(far=SMALL, speed=SMALL, limit=SMALL, part=PART)
def test_what_slides_to_rest_loses_what_its_spring_does_not_take(
    far: Fraction, speed: Fraction, limit: Fraction, part: Fraction
) -> None:
    """It comes so far: m v^2 / 2 = R d + K d^2 / 2, and stays there, as K d is a part of R."""
    stiffness = part * limit / far
    mass = (2 * limit * far + stiffness * far**2) / speed**2
    block = {"mass": mass, "velocity": speed, "friction": limit, "name": "a"}
    (found,) = losses(chain([block, {"spring": stiffness}, "fixed"], 2 * far / speed + 1))
    assert found.dissipated.overlaps(exact(limit * far))
    assert found.dissipated.rad() < 1e-30
    assert found.set.overlaps(exact(far))


@given(mass=SMALL, speed=SMALL, stiffness=SMALL, part=PART)
def test_what_a_spring_yields_is_the_energy_that_it_does_not_give_back(
    mass: Fraction, speed: Fraction, stiffness: Fraction, part: Fraction
) -> None:
    """R is a part of what the spring would take, K s^2 / 2 = m v^2 / 2; as it holds, R^2 / (2 K) is left in it."""
    swing = Fraction(float(mass / stiffness) ** 0.5).limit_denominator(1000)
    limit = part * speed * swing * stiffness
    body = {"mass": mass, "velocity": speed, "name": "a"}
    yields = {"spring": stiffness, "yield": [100, limit]}
    (found,) = losses(chain([body, yields, "fixed"], 2 * swing + mass * speed / limit))
    energy = mass * speed**2 / 2 - limit**2 / (2 * stiffness)
    assert found.dissipated.overlaps(exact(energy))
    assert found.dissipated.rad() < 1e-30
    assert found.set.overlaps(exact(-energy / limit))


def test_a_summary_tells_sets_in_units(tmp_path: Any) -> None:
    path = tmp_path / "slab.toml"
    path.write_text(
        """
name = "slab"
[units]
length = "mm"
[system]
type = "chain"
parts = [{ mass = "2 kg", velocity = "3 m/s", friction = "4 N", name = "slab" }, { spring = "1 N/m" }, "fixed"]
[output]
until = "2 s"
displacement = ["slab"]
"""
    )
    (link,) = wavesym.summary(Scene.from_toml(str(path))).links or ()
    stops = 34**0.5 - 4  # 9 J = 4 N s + 1 N/m s^2 / 2
    assert link.dissipated == (pytest.approx(4 * stops, rel=1e-15), "J")
    assert link.set == (pytest.approx(1000 * stops, rel=1e-15), "mm")


@pytest.mark.parametrize(("speed", "limits"), [(1, [0, 5]), (-1, [5, 0])])
@pytest.mark.parametrize("before_fixed", [False, True])
def test_a_spring_whose_limits_are_exchanged_gives_way(speed: int, limits: list[int], before_fixed: bool) -> None:
    """A body goes on as if nothing held it, v t far; with its limits the other way round the spring stops it."""
    for pair, gives_way in ((limits, not before_fixed), (limits[::-1], before_fixed)):
        spring = {"spring": 100, "yield": pair}
        body = {"mass": 1, "velocity": speed, "name": "a"}
        parts = [body, spring, "fixed"] if before_fixed else [body | spring, {"rod": 1, "impedance": "1/1000000"}]
        (found,) = losses(chain(parts, Fraction(1, 20)))
        assert found.gives_way == gives_way, pair
        if gives_way:
            assert found.dissipated == 0
            assert float(abs(found.set)) == pytest.approx(1 / 20, rel=1e-5)


def test_a_spring_that_was_loaded_before_it_let_go_does_not_give_way() -> None:
    """It bears all of a swing there and back, K s^2 = m v^2, less than its limit, and then yields without a force."""
    body = {"mass": 1, "velocity": 1, "name": "a"}
    (found,) = losses(chain([body, {"spring": 1, "yield": [0, 5]}, "fixed"], Fraction(4)))
    assert found.dissipated == 0
    assert float(found.set) == pytest.approx(4 - 3.141592653589793, rel=1e-12)
    assert not found.gives_way


def test_a_set_is_rounded_once() -> None:
    """(1/2 - R^2 / (2 K)) / R = 31/16, as above: a double, which twice rounded was the one beside it."""
    body = {"mass": 1, "velocity": 1, "name": "a"}
    (link,) = wavesym.summary(chain_scene([body, {"spring": 2, "yield": "1/4"}, "fixed"], Fraction(10))).links or ()
    assert (link.set.value, link.dissipated.value) == (-31 / 16, 31 / 64)
