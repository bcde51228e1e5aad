"""Generated C is compiled strictly and run; what is wrong with it is told in one line."""

import math

import numpy as np
import pytest

from tests.support.generated import files
from wavesym.running.compilation import compile_files, import_text
from wavesym.running.toolchain import CompilerError, compiler
from wavesym.scene import Scene, lower

OUTPUTS = ("strain@0", "strain@1/3", "displacement@1")


@pytest.fixture(scope="module")
def made():
    scene = Scene(
        name="small",
        system={"type": "drive", "m": 1, "kappa": [1], "inertia": [1, 2]},
        load=[{"body": 1, "times": [0, "1/2"], "steps": [1, -1]}],
        output={"until": 4, "strain": [0, "1/3"], "displacement": [1]},
    )
    return files(lower(scene), language="all")


def test_c_and_numpy_give_the_same(made):
    taus = [0.0, 0.25, 0.5, 1.7, 4.0, -1.0, 4.1, math.nan]
    module = import_text(made["small.py"], "small")
    with compile_files(made, len(OUTPUTS)) as program:
        values = program(taus)
        assert program.names == module.OUTPUTS == OUTPUTS
        assert program.selftest() == 0
    assert values.shape == (3, 8)
    assert np.isnan(values[:, 5:]).all()
    # each is within the bound of the true value; 2: the largest value may lie between these taus
    allowed = 2 * module.ERROR_BOUND * 2 * np.nanmax(np.abs(values))
    np.testing.assert_allclose(values, module.evaluate(taus), rtol=0, atol=allowed)


def test_sample_is_eval_on_a_grid(made):
    with compile_files(made, len(OUTPUTS)) as program:
        status, values = program.sample(0.1, 0.3, 10)
        np.testing.assert_array_equal(values, program([0.1 + k * 0.3 for k in range(10)]))
        assert status == 0
        status, values = program.sample(3.0, 0.5, 4)
        assert status == 1
        assert np.isnan(values).any(axis=0).tolist() == [False, False, False, True]
        assert program.sample(0.0, 1.0, 0)[0] == 0


def test_the_self_test_can_fail(made):
    source = made["small.c"]
    changed = source.replace("return sum;", "return sum + 1e-9;", 1)
    assert changed != source
    with compile_files({**made, "small.c": changed}, len(OUTPUTS)) as program:
        assert program.selftest() == 1


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    "flaw", ["int small_extra(void) { return 0; }", "static int unused(void) { return 0; }", "syntax error"]
)
def test_a_warning_is_an_error(made, flaw):
    compiler()
    flawed = {**made, "small.c": f"{made['small.c']}\n{flaw}\n"}
    with pytest.raises(CompilerError, match=r"does not accept.*small\.c") as error, compile_files(flawed, len(OUTPUTS)):
        pass
    assert "\n" not in str(error.value)
