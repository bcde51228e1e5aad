"""The march: waves window by window, for long horizons and many rods, in constant memory and with a proved bound.

On each window [n, n + 1) what arrives at a node was sent on the window before, so the nodes are independent of each
other and each needs one short recurrence (operator.py). The degree of the polynomials that hold the waves grows
like the square root of the horizon, as fronts gather ever finer detail: it is chosen by marching once over the whole
horizon and adding up what was lost (bound.py), and raised until that is no more than what rounding costs.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from flint import arb, fmpq

from wavesym.errors import CostError, WavesymError
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import bound, nearest, rational
from wavesym.numbers.reals import DOUBLE, Real
from wavesym.programs.march.bound import Verdict, judge
from wavesym.programs.march.given import Given, batch_size, given
from wavesym.programs.march.operator import PanelOperator
from wavesym.programs.march.plan import Plan, plan
from wavesym.programs.march.run import operator_count, operators, steps
from wavesym.programs.march.tables import march_constants, march_tables
from wavesym.programs.program import Driven, Program, ProgramOutput, Provenance

_HIGHEST_DEGREE = 2000
_MOST_WORK = 1e9  # nodes * coefficients * windows, half a minute or so
_BOUNDING = 1 / 20  # of an operator, in the same units per third power of the degree
_LARGEST_STATE = 1 << 22  # bytes; programs keep it on the stack
_OVERHEAD = 1000  # of a window, in units of a coefficient
_SETTLED = 0.8  # a bound that a higher degree does not bring below so much of it is left as it is


@dataclass(frozen=True)
class MarchEvaluator:
    """A march over [0, tau_max] with polynomials of `degree` in `real` numbers.

    `given` is what is proved for loads that are not the scene's, where that was asked for.
    """

    plan: Plan
    degree: int
    real: Real
    outputs: tuple[ProgramOutput, ...]
    given: Given | None = None

    @property
    def tau_max(self) -> float:
        """The last tau."""
        return self.plan.tau_max

    @cached_property
    def error_bound(self) -> float:
        """The largest error of any output relative to its largest value; proved."""
        return max(output.bound for output in self.outputs)

    @cached_property
    def operators(self) -> dict[fmpq, PanelOperator]:
        """By rate times length of a panel."""
        return operators(self.plan, self.degree)

    @property
    def bytes(self) -> int:
        """The size of the tables that grow, those of the operators and the loads."""
        return self.real.bytes * (3 * (self.degree + 1) * len(self.operators) + 6 * len(self.plan.events))

    @property
    def state_bytes(self) -> int:
        """The size of what a march remembers: two windows of waves."""
        return self.real.bytes * _state(self.plan, self.degree)

    @property
    def work(self) -> float:
        """About how many operations a window takes, and so a value that is asked for alone on one."""
        return 8.0 * len(self.plan.panels) * len(self.plan.junctions) * self.degree

    @property
    def marched(self) -> float:
        """The same of all windows."""
        return self.work * self.tau_max

    @property
    def summary(self) -> str:
        """What it is, in a few words."""
        size = -(-self.state_bytes // 1024)
        return f"march, degree {self.degree}, a state of {size} KiB, bound {self.error_bound:g}"

    def shortfall(self, tolerance: fmpq) -> str:
        """Why it does not meet a tolerance."""
        worst = max(self.outputs, key=lambda output: output.bound)
        if not worst.bound < 1:
            return f"march: its error may be as large as {worst.name} itself"
        return f"march: rounding leaves a bound of {worst.bound:g} to tau = {self.tau_max:g} for {worst.name}"

    @cached_property
    def check_points(self) -> list[float]:
        """For the self-test: both ends, the first windows, and a few of all later ones."""
        early = [k / 8 for k in range(int(min(8 * self.tau_max, 160)) + 1)]
        late = [self.real.nearest(rational(self.tau_max) * k / 32) for k in range(33)]
        return sorted(set(early + late))

    def program(self, provenance: Provenance) -> Program:
        """A march remembers waves; what it is made of are tables of a window, and constants."""
        return Program(
            "march",
            self.real,
            self.tau_max,
            self.outputs,
            march_tables(self),
            march_constants(self),
            self.bytes,
            provenance,
            sources=tuple(channel.name for channel in self.plan.channels),
            whole=math.isinf(self.plan.valid),
            driven=Driven(self.given.windows, self.given.errors) if self.given else None,
        )


def marched(model: Model, real: Real = DOUBLE, degree: int | None = None, windows: int | None = None) -> MarchEvaluator:
    """The march of a model in `real` numbers, whatever its bound, of the least sufficient degree or of the one given
    (at least 8).

    With `windows` the degree suffices for loads that are given while it runs for so long; WavesymError where none can
    be. OverflowError where numbers would be beyond those of the format.
    """
    prepared = plan(model, real, windows or 0)
    _refuse_extreme(prepared, real)
    if degree is not None:
        return _made(prepared, degree, real)[0]
    degree = _first_degree(prepared, prepared.windows, real)
    before = math.inf
    spent = 0.0
    while True:
        spent = _refuse_long(prepared, degree, spent)
        made, verdict = _made(prepared, degree, real)
        # where bodies are very light, what is lost is mostly rounding that no degree mends
        settled = verdict.truncated <= verdict.rounded or _SETTLED * before < made.error_bound < math.inf
        if verdict.quiet and settled:
            break
        before = made.error_bound
        degree += degree // 6
    return made if windows is None else _driven(made, windows)


def _driven(made: MarchEvaluator, windows: int) -> MarchEvaluator:
    """A march of a degree that is enough for given loads too, and what is proved for them."""
    prepared, real = made.plan, made.real
    if not prepared.channels:
        raise WavesymError("--windows: no load can be given here, a system with a load in the light cone expected")
    degree = max(made.degree, _first_degree(prepared, windows, real))
    before = math.inf
    spent = 0.0
    while True:
        spent = _refuse_long(prepared, degree, spent, windows, batch_size(prepared))
        proved = given(prepared, degree, real, windows)
        worst = max(proved.errors)
        if proved.settled or _SETTLED * before < worst:
            return replace(_made(prepared, degree, real)[0], given=proved)
        before = worst
        degree += degree // 6


def _made(prepared: Plan, degree: int, real: Real) -> tuple[MarchEvaluator, Verdict]:
    verdict = judge(prepared, degree, real)
    outputs = tuple(
        ProgramOutput(output.name, bound(arb(error)) if math.isfinite(error) else error, size)
        for output, error, size in zip(prepared.outputs, verdict.bounds, verdict.largest, strict=True)
    )
    return MarchEvaluator(prepared, degree, real, outputs), verdict


def _first_degree(prepared: Plan, windows: int, real: Real) -> int:
    """A front that has met n bodies of rate g is like a Laguerre function: sqrt(2 g n) oscillations to be resolved."""
    rates = [nearest(node.rate) if node.rate is not None else 0.0 for node in prepared.junctions]
    longest = max(nearest(panel.length) for panel in prepared.panels)
    detail = math.sqrt(2 * float(np.mean(rates)) * longest * windows)
    return math.ceil(detail) + (20 if real is DOUBLE else 10)


def _refuse_extreme(prepared: Plan, real: Real) -> None:
    """OverflowError where a number of the tables is too small for its rounding to be as the unit roundoff says."""
    nodes = prepared.junctions
    numbers = [value for node in nodes for value in (node.alpha, node.beta, node.motion)]
    numbers += [panel.length / 2 for panel in prepared.panels]
    # the smallest ratio of an operator is about this
    numbers += [step / (8 * _HIGHEST_DEGREE) for step in steps(prepared)]
    numbers += [power for event in prepared.events for power in event.powers]
    numbers += [channel.gain for channel in prepared.channels]
    numbers += [heard.gain for output in prepared.outputs for heard in output.heard]
    if any(0 < abs(value) < real.least for value in (*numbers, *prepared.rods)):
        raise OverflowError(f"a number of the tables is too small for {real.name} precision")


def _refuse_long(prepared: Plan, degree: int, spent: float, windows: int = 0, marches: int = 1) -> float:
    """What trying a degree costs, with what is `spent` already; CostError where that is too much."""
    asked, until = ("--windows", float(windows)) if windows else ("output.until", prepared.tau_max)
    shorter = "fewer windows" if windows else "a shorter horizon"
    work = (windows or prepared.windows) * len(prepared.panels)
    work *= _OVERHEAD + marches * len(prepared.junctions) * degree
    if degree > _HIGHEST_DEGREE:
        raise CostError(
            f"{asked}: rates to {nearest(prepared.rate):g} need polynomials of degree {degree:g} to tau = {until:g}, "
            f"at most {_HIGHEST_DEGREE} expected in a march ({shorter}, or heavier bodies, helps)"
        )
    spent += work + _BOUNDING * operator_count(prepared) * degree**3
    if spent > _MOST_WORK:
        raise CostError(
            f"{asked}: a march of degree {degree} to tau = {until:g} would cost {spent:.1e} operations, at most "
            f"{_MOST_WORK:.1e} expected ({shorter} helps)"
        )
    if 8 * _state(prepared, degree) > _LARGEST_STATE:
        raise CostError(
            f"system.m: the state of a march would have {8 * _state(prepared, degree):.1e} bytes, at most "
            f"{_LARGEST_STATE:.1e} expected (fewer rods, or fewer fractional parts of load times, help)"
        )
    return spent


def _state(prepared: Plan, degree: int) -> int:
    return 4 * len(prepared.panels) * (len(prepared.junctions) + 2) * (degree + 1)
