"""JiTCDDE, a peer: the chain as neutral delay equations, put to it as its manual says.

Its unknowns are functions with a derivative. So a wave that a node sends is integrated like the node's velocity q, from
L' = q' - a', R' = q' - b', where the rates a', b' of what arrives are those of waves one unit of tau ago. A wave that
jumps has no such rate. JiTCDDE makes a ramp of the jump at tau = 0; steps that go over an echo of it lose the echo.
"""

from __future__ import annotations

from contextlib import chdir
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from wavesym.rivals.line import stated
from wavesym.rivals.problem import FORCE_TERMS, Array, Evaluate, Problem, Rival

# unknowns of a node: its velocity, the waves it sends to the left and right, and the integrals of these
_Q, _LEFT, _RIGHT, _LEFT_SUM, _RIGHT_SUM = range(5)
_KINDS = 5

# the longest step, and the steps with which it comes to a time exactly
_LONGEST, _SHORT = 0.05, 1e-3


def _equations(problem: Problem, loads: list[Any]) -> list[Any]:
    """The rates of all unknowns; loads[FORCE_TERMS * x + k] multiplies tau**k at node x."""
    from jitcdde import dy, t, y

    equations: list[Any] = []
    for x in range(problem.nodes):
        a = a_rate = b = b_rate = 0
        if x > 0:
            sent = _KINDS * (x - 1) + _RIGHT
            a, a_rate = y(sent, t - 1), dy(sent, t - 1)
        if x + 1 < problem.nodes:
            sent = _KINDS * (x + 1) + _LEFT
            b, b_rate = y(sent, t - 1), dy(sent, t - 1)
        f0, f1, f2 = loads[FORCE_TERMS * x : FORCE_TERMS * (x + 1)]
        here = _KINDS * x
        if problem.inertia[x]:
            load = f0 + t * (f1 + t * f2)
            right = problem.alpha[x] * a + problem.beta[x] * b + load - problem.gamma[x] * y(here)
            rate = right / problem.inertia[x]
        else:
            rate = (problem.alpha[x] * a_rate + problem.beta[x] * b_rate + f1 + 2 * t * f2) / problem.gamma[x]
        equations += [rate, rate - a_rate, rate - b_rate, y(here + _LEFT), y(here + _RIGHT)]
    return equations


def _prepare(problem: Problem, resolution: float) -> Evaluate:
    import symengine
    from jitcdde import jitcdde

    names = [symengine.Symbol(f"load_{k}") for k in range(FORCE_TERMS * problem.nodes)]
    # what is asked for at the end lies as far back as the beginning
    options = {"max_delay": problem.until + 2, "control_pars": names, "verbose": False}
    solver = jitcdde(_equations(problem, names), **options)
    # a pyproject.toml where this is run would tell setuptools, which JiTCDDE compiles with, what to build
    with TemporaryDirectory() as elsewhere, chdir(elsewhere):
        solver.compile_C()
    starts = sorted({0.0, *(float(event.time) for event in problem.events if event.time <= problem.until)})
    before, after = _before(problem), _after(problem)

    def evaluate(taus: Array) -> Array:
        solver.purge_past()
        solver.constant_past(before)
        solver.set_integration_parameters(rtol=resolution, atol=resolution / 10, first_step=1e-3, max_step=_LONGEST)
        for start, end in zip(starts, [*starts[1:], problem.until + 1e-6], strict=True):
            solver.set_parameters(*_loads(problem, start))
            if start == 0:
                solver.jump(after - before, 0.0)
            else:
                solver.adjust_diff()
            # steps go beyond what is asked for, but no load may change within one
            if solver.t < end - _LONGEST:
                solver.integrate(end - _LONGEST)
            if solver.t < end:
                solver.integrate_blindly(end, _SHORT)
        return _read(problem, solver.get_state(), taus)

    return evaluate


def _before(problem: Problem) -> Array:
    """The unknowns before tau = 0, where nothing changes."""
    state = np.zeros((problem.nodes, _KINDS))
    state[:, _Q] = problem.velocity
    state[:, _LEFT], state[:, _RIGHT] = np.stack(problem.beside(problem.rods)) / 2
    return state.ravel()


def _after(problem: Problem) -> Array:
    """The unknowns just after tau = 0: (2.3) and (2.4) with the loads there."""
    state = _before(problem).reshape(problem.nodes, _KINDS)
    a, b = state[:, _LEFT].copy(), state[:, _RIGHT].copy()  # what is in a rod goes both ways
    right = problem.alpha * a + problem.beta * b + _loads(problem, 0.0)[::FORCE_TERMS]
    state[:, _Q] = np.where(problem.inertia > 0, state[:, _Q], right / problem.gamma)
    state[:, _LEFT], state[:, _RIGHT] = state[:, _Q] - a, state[:, _Q] - b
    return state.ravel()


def _loads(problem: Problem, time: float) -> Array:
    """The loads from `time` on until the next event, as polynomials in tau: (FORCE_TERMS * nodes,)."""
    loads = np.zeros((problem.nodes, FORCE_TERMS))
    for event in problem.events:
        start = float(event.time)
        if start <= time:
            f0, f1, f2 = event.coefficients
            loads[event.node] += f0 - start * (f1 - start * f2), f1 - 2 * start * f2, f2
    return loads.ravel()


def _read(problem: Problem, spline: Any, taus: Array) -> Array:
    """The outputs from the course of the unknowns, JiTCDDE's cubic spline."""
    rows = []
    for watch in problem.watches:
        sums = watch.quantity == "displacement"
        right = _KINDS * (watch.rod - 1) + (_RIGHT_SUM if sums else _RIGHT)
        left = _KINDS * watch.rod + (_LEFT_SUM if sums else _LEFT)
        before = problem.rods[watch.rod - 1] / 2
        parts = []
        for unknown, lag in ((right, watch.offset), (left, 1 - watch.offset)):
            times = taus - lag
            values = spline.get_state(np.maximum(times, 0.0))[:, unknown]
            early = before * times if sums else np.full(len(taus), before)
            parts.append(np.where(times < 0, early, values) + (before * lag if sums else 0.0))
        rows.append(parts[1] - parts[0] if watch.quantity == "strain" else parts[0] + parts[1])
    return np.array(rows)


RIVAL = Rival("JiTCDDE, neutral", "C", "relative tolerance", (1e-3, 1e-5, 1e-7), stated, _prepare)
