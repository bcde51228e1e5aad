"""What the bound of a march rests on, each by itself, and that what is left out of it is seen."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from math import inf, pi, sqrt
from typing import Any

import numpy as np
import pytest
from flint import arb, fmpq, fmpq_mat, fmpq_series
from hypothesis import given, settings

from tests.support.drives import drive, every, exact, small
from tests.support.marches import all_windows, apart, energies, energy_of, missed, missed_at, scheme_of, squared
from tests.support.rounded import Rounded
from wavesym.errors import WavesymError
from wavesym.exact.joints.joint_law import JointLaw
from wavesym.exact.motion import Motion
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Bar, Link, Network, Point
from wavesym.numbers.doubles import fraction, nearest, rational
from wavesym.numbers.reals import DOUBLE, SINGLE
from wavesym.programs.march import bound as bounds
from wavesym.programs.march.bound import (
    READING,
    Verdict,
    judge,
    largest_wave,
    most_additions,
    reading_weights,
    size_of,
    smoothness,
)
from wavesym.programs.march.evaluator import march
from wavesym.programs.march.losses import block_loss
from wavesym.programs.march.plan import MarchPlan, largest_number, march_plan, power_of_two
from wavesym.programs.march.responses import NEGLIGIBLE, _round, block_response
from wavesym.programs.march.space import JointSpace, joint_space
from wavesym.programs.march.tables import MarchTables
from wavesym.programs.march.tail import Tail
from wavesym.programs.schemes.march import WindowBlock, _series
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
    law, made = JointLaw.assemble(THREE, THREE.joints[0]), space()
    for p in (Q(1, 3), Q(7)):
        size = range(3)
        rows = [law.mass[a] * p * (a == b) + law.damping[a][b] + law.stiffness[a][b] / p for a in size for b in size]
        unit = fmpq_mat(
            made.states, made.states, [p * (a == b) for a in range(made.states) for b in range(made.states)]
        )
        assert (
            fmpq_mat(3, 3, rows).inv()
            == made.state_velocities * (unit - made.rates).inv() * made.input_rates + made.feedthrough
        )


def test_its_energy_is_lost_to_dashpots_and_ends_alone() -> None:
    """d/dt of sum of weights x**2 / 2 is -q C q, whatever x is."""
    law, made = JointLaw.assemble(THREE, THREE.joints[0]), space()
    for n in range(5):
        x = fmpq_mat(made.states, 1, [Q((3 * n + 2 * k) % 7 - 3, k + 1) for k in range(made.states)])
        moved, q = made.rates * x, made.state_velocities * x
        gained = sum((w * x[k, 0] * moved[k, 0] for k, w in enumerate(made.weights)), Q(0))
        assert gained == -sum((law.damping[a][b] * q[a, 0] * q[b, 0] for a in range(3) for b in range(3)), Q(0))
        size = sum((w * moved[k, 0] ** 2 for k, w in enumerate(made.weights)), Q(0))
        held = sum((w * x[k, 0] ** 2 for k, w in enumerate(made.weights)), Q(0))
        assert nearest(size) <= made.norm**2 * nearest(held)


@pytest.mark.parametrize(("degree", "length"), [(8, Q(1)), (15, Q(1, 3))])
def test_a_block_misses_its_equation_as_it_says(degree: int, length: fmpq) -> None:
    """2 q' + q = s, integrated: what is left is the root of the mass times eps (T_(d+1) -+ 1)."""
    body = Network((Point(Q(2)), Point(Q(1))), (Bar(0, 1, Q(1), Q(1), Q(1)),))
    known = block_response(joint_space(body, body.joints[0]), length, degree)
    size, half, cheb = degree + 1, float(length) / 2, np.polynomial.chebyshev
    given = np.zeros(size + 1)
    given[[0, 1, 4, degree, size]] = 1, -2, 0.5, 0.25, 2
    found = known.matrix @ given
    q = found[:size]
    left = np.pad(2 * q, (0, 1)) - half * cheb.chebint(given[:size] - q, lbnd=-1)
    left[0] -= 2 * given[size]
    eps = (known.truncation_error @ given)[0]
    assert abs(eps) > 1e-4
    wanted = np.zeros(size + 1)
    wanted[[0, size]] = (-1) ** size, -1
    assert np.allclose(left, sqrt(2) * eps * wanted, rtol=0, atol=1e-14)
    assert abs(cheb.chebval(1, q) - (found[size] + given[size])) < 1e-14


def test_no_number_of_a_matrix_is_rounded_before_it_is_known() -> None:
    """A small one, too, or it is wrong by more than its roundoff; what is left out is 0."""
    small = 2.0**-40
    assert _round([[arb(1), arb(small, small * 2.0**-45)]]) is None
    found = _round([[arb(1), arb(small, small * 2.0**-90), arb(NEGLIGIBLE / 2, 2.0**-110)]])
    assert found is not None
    assert found.tolist() == [[1.0, small, 0.0]]


def test_a_block_at_the_end_of_a_panel() -> None:
    """Against power series: x' = rates x + pushed s in fractions."""
    made, length, degree = space(), Q(1, 2), 24
    x = fmpq_mat(made.states, 1, [Q(1), Q(-1, 2), Q(1, 3), Q(2), Q(0), Q(-1)])
    s = fmpq_mat(3, 1, [Q(1), Q(0), Q(-2)])
    term, total = x, x
    for n in range(1, 60):
        term = (made.rates * term + (made.input_rates * s if n == 1 else fmpq_mat(made.states, 1))) * (length / n)
        total += term
    size = degree + 1
    given = np.zeros(3 * size + made.states)
    given[[0, 2 * size]] = 1, -2
    given[3 * size :] = [nearest(value) for value in x.entries()]
    found = block_response(made, length, degree).matrix @ given
    wanted = [nearest(value) for value in (total - x).entries()]
    assert np.allclose(found[3 * size :], wanted, rtol=0, atol=1e-13)


def test_a_scatterer_keeps_the_energy_that_its_dashpots_leave() -> None:
    """What goes in less what comes out is what they take, q C q, to the last digit."""
    points = (Point(Q(0), damping=Q(1, 7)), Point(Q(1)), Point(Q(1)), Point(Q(1)))
    bars = tuple(Bar(0, k, Q(k), Q(1), Q(k, 3), ratios=(Q(-2) if k == 2 else Q(1), Q(1))) for k in (1, 2, 3))
    made = joint_space(network := Network(points, bars), network.joints[0])
    a = fmpq_mat(4, 1, [Q(1), Q(-2, 3), Q(5), Q(0)])
    sent, q = (
        made.scattering * a,
        sum((made.feedthrough[0, 0] * p.push * a[k, 0] for k, p in enumerate(made.ports)), Q(0)),
    )
    lost = sum((p.impedance * (a[k, 0] ** 2 - sent[k, 0] ** 2) for k, p in enumerate(made.ports)), Q(0))
    assert lost == q**2 / 7 > 0


def quiet(model: Model) -> Model:
    """Without loads, and with all that is modelled felt."""
    return replace(model, loads=())


@settings(max_examples=10)
@given(small(until=6))
def test_energy_never_grows(table) -> None:
    """And stays where there is nothing that takes it."""
    try:
        plan = march_plan(quiet(lower(Scene(**table))))
    except WavesymError:
        return
    network = plan.model.network
    driven = any(point.motion not in (None, "fixed") for point in network.points)
    # for polynomials of degree 30
    fine = max(joint.space.norm for joint in plan.joints) * float(fraction(plan.step)) <= 8
    if driven or not fine or len(plan.joints) < len(network.joints) or plan.windows > 200:
        return
    energy = energy_of(plan, 30)
    assert np.all(np.diff(energy) <= 1e-9 * (energy[0] + 1))
    if not any(x.damping for x in (*network.points, *network.links)):
        assert np.allclose(energy, energy[0], rtol=1e-6, atol=0)


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    "system",
    [
        {"type": "collision", "m": 4, "kappa": ["1/10", 1], "velocity": [1, 0]},
        {"type": "chain", "parts": [{"mass": 1, "velocity": 1}, {"rod": 1}, {"mass": "1/3"}, {"rod": 1}, {"mass": 2}]},
    ],
    ids=["collision", "chain"],
)
def test_free_bodies_keep_their_energy_for_long(system) -> None:
    model = lower(Scene(name="free", system=system, output={"until": 400, "strain": ["1/2"]}))
    energy = energy_of(march_plan(model), march(model).degree)
    assert energy[0] > 0
    np.testing.assert_allclose(energy, energy[0], rtol=1e-13)


def sprung() -> Scene:
    parts = [{"mass": 1, "velocity": 1}, {"rod": 1}, {"mass": 2, "spring": 3}, {"rod": "1/2", "impedance": 2}]
    return Scene(
        name="sprung", system={"type": "chain", "parts": parts}, output={"until": 9, "velocity": [0], "strain": ["1-"]}
    )


def test_energy_with_a_wrong_weight_is_seen() -> None:
    plan = march_plan(lower(sprung()))
    energy = energy_of(plan, 24)
    assert np.allclose(energy, energy[0], rtol=1e-11, atol=0)
    body = plan.joints[1]
    stiffer = replace(body.space, weights=(body.space.weights[0], 2 * body.space.weights[1]))
    wrong = replace(plan, joints=(plan.joints[0], replace(body, space=stiffer), *plan.joints[2:]))
    assert np.ptp(energy_of(wrong, 24)) > 1e-2


def of_one_kind(law: str, force: int = 1, time: int = 1, heavy: Fraction = Fraction(1), **outputs: list[Any]) -> Scene:
    """A chain that is loaded, of rods and joints of one kind alone, nothing of which is rounded when it begins.

    In other units, if such are given: forces are numbers so many times as large, instants and lengths too. Masses and
    springs are so many times as `heavy`.
    """
    m, k, z = heavy * force * time, heavy * force / time, Fraction(force)
    joints: list[dict[str, Any]] = {
        "bodies": [{"mass": m, "name": "a"}, {"mass": m * 7 / 5}, {"mass": m / 3}],
        "blocks": [
            {"mass": m, "spring": k, "name": "a"},
            {"mass": m * 7 / 5, "spring": k / 3},
            {"mass": m * 2, "spring": k},
        ],
        "scatterers": [{"joint": True, "dashpot": z / 7, "name": "a"}, {"joint": True}, {"joint": True}],
    }[law]
    rods = {"rod": time, "impedance": z}, {"rod": Fraction(time, 2), "impedance": z * 7 / 3}
    parts = [joints[0], rods[0], joints[1], rods[1], joints[2]]
    times, steps, ramps = [0, Fraction(time, 3)], [z, z * -2 / 3], [0, z / 3 / time]
    load = [{"at": "a", "times": times, "steps": steps, "ramps": ramps}]
    output = {"until": 12 * time, "tolerance": "0.5", **(outputs or {"velocity": [Fraction(time * 3, 4)]})}
    return Scene(name="kind", system={"type": "chain", "parts": parts}, load=load, output=output)


LEFT_OUT = {"bodies": "_of_bodies", "blocks": "_of_blocks", "scatterers": "_of_scatterers"}
KINDS = pytest.mark.parametrize("law", ["bodies", "blocks", "scatterers"])


def without(part: slice, what: str) -> tuple[str, Callable[..., tuple[np.ndarray, ...]]]:
    """What takes part of the losses of a kind of joint away."""
    right = getattr(bounds.Losses, LEFT_OUT[what])

    def less(*args: object) -> tuple[np.ndarray, ...]:
        found = list(right(*args))
        found[part] = [np.zeros_like(each) for each in found[part]]
        return tuple(found)

    return LEFT_OUT[what], less


def proved(plan: MarchPlan, degree: int, real=DOUBLE) -> tuple[float, float]:
    """Of the norm of energy of the error what is truncated and rounded, at most, in the size of the loads."""
    verdict, size = judge(plan, degree, real), nearest(power_of_two([largest_number(plan)]))
    return size * verdict.truncation_error, size * verdict.rounding_error


@KINDS
@pytest.mark.parametrize(("force", "time"), [(2**20, 1), (1, 2**20)])
def test_a_bound_is_the_same_in_any_units(law: str, force: int, time: int) -> None:
    """Energy is a force times a time; velocities are numbers as before, and displacements so many times as large."""
    shown, degree = {"velocity": [Q(3, 4)], "displacement": [Q(1, 4)]}, 9
    of_one, of_other = (
        march_plan(lower(of_one_kind(law, f, t, **{each: [fraction(x * t) for x in xs] for each, xs in shown.items()})))
        for f, t in ((1, 1), (force, time))
    )
    wanted = sqrt(force * time) * np.array(proved(of_one, degree))
    assert proved(of_other, degree) == pytest.approx(tuple(wanted), rel=1e-9)
    velocity, displacement = judge(of_one, degree, DOUBLE).errors
    assert judge(of_other, degree, DOUBLE).errors == pytest.approx((velocity, displacement * time), rel=1e-9)


@KINDS
def test_rounding_that_is_left_out_is_seen(law: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A march in single precision beside the same in double: in the norm of energy it is wrong, but as is proved."""
    plan, degree = march_plan(lower(of_one_kind(law)), SINGLE), 12
    error = apart(plan, all_windows(plan, degree, SINGLE), all_windows(plan, degree, DOUBLE))
    rounded = proved(plan, degree, SINGLE)[1]
    assert 0 < error <= rounded < 1e4 * error
    assert rounded == pytest.approx(2.0**29 * proved(plan, degree, DOUBLE)[1], rel=1e-3)
    monkeypatch.setattr(bounds.Losses, *without(slice(0, 3), law))
    assert proved(plan, degree, SINGLE)[1] < error


def test_rounding_of_a_load_counts_from_the_window_on_in_which_it_comes() -> None:
    """And nothing before: what a joint between endless rods then sends is rounded, and nothing else."""
    rods = {"rod": 1}, {"rod": "1/2", "impedance": "7/3"}
    parts = ["absorbing", rods[0], {"joint": True, "dashpot": "1/7", "name": "a"}, rods[1], "absorbing"]
    load = [{"at": "a", "times": [0, "16/3"], "steps": [0, "1/3"], "ramps": [0, "1/7"]}]
    output = {"until": 8, "velocity": ["a"]}
    scene = Scene(name="late", system={"type": "chain", "parts": parts}, load=load, output=output)
    plan = march_plan(lower(scene), SINGLE)
    error = apart(plan, all_windows(plan, 4, SINGLE), all_windows(plan, 4, DOUBLE))
    assert 0 < error <= proved(plan, 4, SINGLE)[1] < 1e4 * error


@pytest.mark.parametrize(
    ("law", "heavy", "part"),
    [("blocks", Fraction(1, 10**10), 0), ("bodies", Fraction(10**10), 2), ("blocks", Fraction(10**10), 2)],
)
def test_rounding_of_what_is_sent_or_kept_is_seen(
    law: str, heavy: Fraction, part: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What is light keeps hardly any energy, and what is heavy sends hardly any."""
    plan, degree = march_plan(lower(of_one_kind(law, heavy=heavy)), SINGLE), 12
    error = apart(plan, all_windows(plan, degree, SINGLE), all_windows(plan, degree, DOUBLE))
    assert 0 < error <= proved(plan, degree, SINGLE)[1]
    monkeypatch.setattr(bounds.Losses, *without(slice(part, part + 1), law))
    assert proved(plan, degree, SINGLE)[1] < error


@pytest.mark.quick(2)
@KINDS
def test_truncation_that_is_left_out_is_seen(law: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A march of a low degree beside one of a high degree, in the norm of energy; scatterers need no degree."""
    plan = march_plan(lower(of_one_kind(law)))
    for degree in (4, 6, 9):
        error = apart(plan, all_windows(plan, degree), all_windows(plan, 40))
        truncated, rounded = proved(plan, degree)
        assert error <= truncated + rounded
        if law == "scatterers":
            assert truncated == 0
        else:
            assert truncated < 100 * error
    if law != "scatterers":
        monkeypatch.setattr(bounds.Losses, *without(slice(3, 4), law))
        assert sum(proved(plan, degree)) < error


@KINDS
def test_values_are_wrong_by_more_than_a_bound_without_truncation(law: str, monkeypatch: pytest.MonkeyPatch) -> None:
    model = lower(of_one_kind(law))
    assert np.max(missed_at(model, 5)) < 1
    if law != "scatterers":
        monkeypatch.setattr(bounds.Losses, *without(slice(3, 4), law))
        assert np.max(missed_at(model, 5)) > 1


def test_values_are_wrong_by_more_than_a_bound_of_another_precision(monkeypatch: pytest.MonkeyPatch) -> None:
    model, right = lower(drive(6, displacement=[])), bounds.judge
    assert np.max(missed(model, march(model, SINGLE, 14), 10)) < 1
    monkeypatch.setattr("wavesym.programs.march.evaluator.judge", lambda plan, degree, _: right(plan, degree, DOUBLE))
    assert np.max(missed(model, march(model, SINGLE, 14), 10)) > 1


def grown(plan: MarchPlan, jumps: list[float], order: int) -> float:
    """[x^order] of s(x) times G(x) to the power of the crossings."""
    rate = rational(max(place.space.norm for place in plan.joints))
    x = fmpq_series([0, rate], prec=order + 1)
    one = fmpq_series([1], prec=order + 1)
    total = fmpq_series([rational(jump) for jump in jumps], prec=order + 1)
    for _ in range(plan.crossings + 2):
        total *= (one + x) / (one - x)
    return nearest(total[order])


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
    plan = march_plan(model)
    rate = max(place.space.norm for place in plan.joints)
    jumps = list(bounds._jumps(plan, rate))
    assert 0 < steepest(model, order) <= 2 * grown(plan, jumps, order)


def test_a_start_that_is_left_out_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """A body that moves into rods at rest: without it nothing would jump, and any degree would do."""
    plan = march_plan(lower(sprung()))
    assert smoothness(plan, 4).degree > 20
    monkeypatch.setattr(bounds, "start_jump", lambda *_: 0.0)
    assert smoothness(plan, 4).degree == 4


def test_a_point_that_no_rod_shows_moves_no_faster_than_its_size() -> None:
    """In L2 over a window, where the norm of energy is what it is at the start."""
    model = quiet(lower(every(4, strain=[], displacement=[], velocity=["hung"])))
    model = replace(
        model, network=replace(model.network, points=tuple(replace(p, velocity=Q(0)) for p in model.network.points))
    )
    plan = march_plan(model)
    (track,) = {term.track for term in plan.outputs[0].terms}
    assert plan.tracks[track].impedance == 0
    scheme, block = all_windows(plan, 26)
    energy = energies(plan, scheme, block.waves, block.starts[:, 0])
    squares = np.sum(squared(scheme, block.waves[scheme.deepest : scheme.deepest + plan.windows, track]), axis=-1)
    assert np.all(squares <= size_of(plan, track) ** 2 * energy + 1e-12)
    assert np.max(squares) > 1e-4 * size_of(plan, track) ** 2 * energy[0]


def test_a_heavy_point_that_no_rod_shows_moves_as_far_as_its_size_allows() -> None:
    """It keeps its velocity for a window of 1, M q**2 / 2 is its energy, and so q**2 is 2 E**2 / M."""
    parts = ["absorbing", {"rod": 1}, {"joint": True, "name": "c"}, {"rod": 1}, "absorbing"]
    branch = {"from": "c", "name": "b", "parts": [{"spring": "1/1000"}, {"mass": 100, "velocity": 1, "name": "hung"}]}
    system = {"type": "chain", "parts": parts, "branch": [branch]}
    plan = march_plan(lower(Scene(name="heavy", system=system, output={"until": 4, "velocity": ["hung"]})))
    (track,) = {term.track for term in plan.outputs[0].terms}
    assert plan.tracks[track].impedance == 0
    scheme, block = all_windows(plan, 12)
    square = np.sum(squared(scheme, block.waves[scheme.deepest, track]))
    assert (
        2 / 100 * 0.99 < square / energies(plan, scheme, block.waves, block.starts[:, 0])[0] < size_of(plan, track) ** 2
    )


def test_what_rounding_hides_of_a_block_counts_as_missed() -> None:
    """1 + 0.99 u - 1 is 0 to a program."""
    plan, unit = march_plan(lower(of_one_kind("blocks"))), 2.0**-53
    losses = bounds.Losses(plan, MarchTables(plan, 4, DOUBLE), scheme_of(plan, 4), unit, 0.0)
    given, rows = np.ones((1, 1, 3)), np.array([[1.0, 0.99 * unit, -1.0]])
    (missed,) = losses._truncation_losses(rows, 0.5, given, given)
    assert given @ rows.T == 0
    assert missed >= (0.99 * unit * block_loss(0.5)) ** 2


@pytest.mark.parametrize("turned", [1e-6, 0.1, 1.0, 30.0])
def test_a_block_loses_what_it_sends_and_what_it_keeps(turned) -> None:
    """Of the error of a state whose size is 2 eps at most, and grows by g h on the panel: both parts, added."""
    sent, kept = 2 * np.sqrt(turned), 2 * (1 + turned) / np.sqrt(2)
    assert block_loss(turned) >= (sent + kept) * (1 - 1e-15)


def test_largest_values_are_no_larger_than_they_are() -> None:
    """They are seen at instants, less what may be wrong: a bound that is relative to them errs to the safe side."""
    model = lower(drive(6))
    verdict = judge(march_plan(model), 16, DOUBLE)
    dense = np.abs(exact(model, np.linspace(0, 6, 181))).max(axis=1)
    assert np.all(np.array(verdict.largest) <= dense * (1 + 1e-2))
    assert np.all(np.array(verdict.largest) >= dense / 2)
    assert np.all(np.array(verdict.heights) >= dense)


def test_a_verdict_is_relative_to_what_is_certainly_there() -> None:
    verdict = Verdict(8, (0.5, 0.0, 2.0, 1.0), (2.5, 0.0, 1.0, 1.0), 0.0, 0.0)
    assert verdict.largest == (2.0, 0.0, 0.0, 0.0)
    assert verdict.bounds == (0.25, 0.0, inf, inf)


def test_from_the_least_number_on_a_product_is_rounded_as_the_unit_roundoff_says() -> None:
    """The least number times u is rounded to u of itself, and a bit less is not."""
    for real in (DOUBLE, SINGLE):
        assert real.least * real.roundoff * real.roundoff == real.smallest > 0


def test_l2_of_a_series_is_bounded_by_its_norm() -> None:
    """The factor pi/4 of a panel's length is needed: T_k comes within 1.3 of it, and nothing exceeds it."""
    points, gauss = np.polynomial.legendre.leggauss(40)
    basis = np.polynomial.chebyshev.chebvander(points, 30)
    gram = (basis * gauss[:, np.newaxis]).T @ basis / 2  # of a panel of length 1
    twice = np.diag([sqrt(0.5), *np.ones(30)])
    assert 0.6 < np.linalg.norm(twice @ gram @ twice, 2) <= pi / 4


def worst(degree):
    """The polynomial whose value at 1 is largest for its L2 norm, which is 1."""
    c = (2 * np.arange(degree + 1) + 1) / 2
    return np.polynomial.Legendre(c / sqrt(np.sum(c)))


@pytest.mark.parametrize("degree", [0, 1, 7, 40])
def test_no_wave_is_larger_than_its_energy_allows_and_one_is_as_large(degree) -> None:
    plan = march_plan(lower(of_one_kind("bodies")))
    shortest = min(nearest(panel.length) for panel in plan.panels)
    assert shortest == pytest.approx(1 / 6)
    points, gauss = np.polynomial.legendre.leggauss(degree + 1)
    found = 3.0 * worst(degree)
    energy = sqrt(shortest / 2 * (gauss @ found(points) ** 2))
    assert largest_wave(Tail(degree, 0.0), plan, energy) == pytest.approx(found(1.0), rel=1e-12)


def test_the_tail_of_a_wave_counts_twice_over() -> None:
    """A constant and a tail that takes it away but at one point, where it doubles it: no energy, and twice the tail."""
    plan = march_plan(lower(of_one_kind("bodies")))
    assert largest_wave(Tail(0, 0.5), plan, 0.0) == pytest.approx(2 * 0.5)
    # a polynomial of degree K all of whose L2 norm the tail takes away
    assert largest_wave(Tail(5, 0.5), plan, 0.0) == pytest.approx(0.5 + worst(5)(1.0) * 0.5 * sqrt(2))


# a stretch that began with the window, one of the window before, one that begins late: start, half of its panel
STRETCHES = pytest.mark.parametrize(("start", "half"), [(0.0, 0.5), (-0.3, 0.5), (0.4, 0.15)])
DEGREE = 24


def local(w, half):
    """The program's variable on a stretch, w after its start, for all coefficients side by side.

    `start` and `excess` are together what they stand for to twice as many digits, and tau less its cycle is exact.
    """
    return w / Rounded.wrong(half) - Rounded(np.ones(DEGREE + 1))


def since(t, start):
    both = np.ones(DEGREE + 1)
    return (Rounded(t * both) - Rounded(start * both)) + Rounded(2.0**-55 * both)


def errors(read, start, half):
    """The largest error for each coefficient alone, in units of u and of the smallest number, over a stretch."""
    c = Rounded.array([Rounded(row) for row in np.eye(DEGREE + 1)])
    points = np.linspace(max(start, 0.0), min(start + 2 * half, 1.0), 9)
    found = [read(c, t, start, half) for t in points]
    return np.max([each.error for each in found], axis=0), max(np.max(each.underflow) for each in found)


def arrived(c, t, start, half):
    """As `heard` in C; the sum is that of the program in NumPy."""
    u = Rounded.array([local(since(t, start), half)])
    (wave,) = _series(c[:, np.newaxis], u)
    return wave + wave._scaled(1e-9)  # with another wave


def test_what_reading_loses_is_in_the_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of waves that are right, and all T_d: as much as is counted, where a stretch ends."""
    plan = march_plan(lower(of_one_kind("bodies")))
    march_blocks = bounds._march_blocks

    def steep(*of: Any) -> Iterator[WindowBlock]:
        for block in march_blocks(*of):
            block.waves[:] = np.eye(DEGREE + 1)[-1]
            yield block

    class Nothing(bounds.Losses):
        initial_error = 0.0

        def of_block(self, block: WindowBlock) -> tuple[float, float]:
            return 0.0, 0.0

    monkeypatch.setattr(bounds, "_march_blocks", steep)
    monkeypatch.setattr(bounds, "Losses", Nothing)
    monkeypatch.setattr(bounds, "smoothness", lambda *_: Tail(DEGREE, 0.0))
    (error,) = judge(plan, DEGREE, DOUBLE).errors
    gains = sum(abs(nearest(term.gain)) for term in plan.outputs[0].terms)
    found, _ = errors(arrived, 0.0, 0.5)
    assert gains * found[-1] * 2.0**-53 <= error <= 2 * gains * found[-1] * 2.0**-53


def test_what_is_wrong_all_along_adds_up_in_a_displacement(monkeypatch: pytest.MonkeyPatch) -> None:
    """Waves to both sides, of impedance 1, by 1 in L2 in each window of length h, and so their integrals by sqrt(h)."""
    plan = march_plan(lower(of_one_kind("bodies", displacement=["1/4"])))

    class Wrong(bounds.Losses):
        def __init__(self, *of: Any) -> None:
            super().__init__(*of)
            self.initial_error = 1.0

        def of_block(self, block: WindowBlock) -> tuple[float, float]:
            return 0.0, 0.0

    monkeypatch.setattr(bounds, "Losses", Wrong)
    monkeypatch.setattr(bounds, "power_of_two", lambda _: Q(1))
    (error,) = judge(plan, 8, DOUBLE).errors
    assert 2 * sqrt(nearest(plan.step)) * plan.windows <= error <= 2.1 * sqrt(nearest(plan.step)) * plan.windows


@STRETCHES
def test_reading_a_wave_costs_no_more_than_said_and_not_much_less(start, half) -> None:
    claimed = READING * reading_weights(DEGREE, displaced=False)
    found, lost = errors(arrived, start, half)
    assert (found <= claimed).all()
    assert lost <= 4 * (DEGREE + 3) ** 2
    # the local variable is worst at the end of a panel
    assert claimed[-1] <= 1.4 * found[-1]
    assert (claimed[3:] <= 7 * found[3:]).all()


def antiderivative(c, u):
    """As in C."""
    twice, now, after = u + u, 0, 0
    for k in range(DEGREE + 1, 0, -1):
        lower, upper = (2 * c[0] if k == 1 else c[k - 1]), (c[k + 1] if k < DEGREE else 0)
        now, after = (twice * now - after) + (lower - upper) / Rounded(2.0 * k), now
    return u * now - after


def gathered(c, t, start, half):
    """As in C, from the start of a stretch on, or of the window."""
    low = local(Rounded(np.full(DEGREE + 1, max(0.0, -start))), half)
    difference = antiderivative(c, local(since(t, start), half)) - antiderivative(c, low)
    return Rounded.wrong(half) * difference


def test_no_integral_over_a_window_is_the_sum_of_more_numbers_than_said() -> None:
    """Programs add what an antiderivative is at the end of each stretch, less what it is at its start."""
    for law in ("bodies", "blocks", "scatterers"):
        plan = march_plan(lower(of_one_kind(law)))
        delays = {term.delay for output in plan.outputs for term in output.terms}
        added = [2 * len(plan.stretches(delay)) for delay in delays]
        assert len(plan.panels) > 1
        assert len(plan.panels) < max(added) / 2 + 1
        assert max(added) <= most_additions(plan)


@pytest.mark.quick(1)
@STRETCHES
def test_integrating_a_wave_costs_no_more_than_said(start, half) -> None:
    """It costs a good deal less: an error of the local variable is not multiplied by the degree."""
    claimed = 24 * reading_weights(DEGREE, displaced=True)
    found, lost = errors(gathered, start, half)
    assert (found <= claimed).all()
    assert lost <= 4 * (DEGREE + 3) ** 2
