"""Marches for tests: their errors in parts of what is allowed, their windows one by one, and the energy in them."""

from __future__ import annotations

from math import inf

import numpy as np

from tests.support.drives import exact, instants
from wavesym.mechanics.model import Model
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import nearest
from wavesym.numbers.reals import DOUBLE, SINGLE, Real
from wavesym.programs.making import program
from wavesym.programs.march.bound import judge
from wavesym.programs.march.evaluator import March
from wavesym.programs.march.plan import MarchPlan, march_plan
from wavesym.programs.march.tables import MarchTables
from wavesym.programs.schemes.march import Marching, MarchScheme, WindowBlock

HALF_ULP = 2.0**-53
LEAST = 5e-324


def asked(model: Model, real: Real = DOUBLE, most: int = 12) -> Array:
    """Instants at which outputs may jump and beside them, in numbers of a format."""
    taus = instants(model, most)
    if real is SINGLE:
        taus = np.unique(taus.astype(np.float32).astype(np.float64))
        taus = taus[taus <= model.horizon(real)]
    return taus


def missed(model: Model, made: March, most: int = 12, taus: Array | None = None, true: Array | None = None) -> Array:
    """Errors of all outputs in parts of what is allowed; the true values were rounded once."""
    taus = asked(model, made.real, most) if taus is None else taus
    found = program(model, made).evaluate(taus)
    allowed = np.array([output.bound * output.largest if output.bound < inf else inf for output in made.outputs])
    return parts(found, exact(model, taus) if true is None else true, allowed)


def parts(found: Array, true: Array, allowed: Array) -> Array:
    """The same of values."""
    error = np.maximum(np.max(np.abs(found - true), axis=1) - HALF_ULP * np.max(np.abs(true), axis=1), 0)
    return np.where(error == 0, 0, error / np.maximum(allowed, LEAST))


def scheme_of(plan: MarchPlan, degree: int, real: Real = DOUBLE) -> MarchScheme:
    """What marches a plan in NumPy."""
    made = MarchTables(plan, degree, real)
    kind = np.float32 if real is SINGLE else np.float64
    return MarchScheme(made.tables([False] * len(plan.outputs)), made.constants(), plan.tau_max, kind)


def missed_at(model: Model, degree: int, real: Real = DOUBLE, most: int = 12) -> Array:
    """The same at any degree, in parts of what is proved."""
    plan = march_plan(model, real)
    taus = asked(model, real, most)
    found = scheme_of(plan, degree, real).evaluate(taus)
    return parts(found, exact(model, taus), np.array(judge(plan, degree, real).errors))


def all_windows(plan: MarchPlan, degree: int, real: Real = DOUBLE) -> tuple[MarchScheme, WindowBlock]:
    """Of a plan with few of them, as one block."""
    scheme = scheme_of(plan, degree, real)
    return scheme, Marching(scheme, plan.windows).block(0, plan.windows)


def squared(scheme: MarchScheme, series: Array) -> Array:
    """Integrals of squares over panels, (..., panel, k) to (..., panel)."""
    k = np.arange(series.shape[-1])
    both, apart = k[:, None] + k, k[:, None] - k
    even = both % 2 == 0
    gram = np.where(even, 1 / np.where(even, 1.0 - both**2, 1) + 1 / np.where(even, 1.0 - apart**2, 1), 0)
    return np.einsum("...pk,kl,...pl->...p", series, gram, series) * scheme.half_length


def energies(plan: MarchPlan, scheme: MarchScheme, waves: Array, x: Array) -> Array:
    """The energy of bars and joints at the start of each window, from all waves and the states there."""
    held = np.sum(squared(scheme, waves), axis=-1)
    weights = np.array([nearest(weight) for joint in plan.joints for weight in joint.space.weights])
    found = x**2 @ weights / 2
    for number, track in enumerate(plan.tracks):
        for n in range(plan.windows):
            found[n] += nearest(track.impedance) * np.sum(
                held[scheme.deepest + n - track.steps : scheme.deepest + n, number]
            )
    return found


def energy_of(plan: MarchPlan, degree: int, **options: bool) -> Array:
    """That of a march."""
    scheme, block = all_windows(plan, degree, **options)
    return energies(plan, scheme, block.waves, block.starts[:, 0])


def apart(plan: MarchPlan, one: tuple[MarchScheme, WindowBlock], other: tuple[MarchScheme, WindowBlock]) -> float:
    """The largest norm of energy of the difference of two marches, the second of no lower degree."""
    (scheme, block), (_, finer) = one, other
    waves = finer.waves.astype(float)
    waves[..., : block.waves.shape[-1]] -= block.waves
    return float(np.sqrt(np.max(energies(plan, scheme, waves, finer.starts[:, 0] - block.starts[:, 0]))))
