"""The degree of a stream: the least that will do, found by few marches of the horizon."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from flint import fmpq

from wavesym.numbers.doubles import nearest
from wavesym.numbers.reals import DOUBLE
from wavesym.programs.march import evaluator
from wavesym.programs.march.bound import judge
from wavesym.programs.march.evaluator import first_degree
from wavesym.programs.request import Request
from wavesym.programs.stream import making
from wavesym.programs.stream.interpolation import _weights
from wavesym.programs.stream.plan import inputs_of, stream_plan
from wavesym.scene import Scene
from wavesym.scene.lowering import lower


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", ["drive_equal", "building_m2", "stepped_shaft", "geared_drive"])
def test_it_is_the_least_that_will_do_and_few_are_tried(name, monkeypatch) -> None:
    scene = Scene.from_toml(name)
    output = scene.output.model_copy(update={"until": Fraction(60)})
    model = replace(lower(scene.model_copy(update={"output": output})), endless=True)
    inputs = inputs_of(model, ())
    tried = []
    monkeypatch.setattr(
        evaluator, "judge", lambda plan, degree, real: tried.append(degree) or judge(plan, degree, real)
    )
    degree = int(making.stream_program(model, Request(stream=True), inputs).constants["degree"])
    plan = stream_plan(model, inputs, DOUBLE)
    first = max(first_degree(plan.march, DOUBLE) - 8, 4)
    wanted = nearest(max(model.tolerance, making._ROUNDINGS * DOUBLE.roundoff))

    def loses(degree: int) -> bool:
        verdict = judge(plan.march, degree, DOUBLE)
        return 5 * verdict.truncation_error * max(verdict.bounds) > wanted * (
            verdict.truncation_error + verdict.rounding_error
        )

    assert not loses(degree)
    assert degree == first or loses(degree - 1)
    assert len(tried) == len(set(tried)) <= 5


@pytest.mark.parametrize(("step", "told"), [("1/8", ""), ("4", ""), ("5000/1261", "panels, or --step 4 is whole")])
def test_steps_that_end_inside_of_panels_at_ever_new_places_are_told_of(step: str, told: str) -> None:
    """With whole panels no two multiples lie in one; 1261 = 13 * 97, so that of the others none comes back for long."""
    scene = Scene.from_toml("drive_m1")
    output = scene.output.model_copy(update={"until": Fraction(2000), "tolerance": Fraction(1, 10**6)})
    model = replace(lower(scene.model_copy(update={"output": output})), endless=True)
    request = Request(stream=True, step=fmpq(*Fraction(step).as_integer_ratio()))
    plan = stream_plan(model, inputs_of(model, ()), DOUBLE, request.step)
    inside = {k * Fraction(step) % Fraction(int(plan.panel.p), int(plan.panel.q)) for k in range(500)} - {0}
    assert (len(inside) > 256) == bool(told)
    assert told in (said := making._beside_panels(plan, model, request))
    assert bool(said) == bool(told)


@pytest.mark.parametrize("count", [1, 2, 5, 8, 31])
def test_integrals_of_polynomials_are_exact(count: int) -> None:
    """Those of x^k on 0 ... 1 are 1/(k + 1), for k less than the points of the rule."""
    x = (1 + np.cos(np.pi * (2 * np.arange(count) + 1) / (2 * count))) / 2
    powers = np.arange(count)
    assert _weights(count) @ x[:, None] ** powers == pytest.approx(1 / (powers + 1.0), rel=1e-12)
