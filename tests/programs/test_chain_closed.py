"""Closed forms of explicit chains: no program errs by more than its bound, against a Laplace expansion of the text."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from flint import arb, fmpq
from hypothesis import assume, given, settings

from tests.exact.test_chain_truth import STEPPED
from tests.exact.test_network_table import LINKED
from tests.support.chains import chains
from tests.support.generated import files, program_files
from tests.support.laplace import Laplace
from wavesym.errors import UnservedError
from wavesym.exact.tables.signal import Arrival, Signal, signals
from wavesym.mechanics.model import Model
from wavesym.numbers.reals import REALS, Real
from wavesym.programs.choice import attempt, choose
from wavesym.programs.closed_form import ClosedForm, closed_form
from wavesym.running.compilation import compile_files, import_text
from wavesym.scene import Scene, lower

UNTIL = 3


def formed(model: Model, real: Real) -> ClosedForm:
    return closed_form(signals(model, real=real), model.horizon(real), real)


def instants(form: ClosedForm) -> list[float]:
    """Starts of pulses, their neighbours in the numbers of the format, and between them."""
    return [tau for tau in form.check_points[:: max(1, len(form.check_points) // 12)] if tau <= form.tau_max]


def worst(table: dict[str, Any], form: ClosedForm, values: np.ndarray, taus: list[float]) -> float:
    """The largest error over its bound; infinite where an output that is 0 is not 0."""
    expansion = Laplace(table, Fraction(form.tau_max))
    found = 0.0
    for output, row in zip(form.outputs, values, strict=True):
        terms = expansion.terms(*output.name.split("@"))
        allowed = arb(output.bound) * arb(output.largest)
        for tau, value in zip(taus, row.tolist(), strict=True):
            error = abs(terms.value(Fraction(tau)) - value)
            if allowed == 0:
                found = max(found, 0.0 if value == 0 and error.contains(0) else math.inf)
            elif output.bound < 1:
                found = max(found, float((error / allowed).lower()))
    return found


@pytest.mark.parametrize("precision", REALS)
@settings(max_examples=5)
@given(table=chains(UNTIL))
def test_numpy_keeps_its_bound(table: dict[str, Any], precision: str) -> None:
    model, real = lower(Scene(**table)), REALS[precision]
    try:
        form = formed(model, real)
    except UnservedError:
        assume(False)
        raise
    (text,) = program_files(model, form, "numpy").values()
    taus = instants(form)
    assert worst(table, form, import_text(text, "made").evaluate(np.array(taus)), taus) <= 1


@pytest.mark.quick(1)
@pytest.mark.parametrize("table", [STEPPED, LINKED], ids=["stepped", "linked"])
def test_c_keeps_its_bound_and_its_self_test(table: dict[str, Any]) -> None:
    short = {**table, "output": {**table["output"], "until": "5/2", "tolerance": "1e-9"}}
    model = lower(Scene(**short))
    form = choose(model, "closed").evaluator
    assert isinstance(form, ClosedForm)
    taus = instants(form)
    with compile_files(files(model, "c", "closed"), len(model.probes)) as program:
        assert program.selftest() == 0
        assert worst(short, form, program(taus), taus) <= 1


def test_c_in_single_precision() -> None:
    short = {**STEPPED, "output": {**STEPPED["output"], "until": 3, "tolerance": "1e-2"}}
    model = lower(Scene(**short))
    made = files(model, "c", "closed", "single")
    assert "float" in made["stepped.c"]
    with compile_files(made, len(model.probes)) as program:
        assert program.selftest() == 0


def test_a_bound_that_is_false_is_seen() -> None:
    """A pulse that is one part in 1e9 too large."""
    model = lower(Scene(**{**STEPPED, "output": {**STEPPED["output"], "until": 4}}))
    form = formed(model, REALS["double"])
    wrong = closed_form([_larger(signal) for signal in signals(model)], form.tau_max)
    (text,) = program_files(model, wrong, "numpy").values()
    taus = instants(form)
    table = {**STEPPED, "output": {**STEPPED["output"], "until": 4}}
    assert worst(table, form, import_text(text, "made").evaluate(np.array(taus)), taus) > 1


def _larger(signal: Signal) -> Signal:
    first, *rest = signal.arrivals
    increment = {rate: [c * (1 + fmpq(1, 10**9)) for c in powers] for rate, powers in first.increment.items()}
    return Signal(signal.name, (Arrival(first.time, increment), *rest))


def test_the_choice_takes_the_cheaper() -> None:
    """A jump and no more is cheaper as a sum of pulses; a chain of many reflections as pieces."""
    parts = [{"rod": 1, "velocity": 1, "strain": -1}, {"rod": 2, "impedance": 3}, "absorbing"]
    step = {"name": "jump", "system": {"type": "chain", "parts": parts}, "output": {"until": 2, "velocity": ["3/2"]}}
    model = lower(Scene(**step))
    tried = {kind: attempt(model, kind) for kind in ("closed", "pieces")}
    assert all(one.form and not one.refusal for one in tried.values())
    cheapest = min(tried, key=lambda kind: tried[kind].form.work)  # type: ignore[union-attr]
    assert choose(model).name == cheapest
    assert choose(lower(Scene(**STEPPED))).name == "pieces"
