"""What the bound of the march of a chain rests on, each by itself, and that its check sees what is left out."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from math import sqrt

import numpy as np
import pytest
from flint import fmpq, fmpq_mat, fmpq_series
from hypothesis import given, settings

from tests.support.drives import drive, every, exact, instants, small
from wavesym.errors import WavesymError
from wavesym.exact.joints.joint import JointLaw
from wavesym.exact.motion import Motion
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Bar, Link, Network, Point
from wavesym.numbers.doubles import fraction, rational
from wavesym.numbers.reals import DOUBLE, SINGLE
from wavesym.programs.making import program
from wavesym.programs.rings import bound as bounds
from wavesym.programs.rings.answer import answer
from wavesym.programs.rings.bound import judge, size_of, smoothness
from wavesym.programs.rings.evaluator import RingMarch, ring_march
from wavesym.programs.rings.plan import RingPlan, ring_plan
from wavesym.programs.rings.space import JointSpace, joint_space
from wavesym.programs.rings.tables import RingTables
from wavesym.programs.schemes.rings import MarchingRings, RingScheme, WindowBlock
from wavesym.scene import Scene, lower

Q = fmpq
# two bodies and a point without mass on springs and dashpots; gears at an end and in a link
THREE = Network(
    (Point(Q(2), stiffness=Q(3), damping=Q(1, 7)), Point(Q(0), stiffness=Q(1, 2)), Point(Q(1, 3)), Point(Q(1))),
    (Bar(0, 3, Q(1), Q(1), Q(2), ratios=(Q(-3), Q(1))), Bar(1, 3, Q(1), Q(1), Q(1, 5))),
    (Link(0, 1, stiffness=Q(5), ratio=Q(2)), Link(1, 2, stiffness=Q(1, 4), damping=Q(3))),
)


def space() -> JointSpace:
    return joint_space(THREE, THREE.joints[0])


def test_a_state_space_is_the_law_of_its_joint() -> None:
    """Under s e^(p tau) both give (M p + C + K/p) q = s."""
    law, made = JointLaw.of(THREE, THREE.joints[0]), space()
    for p in (Q(1, 3), Q(7)):
        size = range(3)
        rows = [law.mass[a] * p * (a == b) + law.damping[a][b] + law.stiffness[a][b] / p for a in size for b in size]
        unit = fmpq_mat(
            made.states, made.states, [p * (a == b) for a in range(made.states) for b in range(made.states)]
        )
        assert fmpq_mat(3, 3, rows).inv() == made.shown * (unit - made.rates).inv() * made.pushed + made.passed


def test_its_energy_is_lost_to_dashpots_and_ends_alone() -> None:
    """d/dt of sum of weights x**2 / 2 is -q C q, whatever x is."""
    law, made = JointLaw.of(THREE, THREE.joints[0]), space()
    for n in range(5):
        x = fmpq_mat(made.states, 1, [Q((3 * n + 2 * k) % 7 - 3, k + 1) for k in range(made.states)])
        moved, q = made.rates * x, made.shown * x
        gained = sum((w * x[k, 0] * moved[k, 0] for k, w in enumerate(made.weights)), Q(0))
        assert gained == -sum((law.damping[a][b] * q[a, 0] * q[b, 0] for a in range(3) for b in range(3)), Q(0))
        size = sum((w * moved[k, 0] ** 2 for k, w in enumerate(made.weights)), Q(0))
        held = sum((w * x[k, 0] ** 2 for k, w in enumerate(made.weights)), Q(0))
        assert float(size.p) / float(size.q) <= made.norm**2 * float(held.p) / float(held.q)


@pytest.mark.parametrize(("degree", "length"), [(8, Q(1)), (15, Q(1, 3))])
def test_an_answer_misses_its_equation_as_it_says(degree: int, length: fmpq) -> None:
    """2 q' + q = s, integrated: what is left is the root of the mass times eps (T_(d+1) -+ 1)."""
    body = Network((Point(Q(2)), Point(Q(1))), (Bar(0, 1, Q(1), Q(1), Q(1)),))
    known = answer(joint_space(body, body.joints[0]), length, degree)
    size, half, cheb = degree + 1, float(length) / 2, np.polynomial.chebyshev
    given = np.zeros(size + 1)
    given[[0, 1, 4, degree, size]] = 1, -2, 0.5, 0.25, 2
    found = known.matrix @ given
    q = found[:size]
    left = np.pad(2 * q, (0, 1)) - half * cheb.chebint(given[:size] - q, lbnd=-1)
    left[0] -= 2 * given[size]
    eps = (known.missed @ given)[0]
    assert abs(eps) > 1e-4
    wanted = np.zeros(size + 1)
    wanted[[0, size]] = (-1) ** size, -1
    assert np.allclose(left, sqrt(2) * eps * wanted, rtol=0, atol=1e-14)
    assert abs(cheb.chebval(1, q) - (found[size] + given[size])) < 1e-14


def test_the_answer_of_a_body_at_the_end_of_a_panel() -> None:
    """Against power series: x' = rates x + pushed s in fractions."""
    made, length, degree = space(), Q(1, 2), 24
    x = fmpq_mat(made.states, 1, [Q(1), Q(-1, 2), Q(1, 3), Q(2), Q(0), Q(-1)])
    s = fmpq_mat(3, 1, [Q(1), Q(0), Q(-2)])
    term, total = x, x
    for n in range(1, 60):
        term = (made.rates * term + (made.pushed * s if n == 1 else fmpq_mat(made.states, 1))) * (length / n)
        total += term
    size = degree + 1
    given = np.zeros(3 * size + made.states)
    given[[0, 2 * size]] = 1, -2
    given[3 * size :] = [float(value.p) / float(value.q) for value in x.entries()]
    found = answer(made, length, degree).matrix @ given
    wanted = [float(v.p) / float(v.q) for v in (total - x).entries()]
    assert np.allclose(found[3 * size :], wanted, rtol=0, atol=1e-13)


def blocks(plan: RingPlan, degree: int) -> tuple[RingScheme, WindowBlock]:
    """All windows, as one block."""
    made = RingTables(plan, degree, DOUBLE)
    scheme = RingScheme(made.tables([False] * len(plan.outputs)), made.constants(), plan.tau_max, np.float64)
    marching = MarchingRings(scheme)
    assert plan.windows <= marching.most
    return scheme, marching.block(0, plan.windows)


def squared(scheme: RingScheme, series: np.ndarray) -> np.ndarray:
    """Integrals of squares over panels, (..., panel, k) to (..., panel)."""
    k = np.arange(scheme.degree + 1)
    both, apart = k[:, None] + k, k[:, None] - k
    even = both % 2 == 0
    gram = np.where(even, 1 / np.where(even, 1.0 - both**2, 1) + 1 / np.where(even, 1.0 - apart**2, 1), 0)
    return np.einsum("...pk,kl,...pl->...p", series, gram, series) * scheme.half_length


def energies(plan: RingPlan, degree: int) -> np.ndarray:
    """The energy of bars and joints at the start of each window."""
    scheme, block = blocks(plan, degree)
    held = np.sum(squared(scheme, block.waves), axis=-1)
    weights = np.array([float(w.p) / float(w.q) for place in plan.joints for w in place.space.weights])
    found = block.starts[:, 0] ** 2 @ weights / 2
    for number, track in enumerate(plan.tracks):
        z = float(track.impedance.p) / float(track.impedance.q)
        for n in range(plan.windows):
            found[n] += z * np.sum(held[scheme.deepest + n - track.steps : scheme.deepest + n, number])
    return found


def quiet(model: Model) -> Model:
    """Without loads, and with all that is modelled felt."""
    return replace(model, loads=())


@settings(max_examples=10)
@given(small(until=6))
def test_energy_never_grows(table) -> None:
    """And stays where there is nothing that takes it."""
    try:
        plan = ring_plan(quiet(lower(Scene(**table))))
    except WavesymError:
        return
    network = plan.model.network
    driven = any(point.motion not in (None, "fixed") for point in network.points)
    fine = (
        max(joint.space.norm for joint in plan.joints) * float(fraction(plan.step)) <= 8
    )  # for polynomials of degree 30
    if driven or not fine or len(plan.joints) < len(network.joints) or plan.windows > 200:
        return
    energy = energies(plan, 30)
    assert np.all(np.diff(energy) <= 1e-9 * (energy[0] + 1))
    if not any(x.damping for x in (*network.points, *network.links)):
        assert np.allclose(energy, energy[0], rtol=1e-6, atol=0)


def sprung() -> Scene:
    parts = [{"mass": 1, "velocity": 1}, {"rod": 1}, {"mass": 2, "spring": 3}, {"rod": "1/2", "impedance": 2}]
    return Scene(
        name="sprung", system={"type": "chain", "parts": parts}, output={"until": 9, "velocity": [0], "strain": ["1-"]}
    )


def test_energy_with_a_wrong_weight_is_seen() -> None:
    plan = ring_plan(lower(sprung()))
    energy = energies(plan, 24)
    assert np.allclose(energy, energy[0], rtol=1e-11, atol=0)
    body = plan.joints[1]
    stiffer = replace(body.space, weights=(body.space.weights[0], 2 * body.space.weights[1]))
    wrong = replace(plan, joints=(plan.joints[0], replace(body, space=stiffer), *plan.joints[2:]))
    assert np.ptp(energies(wrong, 24)) > 1e-2


def missed(model: Model, made: RingMarch) -> np.ndarray:
    """Errors in parts of the bound."""
    taus = instants(model, 10)
    if made.real is SINGLE:
        taus = np.unique(taus.astype(np.float32).astype(np.float64))
        taus = taus[taus <= made.tau_max]
    allowed = np.array([output.bound * output.largest for output in made.outputs])
    return np.max(np.abs(program(model, made).evaluate(taus) - exact(model, taus)), axis=1) / allowed


def test_truncation_that_is_left_out_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """At degrees that are too low nothing else matters."""
    model = lower(drive(6, displacement=[]))
    for degree in (5, 7, 9):
        assert np.max(missed(model, ring_march(model, degree=degree))) < 1
    with monkeypatch.context() as patched:
        patched.setattr(bounds.Losses, "_truncated", lambda *_: 0.0)
        assert np.max(missed(model, ring_march(model, degree=7))) > 1


def test_rounding_that_is_left_out_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    model = lower(drive(6, displacement=[]))
    assert np.max(missed(model, ring_march(model, SINGLE, 14))) < 1
    right = bounds.judge
    with monkeypatch.context() as patched:
        patched.setattr("wavesym.programs.rings.evaluator.judge", lambda plan, degree, _: right(plan, degree, DOUBLE))
        assert np.max(missed(model, ring_march(model, SINGLE, 14))) > 1


def grown(plan: RingPlan, jumps: list[float], order: int) -> float:
    """[x^order] of s(x) times G(x) to the power of the crossings."""
    rate = rational(max(place.space.norm for place in plan.joints))
    x = fmpq_series([0, rate], prec=order + 1)
    one = fmpq_series([1], prec=order + 1)
    total = fmpq_series([rational(jump) for jump in jumps], prec=order + 1)
    for _ in range(plan.crossings + 2):
        total *= (one + x) / (one - x)
    return float(total[order].p) / float(total[order].q)


def steepest(model: Model, order: int) -> float:
    """The largest jump of a derivative of the outputs, which are waves of bars with impedance 1."""
    until = rational(model.horizon())
    motion, largest = Motion(model, until), 0.0
    for probe in model.probes:
        segments = motion.segments(probe, 256)
        for segment, later in pairwise(segments):
            gap = later.start - segment.start
            (now,), (then,) = segment.families.values(), later.families.values()
            for _ in range(order):
                now, then = now.derivative(), then.derivative()
            largest = max(largest, abs(float((then(0) - now(gap)).mid())))
    return largest


@pytest.mark.parametrize("order", [1, 3, 6])
def test_jumps_of_derivatives_are_bounded(order: int) -> None:
    """Of strain + velocity, twice a wave, in the rods of impedance 1 of a drive."""
    model = lower(drive(6, strain=[], displacement=[], velocity=["1/2", "2", "4"]))
    plan = ring_plan(model)
    rate = max(place.space.norm for place in plan.joints)
    jumps = list(bounds._jumps(plan, rate))
    assert 0 < steepest(model, order) <= 2 * grown(plan, jumps, order)


def test_a_start_that_is_left_out_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """A body that moves into rods at rest: without it nothing would jump, and any degree would do."""
    plan = ring_plan(lower(sprung()))
    assert smoothness(plan, 4).degree > 20
    with monkeypatch.context() as patched:
        patched.setattr(bounds, "started", lambda *_: 0.0)
        assert smoothness(plan, 4).degree == 4


def test_a_point_that_no_rod_shows_moves_no_faster_than_its_size() -> None:
    """In L2 over a window, where the norm of energy is what it is at the start."""
    model = quiet(lower(every(4, strain=[], displacement=[], velocity=["hung"])))
    model = replace(
        model, network=replace(model.network, points=tuple(replace(p, velocity=Q(0)) for p in model.network.points))
    )
    plan = ring_plan(model)
    (track,) = {heard.track for heard in plan.outputs[0].heard}
    assert plan.tracks[track].impedance == 0
    scheme, block = blocks(plan, 26)
    energy = energies(plan, 26)
    squares = np.sum(squared(scheme, block.waves[scheme.deepest : scheme.deepest + plan.windows, track]), axis=-1)
    assert np.all(squares <= size_of(plan, track) ** 2 * energy + 1e-12)
    assert np.max(squares) > 1e-4 * size_of(plan, track) ** 2 * energy[0]


def test_largest_values_are_no_larger_than_they_are() -> None:
    """They are seen at instants, less what may be wrong: a bound that is relative to them errs to the safe side."""
    model = lower(drive(6))
    verdict = judge(ring_plan(model), 16, DOUBLE)
    dense = np.abs(exact(model, np.linspace(0, 6, 181))).max(axis=1)
    assert np.all(np.array(verdict.largest) <= dense * (1 + 1e-2))
