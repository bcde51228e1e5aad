"""Accelerations of what has no mass: their integral is the velocity, closed forms, sums of modes, and refusals."""

from __future__ import annotations

from fractions import Fraction
from random import Random
from typing import Any

import numpy as np
import pytest
from flint import fmpq

import wavesym
from wavesym.errors import WavesymError
from wavesym.exact.arrivals import arrivals, identically_zero
from wavesym.exact.joints.joint_motion import JointMotion
from wavesym.exact.reference import Reference
from wavesym.numbers.doubles import rational
from wavesym.programs.choice import attempt
from wavesym.programs.making import make
from wavesym.programs.request import Request
from wavesym.scene import Scene, lower

GAUSS, WEIGHTS = np.polynomial.legendre.leggauss(12)


def chain(parts: list[Any], load: Any, until: object, accelerated: list[object], **more: Any) -> Scene:
    output = {"until": until, "acceleration": accelerated, "velocity": accelerated, **more.pop("output", {})}
    return Scene(name="made", system={"type": "chain", "parts": parts, **more}, load=load, output=output)


def ramps(at: str, random: Random) -> dict[str, Any]:
    """Loads that do not jump, some close after each other."""
    times = sorted({Fraction(random.randrange(20), random.choice([3, 4, 7])) for _ in range(3)})
    return {"at": at, "times": [str(t) for t in times], "ramps": [random.randrange(-5, 6) or 1 for _ in times]}


def drawn(random: Random) -> Scene:
    """A chain of rods with and without masses, springs and dashpots, read inside rods and at its ends."""
    parts: list[Any] = [{"joint": True, "dashpot": random.choice([0, "1/3"]), "name": "n0"}]
    x, places = Fraction(0), list[object]()
    for k in range(1, random.randrange(2, 5)):
        length = Fraction(random.randrange(1, 7), random.choice([2, 3]))
        parts.append({"rod": str(length), "impedance": random.randrange(1, 4)})
        places.append(str(x + length * Fraction(random.randrange(1, 9), 9)))
        x += length
        kinds: list[dict[str, Any]] = [{"joint": True, "dashpot": "1/2"}, {"mass": "1/2"}, {"mass": 2, "spring": 3}]
        parts.append({**random.choice(kinds), "name": f"n{k}"})
    parts += [{"rod": "3/2"}, "free"]
    places += [0, str(x + Fraction(3, 2)), str(x)]
    loaded = random.sample([part["name"] for part in parts if isinstance(part, dict) and "name" in part], 2)
    return chain(parts, [ramps(name, random) for name in loaded], "9", list(dict.fromkeys(places)))


def worst_integral(scene: Scene) -> float:
    """How far integrals of accelerations are from what velocities gain, relative to the largest acceleration."""
    reference = Reference(lower(scene))
    edges = np.array([*reference.breakpoints(), reference.tau_max])
    edges = edges[np.append(True, np.diff(edges) > 1e-9)]
    inner = (edges[:-1, None] + np.diff(edges)[:, None] * (GAUSS + 1) / 2).ravel()
    taus = np.concatenate([inner, edges])
    values = np.array(reference.values(np.sort(taus).tolist()))[:, np.argsort(np.argsort(taus))]
    velocity, acceleration = np.split(values, 2)
    gained = np.diff(velocity[:, len(inner) :])
    summed = (acceleration[:, : len(inner)].reshape(len(gained), -1, len(GAUSS)) @ WEIGHTS) * np.diff(edges) / 2
    return float(np.max(np.abs(summed - gained)) / np.max(np.abs(acceleration)))


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", [2, 3, 4, *(pytest.param(seed, marks=pytest.mark.slow) for seed in (0, 1, 5))])
def test_the_integral_of_an_acceleration_is_what_the_velocity_gains(seed: int) -> None:
    assert worst_integral(drawn(Random(seed))) < 1e-12


def test_a_law_of_derivatives_that_is_wrong_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    right = JointMotion.accelerations

    def wrong(self: JointMotion, forces: Any, rates: Any, velocities: Any, prescribed: Any) -> Any:
        return right(self, forces, forces, velocities, prescribed)  # s in place of s'

    monkeypatch.setattr(JointMotion, "accelerations", wrong)
    parts = [
        {"joint": True, "name": "a"},
        {"rod": 1},
        {"mass": 1},
        {"spring": 2, "dashpot": 1},
        {"joint": True, "dashpot": 1},
        {"rod": 1},
        "free",
    ]
    scene = chain(parts, [{"at": "a", "times": [0], "ramps": [1]}], 4, ["3/2"])
    assert worst_integral(scene) > 1e-3
    monkeypatch.undo()
    assert worst_integral(scene) < 1e-12


@pytest.mark.slow
def test_programs_are_within_their_bounds() -> None:
    model = lower(drawn(Random(4)))
    form = attempt(model, "pieces").form
    assert form is not None
    taus = np.sort(np.random.default_rng(4).uniform(0, 9, 60))
    exact = np.array(Reference(model).values(taus.tolist()))
    program = make(model)
    for own, right, output in zip(program.evaluate(taus), exact, program.outputs, strict=True):
        assert np.max(np.abs(own - right)) <= output.bound * output.largest * (1 + 1e-9)


def test_a_layer_on_an_absorbing_base_is_a_sum_of_reflections() -> None:
    """f(t) = F/(Z + c) + (Z - c)/(Z + c) f(t - 2 T), and the surface's acceleration is 2 f'(t - T)."""
    samples = [0, 3, -1, 4, 1, -5, 9, 2, 0]
    parts = [{"joint": True, "dashpot": 3, "name": "rock"}, {"rod": "1/2", "impedance": 2}, "free"]
    load = [{"at": "rock", "spacing": "1/8", "samples": samples}]
    scene = chain(parts, load, 6, ["1/2", "1/5"], output={"tolerance": "1e-10"})
    slopes = np.append(np.diff(samples) * 8.0, 0.0)

    def wave(t: np.ndarray) -> np.ndarray:
        """f'."""
        total = np.zeros(t.shape)
        for n in range(7):
            k = np.floor((t - n) * 8).astype(int)
            total += np.where(k >= 0, (-1 / 5) ** n * slopes[np.clip(k, 0, len(slopes) - 1)] / 5, 0.0)
        return total

    taus = np.random.default_rng(0).uniform(0, 6, 500)
    found = wavesym.run(scene, taus)
    assert np.max(np.abs(found["acceleration@1/2"] - 2 * wave(taus - 0.5))) < 1e-13
    assert np.max(np.abs(found["acceleration@1/5"] - wave(taus - 0.2) - wave(taus - 0.8))) < 1e-13


def test_damped_modes_have_the_acceleration_of_a_surface() -> None:
    """Each mode of a uniform column is an oscillator, whose motion under straight lines is known."""
    samples = np.array([0, 1, 3, -1, 0, 0.5, 0])
    parts = [{"motion": "acceleration", "name": "rock"}, {"rod": 1}, "free"]
    load = [{"at": "rock", "spacing": "2/5", "samples": samples.tolist()}]
    output = {"tolerance": "1/50", "velocity": []}
    scene = chain(parts, load, 6, [1], damping=0.05, output=output)
    form = attempt(lower(scene), "modes").form
    assert form is not None
    taus = np.linspace(0, 6, 61) + 0.003
    n = np.arange(4000)[:, None]
    w, z = (n + 0.5) * np.pi, 0.05
    wd, share = w * np.sqrt(1 - z * z), 2 / w * (-1.0) ** n
    kinks = np.diff(np.append(0, np.diff(samples) / 0.4), append=0)
    ground = np.interp(taus, 0.4 * np.arange(len(samples)), samples)
    total = ground.copy()
    for start, slope in zip(0.4 * np.arange(len(samples)), kinks, strict=True):
        since = np.maximum(taus - start, 0.0)
        # x'' of x'' + 2 z w x' + w^2 x = -t: a step's response, as differentiated once
        total -= slope * np.sum(share * np.exp(-z * w * since) * np.sin(wd * since) / wd, axis=0)
    (own,) = make(lower(scene)).evaluate(taus[taus <= 6])
    right = total[taus <= 6]
    assert np.max(np.abs(own - right)) < float(form.error_bound) * np.max(np.abs(right)) + 1e-4


@pytest.mark.parametrize(
    ("parts", "load", "at", "why"),
    [
        (
            [{"joint": True, "name": "top"}, {"rod": 1}, "free"],
            {"at": "top", "times": [1], "steps": [2]},
            "1/2",
            "what acts at top jumps by 2 at tau = 1",
        ),
        ([{"mass": 1, "velocity": 1}, {"rod": 1}, "free"], None, "1/2", "the chain starts with a jump of velocity"),
        (
            [{"motion": "velocity", "name": "end"}, {"rod": 1}, {"rod": 1, "impedance": 2}, "fixed"],
            {"at": "end", "times": [0], "steps": [1]},
            "3/2",
            "what acts at end jumps by 1 at tau = 0",
        ),
    ],
)
def test_where_a_jump_of_velocity_passes_it_is_refused_with_what_makes_it(
    parts: list[Any], load: Any, at: str, why: str
) -> None:
    with pytest.raises(WavesymError, match="a front with a jump of velocity can pass there") as refused:
        wavesym.run(chain(parts, [load] if load else [], 3, [at], output={"velocity": []}))
    assert why in str(refused.value)
    assert f"acceleration@{at}" in str(refused.value)


def test_where_none_passes_it_is_served() -> None:
    """A step on a mass, a mass between, and a horizon that ends before."""
    top = {"at": "top", "times": [0], "steps": [1]}
    steps = chain([{"mass": 1, "name": "top"}, {"rod": 1}, "free"], [top], 3, ["1/2"])
    between = chain(
        [{"joint": True, "dashpot": 1, "name": "top"}, {"rod": 1}, {"mass": 1}, {"rod": 1}, "free"], [top], 5, ["3/2"]
    )
    before = chain([{"joint": True, "name": "top"}, {"rod": 2}, "free"], [top], "1/2", [1])
    for scene in (steps, between):
        assert worst_integral(scene) < 1e-12
    assert not np.any(wavesym.run(before)["acceleration@1"])
    assert wavesym.run(steps, [0.75])["acceleration@1/2"] == pytest.approx(np.exp(-0.25), rel=1e-15)


@pytest.mark.parametrize(("until", "zero"), [("3/2", True), ("151/100", False)])
def test_an_acceleration_that_begins_at_the_end_of_the_horizon(until: str, zero: bool) -> None:
    """Under a parabola of velocity it begins without a jump; under a ramp of force with one, which is seen."""
    moved = chain(
        [{"motion": "acceleration", "name": "g"}, {"rod": 3}, "free"],
        [{"at": "g", "times": [0], "ramps": [1]}],
        until,
        ["3/2"],
    )
    pushed = chain(
        [{"joint": True, "name": "g"}, {"rod": 3}, "free"], [{"at": "g", "times": [0], "ramps": [1]}], until, ["3/2"]
    )
    for scene, seen in ((moved, not zero), (pushed, True)):
        model = lower(scene)
        horizon = rational(model.horizon())
        velocity, acceleration = identically_zero(model, horizon)
        assert acceleration is not seen
        assert (arrivals(model, horizon)[1] is not None) is seen
        assert velocity is zero
        assert bool(np.any(wavesym.run(scene)["acceleration@3/2"])) is seen
        program = attempt(model, "pieces").form
        assert program is not None
        assert (program.outputs[1].bound == 0) is not seen


def test_a_march_has_those_of_places_without_mass(thorough: bool) -> None:
    """As velocities under the derivatives of loads: within its bound of exact values; where these jump it says so."""
    served = 0
    for seed in range(12 if thorough else 6):
        model = lower(drawn(Random(seed))).tolerating(fmpq(1, 10**6))
        tried = attempt(model, "march")
        if tried.form is None:
            assert "no place without mass is supported where" in tried.refusal or "common measure" in tried.refusal
            continue
        served += 1
        if served > 2 and not thorough:
            break
        program = make(model, Request("march"))
        taus = np.linspace(0, program.tau_max, 101)
        exact = np.array(Reference(model).values(taus.tolist()))
        for values, truth, output in zip(program.evaluate(taus), exact, program.outputs, strict=True):
            assert np.max(np.abs(values - truth)) <= output.bound * np.max(np.abs(truth)) * (1 + 1e-9)
    assert served >= (4 if thorough else 2)


def test_an_acceleration_that_jumps_with_a_load_is_no_march() -> None:
    """A force that jumps is felt at once at a free end, a ramp of it is not."""
    parts = [{"joint": True, "name": "top"}, {"rod": 2}, {"mass": 1}]
    for key, served in (("steps", False), ("ramps", True)):
        load = {"at": "top", "times": [1], key: [1]}
        model = lower(chain(parts, [load], "1/2" if key == "steps" else 4, [1]))
        tried = attempt(model, "march")
        assert (tried.form is not None) is served
        assert served or "a load jumps: what acts at top jumps by 1 at tau = 1 (write a steep ramp" in tried.refusal
