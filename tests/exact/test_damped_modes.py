"""Complex modes of chains with dashpots: the frequency equation from the derived law, closed forms, none missed."""

from dataclasses import replace
from itertools import pairwise
from math import atanh, pi

import numpy as np
import pytest
import sympy
from flint import fmpq
from scipy.linalg import eig

from tests.exact.test_modes import COT, CSC, W, by_the_law
from tests.support.modal import by_elements, chain
from wavesym.exact.modes import damped_modes as found
from wavesym.exact.modes.damped_modes import estimate_frequencies, remove_dashpots
from wavesym.exact.modes.damped_spectrum import DampedSpectrum
from wavesym.exact.modes.stiffness import Stiffness
from wavesym.mechanics.network import Bar, Network, Point
from wavesym.mechanics.node import Node, Rod


def complex_frequencies(model, count):
    return np.array([complex(mode.frequency) for mode in DampedSpectrum(model.network).first(count)])


@pytest.mark.parametrize("resisting", [True, False])
def test_frequency_equation_is_the_derived_law(resisting):
    """For any kappa and dashpots to the ground; without them in one of both it is another equation."""
    kappa, delta = sympy.symbols("kappa:3", positive=True), sympy.symbols("delta:3", positive=True)
    rod = Rod(0, 0)
    held = Node(None, rod, inertia=0, alpha=0, beta=0, damping=1)
    inner = Node(rod, rod, inertia=1, alpha=2 * kappa[1], beta=2 * kappa[1], damping=delta[1])
    last = Node(rod, None, inertia=1, alpha=2 * kappa[2], beta=0, damping=delta[2])
    q, rows = by_the_law([held, inner, last], [0, 1 / kappa[1], 1 / kappa[2]])
    free = [Point(1 / k, damping=d / k if resisting else d * 0) for k, d in zip(kappa[1:], delta[1:], strict=True)]
    one = fmpq(1)
    network = Network((Point(fmpq(0), motion="fixed"), *free), tuple(Bar(x, x + 1, one, one, one) for x in range(2)))
    stiffness = Stiffness(network)

    def number(value):
        return value if isinstance(value, sympy.Expr) else sympy.Rational(int(value.p), int(value.q))

    diagonal, up = stiffness.law(number).matrix(W, [COT], [CSC], sympy.I * W)
    for row, point in enumerate(stiffness.points):
        other = 3 - point
        across = up[row] if stiffness.parents[row] is not None else up[1 - row]
        same = sympy.cancel(sympy.together(rows[point].subs(q[0], 0) - diagonal[row] * q[point] - across * q[other]))
        assert (same == 0) == resisting


@pytest.mark.parametrize("size", ["1/2", "1/1000", "999/1000", "1001/1000", 3, 100])
def test_a_dashpot_at_the_end_of_a_bar(size):
    """It sends back (1 - c)/(1 + c) of what arrives: cos w + i c sin w = 0. Above the impedance one creeps."""
    made = complex_frequencies(chain(["fixed", {"rod": 1}, {"joint": True, "dashpot": size}]), 12)
    c = float(fmpq(*map(int, str(size).split("/"))))
    expected = [(k + (c < 1) / 2) * pi + 1j * (atanh(c) if c < 1 else atanh(1 / c)) for k in range(12)]
    np.testing.assert_allclose(made, expected, rtol=1e-12, atol=1e-300)
    assert (made[0].real == 0) == (c > 1)


DAMPED = {
    "a mass": chain(["fixed", {"rod": 1}, {"mass": 1, "dashpot": "1/2"}]),
    "hardly moving": chain(
        ["fixed", {"rod": 1}, {"mass": "1/10", "dashpot": 20}, {"rod": 1}, {"mass": 3, "dashpot": 1}]
    ),
    "across": chain(
        [
            {"mass": 1, "spring": 2},
            {"rod": 1},
            {"mass": 1},
            {"rod": "1/2", "dashpot": "1/3"},
            {"mass": 2, "dashpot": "1/10"},
            {"dashpot": "1/7", "spring": 3},
            {"mass": "1/2"},
            {"rod": "1.3", "impedance": 3},
            "free",
        ],
        velocity=["0-"],
    ),
    "a branch with gears": chain(
        ["fixed", {"rod": 1}, {"mass": 1, "name": "g"}, {"rod": 1}, {"mass": 1}],
        branch=[
            {
                "from": "g",
                "name": "a",
                "ratio": -2,
                "parts": [{"rod": "1/3"}, {"mass": "1/2", "spring": 1, "dashpot": 2}],
            }
        ],
    ),
    "ten storeys": chain(["fixed", *(part for _ in range(10) for part in ({"rod": 1, "dashpot": 1}, {"mass": 30}))]),
}


def zeros_within(network, radius):
    """How many zeros det K times the sines of the bars has: how often its value turns, by dense matrices."""
    free = [number for number, point in enumerate(network.points) if point.motion is None]
    w = radius * np.exp(2j * pi * np.linspace(0, 1, 6000 + int(4000 * radius)))
    matrix = np.zeros((len(w), len(network.points), len(network.points)), complex)
    product = np.ones_like(w)
    for number, point in enumerate(network.points):
        matrix[:, number, number] += float(point.stiffness) + 1j * w * float(point.damping) - w * w * float(point.mass)
    for link in network.links:
        resists = float(link.stiffness) + 1j * w * float(link.damping)
        arms = {link.left: float(link.ratio), link.right: -1.0}
        for a, n in arms.items():
            for b, m in arms.items():
                matrix[:, a, b] += n * m * resists
    for bar in network.bars:
        angle, impedance = w * float(bar.delay), float(bar.impedance)
        product *= np.sin(angle) / w
        ends = list(zip((bar.left, bar.right), map(float, bar.ratios), strict=True))
        for a, n in ends:
            matrix[:, a, a] += n * n * impedance * w / np.tan(angle)
        matrix[:, bar.left, bar.right] -= ends[0][1] * ends[1][1] * impedance * w / np.sin(angle)
        matrix[:, bar.right, bar.left] -= ends[0][1] * ends[1][1] * impedance * w / np.sin(angle)
    values = np.linalg.det(matrix[:, free][:, :, free]) * product
    turns = np.angle(values[1:] / values[:-1])
    assert np.abs(turns).max() < 1.5  # no turn between two points is missed
    return round(turns.sum() / (2 * pi))


SLOW = ["ten storeys", "across", "hardly moving"]


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", [pytest.param(n, marks=[pytest.mark.slow] if n in SLOW else []) for n in DAMPED])
def test_no_complex_frequency_is_missed(name):
    """The argument principle, on a circle through the widest gap of some."""
    model = DAMPED[name]
    made = complex_frequencies(model, 24)
    sizes = np.abs(made)
    assert np.all(np.diff(sizes) >= 0)
    gap = 8 + int(np.argmax(np.diff(sizes)[8:]))
    count = np.where(made[: gap + 1].real > 0, 2, 1).sum()
    assert count == zeros_within(model.network, (sizes[gap] + sizes[gap + 1]) / 2)
    assert np.all(made.imag >= 0)


def test_two_that_meet_go_on_as_creeping_ones():
    """A mass on a bar with more and more to resist it: one mode becomes two without a real part."""
    counts = []
    for size in ("1/2", 3, 5):
        made = complex_frequencies(chain(["fixed", {"rod": 1}, {"mass": "1/2", "dashpot": size}]), 8)
        counts.append(np.count_nonzero(made.real == 0))
        radius = (abs(made[5]) + abs(made[6])) / 2
        network = chain(["fixed", {"rod": 1}, {"mass": "1/2", "dashpot": size}]).network
        assert np.where(made[:6].real > 0, 2, 1).sum() == zeros_within(network, radius)
    assert counts[0] == 0
    assert max(counts) >= 1


@pytest.mark.parametrize(
    "name", ["a mass", *(pytest.param(name, marks=pytest.mark.slow) for name in ("across", "a branch with gears"))]
)
def test_complex_frequencies_are_those_of_finite_elements(name):
    """Linear elements with dashpots between their points, extrapolated."""
    model, count = DAMPED[name], 5
    network = model.network
    values = []
    for resolution in (10, 20):
        free = replace(model, network=remove_dashpots(network))
        _, mass, stiffness = by_elements(free, resolution)
        moving = [number for number, point in enumerate(network.points) if point.motion is None]
        place = {point: row for row, point in enumerate(moving)}
        damping = np.zeros_like(mass)
        for point, row in place.items():
            damping[row, row] += float(network.points[point].damping)
        for link in network.links:
            arms = {place[p]: n for p, n in ((link.left, float(link.ratio)), (link.right, -1.0)) if p in place}
            for a, n in arms.items():
                for b, m in arms.items():
                    damping[a, b] += n * m * float(link.damping)
        zero, one = np.zeros_like(mass), np.eye(len(mass))
        rates = eig(np.block([[zero, one], [-stiffness, -damping]]), np.block([[one, zero], [zero, mass]]), right=False)
        w = -1j * rates
        w = w[w.real > -1e-9]
        values.append(w[np.argsort(np.abs(w))][:count])
    expected = (4 * values[1] - values[0]) / 3
    made = complex_frequencies(model, count)
    assert np.abs(made - expected).max() < 3e-3
    assert np.abs(made.imag).max() > 1e-2


def test_what_is_found_twice_is_one(monkeypatch):
    model = DAMPED["a mass"]
    expected = complex_frequencies(model, 6)

    def twice(stiffness, count, again):
        made = estimate_frequencies(stiffness, count)
        made[3] = made[2] * (1 + 1e-13)
        return made

    monkeypatch.setattr(found, "estimate_frequencies", twice)
    made = complex_frequencies(model, 6)
    np.testing.assert_array_equal(made, np.delete(expected, 3))
    assert all(a != b for a, b in pairwise(made))


def test_what_is_no_zero_is_not_proved(monkeypatch):
    monkeypatch.setattr(found, "estimate_frequencies", lambda *_: np.array([2.1 + 7.0j, 0.8 + 0.2j]))
    monkeypatch.setattr(found, "_NEWTON", 1)
    assert not len(complex_frequencies(DAMPED["a mass"], 2))


@pytest.mark.slow
def test_modes_of_many_rows_do_not_wait_for_those_far_away(monkeypatch):
    """They are those of all rounds, in fewer, and proved with fewer bits."""
    parts = ["free", *({"rod": f"{3 + k % 5}/100", "impedance": f"{100 + k}/100"} for k in range(40)), "absorbing"]
    network, rounds = chain(parts).network, []

    def counted(*given):
        rounds[-1] += 1
        return pull(*given)

    pull = found._slope_of_logarithm
    monkeypatch.setattr(found, "_slope_of_logarithm", counted)
    spectra = []
    for far, bits in ((found._AWAY, found._BITS_A_ROW), (np.inf, found._BITS_A_ROW[-1:])):
        rounds.append(0)
        monkeypatch.setattr(found, "_AWAY", far)
        monkeypatch.setattr(found, "_BITS_A_ROW", bits)
        spectra.append([mode.frequency for mode in DampedSpectrum(network).first(8)])
    assert all(one.overlaps(other) for one, other in zip(*spectra, strict=True))
    assert rounds[0] < rounds[1]
