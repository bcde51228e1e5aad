"""The choice: the cheapest evaluator whose proved bound meets the scene's tolerance, and why."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from math import inf
from typing import NamedTuple, TypeAlias

from wavesym.errors import (
    CostError,
    MeasureError,
    RangeError,
    SpacingError,
    ToleranceError,
    UnservedError,
    WavesymError,
    WindowsError,
)
from wavesym.exact.tables.signal import refuse_many, signals
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import nearest, rational
from wavesym.numbers.reals import DOUBLE, REALS, Real
from wavesym.programs.closed_form import closed_form
from wavesym.programs.form import Form
from wavesym.programs.pieces import pieces
from wavesym.programs.request import unfollowed_waves, unmet_tolerance

_USUAL_TABLES = {"double": "speed", "single": "size"}
# Closed forms with larger tables than this are not tried unless requested: they have lost their digits long before.
_WORTH_TRYING = 50_000
_LAST = ("modes", "march")
# seconds for pieces where another program serves
_OF_MANY = 3


@dataclass(frozen=True)
class Attempt:
    """What came of trying one kind of program: its `form`, where it could be made, and the `refusal`, a sentence.

    The sentence is empty where the form meets the tolerance. `error` is for whoever requested this kind by its name,
    `model` what the form is of, where that is not what was asked for: loads of a shape act as straight lines there.
    """

    kind: str
    form: Form | None
    refusal: str = ""
    error: WavesymError | None = None
    model: Model | None = field(default=None, compare=False, repr=False)

    @property
    def why(self) -> str:
        """The refusal, with the kind that it is of."""
        return f"{self.kind}: {self.refusal}"

    @property
    def bound(self) -> float:
        """The error that it has, relative to the largest value of an output; infinite where nothing is known of it."""
        if self.form:
            return self.form.error_bound
        return self.error.bound if isinstance(self.error, ToleranceError) else inf


class Choice(NamedTuple):
    """The name of the evaluator chosen, itself, the reason in one line, and the model that it is of."""

    name: str
    evaluator: Form
    reason: str
    model: Model


def choose(
    model: Model,
    name: str = "auto",
    precision: str = "double",
    optimize: str | None = None,
    *,
    asked: bool = True,
) -> Choice:
    """The evaluator `name` of a model, or with "auto" the best that meets its tolerance.

    Args:
        model: dimensionless, with its tolerance, relative to each output's largest value.
        name: "auto", "closed", "pieces", "modes" or "march".
        precision: "double" or "single".
        optimize: "speed" for the least work, "size" for the least tables, "making" for what is made soonest; None for
            what is usual: in single precision pieces have small tables.
        asked: whether more may be spent on an evaluator that is requested by its name.

    Returns:
        The evaluator, and in a line why it was taken.

    Raises:
        ToleranceError: where none meets the tolerance; it says what is met.
        CostError, RangeError: where the one that is requested would cost too much or need numbers beyond its format.
    """
    if name == "auto":
        return best(model, attempts(model, precision, optimize), optimize)
    only = attempt(model, name, precision, optimize, asked=asked)
    if only.error:
        raise only.error
    return best(model, (only,), optimize)


def attempts(model: Model, precision: str = "double", optimize: str | None = None) -> tuple[Attempt, ...]:
    """All evaluators tried for a model; modes, and then a march, only where no other meets the tolerance.

    (A single value of these takes as long as all steps or windows before it, and so does trying one.) With damping
    there are only modes.

    Args:
        model, precision, optimize: as of `choose`.
    """
    tried: list[Attempt] = []
    for kind in ("modes",) if model.damping else MAKERS:
        served = any(not one.refusal for one in tried)
        if kind in _LAST and served:
            break
        tried.append(attempt(model, kind, precision, optimize=optimize, served=served))
    return tuple(tried)


def attempt(
    model: Model,
    kind: str,
    precision: str = "double",
    optimize: str | None = None,
    *,
    asked: bool = False,
    served: bool = False,
) -> Attempt:
    """One evaluator tried; what it is refused for is part of the answer.

    Args:
        model, precision, optimize: as of `choose`.
        kind: "closed", "pieces", "modes" or "march".
        asked: whether it is requested by its name, so that more may be spent on it.
        served: whether another one meets the tolerance, so that less is.
    """
    try:
        model = model.in_lines if kind in _LAST else model
        form = MAKERS[kind](model, REALS[precision], asked, optimize or _USUAL_TABLES[precision], served)
    except (CostError, UnservedError) as refusal:
        return Attempt(kind, None, str(refusal), refusal)
    except ToleranceError as refusal:
        return Attempt(kind, None, refusal.refusal or str(refusal), refusal)
    except OverflowError:
        beyond = f"numbers beyond the range of {precision} precision"
        return Attempt(kind, None, beyond, RangeError(f"output: {kind} needs {beyond}"))
    if rational(min(form.error_bound, 2.0)) <= model.tolerance:
        return Attempt(kind, form, model=model)
    return Attempt(kind, form, form.shortfall(model.tolerance).removeprefix(f"{kind}: "), model=model)


def best(model: Model, tried: Sequence[Attempt], optimize: str | None = None) -> Choice:
    """The best of what was tried and meets the tolerance, and why. ToleranceError where nothing does."""
    found = [(one.kind, one.form, one.model or model) for one in tried if one.form and not one.refusal]
    # where modes are for something else altogether that is no news, but of a record that nothing serves
    unserved = () if model.spacing and not found else UnservedError
    refused = [one for one in tried if one.refusal and not (one.kind == "modes" and isinstance(one.error, unserved))]
    if not found:
        if len(tried) == 1 and tried[0].error:
            raise tried[0].error
        refusals, bound = {one.kind: one.refusal for one in refused}, min(one.bound for one in tried)
        if model.network.corners:  # which pieces alone follow, whatever the tolerance
            costs = (str(one.error) for one in tried if one.kind == "pieces" and isinstance(one.error, CostError))
            for cost in costs:
                raise ToleranceError(cost, cost)
        measure = next((one.error for one in tried if isinstance(one.error, MeasureError)), None)
        if measure and bound >= 1:
            raise unfollowed_waves(model, measure, {kind: refusals[kind] for kind in refusals if kind == "modes"})
        if model.written_speeds and bound >= 1 and any(isinstance(one.error, WindowsError) for one in tried):
            from wavesym.programs.adjustment import short_steps  # with what marches

            raise short_steps(model)
        raise unmet_tolerance(model.tolerance, refusals, bound)
    small = optimize == "size"
    name, chosen, its_model = min(found, key=lambda one: one[1].bytes if small else one[1].work)
    loses = "is larger" if small else "takes longer"
    dearer = [f"{form.summary}, {loses}" for _, form, _ in found if form is not chosen]
    return Choice(name, chosen, "; ".join([*(one.why for one in refused), *dearer, chosen.summary]), its_model)


def _make_closed(model: Model, real: Real, asked: bool, *_: object) -> Form:
    refuse_many(model, 1e5 if asked else _WORTH_TRYING)
    merged = signals(model, inf if asked else _WORTH_TRYING, real)
    return closed_form(merged, model.horizon(real), real)


def _make_pieces(model: Model, real: Real, asked: bool, optimize: str, served: bool) -> Form:
    return pieces(model, real, model.tolerance, optimize, _OF_MANY if served else inf)


# modes and marches are loaded where they are tried: most scenes have pieces
def _make_modes(model: Model, real: Real, *_: object) -> Form:
    from wavesym.programs.modes.evaluator import modes

    return modes(model, real)


def _make_march(model: Model, real: Real, asked: bool, *_: object) -> Form:
    from wavesym.programs.hats import hat_march
    from wavesym.programs.march.evaluator import march

    if not asked and model.tolerance < real.roundoff:
        raise CostError(
            f"output: a tolerance of {nearest(model.tolerance):.3g} is below {real.name} precision, the limit is "
            f"{nearest(real.roundoff):.1e} (a larger one helps)"
        )
    try:
        return march(model, real)
    except SpacingError as refusal:
        hats = hat_march(model, str(refusal)) if real is DOUBLE else None
        if hats is None:
            raise
        return hats


Maker: TypeAlias = "Callable[[Model, Real, bool, str, bool], Form]"
MAKERS: dict[str, Maker] = {"closed": _make_closed, "pieces": _make_pieces, "modes": _make_modes, "march": _make_march}
