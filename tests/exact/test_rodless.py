"""Chains without rods: masses, springs, dashpots and gears alone, against dense matrices."""

from __future__ import annotations

from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest

import wavesym
from wavesym.cli import main
from wavesym.errors import UnservedError, WavesymError
from wavesym.numbers.arrays import Array
from wavesym.programs.choice import attempt
from wavesym.programs.making import make
from wavesym.programs.request import Request
from wavesym.scene import Scene, lower


class Dense:
    """M u'' + C u' + K u = F of a chain of masses m0, m1, ... with links between them and one geared branch."""

    def __init__(self, random: Random, *, damped: bool) -> None:
        def pick(*values: float) -> float:
            return random.choice(values)

        def dashpot() -> float:
            return pick(0.0, 0.25, 0.5) if damped else 0.0

        count = random.randrange(2, 5)
        self.ratio = pick(2.0, -0.5, 1.5)
        size = count + 1
        self.mass = np.diag([pick(0.5, 1.0, 1.0, 3.0) for _ in range(size)])
        self.stiffness, self.damping = np.zeros((size, size)), np.zeros((size, size))
        parts: list[Any] = []
        for k in range(count):
            spring, held = pick(0.0, 0.0, 2.0), dashpot()
            self.stiffness[k, k] += spring
            self.damping[k, k] += held
            parts.append({"mass": self.mass[k, k], "spring": spring, "dashpot": held, "name": f"m{k}"})
            if k + 1 < count:
                parts.append(self._link(k, k + 1, 1.0, pick(1.0, 1.0, 4.0), dashpot()))
        if pick(0, 1):
            parts += [{"spring": 1}, "fixed"]
            self.stiffness[count - 1, count - 1] += 1
        wheel, at = pick(0.0, 0.75), random.randrange(count)
        self.mass[at, at] += self.ratio**2 * wheel
        branch: list[Any] = [{"mass": wheel}] if wheel else []
        branch += [self._link(at, count, self.ratio, 2.0, dashpot()), {"mass": self.mass[count, count], "name": "tip"}]
        self.names = [*(f"m{k}" for k in range(count)), "tip"]
        self.system = {
            "type": "chain",
            "parts": parts,
            "branch": [{"from": f"m{at}", "name": "b", "ratio": self.ratio, "parts": branch}],
        }

    def _link(self, left: int, right: int, ratio: float, spring: float, dashpot: float) -> dict[str, float]:
        pair = np.zeros(len(self.mass))
        pair[left], pair[right] = -ratio, 1.0
        self.stiffness += spring * np.outer(pair, pair)
        self.damping += dashpot * np.outer(pair, pair)
        return {"spring": spring, "dashpot": dashpot}

    def scene(self, **more: Any) -> Scene:
        every = dict.fromkeys(("displacement", "velocity", "acceleration"), self.names)
        load = [{"at": "m0", "times": [0, "1/3"], "steps": [0, 2], "ramps": [1, -1]}]
        return Scene(name="bare", system=self.system | more, load=load, output={"until": 5, **every})

    @property
    def matrix(self) -> Array:
        size, inverse = len(self.mass), np.linalg.inv(self.mass)
        return np.block([[np.zeros((size, size)), np.eye(size)], [-inverse @ self.stiffness, -inverse @ self.damping]])

    def responses(self, taus: Array) -> Array:
        """Velocities, places and accelerations under that load, by exponentials of a matrix that makes it, too."""
        size = len(self.mass)
        grown = np.zeros((2 * size + 2, 2 * size + 2))
        grown[: 2 * size, : 2 * size] = self.matrix
        grown[size, 2 * size] = 1 / self.mass[0, 0]
        grown[2 * size, 2 * size + 1] = 1.0

        def moved(state: Array, time: float) -> Array:
            return np.asarray(expm(grown * time) @ state)

        begin = np.zeros(2 * size + 2)
        begin[-1] = 1.0
        later = moved(begin, 1 / 3)
        later[2 * size :] += [2.0, -1.0]
        rows = []
        for tau in taus:
            state = moved(begin, tau) if tau < 1 / 3 else moved(later, tau - 1 / 3)
            rows.append([*state[size : 2 * size], *state[:size], *(grown @ state)[size : 2 * size]])
        return np.array(rows).T


def expm(matrix: Array) -> Array:
    """By its series on a small part, squared."""
    halvings = max(0, int(np.ceil(np.log2(float(np.linalg.norm(matrix)) + 1e-9))) + 3)
    small, total, term = matrix / 2**halvings, np.eye(len(matrix)), np.eye(len(matrix))
    for k in range(1, 20):
        term = term @ small / k
        total = total + term
    for _ in range(halvings):
        total = total @ total
    return total


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", range(6))
def test_motions_are_exponentials_of_a_matrix(seed: int) -> None:
    dense = Dense(Random(seed), damped=seed % 2 == 1)
    taus = np.sort(np.random.default_rng(seed).uniform(0, 5, 25))
    right = dense.responses(taus)
    scene = dense.scene()
    found = wavesym.run(scene, taus)
    own = np.array([found[name] for name in found.outputs])
    assert np.max(np.abs(own - right)) < 1e-12 * np.max(np.abs(right))
    pieces = make(lower(scene)).evaluate(taus)
    assert np.max(np.abs(pieces - right) / np.max(np.abs(right), axis=1, keepdims=True)) < 1e-9


@pytest.mark.parametrize("seed", range(8))
def test_modes_are_eigenvalues_and_all_are_found(seed: int) -> None:
    dense = Dense(Random(seed), damped=seed % 2 == 1)
    found = wavesym.modes(dense.scene(), 50)
    w = -1j * np.linalg.eigvals(dense.matrix)
    if not np.any(dense.damping):
        square = np.linalg.eigvals(np.linalg.solve(dense.mass, dense.stiffness)).real
        assert found.complete
        assert np.square([mode.omega for mode in found]) == pytest.approx(np.sort(square), rel=1e-11, abs=1e-13)
        return
    assert sum(2 if mode.damping < 1 else 1 for mode in found) == len(w), "shifts and rigid motion among them"
    w = w[(w.real > -1e-9) & (np.abs(w) > 1e-7)]
    assert [mode.omega for mode in found if mode.omega] == pytest.approx(np.sort(np.abs(w)), rel=1e-9)


@pytest.mark.parametrize("seed", [1, 2, 5])
def test_frequency_responses_are_solved_dense(seed: int) -> None:
    dense = Dense(Random(seed), damped=seed % 2 == 1)
    found = wavesym.frf(dense.scene(), [0.3, 1.7, 2.9])
    force = np.zeros(len(dense.mass))
    force[0] = 1.0
    for k, w in enumerate([0.3, 1.7, 2.9]):
        right = np.linalg.solve(dense.stiffness + 1j * w * dense.damping - w * w * dense.mass, force)
        assert [found[f"displacement@{name}"][k] for name in dense.names] == pytest.approx(right, rel=1e-12)
        assert [found[f"acceleration@{name}"][k] for name in dense.names] == pytest.approx(-w * w * right, rel=1e-12)


@pytest.mark.parametrize("dashpot", [0, "1/50"])
def test_programs_of_modes_have_all_modes_and_are_right(dashpot: object) -> None:
    """Without and with modal damping, and with a dashpot; where ground and loads are."""
    parts = [
        {"motion": "acceleration", "name": "g"},
        {"spring": 1},
        {"mass": 2, "name": "a"},
        {"spring": 3, "dashpot": dashpot},
        {"mass": 1, "name": "b"},
    ]
    load = [{"at": "g", "spacing": "1/2", "samples": [0, 1, -2, 1, 0]}]
    output = {"until": 6, "displacement": ["b"], "relative": ["a"], "acceleration": ["b"]}
    scene = Scene(name="shaken", system={"type": "chain", "parts": parts}, load=load, output=output)
    form = attempt(lower(scene), "modes").form
    assert form is not None
    assert form.error_bound < 1e-10
    taus = np.linspace(0, 6, 49)
    exact = wavesym.run(scene, taus)
    right = np.array([exact[name] for name in exact.outputs])
    own = make(lower(scene), Request(evaluator="modes")).evaluate(taus)
    bounds = np.array([output.bound * output.largest for output in form.outputs])[:, None]
    assert np.all(np.abs(own - right) <= bounds * (1 + 1e-9) + 1e-15)


def test_units_are_metres_seconds_and_kilograms() -> None:
    """One oscillator: 4 N/m on 1 kg under 1 N is at (1 - cos 2 t)/4."""
    parts = ["fixed", {"spring": "4 N/m"}, {"mass": "1 kg", "name": "bob"}]
    load = [{"at": "bob", "times": ["0 s"], "steps": ["1 N"]}]
    output = {"until": "3 s", "displacement": ["bob"]}
    scene = Scene(name="bob", units={}, system={"type": "chain", "parts": parts}, load=load, output=output)
    found = wavesym.run(scene, [1.0, 2.5])
    assert found["displacement@bob"] == pytest.approx((1 - np.cos([2.0, 5.0])) / 4, rel=1e-14)
    (mode,) = wavesym.modes(scene)
    assert mode.omega == pytest.approx(2, rel=1e-15)


def test_what_is_of_rods_says_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = Dense(Random(0), damped=False).scene()
    model = lower(scene)
    assert "no rod, and a march is of rods; take pieces or modes" in attempt(model, "march").refusal
    for refused in (
        lambda: wavesym.plot(scene, kind="xt"),
        lambda: wavesym.report(scene, tmp_path / "x.html"),
        lambda: wavesym.api.advise(scene, 0.01),
    ):
        with pytest.raises(UnservedError, match="no rod, and "):
            refused()
    wavesym.plot(scene, tmp_path / "x.svg")
    assert wavesym.summary(scene)["displacement@m0"].max.value > 0
    file = tmp_path / "bare.toml"
    head = 'name = "bare"\n[system]\ntype = "chain"\n'
    for parts, why in (
        ('[{ mass = 1 }, "contact", { mass = 1 }]', "contacts alone; write"),
        ("[{ mass = 1 }]", "no rod, spring or dashpot; write"),
    ):
        file.write_text(f"{head}parts = {parts}\n")
        assert main(["modes", str(file)]) == 2
        assert why in capsys.readouterr().err


@pytest.mark.parametrize(
    ("wheel", "why"),
    [
        (
            {"mass": 1, "name": "w"},
            "name: what stands first in a branch is part of its node, and has the name of that; leave it out",
        ),
        ({"mass": 1, "velocity": 2}, "velocity: what stands first in a branch is part of its node"),
        ("fixed", '"fixed" first; write a mass, or what holds the branch to its node'),
    ],
)
def test_a_wheel_is_of_its_node(wheel: object, why: str) -> None:
    parts = [{"mass": 1, "name": "a"}, {"spring": 1}, {"mass": 1}]
    branch = [{"from": "a", "name": "b", "ratio": 3, "parts": [wheel]}]
    with pytest.raises(WavesymError, match=why):
        Scene(name="geared", system={"type": "chain", "parts": parts, "branch": branch}, output={"until": 1})


def test_a_bare_wheel_adds_its_inertia_times_the_square_of_its_ratio() -> None:
    def mode(parts: list[Any], branch: list[Any]) -> float:
        system = {"type": "chain", "parts": parts, "branch": branch}
        return wavesym.modes(Scene(name="g", system=system, output={"until": 1, "velocity": ["a"]}), 2)[1].omega

    wheel = [{"from": "a", "name": "b", "ratio": -3, "parts": [{"mass": 2}]}]
    end = [{"spring": 5}, {"mass": 1}]
    assert mode([{"mass": 1, "name": "a"}, *end], wheel) == pytest.approx(np.sqrt(5 * (1 + 1 / 19)), rel=1e-15)
    rod = [{"rod": 1}, "free"]
    assert mode([{"mass": 1, "name": "a"}, *rod], wheel) == mode([{"mass": 19, "name": "a"}, *rod], [])
