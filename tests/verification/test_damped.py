"""Verify, where modes are damped: elements see programs that are right, and those that are damped otherwise."""

from dataclasses import replace

import numpy as np
import pytest
from flint import fmpq

from wavesym.errors import ToleranceError
from wavesym.mechanics.damping import Damping
from wavesym.methods.discrete import DiscreteModel
from wavesym.methods.elements import Elements
from wavesym.methods.network_problem import linear_problem
from wavesym.programs.making import make
from wavesym.programs.mode_sets.parameters import mode_parameters
from wavesym.programs.request import Request
from wavesym.running import mode_sets
from wavesym.running.mode_sets import ModalSets
from wavesym.scene import Scene, lower
from wavesym.scene.lowering import amplitudes
from wavesym.verification import integrations as module
from wavesym.verification import programs
from wavesym.verification.models import mode_set_names
from wavesym.verification.outcome import IntegratedOutput
from wavesym.verification.report import verify

MODES = [Request("modes")]


@pytest.fixture(autouse=True)
def few(monkeypatch):
    monkeypatch.setattr(module, "_MOST_UNKNOWNS", 40)


def frame(**changes):
    system = {"type": "building", "m": 2, "kappa": ["1/4"] * 3, "base": "ground", "damping": "1/20", **changes}
    samples = [0, 3, 1, -4, 1, -5, 9, 2, -6, 5, 3, -5, 0]
    load = [{"spacing": "2.3", "samples": samples}]
    output = {"until": 40, "tolerance": "1e-6", "strain": ["1/3"], "acceleration": [2], "force": [0]}
    return Scene(name="frame", system=system, load=load, output=output)


def verified(*scenes, requests=MODES):
    return verify([(scene, lower(scene)) for scene in scenes], requests)


def test_damped_scenes_are_verified(thorough):
    scenes = [frame(damping={"modes": [1, 2], "ratio": "1/10"}), *([frame()] if thorough else [])]
    text, passed = verified(*scenes)
    assert passed
    assert text.count("modes, NumPy") == text.count("modes, C") == len(scenes)  # C is fed sample by sample
    assert text.count("PASS") == len(scenes) * (4 + 3)  # NumPy, C and FMUs of both versions, and outputs
    assert "finite elements" in text


@pytest.mark.slow
@pytest.mark.parametrize("language", ["py", "c"])
def test_other_damping_is_seen(language, monkeypatch):
    """In C and in NumPy, each alone."""
    right, make = programs.files, programs.make

    def files(program, of):
        if of != {"py": "numpy", "c": "c"}[language]:
            return right(program, of)
        model = replace(program.provenance.model, damping=Damping((fmpq(51, 1000),)))
        return right(make(model, Request("modes"), tested=True), of)

    monkeypatch.setattr(programs, "files", files)
    text, passed = verified(frame())
    assert not passed
    assert [line.split()[1:3] for line in text.splitlines() if line.endswith("FAIL")] == [
        ["modes,", "NumPy" if language == "py" else "C"]
    ]


@pytest.mark.slow
def test_slow_modes_of_many_elements_are_not_lost_in_rounding():
    """A drive that turns freely for long: of 256 elements its modes were wrong by 6e-8, more than was allowed."""
    load = {"body": 1, "times": [0, "1/2"], "ramps": [2, -2]}
    system = {"type": "drive", "m": 1, "kappa": ["1/20"], "inertia": [1, 1], "damping": "1/50"}
    output = {"until": 80, "tolerance": 1e-8, "velocity": [1]}
    model = lower(Scene(name="free", system=system, load=[load], output=output))
    program = make(model, Request("modes"))
    problem = linear_problem(model)
    taus, finest = DiscreteModel(Elements(problem, np.array([256]))).outputs(0.2)
    _, coarser = DiscreteModel(Elements(problem, np.array([128]))).outputs(0.2)
    right = program.evaluate(np.minimum(taus, model.horizon()))
    assert np.max(np.abs((4 * finest - coarser) / 3 - right)) < 3e-9 * np.max(np.abs(right))


def test_what_has_no_program_is_not_verified(monkeypatch):
    def refusing(*_, **__):
        raise ToleranceError("output.tolerance: 1e-06 cannot be met")

    monkeypatch.setattr(programs, "make", refusing)
    text, passed = verified(frame())
    assert not passed
    assert "frame: no program is verified" in text
    assert text.count("cannot be met") == 1


@pytest.mark.slow
def test_an_output_that_elements_do_not_judge_is_not_verified(monkeypatch):
    """Elements that do not agree with each other."""

    class Noisy(DiscreteModel):
        def outputs(self, step):
            taus, values = super().outputs(step)
            values[0] += 0.1 * np.max(np.abs(values)) * (-1.0) ** (self.elements.cells[0] // 2 % 3)
            return taus, values

    monkeypatch.setattr(module, "DiscreteModel", Noisy)
    text, passed = verified(frame())
    assert not passed
    assert "frame: strain@1/3 is not verified, as no integration is exact enough to judge it" in text
    assert "acceleration@2 is not verified" not in text


def test_an_instant_that_is_there_twice_has_no_slope():
    """As the horizon may be: a program that is right was called wrong by not a number."""
    values = np.array([0.0, 1.0, 1.5])
    assert IntegratedOutput([0.0, 2.0, 2.0], values, 0.0).steepest == 0.5


@pytest.mark.slow
def test_modes_whose_numbers_are_given_are_verified(monkeypatch):
    """They pass, and one whose dampings are 2 % more is seen."""
    names = mode_set_names(lower(frame()))
    request = [Request("modes", runtime=names)]
    text, passed = verified(frame(), requests=request)
    assert passed
    assert text.count(f"runtime {' '.join(names)}, C") == 1
    right, column = ModalSets.values, 0
    for field in mode_parameters(lower(frame()), names, amplitudes(frame())).fields:
        if field.name == "damping":
            break
        column += len(field.values)

    def wrong(self, given, tau):
        other = given.copy()
        other[:, column] *= 1.02
        return right(self, other, tau)

    monkeypatch.setattr(ModalSets, "values", wrong)
    text, passed = verified(frame(), requests=request)
    assert not passed


FAULTS = {
    "more damping": ("2 * z * w * made.p12", "2.1 * z * w * made.p12"),
    "no statics": ("{p->settled[output][load].value, 0}", "{0, 0}"),
    "bars a third heavier": ("c->delay[bar] / 8;", "c->delay[bar] / 6;"),
}
QUICK = "more damping"


@pytest.mark.quick(1)
@pytest.mark.parametrize("streamed", [True, False], ids=["stream", "read"])
@pytest.mark.parametrize("fault", [pytest.param(x, marks=[pytest.mark.slow] * (x != QUICK)) for x in FAULTS])
def test_faults_in_the_c_of_modes_at_run_time_are_seen(fault, streamed, monkeypatch):
    """Where it is stepped sample by sample, and where it is read."""
    names = tuple(name for name in mode_set_names(lower(frame())) if name != "load")
    requests = [Request("modes", runtime=names, stream=streamed)]
    text, passed = verified(frame(), requests=requests)
    assert passed
    assert ("modes, stream, runtime" in text) == streamed

    def broken(right):
        def files(*arguments):
            made = right(*arguments)
            assert FAULTS[fault][0] in made["frame.c"]
            return {**made, "frame.c": made["frame.c"].replace(*FAULTS[fault])}

        return files

    monkeypatch.setattr(programs, "files", broken(programs.files))
    monkeypatch.setattr(mode_sets, "runtime_sets", broken(mode_sets.runtime_sets))
    assert not verified(frame(), requests=requests)[1]
