"""How many complex frequencies a circle has inside, against closed forms and eigenvalues, and what is found by it."""

from __future__ import annotations

from cmath import atanh, cos, sin
from dataclasses import replace
from math import pi
from typing import Any

import numpy as np
import pytest
from flint import arb, fmpq

import wavesym
from tests.support.modal import chain
from wavesym.exact.modes import damped_spectrum
from wavesym.exact.modes import turns as found_by
from wavesym.exact.modes.shape import FoundModes
from wavesym.exact.modes.stiffness import Stiffness
from wavesym.exact.modes.turns import Circles, absorb
from wavesym.scene import Scene

HALF = {"joint": True, "dashpot": "1/2"}


def modes(parts: list[Any], count: int, **system: Any) -> wavesym.Modes:
    table = {"type": "chain", "parts": parts, **system}
    return wavesym.modes(Scene(name="s", system=table, output={"until": 1, "velocity": [0]}), count)


@pytest.mark.parametrize("size", ["1/2", "999/1000", 3])
def test_a_rod_with_a_dashpot_has_as_many_as_its_closed_form(size: Any) -> None:
    """cos w + i c sin w = 0: w = (k + 1/2) pi + i atanh c, or k pi + i atanh 1/c."""
    circles = Circles(chain(["fixed", {"rod": 1}, {"joint": True, "dashpot": size}]).network)
    c = float(fmpq(*map(int, str(size).split("/"))))
    k = np.arange(-20, 21)
    w = (k + (c < 1) / 2) * pi + 1j * atanh(c if c < 1 else 1 / c).real
    for radius in (0.3, 1.0, 4.0, 4.75, 9.4, 23.5, 40.1):
        assert circles.count(radius) == np.count_nonzero(np.abs(w) < radius)


def test_both_counts_agree() -> None:
    """Zeros of the power series, and turns around the circle: rods, masses, springs, dashpots, a branch with a gear."""
    parts = ["free", {"rod": 1, "dashpot": 1}, {"mass": 2, "name": "a"}, {"rod": "1/3", "impedance": 4}, "absorbing"]
    branch = [{"from": "a", "name": "b", "ratio": 2, "parts": [{"spring": 3, "dashpot": "1/5"}, {"mass": "1/2"}]}]
    circles = Circles(chain(parts, branch=branch).network)
    counts = [(circles.count(radius), circles._count_turns(radius)) for radius in (0.02, 0.7, 2.0, 5.0, 11.0, 25.0)]
    assert all(one == other for one, other in counts)
    assert counts[-1][0] > counts[-2][0] > counts[0][0] > 0


@pytest.mark.parametrize("left_out", ["rest", "terms"])
def test_a_series_that_is_cut_off_too_early_tells_nothing(left_out: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without a look at what is left out a count would be wrong: with it more terms are taken."""
    circles = Circles(chain(["fixed", {"rod": 1}, HALF]).network)
    monkeypatch.setattr(found_by, "_TERMS", 8)
    monkeypatch.setattr(found_by, "_TERMS_A_RADIAN", 0)
    if left_out == "rest":
        monkeypatch.setattr(Circles, "_rest", lambda *_: arb(0))
    right = circles.count(9.4) == 6
    assert right == (left_out == "terms")


def test_a_column_of_many_layers_is_counted_without_turns(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of 400 layers arcs took too long, and only the first mode was counted; a power series needs as many terms as one
    rod of the same delay."""
    monkeypatch.setattr(Circles, "_count_turns", lambda *_: None)
    layers = [{"rod": "1/60", "impedance": f"{100 + 37 * k % 90}/100"} for k in range(60)]
    found = modes(["free", *layers, "absorbing"], 10)
    assert (len(found), found.complete) == (10, True)


@pytest.mark.parametrize("seed", range(6))
def test_without_rods_they_are_eigenvalues(seed: int) -> None:
    """Masses, springs, dashpots, a geared branch: counts at every radius between eigenvalues, those at 0 too."""
    draw = np.random.default_rng(seed)
    m, k, c = (draw.integers(1, 9, 4).astype(float) for _ in range(3))
    k[draw.integers(4)] = 0
    ratio = 2.0
    ends = [(None, 0, 1.0), (0, 1, 1.0), (1, 2, 1.0), (1, 3, ratio)]
    stiffness, damping = np.zeros((4, 4)), np.zeros((4, 4))
    for (near, far, turns), a, b in zip(ends, k, c, strict=True):
        pair = np.zeros(4)
        pair[far] = 1
        if near is not None:
            pair[near] = -turns
        stiffness += a * np.outer(pair, pair)
        damping += b * np.outer(pair, pair)
    links = [{"spring": a, "dashpot": b} for a, b in zip(k, c, strict=True)]
    masses = [{"mass": each, "name": f"m{n}"} for n, each in enumerate(m)]
    parts = ["fixed", links[0], masses[0], links[1], masses[1], links[2], masses[2]]
    branch = [{"from": "m1", "name": "b", "ratio": 2, "parts": [links[3], masses[3]]}]
    scene = Scene(
        name="s", system={"type": "chain", "parts": parts, "branch": branch}, output={"until": 1, "velocity": ["m0"]}
    )
    circles = Circles(wavesym.scene.lower(scene).network)
    inverse = np.diag(1 / m)
    matrix = np.block([[np.zeros((4, 4)), np.eye(4)], [-inverse @ stiffness, -inverse @ damping]])
    sizes = np.sort(np.abs(np.linalg.eigvals(matrix)))
    for low, high in zip(sizes, [*sizes[1:], 2 * sizes[-1]], strict=True):
        if low > 1e-6 and high > low * 1.001:
            assert circles.count(float(low * high) ** 0.5) == np.count_nonzero(sizes < (low * high) ** 0.5)
    found = wavesym.modes(scene, 8)
    assert found.complete
    assert sum(2 if mode.damping < 1 else 1 for mode in found) == len(sizes), "shifts and rigid motion among them"


def test_where_a_mode_is_missed_it_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    """The third of a rod with a dashpot is left out by all searches: none is missed below it, and no more is said."""
    every = damped_spectrum.search_modes

    def but_one(stiffness: Stiffness, *others: Any) -> FoundModes:
        found = every(stiffness, *others)
        kept = [mode for mode in found.modes if abs(float(mode.frequency.real.mid()) - 2.5 * pi) > 0.1]
        return replace(found, modes=kept)

    monkeypatch.setattr(damped_spectrum, "search_modes", but_one)
    found = modes(["fixed", {"rod": 1}, HALF], 5)
    assert len(found) == 5
    assert not found.complete
    assert 4.7 < float(found.why.split()[5]) < abs(complex(2.5 * pi, 0.55))


def test_what_absorbs_leaves_its_rod_out() -> None:
    """One mode, i c/m, of a mass before a rod that sends nothing back: it was missed at every --count."""
    parts = ["absorbing", {"rod": "3/2", "impedance": 5}, {"mass": 1, "dashpot": "1/1000"}]
    found = modes(parts, 8)
    assert [(mode.omega, mode.damping) for mode in found] == [(0.0, 1.0), (pytest.approx(5.001, rel=1e-14), 1.0)]
    assert found.complete
    assert not absorb(chain(parts).network).bars
    assert len(absorb(chain([*parts[:2], {"joint": True}, {"rod": 1}, "fixed"]).network).bars) == 1


@pytest.mark.parametrize("count", [7, 21])
def test_few_modes_beside_much_that_absorbs_are_all_found(count: int) -> None:
    """m w^2 = k + i w c + w cot(w/4): only 2 of 7 were found, and 4 of 21."""
    parts = ["absorbing", {"rod": 2, "impedance": "1/2"}, {"mass": 10, "spring": 1}, {"rod": "1/4"}, "fixed"]
    found = modes(parts, count)
    assert (len(found), found.complete) == (count, True)
    w = np.array([complex(mode.frequency) for mode in found.exact])
    assert np.all(np.abs(np.diff(w.real[1:]) - 4 * pi) < 0.1)
    for each in w:
        rest = (1 + 0.5j * each - 10 * each**2) * sin(each / 4) + each * cos(each / 4)
        assert abs(rest) < 1e-9 * abs(each) ** 2


def test_what_creeps_fast_is_found_too() -> None:
    """Of five counts of one chain one left out what creeps at 7: 0.1 w = 1.2 i - (1/2) tan(...) has it."""
    parts = ["absorbing", {"rod": 1}, {"mass": "1/10", "dashpot": "1/5"}, {"rod": 1, "impedance": "1/2"}, {"mass": 2}]
    for count in (5, 10, 25):
        found = modes(parts, count)
        assert found.complete
        assert sum(abs(mode.omega - 6.99999) < 1e-4 and mode.damping == 1 for mode in found) == 1


def test_with_rods_many_rows_are_counted_in_little_time() -> None:
    """A rod in 30 pieces is one rod, whatever they are counted by; what would take too long is not said."""
    parts = ["fixed", *[{"rod": "1/30"}, {"joint": True}] * 29, {"rod": "1/30"}, HALF]
    whole, pieces = (Circles(chain(each).network) for each in (["fixed", {"rod": 1}, HALF], parts))
    assert whole.count(9.4) == pieces.count(9.4) == 6
    assert pieces.count(1e5) is None
    assert pieces.is_exhausted
