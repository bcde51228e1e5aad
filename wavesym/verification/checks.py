"""The checks of `verify`: evaluators against the reference, and the reference against what is not derived at all.

A new one is one more `Check` in `CHECKS`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from flint import fmpq

from wavesym.errors import CostError, ToleranceError, UnservedError, WavesymError
from wavesym.exact.reference import Reference
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import nearest
from wavesym.programs.making import make
from wavesym.programs.request import Request
from wavesym.verification.characteristics import COARSEST, Integrated, doubles_of, integrate
from wavesym.verification.contacts import fronts, happening
from wavesym.verification.damped import damped
from wavesym.verification.graph import Struck, graph
from wavesym.verification.invariants import Balance, Balancing, Evaluate
from wavesym.verification.observed import observed, parted
from wavesym.verification.outcome import FINE, MOST_MOVED, NO_GRID, Check, IntegratedOutput, Outcome
from wavesym.verification.peaks import peaks
from wavesym.verification.reference import Known, KnownOutput, spread
from wavesym.verification.refinement import Refinement, Solutions, shown
from wavesym.verification.spacetime import Displaced, Instants, grid

# the reference is rounded once
_ROUNDED = 2.0**-53

# integrations are refined as long as they take no more doubles than that
_MOST_DOUBLES = 10_000_000

# central differences lag ever further behind: beyond this tau the grids would have to be finer
_LONGEST = 60.0

# of the instants away from fronts, so many are enough to begin with, and so many are looked at
_FEWEST_INSTANTS, _MOST_INSTANTS = 20, 200

# central differences tell nothing of springs that swing more radians than this in a step
_SWING = 0.25

# what is kept is looked at as long as it takes no more values
_MOST_VALUES = 30_000

Balances = Callable[[Evaluate, Sequence[float] | None], tuple[Balance, ...]]
"""What evaluates the outputs, and their errors (None: each value is rounded once), to the balances."""


def records(known: Known) -> list[Outcome]:
    """Modes against a march, at the samples and between: over the whole horizon, with both bounds."""
    model = known.whole
    try:
        program = make(model, Request(evaluator="modes"))
    except WavesymError:  # said of programs
        return []
    try:
        march = make(model.tolerating(fmpq(1)), Request(evaluator="march"))
    except WavesymError as refusal:
        return [Outcome("record", {"march": "refused"}, True, str(refusal))]
    taus = march.instants(nearest(model.spacing or min(bar.delay for bar in model.network.bars)) / 2)
    errors = np.max(np.abs(program.evaluate(taus) - march.evaluate(taus)), axis=1)
    outcomes = []
    for output, other, wrong in zip(program.outputs, march.outputs, errors.tolist(), strict=True):
        scale = output.largest or 1.0
        error, allowed = wrong / scale, output.bound + other.bound * other.largest / scale + _ROUNDED
        cells = {"instants": str(len(taus)), "error": shown(error), "allowed": shown(allowed)}
        outcomes.append(Outcome(output.name, cells, error <= allowed))
    return outcomes


def integration(known: Known) -> list[Outcome]:
    """Characteristics with N, 2N and 4N steps per common measure of delays; N is doubled until errors are bounded well.

    Where it stays coarse, as with stiff springs, that is said; whether it is good enough to judge programs is another
    question. Contacts are for others.
    """
    model = known.integrated
    try:
        steps, refined = characteristics(model, known.until, known.taus, known.outputs)
    except (CostError, UnservedError) as error:
        note = f"{model.name}: {error}"
        return [Outcome(output.probe.name, {"N": "refused"}, True, note) for output in known.outputs]
    return [
        Outcome(
            output.probe.name,
            each.cells(steps),
            each.right,
            "" if each.between <= FINE else _coarse(model, "integration"),
            IntegratedOutput(known.taus, each.values, each.allowed * output.scale),
        )
        for output, each in zip(known.outputs, refined, strict=True)
    ]


def beyond(known: Known) -> list[Outcome]:
    """Characteristics on the whole horizon, where exact values are known of its beginning only."""
    if not known.outputs or known.model.until == known.whole.until:
        return []
    model = known.independent or known.whole
    until = known.whole.horizon()
    taus = sorted({*spread(until), until})
    try:
        steps, refined = characteristics(model, until, taus, [None] * len(known.outputs))
    except (CostError, UnservedError):  # as of the beginning
        return []
    outcomes = []
    for output, each in zip(known.outputs, refined, strict=True):
        size = float(np.max(np.abs(each.values))) or 1.0
        integral = IntegratedOutput(taus, each.values, each.allowed * size)
        outcomes.append(Outcome(output.probe.name, each.cells(steps), integral.judges, integral=integral))
    return outcomes


def characteristics(
    model: Model, until: float, taus: Sequence[float], outputs: Sequence[KnownOutput | None]
) -> tuple[int, list[Refinement]]:
    """N, and each output at taus with N, 2N and 4N steps, compared with what is known of it.

    CostError where contacts open and close, or where it would not fit into memory.
    """
    made = graph(model)
    if made.contacts:
        raise UnservedError("contacts open and close inside the steps of characteristics, but not between fronts")
    if (size := doubles_of(made, until, 4 * COARSEST)) > _MOST_DOUBLES:
        measure = f"{float(made.measure):g}"
        raise CostError(
            f"output.until: integration along characteristics in steps of {measure} would hold {size:.1e} doubles, at "
            f"most {_MOST_DOUBLES:.1e} expected (delays with a longer common measure help)"
        )

    def motion(steps: int) -> Integrated:
        return integrate(made, until, steps)

    views = observed(model)

    def refined() -> list[Refinement]:
        found = []
        for output, view in zip(outputs, views, strict=True):
            coarse, half, quarter = (view.values(partial(each.at, taus=taus), taus) for each in motions)
            truth, scale = (output.values, output.scale) if output else (None, float(np.max(np.abs(quarter))) or 1.0)
            rounding = view.roundoff(motions[-1].roundoff)
            found.append(Solutions((coarse, half, quarter), truth, rounding, scale).plain())
        return found

    steps = COARSEST
    motions = [motion(steps), motion(2 * steps), motion(4 * steps)]
    while any(not each.between <= FINE for each in refined()) and 2 * motions[-1].size <= _MOST_DOUBLES:
        steps *= 2
        motions = [*motions[1:], motion(4 * steps)]
    return steps, refined()


def spacetime(known: Known) -> list[Outcome]:
    """Central differences with N, 2N and 4N cells a rod, at instants away from fronts.

    As far as they can be had; where they stay coarse that is said, but no failure: what they allow is in the table.
    With contacts N is so large that the same happens at them with 2N and 4N, and that is one more front.
    """
    model = known.integrated
    views = observed(model)
    apart = parted(model)
    seen = apart.probes
    first = grid(apart)
    until = min(known.until, _LONGEST, MOST_MOVED / first.finer(4).cost(1.0))
    struck: Struck = []
    if first.graph.contacts:
        if (found := first.struck(until, MOST_MOVED)) is None:
            note = f"{model.name}: {NO_GRID}"
            return [Outcome(output.probe.name, {"to": "refused"}, True, note) for output in known.outputs]
        first, struck = found

    def clear() -> Instants:
        return first.instants(until, struck)

    while len(clear()) < _FEWEST_INSTANTS and first.finer(8).cost(until) <= MOST_MOVED:
        first = first.finer(2)
    finest = first
    while finest.finer(8).cost(until) <= MOST_MOVED:
        finest = finest.finer(2)
    if (swing := first.graph.swings * finest.tau(1) / 4) > _SWING:
        note = f"{model.name}: springs swing {swing:.2g} radians in the shortest step that central differences can take"
        return [Outcome(output.probe.name, {"to": "refused"}, True, note) for output in known.outputs]
    instants = _some(clear())
    if not len(instants):
        step = f"at {first.tau(1):.1g} a step"
        note = f"{model.name}: to step between the fronts, central differences would take too long ({step})"
        return [Outcome(output.probe.name, {"to": "refused"}, True, note) for output in known.outputs]
    taus = [first.tau(k) for k in instants.tolist()]
    truth = [np.array(values) for values in Reference(known.model).values(taus)]

    def motion(finer: int) -> Displaced:
        return first.finer(finer).integrate(finer * instants)

    def refined() -> list[Refinement]:
        found = []
        for output, view, exact in zip(known.outputs, views, truth, strict=True):
            coarse, half, quarter = (
                view.values(dict(zip(seen, each.values, strict=True)).__getitem__, taus) for each in motions
            )
            rounding = view.roundoff(dict(zip(seen, motions[-1].roundoff.tolist(), strict=True)).__getitem__)
            solutions = Solutions((coarse, half, quarter), exact, rounding, output.scale)
            found.append(solutions.extrapolated() if first.aligned and not struck else solutions.wandering())
        return found

    finer = 1
    motions = [motion(1), motion(2), motion(4)]
    while any(not each.between <= FINE for each in refined()) and first.finer(8 * finer).cost(until) <= MOST_MOVED:
        finer *= 2
        motions = [*motions[1:], motion(4 * finer)]
    return [
        Outcome(
            output.probe.name,
            {"to": f"{until:.4g}", **each.cells(first.cells * finer)},
            each.right,
            "" if each.between <= FINE else _coarse(model, "space-time grid"),
            IntegratedOutput(taus, each.values, each.allowed * output.scale, clear=True),
        )
        for output, each in zip(known.outputs, refined(), strict=True)
    ]


def invariants(known: Known) -> list[Outcome]:
    """The balances of momentum and energy, in the reference itself and in the program, which generated NumPy is."""
    model = known.model
    made = Balancing(model, _MOST_VALUES)
    if not made.struck:
        return [_unbalanced(model, "fronts come too often")]
    try:
        return _balanced(made.model, made.balances, f"{float(made.struck[-1]):.4g}")
    except CostError as error:  # all ends are watched, and not only outputs
        return [_unbalanced(model, f"to watch all ends is too much: {error}")]


def _unbalanced(model: Model, why: str) -> Outcome:
    return Outcome("momentum, energy", {"to": "refused"}, True, f"{model.name}: no balances, as {why}")


def _balanced(seen: Model, balances: Balances, until: str) -> list[Outcome]:
    """The balances of a watched model, in the reference and in its program."""
    exact = Reference(seen)
    truth = balances(lambda taus: np.array(exact.values(taus.tolist())), None)
    note = ""
    made: Sequence[Balance | None] = [None] * len(truth)
    try:
        made = balances(*_program(seen))
    except ToleranceError as error:
        note = str(error)
    outcomes = []
    for right, ours in zip(truth, made, strict=True):
        cells = {"to": until, "reference": shown(right.error), "allowed": shown(right.allowed)}
        cells |= {"NumPy": shown(ours.error), "its bound": shown(ours.allowed)} if ours else {"NumPy": "refused"}
        passed = all(each.error <= each.allowed for each in (right, ours) if each)
        coarse = "" if right.allowed <= FINE else _coarse(seen, "quadrature of the balances")
        outcomes.append(Outcome(right.name, cells, passed, note or coarse))
    return outcomes


def _program(model: Model) -> tuple[Evaluate, list[float]]:
    """The program of a model, and the proved errors of its outputs, absolute."""
    program = make(model)
    return program.evaluate, [output.bound * output.largest for output in program.outputs]


def _some(instants: Instants) -> Instants:
    """No more than are looked at, evenly spread."""
    count = min(len(instants), _MOST_INSTANTS)
    return np.asarray(instants[np.linspace(0, len(instants) - 1, count).round().astype(int)])


def _coarse(model: Model, what: str) -> str:
    return f"{model.name}: the {what} is too coarse to tell errors below {FINE:.0e}"


CHECKS = (
    Check(
        "Damped modes: finite elements, N, 2N and 4N in the shortest rod, extrapolated. Allowed: the difference from\n"
        "what N and 2N extrapolate to. Differences are from the last:",
        damped,
    ),
    Check(
        "Records that modes take, against a march (of one hat, where samples fit into no window), at the samples and\n"
        "between. Allowed: what is proved of both:",
        records,
    ),
    Check(
        "Integration along characteristics beyond what is known exactly, with N, 2N and 4N steps. Allowed: the\n"
        "difference from 2N, and rounding. Differences are from 4N:",
        beyond,
    ),
    Check(
        "Integration along characteristics with N, 2N and 4N steps per common measure of the delays. Allowed at 4N:\n"
        "the difference from 2N, and rounding:",
        integration,
    ),
    Check(
        "Collocation between fronts, followed one by one, with N, 2N and 4N points a panel. Allowed at\n"
        "4N: the difference from 2N, and rounding:",
        fronts,
    ),
    Check(
        "Central differences in x and tau with N, 2N and 4N cells a rod, where no front is within a cell. Allowed:\n"
        "the difference from what N and 2N extrapolate to (fronts off the grid: from N and 2N), and rounding:",
        spacetime,
    ),
    Check(
        "When contacts open and close: how far integrations are from it, and what is allowed (between fronts: the\n"
        "difference of N and 2N points; central differences: those of N, 2N and 4N cells, and four steps):",
        happening,
    ),
    Check(
        "Momentum less impulse and energy less work of the whole chain at parts of the horizon (that contacts push or\n"
        "are apart, too): in the reference, and in generated NumPy. Allowed is what the errors of values come to:",
        invariants,
    ),
    Check(
        "Proved extremes: how far values at fronts, beside them and between lie beyond, and how far extremes are from\n"
        "the values at their instants. Allowed: rounding, and what values change by from one double to the next:",
        peaks,
    ),
)
