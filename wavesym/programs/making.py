"""Model -> Program: the evaluator that is requested, or the best, with its reason, contacts and reference values."""

from __future__ import annotations

from wavesym.exact.contacts.events import contact_ends, events
from wavesym.mechanics.model import Model
from wavesym.programs.choice import choose
from wavesym.programs.form import Form
from wavesym.programs.program import Program, Provenance
from wavesym.programs.request import Request

_USUAL = Request()


def make(model: Model, request: Request = _USUAL, *, tested: bool = False, asked: bool = True) -> Program:
    """The program of a model by the evaluator that `choose` takes.

    Args:
        model: dimensionless, with its tolerance.
        request: the evaluator, precision and aim.
        tested: whether it has reference values, for a self-test.
        asked: whether more may be spent on an evaluator that is requested by its name.

    Raises:
        ToleranceError: where no evaluator, or not the one requested, meets the tolerance.
        CostError: where the one requested would cost too much.
    """
    _, form, why, model = choose(model, request.evaluator, request.precision, request.optimize, asked=asked)
    happening = events(model, form.real) if model.network.corners else None
    ends = contact_ends(model, form.real)
    provenance = Provenance(model, why, request.options(model), ends, happening, step=request.step)
    return _finish(model, form, provenance, tested)


def program(model: Model, form: Form, *, tested: bool = False) -> Program:
    """The program of an evaluator that there is already, whatever its bound."""
    return _finish(model, form, Provenance(model, form.summary), tested)


def _finish(model: Model, form: Form, provenance: Provenance, tested: bool) -> Program:
    return form.program(provenance, reference=form.reference(model) if tested else None)
