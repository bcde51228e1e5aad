"""The checks of `verify`: evaluators against the reference, and the reference against what is not derived at all.

A new one is one more `Check` in `CHECKS`.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from flint import fmpq

from wavesym.errors import CostError, ToleranceError, WavesymError
from wavesym.exact.reference import Reference
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import nearest
from wavesym.programs.making import make
from wavesym.programs.program import Program
from wavesym.programs.request import Request
from wavesym.running.compiled import compiled, imported
from wavesym.targets.files import files
from wavesym.verification.characteristics import COARSEST, Integrated, integrate
from wavesym.verification.contacts import fronts, happening
from wavesym.verification.damped import damped
from wavesym.verification.graph import Struck, graph
from wavesym.verification.graph_balance import Balancing
from wavesym.verification.graph_characteristics import doubles_of, integrate_graph
from wavesym.verification.graph_grid import GraphGrid, graph_grid
from wavesym.verification.invariants import Balance, Evaluate, balances, values_per_window, watched
from wavesym.verification.observed import observed, parted
from wavesym.verification.outcome import FINE, MOST_MOVED, NO_GRID, Check, Outcome
from wavesym.verification.reference import Known
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

# what is kept is looked at as long as it takes no more values at nodes, and no more windows of outputs
_MOST_VALUES, _MOST_WINDOWS = 50_000, 240
_MOST_GRAPH_VALUES = 30_000

Balances = Callable[[Evaluate, Sequence[float] | None], tuple[Balance, ...]]
"""What evaluates the outputs, and their errors (None: each value is rounded once), to the balances."""


def generated(known: Known) -> list[Outcome]:
    """The generated C, compiled and run, and the generated NumPy, against their proved bound.

    C that takes loads sample by sample has its self-test alone.
    """
    model = known.whole
    try:
        program = make(model, tested=True)
    except ToleranceError as error:  # an evaluator that says where it ends has not failed
        cells = {"C": "refused", "NumPy": "refused", "bound": "-"}
        return [Outcome(output.probe.name, cells, True, str(error)) for output in known.outputs]
    if program.numpy_only:
        return _in_numpy(known, program)
    made = files(program, "all")
    bounds = [output["error_bound"] for output in json.loads(made[f"{model.name}.json"])["outputs"]]
    numpy = imported(made[f"{model.name}.py"], model.name).evaluate(np.array(known.taus))
    with compiled(made, len(known.outputs)) as built:
        found = {"NumPy": numpy} if built.streams else {"C": built(known.taus), "NumPy": numpy}
        sound = built.selftest() == 0
    note = "" if sound else f"{model.name}: the self-test of the generated C fails"
    outcomes = []
    for output, stated, bound, *values in zip(known.outputs, program.outputs, bounds, *found.values(), strict=True):
        # the largest value may lie between the instants that are looked at, or beyond them
        errors = [output.error(each) * min(1.0, output.scale / (stated.largest or 1.0)) for each in values]
        allowed = 0.0 if stated.largest == 0 else bound + _ROUNDED
        cells = dict(zip((*found, "bound"), map(shown, (*errors, bound)), strict=True))
        passed = sound and all(error <= allowed for error in errors)
        outcomes.append(Outcome(output.probe.name, cells, passed, note))
    return outcomes


def _in_numpy(known: Known, program: Program) -> list[Outcome]:
    """What there is no C of."""
    name = program.provenance.model.name
    values = imported(files(program, "numpy")[f"{name}.py"], name).evaluate(np.array(known.taus))
    outcomes = []
    for output, stated, ours in zip(known.outputs, program.outputs, values, strict=True):
        error = output.error(ours) * min(1.0, output.scale / (stated.largest or 1.0))
        cells = {"C": "refused", "NumPy": shown(error), "bound": shown(stated.bound)}
        allowed = 0.0 if stated.largest == 0 else stated.bound + _ROUNDED
        outcomes.append(Outcome(output.probe.name, cells, error <= allowed, program.numpy_only))
    return outcomes


def records(known: Known) -> list[Outcome]:
    """Modes against a march, at the samples and between: over the whole horizon, with both bounds."""
    model = known.whole
    try:
        program = make(model)
    except WavesymError:  # said already
        return []
    if program.evaluator != "modes":
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
    """Characteristics with N, 2N and 4N steps per unit of tau; N is doubled until their own bound is little.

    Of a chain that is written out N is per common measure of its delays; where stiff springs ask for more than can be
    had, that is said, but no failure. Contacts are for others.
    """
    model = known.model
    made = None if model.chain else graph(model)
    if made and made.contacts:
        note = f"{model.name}: contacts open and close inside the steps of characteristics, but not between fronts"
        return [Outcome(output.probe.name, {"N": "refused"}, True, note) for output in known.outputs]
    if made and (size := doubles_of(made, known.until, 4 * COARSEST)) > _MOST_DOUBLES:
        why = f"{size:.1e} doubles, as all delays are multiples of {float(made.measure):g}"
        note = f"{model.name}: integration along characteristics would hold {why}"
        return [Outcome(output.probe.name, {"N": "refused"}, True, note) for output in known.outputs]

    def motion(steps: int) -> Integrated:
        if made:
            return integrate_graph(made, known.until, steps)
        return integrate(model.named, model.loads, known.until, steps)

    views = observed(model)

    def refined() -> list[Refinement]:
        found = []
        for output, view in zip(known.outputs, views, strict=True):
            coarse, half, quarter = (view.values(partial(each.at, taus=known.taus), known.taus) for each in motions)
            rounding = view.roundoff(motions[-1].roundoff)
            found.append(Solutions((coarse, half, quarter), output.values, rounding, output.scale).plain())
        return found

    steps = COARSEST
    motions = [motion(steps), motion(2 * steps), motion(4 * steps)]
    while any(not each.between <= FINE for each in refined()) and 2 * motions[-1].size <= _MOST_DOUBLES:
        steps *= 2
        motions = [*motions[1:], motion(4 * steps)]
    return [
        Outcome(output.probe.name, each.cells(steps), each.right)
        if each.between <= FINE
        else Outcome(output.probe.name, each.cells(steps), bool(made) and each.right, _coarse(model, "integration"))
        for output, each in zip(known.outputs, refined(), strict=True)
    ]


def spacetime(known: Known) -> list[Outcome]:
    """Central differences with N, 2N and 4N cells a rod, at instants away from fronts.

    As far as they can be had; where they stay coarse that is said, but no failure: what they allow is in the table.
    With contacts N is so large that the same happens at them with 2N and 4N, and that is one more front.
    """
    model = known.model
    views = observed(model)
    apart = parted(model)
    seen = apart.probes
    first = grid(apart) if model.chain else graph_grid(apart)
    until = min(known.until, _LONGEST, MOST_MOVED / first.finer(4).cost(1.0))
    struck: Struck = []
    if isinstance(first, GraphGrid) and first.graph.contacts:
        if (found := first.struck(until, MOST_MOVED)) is None:
            note = f"{model.name}: {NO_GRID}"
            return [Outcome(output.probe.name, {"to": "refused"}, True, note) for output in known.outputs]
        first, struck = found

    def clear() -> Instants:
        return first.instants(until, struck) if isinstance(first, GraphGrid) else first.instants(until)

    while len(clear()) < _FEWEST_INSTANTS and first.finer(8).cost(until) <= MOST_MOVED:
        first = first.finer(2)
    finest = first
    while finest.finer(8).cost(until) <= MOST_MOVED:
        finest = finest.finer(2)
    if isinstance(first, GraphGrid) and (swing := first.graph.swings * finest.tau(1) / 4) > _SWING:
        note = f"{model.name}: springs swing {swing:.2g} radians in the shortest step that central differences can take"
        return [Outcome(output.probe.name, {"to": "refused"}, True, note) for output in known.outputs]
    instants = _some(clear())
    if not len(instants):
        step = f"at {first.tau(1):.1g} a step"
        note = f"{model.name}: to step between the fronts, central differences would take too long ({step})"
        return [Outcome(output.probe.name, {"to": "refused"}, True, note) for output in known.outputs]
    taus = [first.tau(k) for k in instants.tolist()]
    truth = [np.array(values) for values in Reference(model).values(taus)]

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
        )
        for output, each in zip(known.outputs, refined(), strict=True)
    ]


def invariants(known: Known) -> list[Outcome]:
    """The balances of momentum and energy, in the reference itself and in the program, which generated NumPy is."""
    model = known.model
    if model.chain is None:
        made = Balancing(model, _MOST_GRAPH_VALUES)
        if not made.struck:
            return [_unbalanced(model, "fronts come too often")]
        try:
            return _balanced(made.model, made.balances, f"{float(made.struck[-1]):.4g}")
        except CostError as error:  # all ends are watched, and not only outputs
            return [_unbalanced(model, f"to watch all ends is too much: {error}")]
    outputs, values = values_per_window(model)
    windows = min(int(known.until), _MOST_VALUES // values, _MOST_WINDOWS // outputs)
    if windows < 1:
        return [_unbalanced(model, "its horizon is shorter than 1" if known.until < 1 else "too many rods")]
    seen = watched(model, windows)
    return _balanced(seen, partial(balances, seen), str(windows))


def _unbalanced(model: Model, why: str) -> Outcome:
    return Outcome("momentum, energy", {"to": "refused"}, True, f"{model.name}: no balances, as {why}")


def _balanced(seen: Model, balances: Balances, until: str) -> list[Outcome]:
    """The balances of a watched model, in the reference and in its program."""
    exact = Reference(seen)
    # what is no named system is watched where it may be 0 throughout, and only what it is at some instants
    errors = [_ROUNDED * float(size.upper()) for size in exact.largest()] if seen.chain else None
    truth = balances(lambda taus: np.array(exact.values(taus.tolist())), errors)
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
    Check("Generated code, against its proved bound:", generated),
    Check(
        "Damped modes: generated NumPy against finite elements, N, 2N and 4N in the shortest rod, extrapolated.\n"
        "Allowed: the difference from what N and 2N extrapolate to, and the proved bound:",
        damped,
    ),
    Check(
        "Records that modes take, against a march (of one hat, where samples fit into no window), at the samples and\n"
        "between. Allowed: what is proved of both:",
        records,
    ),
    Check(
        "Integration along characteristics with N, 2N and 4N steps per unit of tau (type chain: per common measure\n"
        "of its delays). Allowed at 4N: the difference from 2N, and rounding:",
        integration,
    ),
    Check(
        "Central differences in x and tau with N, 2N and 4N cells a rod, where no front is within a cell. Allowed:\n"
        "the difference from what N and 2N extrapolate to (fronts off the grid: from N and 2N), and rounding:",
        spacetime,
    ),
    Check(
        "Type chain: collocation between fronts, followed one by one, with N, 2N and 4N points a panel. Allowed at\n"
        "4N: the difference from 2N, and rounding:",
        fronts,
    ),
    Check(
        "When contacts open and close: how far integrations are from it, and what is allowed (between fronts: the\n"
        "difference of N and 2N points; central differences: those of N, 2N and 4N cells, and four steps):",
        happening,
    ),
    Check(
        "Momentum less impulse and energy less work of the whole chain at tau = 1, 2, ... (type chain: at parts of\n"
        "the horizon; that contacts push or are apart): in the reference, and in generated NumPy. Allowed is what the\n"
        "errors of their values come to:",
        invariants,
    ),
)
