"""Model -> Program, for loads that come sample by sample.

The degree is that of the march of the same chain on the same panels under a step of every load at tau = 0, of which
march/bound.py proves a bound: the least whose polynomials lose no more than the tolerance, or no more than rounding.
Any loads that are straight on every panel are sums of such steps, earlier or later, and of their integrals.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import gcd, inf, isfinite, log

from flint import arb, fmpq

from wavesym.errors import CostError, MeasureError, RangeError, ToleranceError
from wavesym.mechanics.loads import AppliedLoad, merge_loads
from wavesym.mechanics.model import Model
from wavesym.mechanics.travel_times import percent
from wavesym.numbers.doubles import bound, nearest
from wavesym.numbers.reals import REALS, Real
from wavesym.programs.form import leap, reference_values
from wavesym.programs.march.bound import Verdict
from wavesym.programs.march.evaluator import first_degree, judge_degree, refuse_long
from wavesym.programs.march.plan import readable
from wavesym.programs.program import (
    Input,
    Program,
    ProgramOutput,
    Provenance,
    SteppedRow,
    SteppedValues,
)
from wavesym.programs.request import Request, readable_step, refuse_beside, stream_refusal
from wavesym.programs.stream.adjustment import enough_adjustment, fit_speeds
from wavesym.programs.stream.parameters import free_stream, quick_enough, refuse_stiff, with_parameters
from wavesym.programs.stream.plan import StreamPlan, stream_plan
from wavesym.programs.stream.tables import StreamTables

_ONE = fmpq(1)
_ROUNDINGS = 64  # no tolerance is smaller
_SPARE = 5  # of the tolerance one step of each load takes so much less


def stream_program(model: Model, request: Request, inputs: Sequence[Input], *, tested: bool = False) -> Program:
    """The program of a model whose loads are `inputs`, to be given while it runs.

    WavesymError, CostError as `stream_plan` says, and where other options are given that say otherwise; RangeError
    where numbers would be beyond those of the precision, ToleranceError where rounding is as large as an output.
    """
    try:
        return _program(model, request, inputs, tested)
    except MeasureError:  # which says what to write
        raise
    except CostError as cost:
        raise stream_refusal(model, cost) from None
    except OverflowError:
        beyond = f"numbers beyond the range of {request.precision} precision"
        raise RangeError(f"output: a stream needs {beyond}") from None


def _program(model: Model, request: Request, inputs: Sequence[Input], tested: bool) -> Program:
    model = fit_speeds(model, request.step)
    refuse_beside("--stream", (("--evaluator", request.evaluator, "auto"), ("--optimize", request.optimize, None)))
    real = REALS[request.precision]
    names = request.runtime or (model.parameters.usual if request.target else ())
    free = free_stream(model, names, inputs, real) if names else None
    simulated = bool(request.target)
    quicker = free.quicker if free else _ONE
    plan = stream_plan(model, inputs, real, request.step, simulated=simulated, quicker=quicker)
    tolerance = max(model.tolerance, _ROUNDINGS * real.roundoff)
    degree, verdict = _enough(plan, model, real)
    for output, error in zip(plan.march.outputs, verdict.bounds, strict=True):
        if not isfinite(error):
            told = f"output.tolerance: {nearest(tolerance):g} cannot be met: stream: "
            better = "" if real is REALS["double"] else "double precision or "
            raise ToleranceError(
                f"{told}rounding may leave nothing of {output.name} ({better}a shorter horizon helps, or other outputs)"
            )
    if free:
        refuse_stiff(plan)
        degree, quicker = quick_enough(plan, free.quicker, degree, nearest(tolerance), real)
    made = StreamTables(plan, degree, real)
    program = Program(
        "stream",
        real,
        plan.march.tau_max,
        tuple(
            ProgramOutput(output.name, nearest(tolerance) if free else bound(arb(error)), size)
            for output, error, size in zip(plan.march.outputs, verdict.bounds, verdict.largest, strict=True)
        ),
        made.tables(),
        made.constants(nearest(tolerance)),
        made.bytes,
        Provenance(
            model,
            _reason(plan, degree, made) + _beside_panels(plan, model, request),
            request.options(model),
            shortfall="" if free else _shortfall(plan, verdict, tolerance, real),
            step=request.step,
        ),
        sources=tuple(given.label for given in plan.inputs),
        proved=False,
        direct=plan.direct,
        step="panel",
    )
    if free:
        program = with_parameters(program, free, plan, degree, quicker)
    return replace(program, reference=_reference(model, plan, program)) if tested else program


def _reason(plan: StreamPlan, degree: int, made: StreamTables) -> str:
    count = len(plan.march.panels)
    step = "" if plan.march.step == 1 else f" of {readable(plan.march.step)} tau"
    return (
        f"march as a stream, {count} panels a window{step}, degree {degree}, a state of about "
        f"{-(-made.state_bytes // 1024)} KiB with room for {plan.breakpoints} instants inside of panels, "
        f"{made.panel_operations} multiplications a panel; it goes on after {_horizon(plan)}, for which it is made, "
        "but some time later steps return 2, as more may be lost than the tolerance"
    )


def _horizon(plan: StreamPlan) -> str:
    """The horizon of the scene, in its unit of time."""
    model = plan.march.model
    return model.clock.format(model.until) if model.clock else f"tau = {nearest(model.until):g}"


def _beside_panels(plan: StreamPlan, model: Model, request: Request) -> str:
    """What steps cost that end inside of panels at ever new places, or are many short ones; what mends that."""
    if request.step is None:
        return ""
    enough = enough_adjustment(model, request.step)
    remedy = f'speed_adjustment = "{percent(enough)}" under [system]' if enough is not None else ""
    if (request.step / plan.panel).q == 1:
        many = f"; a step is {request.step / plan.panel} of these short panels; with {remedy} it is fewer"
        return many if remedy else ""
    if plan.breakpoints >= _places(plan, request.step):
        return ""
    near = max(int((request.step / plan.panel + fmpq(1, 2)).floor()), 1) * plan.panel
    about = f"{readable_step(near)} tau" if near.q != 1 else ""
    values = ", ".join(filter(None, (about, model.clock.format(near) if model.clock else "")))
    whole = f"--step {near}{values and f' ({values})'} is whole panels"
    return (
        "; such steps end at ever new instants inside of panels: each is slower than the one before, and there is room "
        f"to the horizon only; {remedy and f'{remedy} makes them whole panels, or '}{whole}"
    )


def _places(plan: StreamPlan, spacing: fmpq) -> int:
    """At how many instants inside of the panels of a window multiples of a spacing lie, sooner or later."""
    every = int((plan.march.step / spacing).p)
    return every - gcd(every, len(plan.march.panels))


def _shortfall(plan: StreamPlan, verdict: Verdict, tolerance: fmpq, real: Real) -> str:
    """How far rounding may take an output, all of it with one sign, where that is beyond the tolerance."""
    error, output = max(zip(verdict.bounds, plan.march.outputs, strict=True), key=lambda pair: pair[0])
    if error <= nearest(tolerance):
        return ""
    better = "" if real is REALS["double"] else "double precision, "
    return (
        f"the tolerance {nearest(tolerance):g} may be missed: rounding takes {output.name} up to "
        f"{bound(arb(error)):g} of its largest value away ({better}a shorter horizon, or such a tolerance, helps)"
    )


def _enough(plan: StreamPlan, model: Model, real: Real) -> tuple[int, Verdict]:
    """The least degree that will do, and what it is worth.

    A march of the whole horizon judges a degree, so few are tried. What polynomials lose falls by about the same
    factor from one degree to the next: e**2 as a rule, until two degrees show it.
    """
    tolerance = nearest(max(model.tolerance, _ROUNDINGS * real.roundoff))
    degree, spent = max(first_degree(plan.march, real) - 8, 4), 0.0
    failed: tuple[int, float] | None = None
    gain = 2.0
    found: tuple[int, float, Verdict] | None = None
    while True:
        try:
            spent = refuse_long(plan.march, degree, spent, real)
        except CostError:
            if failed is None or degree == failed[0] + 1:
                raise
            degree = failed[0] + 1  # not as far at once
            continue
        verdict = judge_degree(plan.march, degree, real, "stream")
        excess = _excess(verdict, tolerance)
        if excess > 0:
            if failed:
                gain = max((failed[1] - excess) / (degree - failed[0]), 0.1)
            failed = degree, excess
        else:
            found = degree, excess, verdict
        if found and (failed is None or found[0] == failed[0] + 1):
            return found[0], found[2]
        assert failed is not None
        low, missing = failed
        if found:
            high, spare, _ = found
            degree = low + min(max(round((high - low) * missing / (missing - spare)), 1), high - low - 1)
        else:
            degree = low + max(1, int(min(missing / gain, low / 4)))


def _excess(verdict: Verdict, tolerance: float) -> float:
    """How much more polynomials lose than they may, as a logarithm: more than 0 where a degree is too low."""
    worst, lost = max(verdict.bounds), _SPARE * verdict.truncation_error
    # what polynomials have in it; where nothing is left of an output, what rounding has says what matters
    share = verdict.rounding_error
    if 0 < worst < inf:
        share = tolerance * (verdict.truncation_error + verdict.rounding_error) / worst
    if lost <= share:
        return max(log(lost / share), -100.0) if lost > 0 else -100.0
    return log(lost / share) if share > 0 else 100.0


_CHECKED = 8  # longest steps of the march, at most
_PLACES = (fmpq(3, 16), fmpq(9, 16), fmpq(15, 16))  # of a panel, where values are looked at
_INSIDE = fmpq(1, 4)  # of a panel, where loads jump


def _reference(model: Model, plan: StreamPlan, program: Program) -> SteppedValues:
    """Loads that jump inside of panels, at edges where there is no room for that, and are held; the exact values."""
    panel, last = plan.panel, min(model.until, _CHECKED * max(plan.march.step, _ONE))
    count = int((last / panel).floor())
    late = _INSIDE * panel if plan.breakpoints >= len(plan.march.panels) else fmpq(0)
    jumps = [(k, j, leap(k, j)) for k in range(count) for j in range(len(plan.inputs)) if k % 5 == (2 * j) % 5]
    applied = [AppliedLoad(plan.inputs[j].source, k * panel + late, rise / plan.inputs[j].size) for k, j, rise in jumps]
    looked = [(k + _PLACES[k % len(_PLACES)]) * panel for k in range(count)]
    taus = [nearest(tau) for tau in looked]
    own = merge_loads(applied) if plan.inputs else model.loads
    tested = replace(model.shorten(last), loads=own, endless=False)
    found = reference_values(tested, program.real, taus)
    columns = dict(zip(found.taus, zip(*found.values, strict=True), strict=True))
    rows, now, time = [], [fmpq(0)] * len(plan.inputs), fmpq(0)
    for k, (instant, tau) in enumerate(zip(looked, taus, strict=True)):
        for then, values in sorted([(k * panel + late, None), (instant, columns.get(tau, ()))], key=lambda row: row[0]):
            row = _row(program.real, then - time, now)
            rows.append(row if values is None else replace(row, values=values))
            time = then
            if values is None:
                for _, j, rise in (jump for jump in jumps if jump[0] == k):
                    now[j] += rise
                rows.append(_row(program.real, fmpq(0), now))
    return SteppedValues(tuple(rows))


def _row(real: Real, dtau: fmpq, loads: Sequence[fmpq]) -> SteppedRow:
    return SteppedRow(real.nearest(dtau), real.table(loads))
