"""A program gives, as a value, what its generated NumPy gives, bit for bit; and it holds all that it needs for that."""

import numpy as np
import pytest

from tests.support.builds import SOURCES, scene
from tests.support.generated import numpy_text
from wavesym.numbers.reals import REALS
from wavesym.programs import making
from wavesym.programs.choice import choose
from wavesym.programs.schemes import SCHEMES, names_read
from wavesym.running.compilation import import_text
from wavesym.scene import Scene, lower

COLLISION = Scene(
    name="both",
    system={"type": "collision", "m": 4, "kappa": ["1/2", "1/3"], "velocity": [1, 0]},
    output={"until": "17/3", "tolerance": "1e-2", "strain": [2], "velocity": ["1/2"], "displacement": [4]},
)
CHAIN = Scene(
    name="both",
    system={"type": "chain", "parts": [{"mass": 1, "name": "a"}, {"rod": 1}, {"rod": "3/2"}, {"mass": 2, "spring": 1}]},
    load=[{"at": "a", "times": ["1/3"], "ramps": [1]}],
    output={"until": "17/3", "tolerance": "1e-2", "strain": [2], "velocity": ["1/2"], "displacement": [1]},
)
RECORD = [{"at": "a", "spacing": "1/37", "samples": [0, 3, 1, 4, 1, 5, 9, 2, 6, 5, 3, 5, 8, 9, 7, 9, 3, 2, 3, 8]}]
SCENES = {"building": scene("both", "1e-2"), "collision": COLLISION}
each_program = pytest.mark.parametrize(("evaluator", "precision"), SOURCES)


def made(name, evaluator, precision):
    model = lower(SCENES[name])
    chosen = choose(model, evaluator, precision)
    return making.program(model, chosen.evaluator), import_text(numpy_text(model, chosen.evaluator), "both")


def same(one, other):
    assert one.dtype == other.dtype
    assert one.shape == other.shape
    assert one.tobytes() == other.tobytes()


@pytest.mark.quick(3)
@pytest.mark.parametrize("name", SCENES)
@each_program
def test_a_program_is_its_generated_numpy(name, evaluator, precision):
    program, module = made(name, evaluator, precision)
    random = np.random.default_rng(4)
    dtype = np.float64 if precision == "double" else np.float32
    taus = random.uniform(-1, program.tau_max + 1, 600).astype(dtype)
    edges = np.array([0, 1 / 3, 1, 5 / 2, program.tau_max, np.nan, -np.inf, np.inf], dtype)
    for each in (taus, np.sort(taus), edges, edges[::-1], taus.reshape(20, 30), [], 1, program.tau_max):
        same(program.evaluate(each), module.evaluate(each))
        same(program.evaluate(each), module.evaluate(each))  # again: it does not wear out
    assert program.evaluate(taus).dtype == dtype
    assert program.tau_max == module.TAU_MAX
    assert tuple(output.name for output in program.outputs) == module.OUTPUTS


@each_program
def test_its_numbers_are_of_its_format(evaluator, precision):
    program, _ = made("building", evaluator, precision)
    assert program.kernel == evaluator
    assert program.real is REALS[precision]
    assert program.provenance.reason
    assert program.error_bound == max(output.bound for output in program.outputs)
    dtype = np.float64 if precision == "double" else np.float32
    for name, table in program.tables.items():
        assert {type(number) for number in table} <= {int} or {type(number) for number in table} == {float}, name
        assert [float(dtype(number)) for number in table] == list(table), name


@pytest.mark.parametrize("kind", SCHEMES)
def test_each_table_that_a_scheme_reads_matters_to_it(kind):
    """Without one of them it is none."""
    recorded = CHAIN.with_({"load": RECORD, "system.parts[1].rod": "7/2"})
    of_chain = {"march": ("march", CHAIN), "hats": ("march", recorded), "modes": ("modes", CHAIN)}
    evaluator, scene = of_chain.get(kind, (kind, SCENES["building"]))
    model = lower(scene)
    program = making.program(model, choose(model, evaluator).evaluator)
    scheme = SCHEMES[kind]
    names, _ = names_read(scheme, program.tables, program.constants, program.tau_max)
    assert len(names) > 5
    for name in names:
        fewer = {other: table for other, table in program.tables.items() if other != name}
        with pytest.raises((KeyError, ValueError)):
            scheme(fewer, program.constants, program.tau_max, np.float64)
    only = {name: program.tables[name] for name in names}
    taus = np.linspace(0, program.tau_max, 40)
    same(scheme(only, program.constants, program.tau_max, np.float64).evaluate(taus), program.evaluate(taus))
