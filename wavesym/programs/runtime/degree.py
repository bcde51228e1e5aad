"""The largest degree of a program: enough for the scene's own parameters, and, where what makes bodies light is given
at run time, for any up to a largest kappa, in a general chain a largest rate of a joint.

It is found as the program finds it, by marching: a degree is raised by a quarter until no window misses more than its
share. Where springs make blocks of joints it is what a front asks for that has met so many of them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import ceil, log10
from typing import NamedTuple

import numpy as np
from flint import fmpq

from wavesym.errors import CostError
from wavesym.numbers.doubles import nearest
from wavesym.numbers.reals import DOUBLE
from wavesym.programs.march.plan import MarchPlan, march_plan
from wavesym.programs.march.space import BLOCK, BODY, JointSpace
from wavesym.programs.march.tables import MarchTables
from wavesym.programs.runtime.plan import RuntimePlan
from wavesym.programs.schemes.march import Marching, MarchScheme
from wavesym.programs.schemes.march_joints import Bodies

LIGHTER = 10
"""Unless it is said how light bodies may be, they may be so many times as light as those of the scene."""
LIGHTEST = fmpq(100)
"""The largest kappa where memory does not matter."""
LEAST = 8
_HIGHEST = 1000
_MOST_WORK = 3e8  # joints * coefficients * windows, for each degree
_AT_ONCE = 16  # windows; what is marched behind the first that misses too much is lost


class DegreeRange(NamedTuple):
    """The degree to begin with, about that of the scene's own parameters, and the largest."""

    first: int
    largest: int


def largest_kappa(made: RuntimePlan, kappa_max: fmpq | None) -> fmpq | None:
    """The largest kappa (in a general chain the largest rate) that a program is made for: `kappa_max`, if it was said,
    or the scene's own, where that is larger.

    None where no field makes bodies lighter.
    """
    if not any(field.positive for field in made.free.fields):
        return None
    parameters = made.model.parameters
    light = parameters.lightness
    own = max(one.value for one in parameters.numbers[light]) if light else fastest(made.own)
    return LIGHTER * own if kappa_max is None else max(kappa_max, own)


def fastest(plan: MarchPlan) -> fmpq:
    """The largest rate at which a joint answers a wave: of a mass, impedances and dashpots beside it over it."""
    return max((-j.space.rates[n, n] for j in plan.joints for n in range(j.space.states)), default=fmpq(0))


def degrees(made: RuntimePlan, share: float, tolerance: fmpq, kappa_max: fmpq | None) -> DegreeRange:
    """The degrees of a program whose windows may miss a `share` of the largest wave, to a relative `tolerance`.

    CostError where they would be beyond reason.
    """
    own = made.own
    if any(joint.space.law == BLOCK for joint in own.joints):
        digits = -log10(nearest(tolerance))
        first = max(LEAST, ceil(_front(own, fastest(own)) / 2 + digits / 3))
        rate = max(fastest(own), kappa_max or fmpq(0))
        return DegreeRange(first, max(ceil(1.5 * _front(own, rate)) + 24, first))
    started = any(field.name == "velocity" for field in made.free.fields)
    degree = LEAST
    for usual in made.usual:
        for each in _initial_state(usual, anew=started):
            degree = _enough(each, degree, share)
    first = max(LEAST, 4 * degree // 5)
    for quick in () if kappa_max is None else _light(made, kappa_max):
        for light in _initial_state(quick, anew=started):
            degree = _enough(light, degree, share, f" for kappa up to {nearest(kappa_max or fmpq(0)):g}")
    return DegreeRange(first, degree)


def _initial_state(plan: MarchPlan, *, anew: bool) -> Iterator[MarchPlan]:
    """As the scene begins, and, where that is given `anew`, with bodies that do not move together."""
    yield plan
    if anew:
        yield plan.alter_joints(
            lambda n, space: replace(space, initial_state=tuple(value - 1 - n for value in space.initial_state))
        )


def _front(plan: MarchPlan, rate: fmpq) -> float:
    """The oscillations of a front that are to be resolved. A stiff spring adds those of a body on it."""
    return plan.oscillations(nearest(rate)) + nearest(rate) * plan.longest / 8 + 2 * plan.turning * plan.longest


def _light(made: RuntimePlan, largest: fmpq) -> list[MarchPlan]:
    """With bodies as light as they may be, all alike, and not: waves between equal ones may cancel."""
    parameters = made.model.parameters
    if not parameters.lightness:
        return [_quick(made.own, largest, uneven=uneven) for uneven in (False, True)]
    light = {one.label: max(one.value, largest) for one in parameters.numbers[parameters.lightness]}
    uneven = {label: value * (1 - fmpq(place % 3, 10)) for place, (label, value) in enumerate(light.items())}
    model = replace(made.model, loads=made.own.model.loads, preset=None)
    return [march_plan(replace(model, network=parameters.network(kappa))) for kappa in (light, uneven)]


def _quick(plan: MarchPlan, rate: fmpq, *, uneven: bool) -> MarchPlan:
    """With bodies whose rates are no less than `rate`."""

    def quick(number: int, space: JointSpace) -> JointSpace:
        if space.law != BODY:
            return space
        return space.speed_up(max(rate / space.rate, fmpq(1)) * (1 - fmpq(number % 3, 10) * uneven))

    return plan.alter_joints(quick)


def _enough(plan: MarchPlan, degree: int, share: float, light: str = "") -> int:
    """The first of the degrees from one on whose march misses nothing; `light` says for what it is."""
    while _misses(plan, degree, share):
        degree += degree // 4
        work = plan.windows * len(plan.panels) * len(plan.joints) * degree
        if degree > _HIGHEST or work > _MOST_WORK:
            raise CostError(
                f"output.until: rates to {nearest(fastest(plan)):g}{light} need polynomials of degree {degree} to "
                f"tau = {plan.tau_max:g}, the limit is {_HIGHEST} and {_MOST_WORK:.1e} operations (a shorter "
                f"horizon{', or a smaller --kappa-max,' if light else ''} helps)"
            )
    return degree


def _misses(plan: MarchPlan, degree: int, share: float) -> bool:
    """Whether polynomials of bodies miss more than their share on some window."""
    made = MarchTables(plan, degree, DOUBLE)
    scheme = MarchScheme(made.tables([False] * len(plan.outputs)), made.constants(), plan.tau_max, np.float64)
    bodies = [group for group in scheme.groups if isinstance(group, Bodies)]
    leaks = [
        [[made.body(plan.joints[number], panel.length).leak for number in group.joints] for panel in plan.panels]
        for group in bodies
    ]
    if not bodies:
        return False
    marching, size = Marching(scheme, _AT_ONCE), 0.0
    for first in range(0, plan.windows, _AT_ONCE):
        count = min(_AT_ONCE, plan.windows - first)
        block = marching.block(first, count)
        n = scheme.deepest + np.arange(count)[:, None, None]
        missed = np.zeros(count)
        for group, leak in zip(bodies, leaks, strict=True):
            for panel in range(scheme.panels):
                a = block.waves[n - group.back, group.arrive, panel, -1]
                sent = block.waves[n[..., 0], group.send[:, 0], panel, -1]
                excess = (sent + a[..., 0]) / group.ratio[:, 0] - np.sum(group.push * a, axis=-1)
                missed += np.sum(np.abs(leak[panel] * excess), axis=-1)
        means = np.max(np.abs(block.waves[scheme.deepest : scheme.deepest + count, :, :, 0]), axis=(1, 2))
        speeds = np.max(np.abs(block.starts), axis=(1, 2))
        sizes = np.maximum(np.maximum.accumulate(np.maximum(means, speeds)), size)
        if np.any(~(missed <= share * sizes)):
            return True
        size = float(sizes[-1])
    return False
