"""Exact modes: the frequency equation from the derived law, frequencies others know, none missed, closed sums."""

from dataclasses import replace
from itertools import pairwise
from math import pi

import numpy as np
import pytest
import sympy
from flint import arb, ctx, fmpq
from scipy.linalg import eigh

from tests.support.modal import NASTY, building, by_elements, chain
from wavesym.derivation.node_law import node_law
from wavesym.errors import UnservedError
from wavesym.exact.modes import equal_frequencies
from wavesym.exact.modes import frequencies as found
from wavesym.exact.modes.frequencies import Spectrum, bisect_frequencies, frequencies
from wavesym.exact.modes.statics import Statics
from wavesym.exact.modes.stiffness import Stiffness
from wavesym.mechanics.network import Bar, End, Network, Point
from wavesym.mechanics.node import Node, Rod
from wavesym.scene import Scene, lower

W, E = sympy.symbols("w E")  # E = exp(-i w)
COT, CSC = sympy.I * (1 + E**2) / (1 - E**2), 2 * sympy.I * E / (1 - E**2)


def by_the_law(nodes, scale):
    """Row by row what is 0 when all velocities are q exp(i w tau): the derived law, its waves between nodes solved."""
    q = sympy.symbols(f"q:{len(nodes)}")

    def sent(x, to):
        # r = q - b, b = E l, l = q' - a', a' = E r
        return (q[x] - E * q[to]) / (1 - E**2)

    rows = []
    for x, node in enumerate(nodes):
        law = node_law().with_numbers(node)
        left = E * sent(x - 1, x) if node.left else 0
        right = E * sent(x + 1, x) if node.right else 0
        moving = (law.own[0] * sympy.I * W + law.own[1]) * q[x]
        rows.append((moving - law.left * left - law.right * right) * sympy.I * W * scale[x])
    return q, rows


def by_the_matrix(network):
    """The same by the dynamic stiffness, held points with a row 0."""
    stiffness = Stiffness(network)

    def number(value):
        return value if isinstance(value, sympy.Expr) else sympy.Rational(int(value.p), int(value.q))

    diagonal, up = stiffness.law(number).matrix(W, [COT], [CSC])
    count = len(network.points)
    matrix = sympy.zeros(count, count)
    for row, point in enumerate(stiffness.points):
        matrix[point, point] = diagonal[row]
        if (parent := stiffness.parents[row]) is not None:
            matrix[point, stiffness.points[parent]] = matrix[stiffness.points[parent], point] = up[row]
    return stiffness, matrix


@pytest.mark.parametrize("m", [1, 2, 3])
def test_frequency_equation_of_buildings_is_the_derived_law(m):
    """For any kappa: alpha = beta = 2 kappa and inertia 1 are a mass 1/kappa between rods of impedance 1."""
    kappa = sympy.symbols(f"kappa:{m + 1}", positive=True)
    rod = Rod(0, 0)
    inner = [Node(rod, rod, inertia=1, alpha=2 * k, beta=2 * k) for k in kappa[1:-1]]
    # the first node is held: its row says nothing, its q is 0
    held = Node(None, rod, inertia=0, alpha=0, beta=0, damping=1)
    nodes = [held, *inner, Node(rod, None, inertia=1, alpha=2 * kappa[-1], beta=0)]
    q, rows = by_the_law(nodes, [0, *(1 / k for k in kappa[1:])])
    points = [Point(fmpq(0), motion="fixed"), *(Point(1 / k) for k in kappa[1:])]
    one = fmpq(1)
    _, matrix = by_the_matrix(Network(tuple(points), tuple(Bar(x, x + 1, one, one, one) for x in range(m))))
    for x in range(1, m + 1):
        row = sum(matrix[x, y] * q[y] for y in range(1, m + 1))
        assert sympy.cancel(sympy.together(rows[x].subs(q[0], 0) - row)) == 0


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", range(4))
def test_frequency_equation_of_drawn_chains_is_the_derived_law(seed):
    draw = np.random.default_rng(seed)
    kappa, inertia = ([f"{a}/{b}" for a, b in draw.integers(1, 30, (n, 2))] for n in (3, 4))
    table = {"type": "drive", "m": 3, "kappa": kappa, "inertia": inertia}
    if seed % 2:
        table = {"type": "building", "m": 2, "kappa": kappa, "base": "force"}
    scene = Scene(name="a", system=table, output={"until": 1, "velocity": [1]})
    model, nodes = lower(scene), scene.system.chain.nodes
    rows_of = [
        point.mass / node.inertia if node.inertia else 1
        for point, node in zip(model.network.points, nodes, strict=True)
    ]
    q, rows = by_the_law(nodes, [sympy.Rational(str(factor)) for factor in rows_of])
    _, matrix = by_the_matrix(model.network)
    for x in range(len(q)):
        row = sum(matrix[x, y] * q[y] for y in range(len(q)))
        assert sympy.cancel(sympy.together(rows[x] - row)) == 0
        assert row != 0


def test_another_equation_is_not_the_derived_law():
    kappa = sympy.Symbol("kappa")
    rod = Rod(0, 0)
    nodes = [Node(None, rod, 0, 0, 0, damping=1), Node(rod, None, inertia=1, alpha=2 * kappa, beta=0)]
    q, rows = by_the_law(nodes, [0, 1 / kappa])
    points = Point(fmpq(0), motion="fixed"), Point(2 / kappa)
    _, matrix = by_the_matrix(Network(points, (Bar(0, 1, fmpq(1), fmpq(1), fmpq(1)),)))
    assert sympy.cancel(rows[1].subs(q[0], 0) - matrix[1, 1] * q[1]) != 0


def extrapolated(model, count):
    """The first frequencies of linear finite elements, extrapolated, and about how wrong that is."""
    values = []
    for resolution in (12, 24, 48):
        _, mass, stiffness = by_elements(model, resolution)
        squares = eigh(stiffness, mass, eigvals_only=True)
        values.append(np.sqrt(np.maximum(squares[:count], 0.0)))
    coarse, fine = ((4 * b - a) / 3 for a, b in pairwise(values))
    return fine, np.abs(fine - coarse) + 1e-6 * fine + 1e-5


LARGE = ["nearly equal", "heavy", "light"]  # whose elements take long
ELEMENTS = [
    pytest.param(name, marks=[pytest.mark.slow] if name in LARGE else []) for name in NASTY if name != "a short rod"
]


@pytest.mark.parametrize("name", ELEMENTS)
def test_frequencies_are_those_of_finite_elements(name):
    count = 6
    expected, wrong = extrapolated(NASTY[name], count)
    made = np.array([float(w) for w in frequencies(NASTY[name].network, count)])
    assert np.all(np.abs(made - expected) <= wrong)
    assert np.max(wrong / np.maximum(expected, 0.02)) < 2e-2


def test_frequencies_in_books():
    """Bars without masses, a mass on a bar: w tan w = kappa; and a bar with a short piece is a bar."""
    held = [float(w) for w in frequencies(NASTY["bare, held at both ends"].network, 20)]
    assert held == pytest.approx([k * pi / 3 for k in range(1, 21)], rel=1e-15)
    one_end = chain(["fixed", *({"rod": 1} for _ in range(5)), "free"])
    assert [float(w) for w in frequencies(one_end.network, 9)] == pytest.approx(
        [(k + 0.5) * pi / 5 for k in range(9)], rel=1e-15
    )
    with ctx.workprec(200):
        for w in frequencies(building(["1", "3/5"]).network, 30):
            assert (w * w.tan()).overlaps(arb(fmpq(3, 5)))
            assert (w * w.tan()).rad() < 1e-10
    alone = chain(["fixed", {"rod": 2}, "fixed"])
    assert [float(w) for w in frequencies(alone.network, 3)] == pytest.approx([pi / 2, pi, 3 * pi / 2], rel=1e-15)
    pieces = chain(["fixed", {"rod": "1/1000"}, {"joint": True}, {"rod": "999/1000"}, {"mass": "5/3"}])
    short = frequencies(pieces.network, 12)
    assert all(a.overlaps(b) for a, b in zip(short, frequencies(building(["1", "3/5"]).network, 12), strict=True))


@pytest.mark.quick(4)
@pytest.mark.parametrize("name", NASTY)
def test_no_frequency_is_missed(name):
    """Each ball lies above the one before; none but one of a free chain is 0; those left of w are as many as without
    masses and springs, and at most one more for each point that is free."""
    network = NASTY[name].network
    spectrum = Spectrum(network)
    made = spectrum.first(60)
    edges = [mode.frequency for mode in made]
    assert all(a < b for a, b in pairwise(edges))
    assert sum(w == 0 for w in edges) == ("nothing" in name or "gears" in name)
    stiffness = Stiffness(spectrum.cut.network)
    for below, above in pairwise(edges[1:]):
        w = float((below + above) / 2)
        clamped = sum(int(w * float(bar.delay) / pi) for bar in network.bars)
        count = edges.index(above)
        assert stiffness.count_below(np.array([w]))[0] == count
        assert clamped <= count <= clamped + sum(point.motion is None for point in network.points)


def test_a_frequency_that_was_missed_is_seen(monkeypatch):
    """Where the search in doubles gives one frequency twice, counting in balls finds the other."""

    def wrong(stiffness, count):
        made = bisect_frequencies(stiffness, count)
        made[3] = made[4]
        return made

    expected = frequencies(NASTY["heavy"].network, 8)
    monkeypatch.setattr(found, "bisect_frequencies", wrong)
    made = frequencies(NASTY["heavy"].network, 8)
    assert all(a.overlaps(b) for a, b in zip(made, expected, strict=True))


def gram(modes):
    """Products of modes by Simpson's rule, which knows no formula."""
    network = modes[0].stiffness.network
    grams = np.zeros((len(modes), len(modes)))
    for number, point in enumerate(network.points):
        q = np.array([float(mode.points[number]) for mode in modes])
        grams += float(fmpq(point.mass)) * np.outer(q, q)
    for number, bar in enumerate(network.bars):
        s = np.linspace(0, 1, 201)
        weights = np.array([1, *([4, 2] * 99), 4, 1]) / 600 * float(bar.impedance * bar.delay)
        moved = []
        for mode in modes:
            angle = float(mode.frequency) * float(bar.delay)
            left, right = (float(mode.displacement(End(number, side))) for side in (0, 1))
            shape = (
                left + float(mode.amplitudes.get(number, 0)) * np.sin(angle * s)
                if angle == 0 or mode.amplitudes
                else (left * np.sin(angle * (1 - s)) + right * np.sin(angle * s)) / np.sin(angle)
            )
            moved.append(shape)
        grams += (np.array(moved) * weights) @ np.array(moved).T
    return grams


@pytest.mark.parametrize("name", NASTY)
def test_modes_are_orthogonal(name):
    assert gram(Spectrum(NASTY[name].network).first(7)) == pytest.approx(np.eye(7), abs=3e-8)


@pytest.mark.parametrize("name", ["springs", "a branch with gears", "a node at rest in the middle", "one storey"])
def test_sums_over_all_modes_are_known(name):
    """Sums over the first modes come near the closed forms, and never above where all terms are squares."""
    count = 150
    modes = Spectrum(NASTY[name].network).first(count)
    with ctx.workprec(256):
        statics = Statics(modes[0].stiffness)
        network = statics.stiffness.network
        strained = [mode for mode in modes if mode.frequency != 0]
        for point in statics.stiffness.points:
            shape = statics.loaded_shape({point: fmpq(1)})
            for end in (End(0, 0), End(len(network.bars) - 1, 1)):
                total = sum(
                    (m.points[point] * m.displacement(end) / (m.frequency * m.frequency) for m in strained), arb(0)
                )
                assert abs(total - shape.displacement(end)) < 2e-3
        for end in (End(0, 0), End(0, 1), End(len(network.bars) - 1, 1)):
            total = sum((m.slope(end) * m.slope(end) / (m.frequency * m.frequency) ** 2 for m in strained), arb(0))
            assert 0 <= statics.break_mass(end) - total < 2e-2


def test_what_has_no_modes_is_refused():
    """Dashpots, absorbing ends and contacts in one line."""
    dashpot = chain(["fixed", {"rod": 1}, {"mass": 1, "dashpot": 1, "name": "hammer"}, {"rod": 1}, "free"])
    with pytest.raises(UnservedError, match="at hammer is not supported by modes"):
        frequencies(dashpot.network, 1)
    contact = chain([{"mass": 1, "velocity": 1}, "contact", {"rod": 1}, "fixed"], velocity=["0-"])
    with pytest.raises(UnservedError, match="the contact at 0 is not supported by modes"):
        frequencies(contact.network, 1)


def star(count, apart=0):
    """Branches from one mass: all but three of them equal, the masses of these `apart`."""
    names = "abcdefhk"[:count]
    same = [{"from": "g", "name": name, "parts": [{"rod": 1}, {"mass": 1, "name": f"m{name}"}]} for name in names]
    model = chain(["fixed", {"rod": 1}, {"mass": 1, "name": "g"}, {"rod": 1}, "free"], branch=same)
    more = {"ma": apart, "mb": 2 * apart}
    points = tuple(replace(p, mass=p.mass + more.get(p.name, 0)) for p in model.network.points)
    return replace(model, network=replace(model.network, points=points))


CLUSTERS = {
    "equal": star(4),
    "hardly different": star(5, fmpq(1, 10**14)),
    "beyond most bits": star(7, fmpq(1, 10**70)),
    "beyond all bits": star(4, fmpq(1, 10**200)),
    "equal bars at rest": chain(
        ["fixed", {"rod": 1}, {"joint": True, "name": "g"}, {"rod": 1}, "fixed"],
        branch=[{"from": "g", "name": name, "parts": [{"rod": 1}, "fixed"]} for name in "ab"],
    ),
}


FEW_BITS = ["equal", "equal bars at rest"]


@pytest.mark.parametrize("name", [pytest.param(n, marks=[] if n in FEW_BITS else [pytest.mark.slow]) for n in CLUSTERS])
def test_equal_frequencies_are_all_found(name):
    """As many as finite elements have; and their shapes are modes at right angles: the gram matrix is one."""
    count = 14
    modes = Spectrum(CLUSTERS[name].network).first(count)
    w = np.array([float(mode.frequency) for mode in modes])
    squares = []
    for resolution in (12, 24):
        _, mass, stiffness = by_elements(CLUSTERS[name], resolution)
        squares.append(eigh(stiffness, mass, eigvals_only=True)[:count])
    assert w == pytest.approx(np.sqrt((4 * squares[1] - squares[0]) / 3), rel=2e-2, abs=1e-6)
    assert np.count_nonzero(np.diff(w) < 1e-12) >= 4
    assert gram(modes) == pytest.approx(np.eye(count), abs=3e-7)


def test_the_shapes_of_a_cluster_are_proved(monkeypatch):
    """The sum of q q^T of all modes below, with others added as a force near them adds them, is that of three forces:
    balls are as narrow as they say, and contain what many more bits find."""
    found_with = []
    for more in (1, 2):
        monkeypatch.setattr(found, "_TIMES", (1, 4, 8 * more))
        modes = Spectrum(CLUSTERS["equal"].network).first(4)[1:4]
        found_with.append([[m.points[a] * m.points[b] for a in range(6) for b in range(6)] for m in modes])
    first, second = (np.array(each).sum(axis=0) for each in found_with)
    assert all(a.overlaps(b) and a.rad() < 1e-15 for a, b in zip(first, second, strict=True))


def test_shapes_that_cannot_be_told_are_refused(monkeypatch):
    monkeypatch.setattr(equal_frequencies, "_APART", (2,))
    monkeypatch.setattr(found, "_TIMES", (1, 8))
    with pytest.raises(UnservedError, match=r"frequencies meet near 0\.86.*take pieces or march"):
        frequencies(CLUSTERS["beyond most bits"].network, 5)


@pytest.mark.parametrize("name", ["springs", "a node at rest in the middle", "one storey"])
def test_wrong_guesses_lead_to_the_same_frequencies(name, monkeypatch):
    """Doubles lose digits beside resonances of bars; whatever is lost there, balls count."""
    network = NASTY[name].network
    right = frequencies(network, 6)
    draw = np.random.default_rng(5)

    def wrong(stiffness, count):
        return np.sort(bisect_frequencies(stiffness, count) * (1 + 1e-3 * draw.uniform(-1, 1, count)))

    monkeypatch.setattr(found, "bisect_frequencies", wrong)
    assert all(one.overlaps(other) for one, other in zip(frequencies(network, 6), right, strict=True))


def test_a_frequency_is_counted_on_both_its_sides_and_no_more(monkeypatch):
    """Six times before: too near for what one step of Newton's method leaves, and twice where it was near enough."""
    counted, right = [], Stiffness.proved_count
    monkeypatch.setattr(Stiffness, "proved_count", lambda *args: counted.append(1) or right(*args))
    modes = Spectrum(building(["1/4"] * 8).network).first(60)
    assert len(counted) <= 2.2 * len(modes)


def test_of_a_light_mass_between_stiff_bars_digits_are_lost_in_doubles_alone():
    """1000 tan w + 1e-6 w = 1e-3 cot 2 w: guesses are off by more than rounding, what is proved is not."""
    parts = ["free", {"rod": 1, "impedance": 1000}, {"mass": "1/1000000"}, {"rod": 2, "impedance": "1/1000"}, "fixed"]
    network = chain(parts).network
    guesses, w = bisect_frequencies(Stiffness(network), 8), frequencies(network, 8)
    assert max(float(abs(each - guess) / each) for each, guess in zip(w, guesses, strict=True)) > 1e-13
    z, light = 1000.0, 1e-6
    for each in map(float, w):
        rest = z * np.tan(each) + light * each - 1e-3 / np.tan(2 * each)
        assert abs(rest) < 1e-9 * (z / np.cos(each) ** 2 + 2e-3 / np.sin(2 * each) ** 2) * each
