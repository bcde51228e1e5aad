"""The choice: the cheapest evaluator whose proved bound meets the scene's tolerance, and why."""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from typing import NamedTuple, Protocol

from flint import fmpq

from wavesym.errors import CostError, RangeError, WavesymError
from wavesym.exact.signal import refuse_many, signals
from wavesym.model.model import Model
from wavesym.numbers.doubles import rational
from wavesym.numbers.reals import REALS, Real
from wavesym.programs.closed import ClosedForm, closed_form
from wavesym.programs.march.evaluator import MarchEvaluator, marched, unmet
from wavesym.programs.pieces import Pieces, pieces
from wavesym.programs.program import ProgramOutput

Made = ClosedForm | Pieces | MarchEvaluator

_USUAL_TABLES = {"double": "speed", "single": "size"}
# Closed forms with larger tables than this are not tried unless asked for: they have lost their digits long before.
_WORTH_TRYING = 50_000


class Evaluator(Protocol):
    """What computes the outputs of a scene on [0, tau_max]."""

    @property
    def real(self) -> Real: ...

    @property
    def tau_max(self) -> float: ...

    @property
    def outputs(self) -> tuple[ProgramOutput, ...]: ...

    @property
    def error_bound(self) -> float: ...

    @property
    def work(self) -> float: ...

    @property
    def bytes(self) -> int: ...

    @property
    def summary(self) -> str: ...

    @property
    def check_points(self) -> list[float]: ...

    def shortfall(self, tolerance: fmpq) -> str: ...


class Choice(NamedTuple):
    """The name of the evaluator chosen, itself, and the reason in one line."""

    name: str
    evaluator: Made
    reason: str


def choose(
    model: Model,
    name: str = "auto",
    precision: str = "double",
    windows: int | None = None,
    optimize: str | None = None,
) -> Choice:
    """The evaluator `name` of a model, or with "auto" the best that meets its tolerance.

    Best is what takes least work or, where it is to `optimize` "size", has the least tables. Pieces in single precision
    have small tables unless "speed" is asked for.
    `windows`: for how many of them a march is driven by hand; WavesymError for another evaluator.
    ToleranceError where none does: it says what can be had. CostError, RangeError where one is asked for that would
    cost too much or need numbers beyond those of its format.
    """
    if windows is not None and name != "march":
        raise WavesymError(f"--windows goes with --evaluator march, {name} given")
    real = REALS[precision]
    tables = optimize or _USUAL_TABLES[precision]
    tolerance = model.tolerance
    found: list[tuple[str, Made]] = []
    refused: list[str] = []
    for each in MAKERS if name == "auto" else (name,):
        if each == "march" and found and name == "auto":
            break  # it takes as long for a value as for all windows before it
        try:
            evaluator = MAKERS[each](model, real, name != "auto", windows, tables)
        except CostError as refusal:
            if name != "auto":
                raise
            refused.append(f"{each}: {refusal}")
            continue
        except OverflowError:
            if name != "auto":
                raise RangeError(f"output: {each} needs numbers beyond the range of {precision} precision") from None
            refused.append(f"{each}: numbers beyond the range of {precision} precision")
            continue
        if rational(min(evaluator.error_bound, 2.0)) <= tolerance:
            found.append((each, evaluator))
        else:
            refused.append(evaluator.shortfall(tolerance))
    if not found:
        raise unmet(tolerance, "; ".join(refused))
    small = optimize == "size"
    name, best = min(found, key=lambda one: one[1].bytes if small else one[1].work)
    dearer = [
        f"{evaluator.summary}, {'is larger' if small else 'takes longer'}"
        for _, evaluator in found
        if evaluator is not best
    ]
    return Choice(name, best, "; ".join([*refused, *dearer, best.summary]))


def _closed(model: Model, real: Real, asked: bool, *_: object) -> ClosedForm:
    refuse_many(model, 1e5 if asked else _WORTH_TRYING)
    merged = signals(model, inf if asked else _WORTH_TRYING, real)
    return closed_form(merged, model.horizon(real), real)


def _pieces(model: Model, real: Real, asked: bool, windows: int | None, optimize: str) -> Pieces:
    return pieces(model, real, model.tolerance, optimize)


def _march(model: Model, real: Real, asked: bool, windows: int | None, _: str) -> MarchEvaluator:
    return marched(model, real, windows=windows)


Maker = Callable[[Model, Real, bool, int | None, str], Made]
MAKERS: dict[str, Maker] = {"closed": _closed, "pieces": _pieces, "march": _march}
