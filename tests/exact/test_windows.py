"""Waves on windows: all that the proof allows for, and no more, against closed forms and the exact solver."""

from fractions import Fraction
from itertools import pairwise

import pytest
from flint import arb, arb_poly, ctx, fmpq

import wavesym
from tests.support.truth import Truth
from wavesym.errors import CostError
from wavesym.exact import windows as room
from wavesym.exact.windows import STILL, PanelWave, WindowPanel, Windows, _Body, panels_of, windows
from wavesym.model.loads import Applied
from wavesym.model.node import Node, Rod
from wavesym.numbers.doubles import rational
from wavesym.scene import lower

REST = Rod(0, 0)


@pytest.fixture(autouse=True)
def _precision():
    with ctx.workprec(256):
        yield


def body(alpha, beta, velocity=0, extra=0):
    return Node(Rod(0, 0, velocity), Rod(0, 0, velocity), inertia=1, alpha=alpha, beta=beta, damping=extra)


def wave(powers, error=0):
    return PanelWave(arb_poly(powers), arb(error))


def driven(gamma, powers, start, u):
    """The q with q' + gamma q = sum_k powers[k] u**k and q(0) = start, in closed form."""
    steady = [arb(0)] * (len(powers) + 1)
    for k in reversed(range(len(powers))):
        steady[k] = (powers[k] - (k + 1) * steady[k + 1]) / gamma
    return arb_poly(steady)(arb(u)) + (start - steady[0]) * (-arb(gamma) * arb(u)).exp()


def force(alpha, a, beta, b, load, size):
    """The right side, where each arriving wave is off by all of its error, in one direction."""
    powers = [fmpq(0)] * 4
    for factor, one in ((alpha, a), (beta, b)):
        for k, c in enumerate(one.polynomial.coeffs()):
            powers[k] += factor * c
        powers[0] += factor * size * one.error
    for k, c in enumerate(load):
        powers[k] += c
    return powers


@pytest.mark.parametrize(
    ("a", "b", "load", "length"),
    [
        (wave([2]), STILL, [], 1),  # the defect alone
        (wave([0, 3]), STILL, [], 1),  # with a power of the right side in it
        (STILL, STILL, [0, -5], 1),
        (wave([1, 0, 80_000]), STILL, [], 1),  # the last power of the right side is as large as what it is to balance
        (wave([1, 0, -160_000]), STILL, [], 1),
        (wave([2], "1e4"), STILL, [], 1),
        (wave([1], 2**13), wave([1], 2**15), [], 1),  # the three parts are of like size
        (wave([1], 2**13), wave([-3], 2**14), [0, 7], fmpq(1, 2)),
    ],
)
def test_a_cut_off_series_is_off_by_what_is_told(a, b, load, length):
    """With three terms and a rate of 400 the defect is all there is: the error comes within 2 % of the bound."""
    alpha, beta, terms = 500, 250, 3
    gamma = alpha // 2 + beta // 2 + 25
    cut = _Body(body(alpha, beta, extra=25)).moved(a, b, arb_poly(load), fmpq(length), terms)
    assert cut.polynomial.length() == terms
    worst = arb(0)
    for sign in (-1, 1):
        exact = force(alpha, a, beta, b, load, sign)
        for k in range(201):
            u = fmpq(k, 200) * length
            error = abs(driven(gamma, exact, fmpq(0), u) - cut.polynomial(arb(u)))
            assert not error > cut.error
            worst = worst.max(error)
    assert worst > cut.error * fmpq(98, 100)


def test_an_error_at_the_start_stays_where_it_is():
    """The next panel starts anywhere in the ball in which the last one ended."""
    node = _Body(body(2, 2))
    first = node.moved(wave([1], fmpq(1, 10)), STILL, arb_poly(), fmpq(1), 30)
    second = node.moved(STILL, STILL, arb_poly(), fmpq(1, 2), 30)
    assert abs(second.error) < fmpq(1, 10**20)
    for off in (-1, 0, 1):
        ended = driven(2, [2 * (1 + off * fmpq(1, 10))], fmpq(0), 1)
        assert first.at(fmpq(1)).contains(ended)
        for u in (fmpq(0), fmpq(1, 4), fmpq(1, 2)):
            assert second.at(u).contains(ended * (-2 * arb(u)).exp())
    assert second.at(fmpq(0)).rad() < fmpq(11, 100)  # 2/10 over gamma = 2
    assert second.at(fmpq(0)).rad() > fmpq(9, 100)


def test_a_node_without_mass_follows_at_once():
    node = Node(REST, REST, inertia=0, alpha=3, beta=1, damping=2)
    moved = _Body(node).moved(wave([1, 2], fmpq(1, 8)), wave([4], fmpq(1, 2)), arb_poly([0, 8]), fmpq(1), 9)
    assert [c == fmpq(k, 4) for c, k in zip(moved.polynomial.coeffs(), (7, 14), strict=True)] == [True, True]
    assert moved.error == arb(fmpq(7, 8) / 4).upper()  # (3/8 + 1/2)/gamma, gamma = 2 + (3 + 1)/2
    assert moved.error > fmpq(7, 8) / 4 - fmpq(1, 2**200)


def test_what_does_not_move_is_exactly_still():
    assert _Body(body(1, 1)).moved(STILL, STILL, arb_poly(), fmpq(1), 9) is STILL
    assert _Body(body(1, 1, velocity=2)).moved(STILL, STILL, arb_poly(), fmpq(1), 9) is not STILL
    blurred = _Body(body(1, 1)).moved(PanelWave(arb_poly(), arb(fmpq(1, 4))), STILL, arb_poly(), fmpq(1), 9)
    assert blurred.error == fmpq(1, 4)  # alpha/gamma = 1
    assert blurred.at(fmpq(1)).contains(arb(fmpq(-1, 4)))
    assert blurred.at(fmpq(0)).contains(arb(fmpq(1, 4)))


def test_errors_pass_through_nodes_as_waves_do(monkeypatch):
    """A node sends q less what arrives: where the error of that jumps from one side to the other, both count."""
    scene = wavesym.Scene(
        name="passed",
        system={"type": "drive", "m": 2, "kappa": ["1/2", 3], "inertia": [1, 2, 5]},
        load=[],
        output={"until": 1, "strain": ["1/2"]},
    )
    told = {("right", 0): fmpq(1, 8), ("left", 2): fmpq(1, 2)}
    made = scene.system.chain
    right = room._arriving

    def arriving(sent, x, rod, step):
        if step < 0 and x in (0, 2):
            return PanelWave(arb_poly(), arb(told["right" if x == 0 else "left", x]))
        return right(sent, x, rod, step)

    monkeypatch.setattr(room, "_arriving", arriving)
    result = windows(made, range(1, 2), (), 1, 30, ctx.prec)
    node = made.nodes[1]
    q = (node.alpha * fmpq(1, 8) + node.beta * fmpq(1, 2)) / ((node.alpha + node.beta) / 2)
    assert node.alpha != node.beta
    for waves, own in ((result.left[1], fmpq(1, 8)), (result.right[1], fmpq(1, 2))):
        assert waves[0].error >= q + own
        assert waves[0].error < q + own + fmpq(1, 2**200)


SYSTEMS = {
    "collision": {"type": "collision", "m": 6, "kappa": ["1/10", 2, "1/5"], "velocity": [1, "1/3", "-1/2"]},
    "drive": {"type": "drive", "m": 3, "kappa": ["1/2", 2, "1/3"], "inertia": [1, 2, 3, "1/2"]},
    "force": {"type": "building", "m": 2, "kappa": ["1/4", "3/5", 2], "base": "force"},
    "ground": {"type": "building", "m": 3, "kappa": ["1/4", 3, "1/5", 1], "base": "ground"},
}
LOADS = {
    "drive": [
        {"body": 1, "times": [0, "7/3"], "steps": [1, "-1/2"]},
        {"body": 4, "times": ["3/2"], "steps": [2]},
    ],
    "force": [{"times": ["1/3", "5/2"], "a": [1, -2], "b": ["1/2", 1]}],
    "ground": [{"times": ["1/3", "3/2"], "a": [1, -2], "b": ["1/2", 1]}],
}


def watched(name):
    """A scene with velocity and strain on either side of every node."""
    system = SYSTEMS[name]
    m, collision = system["m"], system["type"] == "collision"
    nodes = range(m + 1)
    divided = [x for x in nodes if 0 < x < m and (x % 2 or not collision)]
    strain = [str(x) for x in nodes if x not in divided] + [f"{x}{side}" for x in divided for side in "-+"]
    output = {"until": 4, "velocity": list(nodes), "strain": strain}
    return wavesym.Scene(name=name, system=system, load=LOADS.get(name, []), output=output)


@pytest.mark.parametrize("terms", [4, 12, 60])
@pytest.mark.parametrize("name", SYSTEMS)
def test_waves_are_where_they_are_said_to_be(name, terms):
    """In a rod the velocity is p + r and the strain r - p: half their difference goes right, half their sum left."""
    scene = watched(name)
    until = rational(scene.output.until)
    made = scene.system.chain
    nodes = lower(scene).light_cone(lower(scene).until)
    result = windows(made, nodes, lower(scene).loads, int(until), terms, ctx.prec)
    exact = Truth(scene, scene.output.until)
    number = {(o.quantity, o.x, o.side): k for k, o in enumerate(scene.outputs)}
    m = scene.system.m
    taus = [n + panel.start + panel.length * part for n in range(4) for panel in result.panels for part in parts(terms)]
    loosest = arb(0)
    for tau in taus:
        at = Fraction(int(tau.p), int(tau.q))
        for x in nodes:
            velocity = exact.value(number["velocity", x, 0], at, 200)
            for direction, side in (("left", -1), ("right", 1)):
                if not 0 <= x + side <= m:
                    continue
                divided = ("strain", x, side) in number
                strain = exact.value(number["strain", x, side if divided else 0], at, 200)
                sent, u = result.sent(direction, x, tau)
                found = sent.at(u)
                assert found.overlaps((velocity - side * strain) / 2), (tau, x, direction)
                loosest = loosest.max(found.rad())
    assert terms < 60 or loosest < fmpq(1, 10**15)


def parts(terms):
    return [fmpq(0), fmpq(1, 3), fmpq(999, 1000)] if terms == 4 else [fmpq(0), fmpq(5, 7)]


@pytest.mark.parametrize("velocity", [2, -2, fmpq(1, 3)])
def test_a_body_goes_on_as_its_rods_move(velocity):
    """Each of its rods carries half of the velocity to it; at an end there is one rod, on either side."""
    rod, still = Rod(0, 0, velocity), fmpq(0)
    half = room._arriving({}, 0, rod, -1)
    for left, right, a, b in ((rod, rod, half, half), (None, rod, STILL, half), (rod, None, half, STILL)):
        node = Node(left, right, inertia=1, alpha=2 if left else 0, beta=2 if right else 0)
        moved = _Body(node).moved(a, b, arb_poly(), fmpq(1), 40)
        for u in (still, fmpq(1, 2), fmpq(1)):
            assert moved.at(u).contains(velocity)
            assert moved.at(u).rad() < fmpq(1, 2**100)
    assert room._arriving({}, 0, None, -1) is STILL
    assert half.at(still).contains(fmpq(velocity) / 2)


@pytest.mark.parametrize("error", [fmpq(1), fmpq(1, 8)])
def test_a_wave_is_anywhere_within_its_error(error):
    value = wave([3, 2], error).at(fmpq(5))
    assert value.contains(13 + arb(error))
    assert value.contains(13 - arb(error))
    assert value.rad() < error + fmpq(1, 2**20)
    assert wave([3, 2]).at(fmpq(5)) == 13


def test_an_error_is_kept_without_a_radius():
    for error in (arb(1), arb(0), arb(fmpq(1, 3)), arb(2, 1)):
        upper = room._upper(error)
        assert upper.rad() == 0
        assert upper >= error
        assert upper <= error.upper()


def test_before_the_first_window_rods_move_with_half_their_velocity():
    made = watched("collision").system.chain
    result = Windows(made, range(7), (WindowPanel(fmpq(0), fmpq(1)),), {}, {})
    for direction, x, rod in (("right", 1, 2), ("right", 2, 3), ("left", 3, 3), ("left", 2, 2)):
        sent, offset = result.sent(direction, x, fmpq(-1, 1000))
        assert sent.at(fmpq(1, 2)).contains(made.rod(rod).velocity / 2)
        assert sent.at(fmpq(1, 2)).rad() < fmpq(1, 2**250)
        assert (sent.error, offset) == (0, 0)


def test_the_wave_at_a_panels_start_is_the_one_that_begins_there():
    made = watched("drive").system.chain
    panels = (WindowPanel(fmpq(0), fmpq(1, 3)), WindowPanel(fmpq(1, 3), fmpq(2, 3)))
    waves = [wave([k]) for k in range(6)]
    result = Windows(made, range(1), panels, {0: waves}, {0: [wave([10 + k]) for k in range(6)]})
    for tau, k, u in (("0", 0, "0"), ("1/3", 1, "0"), ("333/1000", 0, "333/1000"), ("5/3", 3, "1/3"), ("2", 4, "0")):
        at, offset = (rational(Fraction(text)) for text in (tau, u))
        assert result.sent("left", 0, at) == (waves[k], offset)
        assert result.sent("right", 0, at)[0].at(fmpq(0)) == 10 + k


def test_panels_lie_between_the_instants_of_loads_that_act():
    made = watched("drive").system.chain
    times = [("M1", "7/3"), ("M1", "1/2"), ("M4", "6")]
    pieces = [Applied(source, rational(Fraction(time)), fmpq(1)) for source, time in times]
    for nodes, starts in ((range(4), ["0", "1/3", "1/2"]), (range(1, 4), ["0"])):
        panels = panels_of(made, nodes, pieces)
        assert [panel.start for panel in panels] == [rational(Fraction(start)) for start in starts]
        ends = [*(panel.start for panel in panels), fmpq(1)]
        assert [panel.length for panel in panels] == [high - low for low, high in pairwise(ends)]


def test_a_node_radiates_into_both_its_rods():
    assert body(fmpq(1, 3), 5, extra=7).radiation == 7 + fmpq(8, 3)


def test_waves_that_would_fill_the_memory_are_refused_before_the_first(monkeypatch):
    def begun(*_):
        raise AssertionError("a wave was computed")

    monkeypatch.setattr(_Body, "moved", begun)
    made = watched("drive").system.chain
    with pytest.raises(CostError, match=r"^output.until: the waves of 4 nodes on 30000 windows with 256 bits would"):
        windows(made, range(4), (), 30_000, 64, ctx.prec)
