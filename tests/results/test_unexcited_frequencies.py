"""Natural frequencies that no load excites or no output sees: amplitudes are finite there, and are said to be."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
import sympy

import wavesym
from wavesym.exact.modes.branches import BranchTree
from wavesym.results.transfer import Transfer
from wavesym.scene import Scene

ULP = np.finfo(float).eps


def chain(parts: list[object], at: str, branches: dict[str, list[object]] | None = None, **outputs: list[str]) -> Scene:
    """A force on one node of a chain, whose branches begin at the node "n"."""
    system = {
        "type": "chain",
        "parts": parts,
        "branch": [{"from": "n", "name": name, "parts": each} for name, each in (branches or {}).items()],
    }
    return Scene(
        name="chain", system=system, load=[{"at": at, "times": [0], "steps": [1]}], output={"until": 1, **outputs}
    )


def bar(at: str) -> Scene:
    """A bar between walls, with a dashpot of 1/5 in the middle."""
    middle = {"joint": True, "name": "mid", "dashpot": "1/5"}
    left, right = ({"joint": True, "name": name} for name in ("l", "r"))
    parts = ["fixed", {"rod": 1}, left, {"rod": 1}, middle, {"rod": 1}, right, {"rod": 1}, "fixed"]
    return chain(parts, at, displacement=["mid", "l"], strain=["0"])


@pytest.mark.quick(1)
@pytest.mark.parametrize("second", [("2/3", "1/5"), ("4/3", "2/5"), ("10/9", "1/3")])
def test_two_branches_that_hold_still_between_them(second: tuple[str, str]) -> None:
    """Masses m on springs k, all of one frequency w: at w they take the force alone, each by its stiffness."""
    k, m = 2 / 3, 1 / 5
    other, w = float(sympy.Rational(second[0])), np.sqrt(k / m)
    branches = {
        "a": [{"spring": "2/3"}, {"mass": "1/5", "name": "ea"}],
        "b": [{"spring": second[0]}, {"mass": second[1], "name": "eb"}],
    }
    parts = ["fixed", {"spring": 1}, {"mass": 1, "name": "n", "dashpot": "1/4"}]
    response = wavesym.frf(chain(parts, "n", branches, displacement=["n", "ea", "eb"]), low=1.2, high=3, points=2)
    peaks = response.peaks()
    v = np.linspace(1.2, 3, 100_001)
    v = v[np.abs(v - w) > 1e-6]
    held = 1 - v**2 + 0.25j * v - v**2 * (k + other) * m / (k - v**2 * m)
    moved = np.abs(1 / held)
    for name, expected in (("n", moved), ("ea", moved * np.abs(k / (k - v**2 * m)))):
        peak = peaks[f"displacement@{name}"]
        assert expected.max() * (1 - 1e-12) <= peak.high <= expected.max() * (1 + 1e-7)
    at_w = wavesym.frf(chain(parts, "n", branches, displacement=["n", "ea"]), [float(w)])
    assert at_w.values[:, 0] == pytest.approx([0, -1 / (k + other)], abs=1e-13)


def test_frequencies_met_exactly() -> None:
    """Whole frequencies: of equal branches, and of branches that are of one frequency and else differ."""
    for second, force in ((1, "-1/2"), (2, "-1/3")):
        branches = {
            "a": [{"spring": 1}, {"mass": 1, "name": "ea"}],
            "b": [{"spring": second}, {"mass": second, "name": "eb"}],
        }
        parts = ["fixed", {"spring": 1}, {"mass": 1, "name": "n"}]
        response = wavesym.frf(chain(parts, "n", branches, displacement=["n", "ea", "eb"]), [1.0])
        expected = float(sympy.Rational(force))
        assert response.values[:, 0].tolist() == [0, expected, expected]
        assert response.poles == response.possible_poles == ()
        # the same frequency, with the force where it is felt
        excited = wavesym.frf(chain(parts, "ea", branches, displacement=["n", "ea", "eb"]), [1.0])
        assert excited["displacement@n"][0] == pytest.approx(expected, abs=ULP)  # by reciprocity
        assert np.isnan(excited.values[1:].real).all()
        assert (excited.poles, excited.possible_poles) == ((1.0,), ())


@pytest.mark.slow
def test_a_bar_that_is_loaded_or_read_in_the_middle() -> None:
    """At w = pi/2 and pi its halves swing against each other. From the middle: 1/(2 w cot 2w + i w/5)."""
    w = np.linspace(1.2, 3.3, 100_001)
    moved = 1 / (2 * w / np.tan(2 * w) + 0.2j * w)
    at_side = moved * np.sin(w) / np.sin(2 * w)
    expected = {"displacement@mid": moved, "displacement@l": at_side, "strain@0": moved * w / np.sin(2 * w)}
    peaks = wavesym.frf(bar("mid"), low=1.2, high=3.3, points=2).peaks()
    for name, values in expected.items():
        assert peaks[name].low <= np.abs(values).max() * (1 + 1e-6)
        assert np.abs(values).max() <= peaks[name].high * (1 + 1e-12)
        assert peaks[name].high - peaks[name].low < 1e-9 * peaks[name].high
    aside = wavesym.frf(bar("l"), low=1.2, high=3.3, points=2).peaks()
    assert aside["displacement@mid"].high == pytest.approx(peaks["displacement@l"].high, rel=1e-9)
    assert (aside["displacement@l"].amplitude, aside["displacement@l"].high) == (np.inf, np.inf)
    assert aside["displacement@l"].frequency == pytest.approx(np.pi / 2)


@pytest.mark.quick(1)
@pytest.mark.parametrize("load", [0, 1])
@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(1, 6))])
def test_masses_against_their_fractions_in_lowest_terms(load: int, seed: int) -> None:
    """A chain that is its own mirror image, with dashpots in the middle of it: K by hand, cancelled by SymPy."""
    draw = np.random.default_rng(seed)
    k, m = draw.integers(1, 5, 3).tolist(), draw.integers(1, 5, 2).tolist()
    springs, masses, s = [k[0], k[1], k[2], k[1], k[0]], [*m, *m[::-1]], sympy.Symbol("s")
    stiffness = sympy.zeros(4)
    for row, spring in enumerate(springs):
        for one, other in ((row - 1, row - 1), (row, row), (row - 1, row), (row, row - 1)):
            if min(one, other) >= 0 and max(one, other) < 4:
                stiffness[one, other] += (spring + (s / 3 if row == 2 else 0)) * (1 if one == other else -1)
    dynamic = stiffness + sympy.diag(*(mass * s**2 for mass in masses))
    parts: list[object] = ["fixed"]
    for row, spring in enumerate(springs):
        parts.append({"spring": spring, **({"dashpot": "1/3"} if row == 2 else {})})
        parts.append({"mass": masses[row], "name": f"m{row}"} if row < 4 else "fixed")
    outputs = [f"m{row}" for row in range(4)]
    peaks = wavesym.frf(chain(parts, f"m{load}", displacement=outputs), low=0.1, high=6, points=2).peaks()
    moved = dynamic.LUsolve(sympy.eye(4)[:, load])
    for name, value in zip(outputs, moved, strict=True):
        below = sympy.cancel(value).as_numer_denom()[1]
        roots = map(complex, sympy.Poly(below.subs(s, sympy.I * s).expand(), s).nroots(n=30))
        swinging = [root.real for root in roots if abs(root.imag) < 1e-12 and 0.1 < root.real < 6]
        peak = peaks[f"displacement@{name}"]
        assert np.isinf(peak.amplitude) == bool(swinging)
        if swinging:
            assert min(abs(peak.frequency - each) for each in swinging) < 1e-9


def test_a_force_on_a_free_bar_strains_it_at_frequency_0() -> None:
    """Half of it hangs on the middle, whose motion has no bound: exact limits at 0, where all is 0/0."""
    scene = chain(
        [{"joint": True, "name": "a"}, {"rod": 1}, "free"], "a", strain=["1/2"], displacement=["1"], acceleration=["1"]
    )
    response = wavesym.frf(scene, [0.0])
    assert response["strain@1/2"][0] == -0.5
    assert response["acceleration@1"][0] == 1
    assert np.isnan(response["displacement@1"].real)
    assert (response.poles, response.possible_poles) == ((0.0,), ())


def test_what_is_not_decided_is_said_to_be(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without fractions in lowest terms, and with equal branches taken one by one."""
    branches = {name: [{"spring": 1}, {"mass": 1, "name": f"e{name}"}] for name in "ab"}
    parts = ["fixed", {"spring": 1}, {"mass": 1, "name": "n", "dashpot": 1}]
    scene = chain(parts, "n", branches, displacement=["n"])
    monkeypatch.setattr(Transfer, "lowest_terms", lambda self, k: None)
    assert wavesym.frf(scene, [1.0]).possible_poles == ()
    alone = property(lambda self: {each.far_point: each.far_point for each in self.branches})
    monkeypatch.setattr(BranchTree, "twins", alone)
    response = wavesym.frf(scene, [1.0, 2.0])
    assert response.possible_poles == (1.0,)
    assert "not decided at 1 rad per tau: the load may not excite it" in response.notes
    (peak,) = response.peaks()
    assert np.isnan(peak.amplitude)
    assert (peak.frequency, peak.high) == (pytest.approx(1), np.inf)


@pytest.mark.slow
def test_delays_without_a_useful_measure() -> None:
    """Too long a fraction: a mode that the output does not see stays open, and a pole beside a dashpot, too."""
    rods = [{"rod": "1"}, {"rod": "12347/10001"}]
    middle = {"joint": True, "name": "mid", "dashpot": "1/5"}
    parts = ["fixed", *rods, {"joint": True, "name": "l"}, {"rod": 1}, middle, {"rod": 1}, *rods[::-1], "fixed"]
    for dashpot, expected in (("1/5", [np.nan, np.nan]), ("0", [np.nan, np.inf])):
        middle["dashpot"] = dashpot
        peaks = wavesym.frf(chain(parts, "l", displacement=["mid", "l"]), low=0.95, high=1, points=2).peaks()
        assert [peak.amplitude for peak in peaks] == pytest.approx(expected, nan_ok=True)
        assert all(peak.high == np.inf for peak in peaks)


SPRINGS = ["fixed", {"spring": 1}, {"mass": 1, "name": "m"}, {"spring": 1}, {"mass": 1, "name": "n"}]
BARS = ["fixed", {"rod": 1}, {"mass": 1, "name": "m"}, {"rod": 1}, "fixed"]


def first_undamped(parts):
    system = {"type": "chain", "parts": parts, "damping": [0, "1/20"]}
    output = {"until": 20, "tolerance": 1e-6, "displacement": ["m"]}
    return Scene(name="first", system=system, load=[{"at": "m", "times": [0], "steps": [1]}], output=output)


@pytest.mark.parametrize(("parts", "natural"), [(SPRINGS, (5**0.5 - 1) / 2), (BARS, 1.0768739863118)])
def test_a_mode_without_damping_beside_damped_ones_has_a_pole(parts, natural):
    """That of a mass between rods at 2 cot w = w: a power series about it does not exist."""
    (peak,) = wavesym.frf(first_undamped(parts), low=0.5, high=2, points=2).peaks()
    assert peak.amplitude == np.inf
    assert peak.frequency == pytest.approx(natural, rel=1e-9)


def test_of_masses_on_springs_no_mode_is_left_out():
    """A sum over two modes is all there is: shapes by hand from the golden ratio."""
    taus = np.array([0.3, 1.15, 2.0])
    frequencies, shapes = np.linalg.eigh(np.array([[2.0, -1.0], [-1.0, 1.0]]))
    w = np.sqrt(frequencies)
    right = sum(shapes[0, k] ** 2 / (w[k] ** 2 - taus**2 + 2j * (0, 0.05)[k] * w[k] * taus) for k in range(2))
    found = wavesym.frf(first_undamped(SPRINGS), taus)
    assert found.values[0] == pytest.approx(right, rel=1e-13)


@pytest.mark.quick(1)
@pytest.mark.parametrize("closeness", ["1e-12", "1e-25"])
@pytest.mark.parametrize("dashpot", [0, "1/5"])
def test_branches_that_are_nearly_equal_have_their_peak(closeness: str, dashpot: object) -> None:
    """Between their two resonances they pull nothing together with the rest: what is left is the dashpot, 1/(1/5)."""
    arms = [str(1 + k * Fraction(closeness)) for k in range(3)]
    branch = [{"from": "a", "name": f"b{k}", "parts": [{"rod": length}, {"mass": 1}]} for k, length in enumerate(arms)]
    parts = ["fixed", {"rod": 1}, {"mass": 1, "name": "a", "dashpot": dashpot}, {"rod": 1}, "free"]
    if not dashpot:
        del parts[2]["dashpot"]
    scene = wavesym.Scene(
        name="near",
        system={"type": "chain", "parts": parts, "branch": branch},
        load=[{"at": "a", "times": [0], "steps": [1]}],
        output={"until": 1, "velocity": ["a"]},
    )
    (peak,) = wavesym.frf(scene, [0.8, 0.9]).peaks()
    assert peak.amplitude == pytest.approx(5.0 if dashpot else np.inf, rel=1e-9)
    assert np.tan(peak.frequency) == pytest.approx(1 / peak.frequency, rel=1e-6)
