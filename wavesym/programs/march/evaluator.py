"""The march as an evaluator: of the least degree that is enough for its horizon, in constant memory.

The degree of the polynomials that hold the waves grows like the square root of the horizon, as fronts gather ever finer
detail: it is found by marching once over the whole horizon and adding up what was lost (bound.py), and raised until
that is no more than what rounding costs.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

from flint import arb, fmpq

from wavesym.errors import CostError, WindowsError
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import bound, nearest, rational
from wavesym.numbers.reals import DOUBLE, Real
from wavesym.programs.form import Form
from wavesym.programs.march.bound import Verdict, judge
from wavesym.programs.march.plan import HIGHEST_DEGREE, MarchPlan, least_numbers, march_plan, readable
from wavesym.programs.march.space import BLOCK, BODY, SCATTERER, JointSpace
from wavesym.programs.march.tables import MarchTables, state_bytes, table_bytes
from wavesym.programs.program import ProgramOutput
from wavesym.programs.tables import Tables

_MOST_BYTES = 1 << 22  # of tables, and of the state, which programs keep on the stack
_MOST_WORK = 2e10  # multiplications of trying all degrees, half a minute or so
_KIND = 2e4  # what joints of a kind take on a panel besides, in such units
_SETTLED = 0.8  # a bound that a higher degree does not bring below so much of it is left as it is
_LEAST_DEGREE = 4


@dataclass(frozen=True)
class March(Form):
    """A march over [0, tau_max] with polynomials of `degree` in `real` numbers."""

    KERNEL = "march"

    plan: MarchPlan
    degree: int
    real: Real
    outputs: tuple[ProgramOutput, ...]
    tau_max: float

    @cached_property
    def tables(self) -> Tables:
        """The numbers of its program."""
        return MarchTables(self.plan, self.degree, self.real).tables([output.bound == 0 for output in self.outputs])

    @cached_property
    def constants(self) -> dict[str, float]:
        """Its single numbers."""
        return MarchTables(self.plan, self.degree, self.real).constants()

    @property
    def bytes(self) -> int:
        """The size of the tables that grow."""
        return table_bytes(self.plan, self.degree, self.real)

    @property
    def state_bytes(self) -> int:
        """The size of what a march remembers: the waves in all bars."""
        return state_bytes(self.plan, self.degree, self.real)

    @property
    def work(self) -> float:
        """About how many operations a window takes, and so a single value on one."""
        return 2.0 * _multiplications(self.plan, self.degree)

    @property
    def total_work(self) -> float:
        """The same of all windows."""
        return self.work * self.plan.windows

    @property
    def summary(self) -> str:
        """What it is, in a few words."""
        size = -(-self.state_bytes // 1024)
        step = "" if self.plan.step == 1 else f" on steps of {self.plan.step}"
        return f"march, degree {self.degree}{step}, a state of {size} KiB, bound {self.error_bound:g}"

    def shortfall(self, tolerance: fmpq) -> str:
        """Why it does not meet a tolerance."""
        if not self.worst.bound < 1:
            return f"march: its error may be as large as {self.worst.name} itself"
        return f"march: rounding leaves a bound of {self.worst.bound:g} to tau = {self.tau_max:g} for {self.worst.name}"

    @cached_property
    def check_points(self) -> list[float]:
        """For the self-test: both ends, the first windows, and a few of all later ones."""
        step, last = self.plan.step, rational(self.tau_max)
        early = [self.real.nearest(step * k / 8) for k in range(161) if step * k / 8 <= last]
        late = [self.real.nearest(last * k / 32) for k in range(33)]
        return sorted({min(tau, self.tau_max) for tau in early + late})


def march(model: Model, real: Real = DOUBLE, degree: int | None = None) -> March:
    """The march of a model, whatever its bound.

    Args:
        model: dimensionless, at rest or moving at tau = 0.
        real: the numbers of the program.
        degree: of the polynomials on a panel; the least sufficient one where it is None.

    Raises:
        UnservedError: where the model has contacts that open, or damping of modes.
        CostError: where it would be long or large.
        OverflowError: where numbers would be beyond those of the format.
    """
    return judge_march(model, real, degree)[0]


def judge_march(model: Model, real: Real = DOUBLE, degree: int | None = None) -> tuple[March, Verdict]:
    """The same with all that is known of it."""
    plan = march_plan(model, real)
    if any(0 < abs(value) < real.least for value in least_numbers(plan)) or plan.cycle[1] * real.roundoff > 1:
        raise OverflowError(f"a number of the tables is beyond {real.name} precision")
    if degree is not None:
        return _march_of_degree(plan, max(degree, _LEAST_DEGREE), real)
    degree = first_degree(plan, real)
    before = math.inf
    spent = 0.0
    while True:
        spent = refuse_long(plan, degree, spent, real)
        made, verdict = _march_of_degree(plan, degree, real)
        if verdict.truncation_error <= verdict.rounding_error or _SETTLED * before <= made.error_bound < math.inf:
            return made, verdict
        before = made.error_bound
        # each degree gains a factor of e or more
        missing = (
            math.log(verdict.truncation_error / verdict.rounding_error) if verdict.rounding_error > 0 else math.inf
        )
        degree += max(2, min(degree // 6, math.ceil(min(missing, 1e6)) + 2))


def judge_degree(plan: MarchPlan, degree: int, real: Real, what: str = "march") -> Verdict:
    """What a plan is worth at some degree: its proved errors.

    Args:
        plan: a model made ready to march.
        degree: that of the polynomials on panels.
        real: the type of the numbers that it is computed in.
        what: the program that is made of it, for messages.

    Raises:
        CostError: where its joints take too many bits.
    """
    try:
        return judge(plan, degree, real)
    except OverflowError:  # of the numbers' format, which costs have nothing to do with
        raise
    except ArithmeticError as error:
        raise CostError(f"system.parts: to solve the joints of a {what}, {error} (softer springs help)") from None


def _march_of_degree(plan: MarchPlan, degree: int, real: Real) -> tuple[March, Verdict]:
    verdict = judge_degree(plan, degree, real)
    outputs = tuple(
        ProgramOutput(
            probe.name, bound(arb(error)) if math.isfinite(error) else error, size, incidental=probe.incidental
        )
        for probe, error, size in zip(plan.model.probes, verdict.bounds, verdict.largest, strict=True)
    )
    return March(plan, degree, real, outputs, plan.tau_max), verdict


def first_degree(plan: MarchPlan, real: Real) -> int:
    """Enough for the oscillations of a front; a stiff spring adds those of a body on it. Blocks cost its square."""
    if not any(joint.space.states for joint in plan.joints):
        return _LEAST_DEGREE
    bodies = [-nearest(p.space.rates[n, n]) for p in plan.joints for n in range(p.space.states)]
    slow = sum(rate for rate in bodies if rate > 0) / len(bodies)
    detail = plan.oscillations(slow) + min(plan.turning * plan.longest / 2, 1e6)
    spare = 8 if any(joint.space.law == BLOCK for joint in plan.joints) else 12
    return math.ceil(detail) + (spare if real is DOUBLE else spare // 2)


def _multiplications(plan: MarchPlan, degree: int) -> int:
    """On one window."""
    return len(plan.panels) * sum(step_multiplications(joint.space, degree) for joint in plan.joints)


def step_multiplications(space: JointSpace, degree: int) -> int:
    """Multiplications with an addition of a joint on a panel, for polynomials of `degree`."""
    ports, size = len(space.ports), degree + 1
    if space.law == SCATTERER:
        return (ports + space.points) * size * ports
    if space.law == BODY:
        return (2 * ports + 4) * size
    return int((space.points * size + space.states) ** 2)


def _kinds(plan: MarchPlan) -> int:
    """How many sorts of joints there are, each of which takes its steps at once."""
    return len(
        {
            (of.law, len(of.ports), of.points, of.states, of.key if of.law == BLOCK else None)
            for of in (joint.space for joint in plan.joints)
        }
    )


def refuse_long(plan: MarchPlan, degree: int, spent: float, real: Real) -> float:
    """What trying a degree costs, with what is `spent` already; CostError where that is too much."""
    _refuse_rings(plan, _LEAST_DEGREE, real)  # it is not the joints then
    if degree > HIGHEST_DEGREE:
        raise CostError(
            f"output.until: rates to {plan.norm:g} need polynomials of degree {degree:g} to tau = "
            f"{plan.tau_max:g}, the limit in a march is {HIGHEST_DEGREE} (a shorter horizon, or heavier bodies, "
            "helps)"
        )
    if (size := table_bytes(plan, degree, real)) > _MOST_BYTES:
        raise CostError(
            f"system.parts: joints as fast as {plan.norm:.3g} on a step of {readable(plan.step)} need polynomials of "
            f"degree {degree:g} to tau = {plan.tau_max:g}, and so {size:.1e} bytes of tables, the limit in a "
            f"march is {_MOST_BYTES:.1e} (softer springs, heavier bodies, or lengths with a smaller common "
            "measure, help)"
        )
    _refuse_rings(plan, degree, real)
    # two matrices are multiplied with: the responses, and their sizes; and those of what bodies round
    operators = {(s.rate, p.length) for s in (j.space for j in plan.joints) if s.law == BODY for p in plan.panels}
    work = len(operators) * degree**3.0 + plan.windows * (
        3.0 * _multiplications(plan, degree) + _KIND * _kinds(plan) * len(plan.panels)
    )
    spent += work
    if spent > _MOST_WORK:
        raise WindowsError(
            f"output.until: a march of degree {degree} on steps of {readable(plan.step)} to tau = {plan.tau_max:g} "
            f"would cost {spent:.1e} operations, the limit is {_MOST_WORK:.1e} (a shorter horizon helps)"
        )
    return spent


def _refuse_rings(plan: MarchPlan, degree: int, real: Real) -> None:
    if (size := state_bytes(plan, degree, real)) > _MOST_BYTES:
        raise CostError(
            f"system.parts: the rings of a march on a step of {plan.step} would have {size:.1e} bytes, the limit "
            f"is {_MOST_BYTES:.1e} (fewer rods, or lengths with a larger common measure, help)"
        )
