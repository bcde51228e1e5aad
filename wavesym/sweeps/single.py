"""A case by itself: what `wavesym.summary` says of its scene."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wavesym.errors import SceneError
from wavesym.mechanics.model import Model
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import nearest, not_below
from wavesym.results.response import Response
from wavesym.results.rows import own_samples
from wavesym.results.statistics import LINK_ARRAYS, array_values
from wavesym.results.summary import Summary, summarise
from wavesym.scene import Scene, lower
from wavesym.scene.lowering import sample_comb
from wavesym.sweeps.plan import SweepPlan, link_name
from wavesym.sweeps.values import CaseValues


def single(plan: SweepPlan, scene: Scene, *, at_samples: bool = False) -> CaseValues:
    """The values of a scene, of a summary `at_samples` or true ones. WavesymError as for `summary` and `evaluator`."""
    model = lower(scene)
    rows = output_rows(plan, model)
    made = dict[str, Array | float]()
    bounds, hows = [], []
    if plan.summary:
        found = summarise(model, own_samples(model, sample_comb(scene)) if at_samples else None)
        every = [array_values(output) for output in found.outputs]
        for name in plan.summary:
            if name in LINK_ARRAYS:
                made[name] = _sets(plan, found)
            else:
                made[name] = spread_out(plan, rows, np.array([values[name] for values in every]))
        bounds.append(found.bound)
        hows.append(found.how.partition(" at ")[0])
    if plan.histories:
        response = Response(model)
        made["history"] = spread_out(plan, rows, response(instants(model, plan.histories)))
        bounds.append(response.error_bound)
        hows.append(f"histories of {response.program.evaluator}" if response.program else "exact histories")
    return CaseValues({**made, **of_model(plan, model), "bound": max(bounds)}, ", ".join(hows))


def _sets(plan: SweepPlan, found: Summary) -> Array:
    """The permanent sets of links; NaN where they would cost too much, and of what no output feels."""
    sets = {link_name(link.where, link.law): link.set for link in found.links or ()}
    if any(each.unit != plan.link_unit for each in sets.values()):
        raise SceneError("sets in another unit than in the other cases; write the same units", "units")
    return np.array([sets[name].value if name in sets else np.nan for name in plan.links])


def extremes_and_history(
    plan: SweepPlan, model: Model, bound: float, extremes: tuple[Array, Array], history: Array, how: str
) -> CaseValues:
    """A case that was computed beside others: `extremes` are the least and greatest value of each of the model's
    outputs, (outputs, 2), and their tau; `history` has those at `instants`, (outputs, instants)."""
    rows = output_rows(plan, model)
    made: dict[str, Array | float] = {**of_model(plan, model), "bound": bound}
    for side, name in enumerate(("min", "max")):
        for prefix, values in zip(("", "tau_"), extremes, strict=True):
            made[f"{prefix}{name}"] = spread_out(plan, rows, values[:, side])
    if plan.histories:
        made["history"] = spread_out(plan, rows, history)
    return CaseValues(made, how)


def of_model(plan: SweepPlan, model: Model) -> dict[str, float]:
    """What is kept of a case whatever it does: its horizon, and its clock."""
    if plan.time_unit is None:
        return {"until": nearest(model.until)}
    if model.clock is None or model.clock.unit != plan.time_unit:
        raise SceneError(f"times in another unit than in the other cases; write {plan.time_unit}", "units.time")
    return {"until": nearest(model.until), "time_per_tau": nearest(model.clock.per_tau)}


def instants(model: Model, count: int) -> list[float]:
    """Equally spaced tau from 0 to the end of the horizon, each the first double that is not below."""
    return [min(not_below(model.until * k / (count - 1)), model.horizon()) for k in range(count)]


def output_rows(plan: SweepPlan, model: Model) -> list[int]:
    """The places of a model's outputs among those of the sweep."""
    place = {pair: k for k, pair in enumerate(zip(plan.outputs, plan.units, strict=True))}
    for probe in model.probes:
        if (probe.name, probe.unit) not in place:
            raise SceneError(f"{probe.heading} is not an output of the other cases; write the same outputs", "output")
    return [place[probe.name, probe.unit] for probe in model.probes]


def spread_out(plan: SweepPlan, rows: Sequence[int], values: Array) -> Array:
    """Values of a model's outputs as those of the sweep's."""
    made = np.full((len(plan.outputs), *values.shape[1:]), np.nan)
    made[list(rows)] = values
    return made
