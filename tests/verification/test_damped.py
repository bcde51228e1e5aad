"""Verify, where modes are damped: elements see programs that are right, and those that are damped otherwise."""

from dataclasses import replace

import pytest
from flint import fmpq

from wavesym.errors import ToleranceError
from wavesym.mechanics.damping import Damping
from wavesym.scene import Scene, lower
from wavesym.verification import damped as module
from wavesym.verification.report import verify


@pytest.fixture(autouse=True)
def few(monkeypatch):
    monkeypatch.setattr(module, "_MOST", 40)


def frame(**changes):
    system = {"type": "building", "m": 2, "kappa": ["1/4"] * 3, "base": "ground", "damping": "1/20", **changes}
    samples = [0, 3, 1, -4, 1, -5, 9, 2, -6, 5, 3, -5, 0]
    load = [{"spacing": "2.3", "samples": samples}]
    output = {"until": 40, "tolerance": "1e-6", "strain": ["1/3"], "acceleration": [2], "force": [0]}
    return Scene(name="frame", system=system, load=load, output=output)


def test_damped_scenes_are_verified():
    text, passed = verify([lower(frame()), lower(frame(damping={"modes": [1, 2], "ratio": "1/10"}))])
    assert passed
    assert text.count("PASS") == 6
    assert text.count("\nscene ") == 1
    assert "finite elements" in text


def test_other_damping_is_seen(monkeypatch):
    make = module.make
    monkeypatch.setattr(
        module, "make", lambda model, **tested: make(replace(model, damping=Damping((fmpq(51, 1000),))), **tested)
    )
    text, passed = verify([lower(frame())])
    assert not passed
    assert text.count("FAIL") == 3


def test_what_has_no_program_is_not_verified(monkeypatch):
    def refusing(*_, **__):
        raise ToleranceError("output.tolerance: 1e-06 cannot be met")

    monkeypatch.setattr(module, "make", refusing)
    text, passed = verify([lower(frame())])
    assert not passed
    assert (text.count("refused  FAIL"), text.count("cannot be met")) == (3, 1)
