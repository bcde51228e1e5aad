"""Explicit chains against published and elementary numbers, and what must hold of every chain."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

import wavesym

EXACT = 4e-16
"""A few roundings of a double."""


def values(
    parts: Sequence[Any],
    taus: Sequence[float],
    load: Sequence[Mapping[str, Any]] = (),
    branch: Sequence[Mapping[str, Any]] = (),
    **outputs: Sequence[Any],
) -> np.ndarray:
    """The outputs of a chain, one row each: strains, velocities, displacements."""
    system = {"type": "chain", "parts": list(parts), "branch": list(branch)}
    scene = wavesym.Scene(name="known", system=system, load=list(load), output={"until": max(taus) or 1, **outputs})
    return wavesym.evaluator(scene)(np.array(taus, dtype=float))


def step(at: str | int, size: object = 1, time: object = 0) -> dict[str, Any]:
    return {"at": at, "times": [time], "steps": [size]}


# ---- published numbers


def test_a_bar_pushed_at_one_end() -> None:
    """Timoshenko; ANSYS VM84: E 3e7 psi, rho 7.202e-4, L 48 000 in, A 2 in^2, a force of 6000 lb at a free end."""
    young, density, length, area, force = 3e7, 7.202e-4, 48_000, 2, 6000
    speed = math.sqrt(young / density)
    assert speed == pytest.approx(204095.800561208, rel=1e-14)
    assert length / speed == pytest.approx(0.235183672902691, rel=1e-14)
    velocity = force * speed / (young * area)  # force over impedance
    found = values(
        [{"joint": True, "name": "end"}, {"rod": 1}], [0, 1, 1.5, 2, 3, 4, 5.5], [step("end")], velocity=[0, 1]
    )
    assert found[0].tolist() == [1, 1, 1, 3, 3, 5, 5]
    assert found[1].tolist() == [0, 2, 2, 2, 4, 4, 6]
    assert found[0, 0] * velocity == pytest.approx(20.4095800561208, rel=1e-14)
    moved = values([{"joint": True, "name": "end"}, {"rod": 1}], [1, 2], [step("end")], displacement=[0])
    assert (moved[0] * velocity * length / speed).tolist() == pytest.approx([4.8, 9.6], rel=1e-14)
    # with the numbers of the bar itself, in its own units
    rod = {
        "rod": length,
        "speed": "204095.800561208",
        "impedance": str(Fraction(young * area) / Fraction("204095.800561208")),
    }
    own = values(
        [{"joint": True, "name": "end"}, rod], [length / speed], [step("end", force)], velocity=[0], displacement=[0]
    )
    assert own[:, 0].tolist() == pytest.approx([20.4095800561208, 4.8], rel=1e-14)


@pytest.mark.parametrize("beta", ["1/4", "1/2", 3])
def test_stresses_that_pass_a_split_hopkinson_bar(beta: object) -> None:
    """Three bars, the middle one of impedance beta: after its n-th arrival the stress passed is 1 - R^(2n)."""
    middle = Fraction(str(beta))
    r = (1 - middle) / (1 + middle)
    parts = [{"motion": "velocity", "name": "gun"}, {"rod": 6}, {"rod": 1, "impedance": beta}, {"rod": 2}, "absorbing"]
    taus = [7, 8.5, 9, 11, 13, 15]
    found = values(parts, taus, [step("gun")], strain=["7+"])[0]
    # the incident stress is that of the velocity 1; what arrives at the end of the middle bar at 7, 9, 11, ...
    assert [-float(1 - r ** (2 * n)) for n in (1, 1, 2, 3, 4, 5)] == found.tolist()
    if beta == "1/4":
        assert (-found[[0, 2, 3]]).tolist() == [0.64, 0.8704, 0.953344]


@pytest.mark.parametrize(("z", "passed"), [(2, "8/9"), (3, "3/4"), (5, "5/9"), ("1/3", "3/4")])
def test_the_energy_that_passes_an_impedance_step(z: object, passed: str) -> None:
    """4 z/(1 + z)^2 of a pulse; the other part comes back."""
    parts = [{"rod": 1, "velocity": 1, "strain": -1}, {"rod": 2}, {"rod": 3, "impedance": z}]
    sent, back = values(parts, [3.0], velocity=["7/2", "5/2"])[:, 0]
    strains = values(parts, [3.0], strain=["7/2", "5/2"])[:, 0]
    ratio = Fraction(str(z))
    assert strains.tolist() == [-sent, back]
    assert float(ratio) * sent**2 == pytest.approx(float(Fraction(passed)), rel=EXACT)
    assert back**2 == pytest.approx(float(1 - Fraction(passed)), rel=EXACT)
    assert float(4 * ratio / (1 + ratio) ** 2) == float(Fraction(passed))


@pytest.mark.parametrize("b", [0, "1/10", 1, "1.001", 7])
def test_what_a_dashpot_sends_back(b: object) -> None:
    """Stress by (b - Z)/(b + Z), velocity by minus that; exactly 0 at the impedance of the rod."""
    z = Fraction(3, 2)
    for damping in (Fraction(str(b)), z):
        rho = (damping - z) / (damping + z)
        end = {"joint": True, "dashpot": str(damping)}
        parts = [{"rod": 1, "velocity": 1, "strain": -1, "impedance": z}, {"rod": 2, "impedance": z}, end]
        strain, velocity = values(parts, [4.0], strain=["3/2"], velocity=["3/2"])[:, 0]
        assert [strain, velocity] == [float(-rho), float(-rho)]


@pytest.mark.parametrize(("end", "sent"), [("fixed", -1), ("free", 1), ("absorbing", 0)])
def test_what_ends_send_back(end: str, sent: int) -> None:
    parts = [{"rod": 1, "velocity": 1, "strain": -1, "impedance": "1.001"}, {"rod": 2, "impedance": "1.001"}, end]
    found = values(parts, [4.0, 4.5], strain=["3/2"], velocity=["3/2"])
    assert found.tolist() == [[sent, 0], [sent, 0]]


def test_an_absorbing_end_sends_exactly_nothing() -> None:
    """Behind it a body on a spring stays where it is, to the last bit; and so does the rod when all has passed."""
    parts = [
        "absorbing",
        {"rod": 1, "impedance": "1.7"},
        {"joint": True, "name": "a"},
        {"rod": 1, "impedance": "1.7"},
        "absorbing",
    ]
    load = [{"at": "a", "times": [0, "1/3"], "steps": [1, -1], "ramps": ["1/7", "-1/7"]}, step("a", "1/21", "1/3")]
    load[1]["steps"] = ["-1/21"]
    found = values(parts, [0.2, 1.2, 1.4, 2, 5], load, strain=["1/2", 0], velocity=["3/2"])
    assert (found[:, 1] != 0).any()
    assert (found[:, 2:] == 0).all()


CONTACT_ENDS = {
    1: ("3.06766764161830635", "-0.687618939800652"),
    2: ("4.70856724366772666", "-0.925246996732303"),
    3: ("5.26415685826560592", "-0.880071196624831"),
    4: ("5.8995904396032681", "-0.816911551636064"),
    5: ("7.01006663529963883", "-0.957837007660866"),
    6: ("7.40759189126927617", "-0.929680854061986"),
    8: ("8.9398659461250889", "-0.97800873190252"),
    10: ("9.54105790383836858", "-0.949134061418203"),
}
"""By the mass of the body over that of the bar: when a struck bar lets it go, and how fast it then is.

From p(tau) = sum_k H(tau - 2k) exp(-alpha (tau - 2k)) L_k(2 alpha (tau - 2k)), alpha = bar over body (Boussinesq, St
Venant): stress p(tau) + p(tau - 2), velocity p(tau) - p(tau - 2).
"""


@pytest.mark.parametrize("ratio", CONTACT_ENDS)
def test_a_body_on_a_fixed_bar_until_the_bar_lets_it_go(ratio: int) -> None:
    end, rebound = CONTACT_ENDS[ratio]
    last = math.nextafter(float(end), 0)
    parts = [{"mass": ratio, "velocity": 1, "name": "striker"}, {"rod": 1}, "fixed"]
    found = values(parts, [last - 1e-9, last, 3.0, 2.0], strain=[0, 1], velocity=["striker"])
    # the bar is pressed until then, and no longer
    assert found[0, 0] < 0
    slope = found[0, 0] - found[0, 1]
    assert abs(found[0, 1]) < 1e-5 * abs(slope) + 1e-14
    assert found[2, 1] == pytest.approx(float(rebound), rel=4e-15)
    alpha = 1 / ratio

    def p(tau: float, terms: int = 8) -> float:
        """By the closed form."""
        total = 0.0
        for k in range(terms):
            if tau >= 2 * k:
                w = tau - 2 * k
                laguerre = sum(math.comb(k, j) * (-2 * alpha * w) ** j / math.factorial(j) for j in range(k + 1))
                total += math.exp(-alpha * w) * laguerre
        return total

    assert found[1, 2] == pytest.approx(-2 * p(2), rel=1e-14)  # the fixed end at tau = 3
    if ratio <= 5:
        assert {
            1: 2.27067056647323,
            2: 2.73575888234288,
            3: 3.02683423806518,
            4: 3.21306131942527,
            5: 3.34064009207128,
        }[ratio] == pytest.approx(-found[1, 2], rel=4e-15)
    assert found[0, 3] == pytest.approx(-(p(2) + p(0)), rel=1e-14)


# ---- what changes nothing, or changes all alike

TAUS = [0.0, 0.3, 1.0, 1.7, 2.0, 2.9, 4.0]


def like(found: np.ndarray, expected: np.ndarray, error: float = EXACT) -> bool:
    """Whether outputs agree, relative to the largest value of each."""
    return bool((np.abs(found - expected) <= error * np.abs(expected).max(axis=1, keepdims=True)).all())


@pytest.mark.parametrize("ratio", [1, -1])
def test_a_gear_of_one_is_nothing_and_of_minus_one_a_mirror(ratio: int) -> None:
    ahead = [{"rod": "3/2", "impedance": 2, "spring": 1}, {"mass": 2, "name": "far"}, {"spring": 3}, {"rod": 1}]
    trunk = [{"rod": 1}, {"mass": 1, "velocity": 1, "name": "gear"}]
    load = [step("gear"), step("far", "1/2", 1)]
    branch = {"from": "gear", "name": "b", "ratio": ratio, "parts": ahead}
    turned = [step("gear"), step("far", f"{ratio}/2", 1)]
    found = values(trunk, TAUS, turned, [branch], strain=["1/2", "b:1"], velocity=["gear", "far", "b:2"])
    straight = values([*trunk, *ahead], TAUS, load, strain=["1/2", "2"], velocity=["gear", "far", "3"])
    assert like(found * [[1], [ratio], [1], [ratio], [ratio]], straight)


def test_a_ratio_squares_the_impedance() -> None:
    """A rod behind a gear of ratio n is one of n^2 times the impedance that moves n times as fast."""
    trunk = [{"rod": 1}, {"mass": 1, "velocity": 1, "name": "gear"}]
    branch = {
        "from": "gear",
        "name": "b",
        "ratio": -3,
        "parts": [{"rod": 1, "impedance": "1/2"}, {"mass": 1, "name": "far"}],
    }
    found = values(trunk, TAUS, (), [branch], strain=["b:1/2"], velocity=["gear", "far"])
    plain = [*trunk, {"rod": 1, "impedance": "9/2"}, {"mass": 9, "name": "far"}]
    assert like(found, values(plain, TAUS, strain=["3/2"], velocity=["gear", "far"]) * [[-3], [1], [-3]])


def between(part: list[Any]) -> np.ndarray:
    """A pulse over what is between two rods."""
    parts = [{"motion": "velocity", "name": "gun"}, {"rod": 1, "impedance": "3/2"}, *part, {"rod": 2}, "absorbing"]
    load = [{"at": "gun", "times": [0, "1/2"], "ramps": [1, -1]}]
    return values(parts, [0.5, 1.25, 1.75, 2.5, 2.9], load, strain=["3/4", "5/4"], velocity=["1/2", "3/2"])


@pytest.mark.parametrize("stiff", ["spring", "dashpot"])
def test_what_is_stiff_is_a_joint_and_what_is_soft_is_open(stiff: str) -> None:
    size, error = ("60", 3e-2) if stiff == "spring" else ("1e12", 1e-11)
    assert like(between([{stiff: size}]), between([]), error)
    soft = between([{stiff: "1e-12"}])
    open_ended = between([{"joint": True}, {"spring": "1e-30"}])
    assert like(soft[[0, 2]], open_ended[[0, 2]], 1e-11)
    assert np.abs(soft[[1, 3]]).max() < 1e-11


@pytest.mark.parametrize(("dashpot", "end"), [("0", "free"), ("1e12", "fixed")])
def test_a_dashpot_of_nothing_is_free_and_of_everything_is_fixed(dashpot: str, end: str) -> None:
    parts = [{"mass": 2, "velocity": 1, "name": "a"}, {"rod": "3/2"}]
    held = values([*parts, {"joint": True, "dashpot": dashpot}], TAUS, velocity=["a", 1], strain=["1/2"])
    assert like(held, values([*parts, end], TAUS, velocity=["a", 1], strain=["1/2"]), 1e-11)


def test_a_spring_that_is_stiff_for_its_body() -> None:
    """K/M = 1e6: the body swings about where a body that is held would stay."""
    parts = [{"mass": "1/1000", "spring": 1000, "name": "a"}, {"rod": 1}, "absorbing"]
    found = values(parts, [0.001, 0.002, 1.0], [step("a")], displacement=["a"])[0]
    root = complex(-500, math.sqrt(1e6 - 500**2))
    true = [
        (1 + (root.conjugate() * np.exp(root * t) / (root - root.conjugate())).real * 2) / 1000 for t in (0.001, 0.002)
    ]
    assert found[:2].tolist() == pytest.approx(true, rel=1e-13)
    assert found[2] == 0.001
