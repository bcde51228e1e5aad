"""The largest degree of a program: enough for the scene's own parameters, and, where kappa, or what else makes bodies
light, is given at run time, for any kappa up to a largest one.

Found as the program finds it, by marching: a degree is raised by a quarter until no window misses more than its share.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from flint import fmpq

from wavesym.errors import CostError
from wavesym.mechanics.network import network_of
from wavesym.numbers.doubles import nearest
from wavesym.numbers.reals import Real
from wavesym.programs.runtime.line import LOAD, Plan, plan
from wavesym.programs.runtime.plan import RuntimePlan
from wavesym.programs.runtime.request import RuntimeField
from wavesym.programs.runtime.run import Run, Since

LIGHTER = 10
"""Unless it is said how light bodies may be, they may be so many times as light as those of the scene."""
LIGHTEST = fmpq(100)
"""The largest kappa where memory does not matter."""
LEAST = 8
MARGIN = 24  # outputs are often smaller than waves, and errors a few times what is missed
_HIGHEST = 1000
_BLOCK = 8  # windows; what is marched behind the first that is missed is lost
_MOST_WORK = 3e8  # nodes * coefficients * windows, for each degree
LARGEST_MODEL = 1 << 28  # bytes


def raised(degree: int) -> int:
    """The next degree to try."""
    return degree + degree // 4


def share(given: RuntimePlan, tolerance: fmpq, real: Real) -> float:
    """What a window may miss, relative to the largest wave; no less than what rounding leaves."""
    return max(nearest(tolerance / (MARGIN * given.plan.windows)), 2 * nearest(real.roundoff))


def lightest(fields: Sequence[RuntimeField], asked: fmpq | None, own: fmpq) -> fmpq | None:
    """The largest kappa that a program is made for: what was asked for, else `LIGHTER` times the scene's `own`.

    None where no field makes bodies lighter.
    """
    if not any(field.positive for field in fields):
        return None
    return LIGHTER * own if asked is None else asked


def degrees(given: RuntimePlan, tolerance: fmpq, real: Real, kappa_max: fmpq | None) -> tuple[int, int]:
    """The degree to begin with, about that of the scene's own parameters, and the one that is enough for any kappa up
    to `kappa_max`, too.

    CostError where that would be beyond reason.
    """
    allowed = share(given, tolerance, real)
    own = given.model.named.parameters.kappa
    degree = _enough(_numbers(given, own), LEAST, allowed)
    first = max(LEAST, 4 * degree // 5)
    if kappa_max is not None:
        light = {i: max(value, kappa_max) for i, value in own.items()}
        uneven = {i: value * (1 - fmpq(place % 3, 10)) for place, (i, value) in enumerate(light.items())}
        for kappa in (light, uneven):  # waves between equal bodies may cancel
            degree = _enough(_numbers(given, kappa), degree, allowed, f" for kappa up to {nearest(kappa_max):g}")
    refuse_huge(given.plan.windows, given.plan.tau_max, len(given.strands), degree, real)
    return first, degree


def refuse_huge(windows: int, tau_max: float, strands: int, degree: int, real: Real) -> None:
    """CostError for a model that would be beyond reason."""
    size = real.bytes * windows * strands * (degree + 2)
    if size > LARGEST_MODEL:
        raise CostError(
            f"output.until: a model of {size:.1e} bytes would be kept to tau = {tau_max:g}, at most "
            f"{LARGEST_MODEL:.1e} expected (a shorter horizon, fewer outputs, or a smaller --kappa-max helps)"
        )


def _numbers(given: RuntimePlan, kappa: dict[int, fmpq]) -> Plan:
    """The plan of the scene's own numbers but for kappa; what loads have no amplitude has 1, and bodies whose
    velocities are given at run time do not move together.
    """
    model = given.model
    chain = model.named
    velocity = chain.parameters.velocity
    if velocity and len(set(velocity.values())) < len(velocity) and any(of.name == "velocity" for of in given.fields):
        velocity = {i: fmpq(-i) for i in velocity}
    chain = replace(chain, parameters=replace(chain.parameters, kappa=kappa, velocity=velocity))
    ordered = tuple(sorted(given.loads, key=lambda load: load.time))
    return plan(replace(model, chain=chain, network=network_of(chain), loads=ordered or model.loads))


def _enough(prepared: Plan, degree: int, allowed: float, told: str = "") -> int:
    """The first of the degrees from one on whose march misses nothing; `told` is whose, where there are too many.

    About which one that is is seen in one march, where each degree goes on from the window that is too much for the one
    before. What that one left out is not missed again, though, so the degree is then tried from the start.
    """
    since, size = None, 0.0
    while True:
        missed = _first_missed(Run(prepared, degree), allowed, since, size)
        if missed:
            since, size = missed
            degree = raised(degree)
            _refuse_high(prepared, degree, told)
        elif since and since.window:
            since, size = None, 0.0
        else:
            return degree


def _refuse_high(prepared: Plan, degree: int, told: str) -> None:
    work = prepared.windows * len(prepared.panels) * len(prepared.junctions) * degree
    if degree > _HIGHEST or work > _MOST_WORK:
        raise CostError(
            f"output.until: rates to {nearest(prepared.rate):g}{told} need polynomials of degree {degree} to tau = "
            f"{prepared.tau_max:g}, at most {_HIGHEST} and {_MOST_WORK:.1e} operations expected "
            f"(a shorter horizon{', or a smaller --kappa-max,' if told else ''} helps)"
        )


def _first_missed(run: Run, allowed: float, since: Since | None, size: float) -> tuple[Since, float] | None:
    """The first window that misses more than it may, and the largest wave before it; None if there is none."""
    plan = run.plan
    leak = np.array(
        [
            [0.0 if node.rate is None else run.operators[node.rate * panel.length].leak for node in plan.junctions]
            for panel in plan.panels
        ]
    )
    window = since.window if since else 0
    for block in run.blocks(since, _BLOCK):
        missed = np.sum(np.abs(block.excess) * leak, axis=(1, 2))
        means = np.max(np.abs(block.after[:, :LOAD, :, 1:-1, 0]), axis=(1, 2, 3))
        sizes = np.maximum.accumulate(np.maximum(means, np.max(np.abs(block.ends), axis=(1, 2))))
        sizes = np.maximum(sizes, size)
        late = ~(missed <= allowed * sizes)
        if late.any():
            n = int(np.argmax(late))
            return Since(window + n, block.before[n], block.starts[n, 0]), float(sizes[n - 1]) if n else size
        window, size = window + len(late), float(sizes[-1])
    return None
