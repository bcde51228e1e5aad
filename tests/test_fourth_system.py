"""A system is one file: one more is there for every stage, without a line elsewhere."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import chain

import numpy as np
import pytest
from flint import fmpq

import wavesym
from tests.support.braced import Braced
from tests.support.gauged import gauge
from tests.support.generated import files
from wavesym import api
from wavesym.errors import WavesymError
from wavesym.mechanics.loads import AppliedLoad
from wavesym.mechanics.network import Bar, Point
from wavesym.numbers.doubles import rational
from wavesym.running.compilation import compile_files, import_text
from wavesym.scene import Scene, lower
from wavesym.systems import SYSTEMS
from wavesym.verification.collocation import integrate
from wavesym.verification.independent import READERS, Sketch
from wavesym.verification.problem import corner_problem

FIELDS = {
    "name": "tower",
    "system": {"type": "braced", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "dashpot": ["2/7"]},
    "load": [{"times": [0, 2], "a": [1, -1], "b": [0, 0]}],
    "output": {"until": 7, "tolerance": 1e-7, "strain": ["1/2", "1+"], "velocity": [2]},
}


def braced(system: Braced) -> Sketch:
    """What integrators read of it: a building on moving ground whose last floor has a dashpot."""
    points = [Point(1 / rational(kappa)) for kappa in system.kappa[1:]]
    points[-1] = replace(points[-1], damping=rational(system.dashpot[0]) / rational(system.kappa[-1]))
    rods = [(Bar(0, 0, fmpq(1), fmpq(1), fmpq(1)),)] * len(points)
    sketch = Sketch()
    sketch.line("", [Point(fmpq(0), motion="acceleration"), *chain.from_iterable(zip(rods, points, strict=True))])
    return sketch


@pytest.fixture(autouse=True)
def fourth(monkeypatch):
    monkeypatch.setitem(SYSTEMS, "braced", Braced)
    monkeypatch.setitem(READERS, "braced", braced)


def scene() -> Scene:
    return Scene(**FIELDS)


def test_its_dashpot_brakes_the_roof():
    roof = scene().system.chain.nodes[2]
    assert (roof.damping, roof.radiation) == (fmpq(2, 7), fmpq(2, 7) + fmpq(1, 5))


def test_its_table_has_the_rate_of_the_braked_roof():
    rates = {row.rate for row in wavesym.tables(scene())}
    assert Fraction(2, 7) + Fraction(1, 5) in rates
    assert Fraction(1, 5) not in rates


@pytest.mark.quick(1)
@pytest.mark.parametrize("kind", ["closed", "pieces", "march"])
def test_its_programs_are_those_of_an_integrator_that_is_not_derived(kind):
    model = lower(scene())
    made = files(model, "all", kind)
    taus = [0.0, 0.3, 1.1, 2.0, 2.6, 3.7, 5.2, 6.9, 7.0]
    found = import_text(made["tower.py"], "tower").evaluate(np.array(taus))
    motion = integrate(corner_problem(model), 7.0, 16)
    for reading, values in zip(map(gauge, model.probes), found, strict=True):
        truth = motion.evaluate(reading, taus)
        assert np.max(np.abs(values - truth)) < 1e-6 * np.max(np.abs(truth))
    with compile_files(made, len(model.probes)) as program:
        assert program.selftest() == 0


def test_without_its_dashpot_the_integrator_sees_it():
    model = lower(scene())
    free = lower(scene().with_({"system.dashpot[0]": "1e-9"}))
    values = [wavesym.evaluator(each)(6.9)[2] for each in (scene(), scene().with_({"system.dashpot[0]": "1e-9"}))]
    truth = [
        integrate(corner_problem(each), 7.0, 16).evaluate(gauge(each.probes[2]), [6.9])[0] for each in (model, free)
    ]
    assert abs(values[0] - values[1]) > 0.05
    assert np.allclose(values, truth, rtol=1e-5)


@pytest.mark.slow
def test_it_is_verified(monkeypatch):
    text, passed = api.verify([scene()], "pieces")
    assert passed, text
    monkeypatch.setitem(READERS, "braced", lambda system: braced(system.model_copy(update={"dashpot": [1]})))
    text, passed = api.verify([scene()], "pieces")
    assert not passed


def test_it_is_derived_with_its_dashpot():
    text = api.derive("braced", None)
    assert "q = b_m + kappa_m" in text
    assert api.derive("braced", 2, "latex").count("b_{2}") > 2
    assert "Here\n" not in text  # of section 2 nothing is known
    own = api.derive(scene(), None)
    assert "b_2 = 2/7" in own


def test_its_symbolic_table_is_its_table():
    merged, lines = api.symbolic_tables(scene(), 2, "csv")
    text = "".join(lines)
    assert "b_2" in text
    assert merged == []


def test_walk_polynomials_refuse_a_dashpot_in_one_line():
    with pytest.raises(WavesymError, match=r"x = 2 has a dashpot"):
        api.walks(scene(), None, 2)


def test_its_mistakes_are_one_line():
    with pytest.raises(wavesym.SceneError, match=r"system.dashpot: 2 numbers; write 1 \(1\)"):
        Scene(**FIELDS | {"system": FIELDS["system"] | {"dashpot": [1, 2]}})
    with pytest.raises(wavesym.SceneError, match='"collision", "drive", "building", "chain" or "braced"'):
        Scene(**FIELDS | {"system": {"type": "bridge"}})


def test_its_loads_are_those_of_a_building():
    assert lower(scene()).loads == (AppliedLoad("a", fmpq(0), fmpq(1)), AppliedLoad("a", fmpq(2), fmpq(-1)))
