"""Records of any spacing: the march of one hat, added up, against exact values."""

from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from flint import fmpq

from wavesym.errors import CostError, UnservedError
from wavesym.exact.reference import Reference
from wavesym.programs.making import make
from wavesym.programs.march.evaluator import march
from wavesym.programs.request import Request
from wavesym.scene import Scene, lower
from wavesym.verification import checks, hat
from wavesym.verification.checks import records
from wavesym.verification.hat import at_samples
from wavesym.verification.reference import Known

SAMPLES = [(37 * k * k) % 101 - 50 for k in range(25)]


def record(samples, spacing="1.37", until=36, **output):
    return lower(
        Scene(
            name="record",
            system={"type": "building", "m": 3, "kappa": ["1/4", "3/5", "3/5", "1/5"], "base": "ground"},
            load=[{"spacing": spacing, "samples": samples}],
            output={"until": until, "strain": ["1/3", "2+"], "velocity": [3], "displacement": ["1/2"], **output},
        )
    )


@pytest.mark.parametrize("first", [0, 7], ids=["from nothing", "a jump first"])
def test_a_record_that_the_march_refuses_is_what_it_is(first):
    model = record([first, *SAMPLES])
    with pytest.raises(
        CostError, match=r"times at a spacing of 137/100 have 26 different fractional parts, at most 16"
    ):
        march(model)
    found = at_samples(model)
    exact = np.array(Reference(model).values(found.taus.tolist()))
    assert len(found.taus) == 27  # and one after the last sample
    assert np.all(np.abs(found.values - exact).max(axis=1) <= found.allowed)
    assert np.all(found.allowed < 1e-8 * np.abs(exact).max(axis=1))


def test_a_hat_of_another_width_is_seen(monkeypatch):
    model = record([0, *SAMPLES])
    exact = np.array(Reference(model).values(at_samples(model).taus.tolist()))
    made = hat.make

    def wider(given, request):
        return made(
            replace(given, loads=tuple(replace(load, time=load.time * fmpq(101, 100)) for load in given.loads)), request
        )

    monkeypatch.setattr(hat, "make", wider)
    found = at_samples(model)
    assert np.all(np.abs(found.values - exact).max(axis=1) > 1e3 * found.allowed)


def test_a_chain_with_loads_at_two_places():
    parts = [{"mass": 2, "name": "a"}, {"rod": 1}, {"mass": 1, "name": "b"}, {"rod": "3/2", "impedance": 2}, "fixed"]
    load = [
        {"at": "a", "spacing": "0.31", "samples": [1, 2, -1, 3, 0, 1, 5] * 4},
        {"at": "b", "spacing": "0.62", "samples": [0, 2, -1, 3, 0, 1, 5] * 3},
    ]
    model = lower(
        Scene(
            name="chain",
            system={"type": "chain", "parts": parts},
            load=load,
            output={"until": 9, "strain": ["1/2", "2"], "velocity": ["a"], "displacement": ["b"]},
        )
    )
    found = at_samples(model)
    exact = np.array(Reference(model).values(found.taus.tolist()))
    assert np.all(np.abs(found.values - exact).max(axis=1) <= found.allowed)


def test_loads_that_are_no_record():
    jump = [{"times": [0, 3], "a": [1, 1], "b": [0, 0]}]
    building = record([0, 1])
    with pytest.raises(UnservedError, match="a jumps at tau = 3"):
        at_samples(
            lower(
                Scene(
                    name="jump",
                    system=Scene.from_toml("building_m2").system,
                    load=jump,
                    output={"until": 5, "velocity": [1]},
                )
            )
        )
    with pytest.raises(UnservedError, match=r"M1|M2"):
        at_samples(lower(Scene.from_toml("drive_m1")))
    with pytest.raises(UnservedError, match="no load that changes after tau = 0"):
        at_samples(replace(building, loads=building.loads[:1] * 0))


@cache
def made():
    """A record that modes take, with their program."""
    model = record([0, *SAMPLES], until=90, strain=["1/3"], velocity=[3], displacement=[], tolerance="1e-5")
    return model, make(model, Request(evaluator="modes"))


@pytest.fixture
def modal(monkeypatch):
    model, program = made()
    monkeypatch.setattr(checks, "make", lambda _: program)
    return model, program


def test_modes_agree_with_the_march_of_a_hat(modal):
    """Motion to 1e-11, strain to what is proved of the modes that are left out."""
    model, program = modal
    strain, velocity = records(Known(model, model, 90.0, (), ()))
    assert strain.passed
    assert velocity.passed
    assert float(velocity.cells["error"]) < 1e-11
    assert float(velocity.cells["allowed"]) < 1e-7
    assert float(strain.cells["error"]) < program.outputs[0].bound < 1e-5


def test_modes_that_are_wrong_are_seen(modal, monkeypatch):
    model, program = modal
    right = program.evaluate
    wrong = SimpleNamespace(evaluator="modes", outputs=program.outputs, evaluate=lambda taus: right(taus + 1e-4))
    monkeypatch.setattr(checks, "make", lambda _: wrong)
    assert not any(outcome.passed for outcome in records(Known(model, model, 90.0, (), ())))


def test_what_a_march_does_not_serve_is_said(modal, monkeypatch):
    model, _ = modal
    jumps = replace(model, loads=(*model.loads, replace(model.loads[0], source="a", time=fmpq(3))))
    (outcome,) = records(Known(jumps, jumps, 90.0, (), ()))
    assert (outcome.passed, outcome.cells) == (True, {"march": "refused"})
    assert "jumps at tau = 3" in outcome.note
