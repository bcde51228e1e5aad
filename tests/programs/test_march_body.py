"""Bodies on a panel: their operator, what its arithmetic rounds, counted, and what its polynomials miss."""

from __future__ import annotations

from math import sqrt
from types import SimpleNamespace

import numpy as np
import pytest
from flint import arb, arb_poly, ctx, fmpq, fmpq_poly

from tests.support.marches import all_windows, scheme_of
from tests.support.rounded import Rounded
from wavesym.numbers.doubles import nearest
from wavesym.numbers.reals import DOUBLE
from wavesym.programs.march.losses import _LOADED, Losses
from wavesym.programs.march.plan import march_plan
from wavesym.programs.march.responses import BodyOperator, block_response, body_operator, body_roundings
from wavesym.programs.march.space import BODY
from wavesym.programs.march.tables import MarchTables
from wavesym.programs.schemes.march import Marching, RunningLoads
from wavesym.programs.schemes.march_joints import Bodies
from wavesym.scene import Scene, lower

STEPS = pytest.mark.parametrize(
    ("step", "degree"), [("1/1000", 8), ("1/10", 21), ("1/10", 33), ("1", 8), ("1", 21), ("8", 21), ("100", 13)]
)


def moved(of: BodyOperator, p, velocity, e=None, first=None, last=None, slack=None, loss=None):
    """The velocities q and that at the end, as `step_body` of the C has them."""
    degree = len(of.ratio) - 1
    e, first, last = of.ratio if e is None else e, of.first if first is None else first, last or of.last
    slack, loss = of.slack if slack is None else slack, of.loss if loss is None else loss
    q = [0] * (degree + 1)
    y = begun = ended = 0
    for k in range(degree, 0, -1):
        y = e[k] * (((2 * p[0] if k == 1 else p[k - 1]) - (p[k + 1] if k < degree else 0)) + y)
        q[k] = y
        begun += first[k] * y
        ended += last[k] * y
    begun = velocity - begun
    q[0] = begun - slack * begun
    velocity = q[0] + (ended - loss * q[0])
    before = 2 * q[0]
    for k in range(1, degree + 1):
        q[k] = before = q[k] - e[k] * before
    return q, velocity


def test_the_operator_solves_the_equation() -> None:
    """q' + 2 q = 2 p for p = u + 1 on [-1, 1], in twice as fine a variable: q = u + 1/2 + c exp(-2 u)."""
    rate, degree = 2.0, 30
    of = body_operator(fmpq(4), degree)  # rate 2 on a panel of length 2
    q, end = moved(of, [1.0, 1.0] + [0.0] * (degree - 1), 0.7)
    u = np.linspace(-1, 1, 11)
    exact = u + 1 - 1 / rate + (0.7 + 1 / rate) * np.exp(-rate * (u + 1))
    np.testing.assert_allclose(np.polynomial.chebyshev.chebval(u, q), exact, atol=1e-14)
    assert end == pytest.approx(exact[-1], abs=1e-14)
    assert all(0 < e < 1 for e in of.ratio[1:])


def body(mass="1", dashpot="0", times=(0,), steps=(1,), ramps=(0,), until="1/2", ratio=1) -> Scene:
    """One between a rod and another, and a branch."""
    parts = [{"rod": 1}, {"mass": mass, "dashpot": dashpot, "name": "b"}, {"rod": 1, "impedance": 2}, "absorbing"]
    branch = [{"from": "b", "name": "side", "ratio": ratio, "parts": [{"rod": 2, "impedance": "1/3"}, "absorbing"]}]
    load = [{"at": "b", "times": list(times), "steps": list(steps), "ramps": list(ramps)}]
    output = {"until": until, "tolerance": "1e-2", "velocity": ["b"]}
    return Scene(name="made", system={"type": "chain", "parts": parts, "branch": branch}, load=load, output=output)


def only_body(plan):
    """The joint that is one."""
    (joint,) = [joint for joint in plan.joints if joint.space.law == BODY]
    return joint


@pytest.mark.parametrize("degree", [7, 12])
@pytest.mark.parametrize("ratio", [1, -2])
def test_a_body_is_a_block_of_one_mass(degree, ratio) -> None:
    """Made another way: a matrix for all of it, from the laws of its joint."""
    space = only_body(march_plan(lower(body("2/3", "1/5", ratio=ratio)))).space
    for length in (fmpq(1), fmpq(1, 7)):
        block = block_response(space, length, degree)
        of = body_operator(space.rate * length, degree)
        for s in np.random.default_rng(degree).uniform(-1, 1, (3, degree + 2)):
            q, end = moved(of, nearest(space.drive) * s[:-1], s[-1])
            np.testing.assert_allclose([*q, end - s[-1]], block.matrix @ s, rtol=0, atol=1e-14)


def inputs(degree, count):
    """p, `count` times rounded, and the velocity at the start; a run for each coefficient, and for that, alone."""
    unit = np.eye(degree + 2)
    return Rounded.array([Rounded.wrong(row, count) for row in unit[:-1]]), Rounded(unit[-1])


@pytest.mark.parametrize("ports", [1, 2, 3, 4])
@pytest.mark.parametrize("of", [0, 1])
def test_what_acts_is_rounded_no_more_often_than_ports_and_4(ports, of) -> None:
    """Of a wave that arrives in any port alone, beside a load: in the order of the C."""
    for alone in range(ports):
        waves = [Rounded(np.array([float(port == alone)])) for port in range(ports)]
        p = Rounded.wrong(1.0) * waves[0]
        for wave in waves[1:]:
            p = p + Rounded.wrong(1.0) * wave
        p = p + Rounded(np.zeros(1)) if of else p
        assert ports + 2 >= p.error[0] > 0


def in_c(of, count):
    """The function `step_body` of the C."""
    p, velocity = inputs(len(of.ratio) - 1, count)
    e, first, last = (Rounded.table(table) for table in (of.ratio, of.first, of.last))
    slack, loss = (Rounded.table(number)[()] for number in (of.slack, of.loss))
    return moved(of, p, velocity, e, first, list(last), slack, loss)


def in_numpy(of, count):
    """The scheme, with numbers that count in place of its own; q is what it sends into a port where nothing arrives."""
    degree = len(of.ratio) - 1
    numbers = {"push": (1, 0), "ratio": (1, 1), "drive": (0,), "matrix": Rounded.table(of.rows)}
    scheme = SimpleNamespace(
        real=object,
        held=np.zeros(3),
        steps=np.ones(3, int),
        degree=degree,
        panels=1,
        firsts={"point": np.array([0, 1]), "state": np.array([0, 1]), "port": np.array([0, 2])},
        ports={"arrive": (0, 1), "send": (0, 1), "point_of": (0, 0)},
        joint_numbers={name: np.array(values, object) for name, values in numbers.items()},
        answers=np.zeros((1, 1), int),
    )
    group = Bodies(scheme, np.array([0]))
    p, velocity = inputs(degree, count)
    x = Rounded.array([velocity])
    arriving = np.stack([p, np.zeros(degree + 1, object)])[None, None]
    sent = group.step(arriving, np.zeros((1, 1, 1, 3), object), x, np.zeros((1, 1), object))
    return sent[0, 0, 1], x[0]


def counted(q, end):
    """What is counted, as in `body_roundings`."""
    return np.array([[*number.error, number.underflow] for number in (*q, end)])


def norms(wrong):
    """Of the coefficients, and of the end: per |p|, |start|, smallest number; c_0 counts twice."""
    twice = np.ones(len(wrong) - 1)
    twice[0] = np.sqrt(2)
    q, end = twice[:, np.newaxis] * wrong[:-1], wrong[-1]
    of_q = np.linalg.norm(q[:, :-2] / twice, 2), np.linalg.norm(q[:, -2]), np.linalg.norm(q[:, -1])
    return np.array([of_q, (np.linalg.norm(end[:-2] / twice), end[-2], end[-1])])


@pytest.mark.quick(1)
@pytest.mark.parametrize("count", [5, 8])
@STEPS
def test_roundings_are_no_less_than_a_count_and_little_more(step, degree, count) -> None:
    of = body_operator(fmpq(step), degree)
    claimed = body_roundings(of, count)
    c, numpy = counted(*in_c(of, count)), counted(*in_numpy(of, count))
    assert (claimed >= c).all()
    assert (claimed >= numpy).all()
    if fmpq(step) <= 1:  # of light bodies errors cancel, and the constants do not count with it
        assert (norms(claimed) <= np.array([[2.1, 2.1, 12]]) * norms(np.maximum(c, numpy))).all()


@pytest.mark.quick(1)
@pytest.mark.parametrize("step", ["1/10", "1"])
def test_roundings_of_what_acts_that_are_not_counted_are_seen(step) -> None:
    """Where p has as many as a joint of 60 rods."""
    of = body_operator(fmpq(step), 21)
    assert (body_roundings(of, 64) >= counted(*in_c(of, 64))).all()
    assert not (body_roundings(of, 0) >= counted(*in_c(of, 64))).all()


@pytest.mark.parametrize(("step", "degree"), [("100", 2), ("1000", 2), ("1000", 3), ("1000000", 3), ("1000000", 4)])
def test_roundings_are_no_less_than_a_count_where_degrees_are_far_too_low(step, degree) -> None:
    """Of odd degree `slack` is nearly 1, of even degree `loss` is below -1."""
    of = body_operator(fmpq(step), degree)
    claimed = body_roundings(of, 6)
    assert (claimed >= counted(*in_c(of, 6))).all()
    assert (claimed >= counted(*in_numpy(of, 6))).all()


@pytest.mark.parametrize(
    ("slack", "loss", "degree"),
    [(0, 0, 64), pytest.param(0, 0, 100, marks=pytest.mark.slow), (1, -100, 3), (1, 100, 8)],
)
def test_what_sums_and_the_mean_lose_is_counted_by_itself(slack, loss, degree) -> None:
    """With tables of nearly 0, where what the coefficients may lose does not reach the value at the end."""
    tiny = (0.0,) + (2.0**-40,) * degree
    of = BodyOperator(2.0**-40, tiny, tiny, tiny, slack, loss, 2.0**-40)
    lost, told = counted(*in_c(of, 5))[-1, -1], body_roundings(of, 5)[-1, -1]
    assert lost <= told <= 30 * lost


@pytest.mark.slow
def test_what_one_coefficient_loses_is_handed_on_to_all_below_it() -> None:
    """With ratios of 1, to which those of light bodies come; a product that underflows is then lost in all of them."""
    degree = 64
    one = (0.0,) + (1.0,) * degree
    of = BodyOperator(1.0, one, one, one, 0.0, 0.0, 2.0**-40)
    lost, told = counted(*in_c(of, 5))[:-1, -1], body_roundings(of, 5)[:-1, -1]
    assert (lost <= told).all()
    assert np.linalg.norm(told) <= 100 * np.linalg.norm(lost)


def ended_at_1(degree) -> BodyOperator:
    """With ratios of 1, and y_1 for what the velocity changes by."""
    none = (0.0,) * (degree + 1)
    return BodyOperator(1.0, (0.0,) + (1.0,) * degree, none, (0.0, 1.0, *none[2:]), 0.0, 0.0, 2.0**-40)


@pytest.mark.slow
def test_what_is_rounded_on_the_way_down_is_handed_on_to_the_last() -> None:
    """The last coefficient of p comes to y_1, three times rounded at each step; on a way so long that this shows."""
    degree = 20
    of = ended_at_1(degree)
    p = [Rounded.wrong(np.array([float(k == degree)]), 5) for k in range(degree + 1)]
    _, end = moved(
        of, p, Rounded(np.zeros(1)), *(list(Rounded.table(table)) for table in (of.ratio, of.first, of.last))
    )
    assert end.error[0] >= 3 * degree
    assert max(body_roundings(ended_at_1(1000), 5)[-1, :-2]) >= 3 * 1000


def chebyshev(k):
    """T_k as a polynomial."""
    one, two = fmpq_poly([1]), fmpq_poly([0, 1])
    for _ in range(k):
        one, two = two, 2 * fmpq_poly([0, 1]) * two - one
    return one


def solved(step, p, u):
    """The q of q' + L q = L p, L = step/2, that is 0 at -1: at points u of [-1, 1], p a polynomial."""
    with ctx.workprec(400):
        steady, rest = fmpq_poly(), p
        while rest:
            steady += rest
            rest = rest.derivative() * (-2 / step)
        at_start, near = arb(steady(fmpq(-1))), arb_poly(steady)
        return np.array([float(near(arb(x)) - at_start * (-arb(step) / 2 * (arb(x) + 1)).exp()) for x in u])


@pytest.mark.quick(8)
@pytest.mark.parametrize("degree", [8, 9, 14])
@pytest.mark.parametrize("mass", ["10000/3", "10/3", "5/6", "1/10"])
@pytest.mark.parametrize("ratio", [1, "-1/2"])
def test_truncation_is_no_less_than_what_a_step_loses(mass, degree, ratio) -> None:
    """Where T_d arrives at one of its ports: in the energy of what is sent and kept, against the exact motion."""
    plan = march_plan(lower(body(mass, ratio=ratio)))
    joint, scheme = only_body(plan), scheme_of(plan, degree)
    marching = Marching(scheme, 1)
    marching._waves[:, joint.arrive[0], :, degree] = 1
    marching._loads._powers = 0 * marching._loads._powers
    block = marching.block(0, 1)
    losses = Losses(plan, MarchTables(plan, degree, DOUBLE), scheme, 0.0, 0.0)
    lost, rounded = losses.of_block(block)
    assert rounded == 0
    step, (start,) = joint.space.rate, joint.space.weights
    points, gauss = np.polynomial.legendre.leggauss(200)
    p = nearest(joint.space.drive * joint.space.ports[0].push)
    truth = p * solved(step, chebyshev(degree), [*points, 1.0])
    q = block.waves[scheme.deepest, joint.sends[0], 0].copy()
    q[degree] += 1
    q /= nearest(joint.space.ports[0].ratio)
    error = np.polynomial.chebyshev.chebval(points, q) - truth[:-1]
    sent = sum(nearest(port.impedance * port.ratio**2) for port in joint.space.ports)
    end = marching._x[scheme.groups[[type(g) for g in scheme.groups].index(Bodies)].states[0, 0]] - truth[-1]
    energy = sent / 2 * (gauss @ error**2) + nearest(start) / 2 * end**2
    assert lost >= sqrt(energy) > 0
    if mass == "10000/3" and degree % 2 == 0:  # at the end the whole of 2 eps
        assert lost <= 1.01 * sqrt(energy)


@pytest.mark.parametrize("ratio", [1, -3])
def test_what_a_body_sends_is_as_wrong_as_its_velocity(ratio) -> None:
    """Where T_k arrives: in squares that count c_0 twice, and in absolute values."""
    plan = march_plan(lower(body("10", ratio=ratio)))
    joint, scheme, degree, u = only_body(plan), scheme_of(plan, 9), 9, 2.0**-53
    losses = Losses(plan, MarchTables(plan, degree, DOUBLE), scheme, u, 0.0)
    number, group = next((n, each) for n, each in enumerate(scheme.groups) if isinstance(each, Bodies))
    ports, of = len(joint.space.ports), body_operator(joint.space.rate * plan.panels[0].length, degree)
    lost = counted(*in_numpy(of, ports + 4))[:-1, : degree + 1]
    sizes = np.abs(group.ratio[0]) * group.push[0, 0] * u
    for k in (0, 1, 5, degree):
        a = np.zeros((1, 1, ports, degree + 1))
        a[0, 0, 0, k] = 1
        squares, sums, *_ = losses._of_bodies(
            group, losses._bodies[number, 0], a, 0 * a, np.zeros((1, 1, 1, 3)), np.zeros((1, 1, 1))
        )
        norm = np.sqrt(np.sum(lost[:, k] ** 2) + lost[0, k] ** 2)
        assert np.all((sizes * norm) ** 2 <= squares[0, 0])
        assert np.all(squares[0, 0] <= (3 * sizes * norm + 3 * u) ** 2)
        assert np.all(sizes * np.sum(lost[:, k]) <= sums[0, 0])


def test_what_rounding_hides_of_a_last_coefficient_counts_as_missed() -> None:
    """q_d - p_d is told from what is sent and arrives, which has lost some units of rounding of it, or made some."""
    plan = march_plan(lower(body("10/3")))
    joint, scheme, degree, u = only_body(plan), scheme_of(plan, 9), 9, 2.0**-53
    losses = Losses(plan, MarchTables(plan, degree, DOUBLE), scheme, u, 0.0)
    number, group = next((n, each) for n, each in enumerate(scheme.groups) if isinstance(each, Bodies))
    of, a = losses._bodies[number, 0], np.zeros((1, 1, len(joint.space.ports), degree + 1))
    a[0, 0, 0, degree] = 1
    p = group.push[0, 0]
    assert 1 / 2 < p < 1
    for k in range(65):
        sent = -a
        sent[0, 0, :, degree] += group.ratio[0] * (p + k * u)  # exact
        *_, (missed,) = losses._of_bodies(group, of, a, sent, np.zeros((1, 1, 1, 3)), np.zeros((1, 1, 1)))
        least = of.squared_loss[0] * (of.leak[0] * k * u) ** 2
        assert least <= missed <= 4 * least + of.squared_loss[0] * (of.leak[0] * 16 * u) ** 2


def acts(since, start, half, powers, window=1.0):
    """A load on a panel as a series, as in C; `start` is by how much that begins later than the panel of the event."""
    c = [Rounded.wrong(power) for power in powers]
    half = Rounded.wrong(half)
    middle = (Rounded(float(since)) * Rounded.wrong(window) + Rounded.wrong(start)) + half
    square = (half * half)._scaled(0.5)
    first = (c[0] + middle * c[1]) + (middle * middle + square) * c[2]
    return [first, half * (c[1] + 2 * (middle * c[2])), square * c[2]]


@pytest.mark.parametrize(("steps", "ramps"), [([1, 0], [0, 0]), ([0, 0], [1, 0]), ([1, "-1/2"], ["1/3", 2])])
@pytest.mark.parametrize("moved", [False, True], ids=["force", "acceleration"])
def test_a_load_is_as_large_and_as_wrong_as_it_is_said_to_be(steps, ramps, moved) -> None:
    """Its roundings, and those of `drive` times it, are no more than those of `_LOADED` waves of its size."""
    times = ["1/3", "5/2"]
    if moved:
        parts = [{"motion": "acceleration", "name": "b"}, {"rod": 1}, {"mass": 1}]
        load = [{"at": "b", "times": times, "steps": steps, "ramps": ramps}]
        output = {"until": 7, "tolerance": "1e-2", "velocity": ["b"]}
        scene = Scene(name="made", system={"type": "chain", "parts": parts}, load=load, output=output)
    else:
        scene = body(times=times, steps=steps, ramps=ramps, until=7)
    plan = march_plan(lower(scene))
    scheme, block = all_windows(plan, 8)
    sizes = RunningLoads(scheme, np.abs(scheme.event_power), np.abs(scheme.since))
    cuts = [float(panel.start) for panel in plan.panels]
    (point,) = {p for p in range(len(scheme.force_on)) if scheme.force_on[p] == 0}
    compared = 0
    largest = [sizes.on_window(window)[:, point] for window in range(plan.windows)]
    for window, p in np.ndindex(plan.windows, len(cuts)):
        size = largest[window][p]
        begun = [event for event in plan.events if (event.window, event.panel) <= (window, p)]
        if not begun:
            assert not size.any()
            continue
        event, half = begun[-1], nearest(plan.panels[p].length) / 2
        series = acts(window - event.window, cuts[p] - cuts[event.panel], half, list(map(nearest, event.powers)))
        value = np.array([c.value for c in series])
        np.testing.assert_allclose(block.acting[window, p, point], value, rtol=1e-13, atol=1e-16)
        wrong = np.array([(Rounded.wrong(1.0) * c).error for c in series]) + np.abs(value)
        norm, said = (np.sqrt(2 * c[0] ** 2 + np.sum(c[1:] ** 2)) for c in (wrong, size))
        assert np.all(np.abs(value) <= size * (1 + 1e-13))
        assert norm <= _LOADED * 5 * said
        compared += norm > said > 0
    assert compared > 3
