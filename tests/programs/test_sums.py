"""Programs of acceleration, force, drift and relative motion: within their bounds, in C and NumPy, times a factor."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from flint import fmpq

from tests.exact.test_sums import ALL
from tests.support.generated import files
from wavesym.errors import UnservedError
from wavesym.exact.reference import Reference
from wavesym.mechanics.model import Model
from wavesym.numbers.arrays import Array
from wavesym.programs.choice import choose
from wavesym.programs.making import program
from wavesym.programs.march.evaluator import march
from wavesym.running.compilation import compile_files, import_text
from wavesym.scene import Scene, lower

OPEN = [part for part in ALL["system"]["parts"] if part != "contact"]
MASSES = ["first", "gear", "hung", "struck", "tip", "a:0"]
CHAIN = {
    **ALL,
    "system": {**ALL["system"], "parts": OPEN},
    "output": {
        "until": "61/13",
        "velocity": ["hung"],
        "displacement": ["gear"],
        "acceleration": MASSES,
        "force": ["0", "1+", "a:1/4"],
        "drift": [1, 2, 3, "a:1"],
        "relative": ["base", "gear", "hung"],
    },
}
BUILDING = {
    "name": "building",
    "system": {"type": "building", "m": 3, "kappa": ["1/4", "1/2", "1.001", "1/5"], "base": "ground"},
    "load": [{"times": [0, "3/2"], "a": [1, -1], "b": [0, "1/7"]}],
    "output": {
        "until": "87/13",
        "displacement": [3],
        "acceleration": [1, 2, 3],
        "force": [0, "2-", "5/2"],
        "drift": [1, 3],
        "relative": [0, 1, "5/2"],
    },
}
DRIVE = {
    "name": "drive",
    "system": {"type": "drive", "m": 2, "kappa": [1, "1/2"], "inertia": [1, 2, "1/2"]},
    "load": [
        {"body": 1, "times": [0, "3/2"], "steps": [1, "-1/2"]},
        {"body": 2, "times": ["1/3"], "steps": ["1/5"]},
        {"body": 3, "times": ["1/3"], "steps": [2]},
    ],
    "output": {"until": "87/13", "acceleration": [0, 1, 2], "force": ["1+"], "drift": [1, 2]},
}
SCENES: dict[str, dict[str, Any]] = {"chain": CHAIN, "building": BUILDING, "drive": DRIVE}
KINDS = [
    pytest.param(name, kind, marks=pytest.mark.slow) if (name, kind) == ("chain", "pieces") else (name, kind)
    for name in SCENES
    for kind in ("closed", "pieces", "march")
    if (name, kind) != ("chain", "closed")
]


def model(name: str, factor: fmpq | None = None, tolerance: str = "1e-6") -> Model:
    given = SCENES[name]
    made = lower(Scene(**{**given, "output": {**given["output"], "tolerance": tolerance}}))
    if factor is None:
        return made
    return made.watching(replace(probe, factor=(-1) ** k * factor**k) for k, probe in enumerate(made.probes))


def instants(reference: Reference) -> Array:
    """Breakpoints, the doubles before them, and others."""
    breaks = np.array(reference.breakpoints())
    even = np.linspace(0, reference.tau_max, 40)
    taus = np.concatenate([breaks, np.nextafter(breaks[breaks > 0], 0), even])
    return np.unique(taus[taus <= reference.tau_max])


def missed(values: Array, reference: Reference, taus: Array, bounds: list[float]) -> float:
    """The largest error, in what is allowed."""
    exact = np.array(reference.values(taus.tolist()))
    sizes = [float(size.upper()) for size in reference.largest()]
    worst = 0.0
    for row, truth, bound, size in zip(values, exact, bounds, sizes, strict=True):
        if size == 0:
            assert bound == 0
            assert not row.any()
        else:
            worst = max(worst, float(np.max(np.abs(row - truth))) / size / (bound + 2.0**-52))
    return worst


@pytest.mark.quick(2)
@pytest.mark.parametrize(("name", "kind"), KINDS)
def test_every_program_keeps_its_bounds(name: str, kind: str) -> None:
    given = model(name, fmpq(10**9, 7))
    reference = Reference(given)
    taus = instants(reference)
    form = choose(given, kind).evaluator
    bounds = [output.bound for output in form.outputs]
    assert missed(program(given, form).evaluate(taus), reference, taus, bounds) <= 1
    assert max(bounds) <= 1e-6


@pytest.mark.quick(1)
@pytest.mark.parametrize(("name", "kind"), [("drive", "march"), ("chain", "march")])
def test_c_and_numpy_are_one(name: str, kind: str) -> None:
    given = model(name)
    reference = Reference(given)
    taus = instants(reference)
    made = files(given, "all", kind)
    bounds = [output.bound for output in choose(given, kind).evaluator.outputs]
    with compile_files(made, len(given.probes)) as built:
        c = np.array(built(taus.tolist()))
        assert built.selftest() == 0
    assert missed(c, reference, taus, bounds) <= 1
    assert missed(import_text(made[f"{given.name}.py"], given.name).evaluate(taus), reference, taus, bounds) <= 1
    header = made[f"{given.name}.h"]
    assert f"{given.name.upper()}_ACCELERATION_{'FIRST' if name == 'chain' else '1'} =" in header
    assert "strains, velocities, displacements, accelerations, forces, drifts" in header


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", SCENES)
def test_a_factor_is_a_factor(name: str) -> None:
    """Values are rounded once, and errors relative to largest values are what they were."""
    plain, scaled = model(name), model(name, fmpq(3, 10**7))
    taus = np.linspace(0.1, 4.6, 9).tolist()
    factors = [float(probe.factor) for probe in scaled.probes]
    values, others = (np.array(Reference(each).values(taus)) for each in (plain, scaled))
    np.testing.assert_allclose(others, values * np.array(factors)[:, np.newaxis], rtol=4e-16, atol=0)
    before, after = (march(each, degree=20) for each in (plain, scaled))
    for one, other, factor in zip(before.outputs, after.outputs, factors, strict=True):
        assert other.bound == pytest.approx(one.bound, rel=0.02)
        assert other.largest == pytest.approx(one.largest * abs(factor), rel=1e-6)


def test_what_a_load_does_is_read_on_its_own_panel() -> None:
    """A body that is pushed is accelerated at once, also where the push changes inside a window."""
    made = march(model("drive"))
    assert {made.plan.tracks[term.track].prescribed for term in made.plan.outputs[0].terms} == {False, True}
    before, after = program(model("drive"), made).evaluate([np.nextafter(1.5, 0), 1.5])[0]
    assert after - before == pytest.approx(-0.5, rel=1e-12)


def test_a_program_that_drops_a_load_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    given = model("drive")
    reference = Reference(given)
    taus = instants(reference)
    made = march(given)
    deaf = replace(
        made,
        plan=replace(
            made.plan,
            outputs=tuple(
                replace(
                    output, terms=tuple(each for each in output.terms if not made.plan.tracks[each.track].prescribed)
                )
                for output in made.plan.outputs
            ),
        ),
    )
    assert missed(program(given, deaf).evaluate(taus), reference, taus, [output.bound for output in made.outputs]) > 1e6


@pytest.mark.slow
def test_contacts_are_refused_by_the_march_alone() -> None:
    given = lower(Scene(**{**ALL, "output": {**CHAIN["output"], "until": 5, "tolerance": "1e-6"}}))
    form = choose(given, "pieces").evaluator
    reference = Reference(given)
    taus = instants(reference)
    bounds = [output.bound for output in form.outputs]
    assert missed(program(given, form).evaluate(taus), reference, taus, bounds) <= 1
    with pytest.raises(UnservedError, match="opens and closes"):
        choose(given, "march")
