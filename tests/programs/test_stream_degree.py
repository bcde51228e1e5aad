"""The degree of a stream: the least that will do, found by few marches of the horizon."""

from dataclasses import replace
from fractions import Fraction

import pytest

from wavesym.numbers.doubles import nearest
from wavesym.numbers.reals import DOUBLE
from wavesym.programs.march import evaluator
from wavesym.programs.march.bound import judge
from wavesym.programs.march.evaluator import first_degree
from wavesym.programs.request import Request
from wavesym.programs.stream import making
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
