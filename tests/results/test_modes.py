"""Modes of vibration against published numbers, closed forms and sums that are known."""

from __future__ import annotations

import json
from math import atan, pi, sqrt
from pathlib import Path

import numpy as np
import pytest
from flint import arb, ctx

import wavesym
from wavesym.cli import main
from wavesym.scene import Scene

ROD = {"name": "rod", "output": {"until": 1, "velocity": ["1"]}}


def chain(*parts: object, name: str = "chain") -> Scene:
    """A chain without loads, whose outputs do not matter."""
    return Scene(name=name, system={"type": "chain", "parts": list(parts)}, output={"until": 1, "velocity": ["1/2"]})


def test_a_rod_has_the_frequencies_of_its_closed_form() -> None:
    held = wavesym.modes(chain("fixed", {"rod": 1}, "free"), 5)
    assert held.frequencies == pytest.approx([(2 * n - 1) / 4 for n in range(1, 6)], rel=1e-15)
    free = wavesym.modes(chain("free", {"rod": 1}, "free"), 5)
    assert free.frequencies == pytest.approx([n / 2 for n in range(5)], rel=1e-15)
    assert (free[0].omega, free[0].period, free[0].effective_mass) == (0.0, None, None)
    assert held.complete
    assert all(mode.radius < 1e-15 for mode in held)


def test_a_radius_holds_the_rounding_of_the_printed_number() -> None:
    """pi/2 and its odd multiples are no doubles."""
    for n, mode in enumerate(wavesym.modes(chain("fixed", {"rod": 1}, "free"), 5), 1):
        with ctx.workprec(128):
            error = abs(arb.pi() * (2 * n - 1) / 2 - mode.omega)
        assert 0 < error <= mode.radius


@pytest.mark.parametrize("link", [{"spring": 9}, {}])
def test_rigid_motion_stays_the_first_mode_where_no_dashpot_resists_it(link: dict[str, int]) -> None:
    """Two bodies alone: w = 0, and the zeros of (K + i w c) (1/m + 1/M) = w^2; a dashpot to ground leaves no motion."""

    def bodies(*parts: object) -> Scene:
        return Scene(name="bodies", system={"type": "chain", "parts": parts}, output={"until": 1, "velocity": ["0-"]})

    dashpot = link | {"dashpot": "1/10"}
    free = wavesym.modes(bodies({"mass": 1}, dashpot, {"mass": 2}), 3)
    *shifts, _ = free.modes[1:]
    assert [(mode.omega, mode.damping, tuple(mode.shape.values())) for mode in shifts] == [(0.0, 1.0, (0.0, 1.0))] * (
        not link
    ), "of two bodies that nothing but a dashpot ties"
    k, c = link.get("spring", 0) * 1.5, 0.15
    swinging = [sqrt(k)] if k else [c]  # without a spring the two creep towards each other
    assert [mode.omega for mode in (free[0], *free.modes[-1:])] == pytest.approx([0.0, *swinging], rel=1e-14)
    assert (free[0].period, free[0].damping, set(free[0].shape.values())) == (None, 0.0, {1.0})
    assert free[len(free) - 1].damping == pytest.approx(c / (2 * sqrt(k)) if k else 1.0, rel=1e-14)
    assert free.complete
    held = wavesym.modes(bodies({"mass": 1, "dashpot": 1}, dashpot, {"mass": 2}), 3)
    assert [(mode.omega, mode.damping) for mode in held if mode.omega == 0] == [(0.0, 1.0)] * (1 if link else 2)
    assert json.loads(free.json(shapes=True))["modes"][0]["omega"] == 0.0


def test_effective_masses_are_those_of_a_rod_and_add_up_to_all() -> None:
    """A held rod: 8/((2 n - 1) pi)^2 of its mass in mode n."""
    held = wavesym.modes(chain("fixed", {"rod": 1}, "free"), 40)
    expected = [8 / ((2 * n - 1) * pi) ** 2 for n in range(1, 41)]
    assert [mode.effective_mass for mode in held] == pytest.approx(expected, rel=1e-12)
    mixed = chain(
        "fixed", {"spring": 3}, {"mass": 2}, {"rod": 1}, {"mass": "1/2", "spring": "1/4"}, {"rod": "1/3"}, "fixed"
    )
    found = wavesym.modes(mixed, 60)
    assert 0.99 < sum(mode.effective_mass or 0.0 for mode in found) < 1
    assert next(iter(found[0].shape)) == "fixed"  # the wall before the spring: its place is that of the mass, too


def test_nodes_at_rest_are_0_in_shapes() -> None:
    """Two rods of length 1 with a mass between: at k pi it is at rest, and both rods vibrate: 1 along them, 0 there."""
    parts = ["fixed", {"rod": 1}, {"mass": "1/3", "name": "m"}, {"rod": 1}, "fixed"]
    scene = chain(*parts, name="two").with_({"load": [{"at": "m", "times": [0], "steps": [1]}]})
    found = wavesym.modes(scene, 6, points=5)
    resting = [mode for mode in found if abs(mode.omega / pi - round(mode.omega / pi)) < 1e-12]
    assert len(resting) == 3
    for mode in resting:
        assert set(mode.shape.values()) == {0}
        assert mode.loads["m"].factor == 0
        along = np.abs(found.line_shapes[0].displacements[mode.number - 1])
        assert along.max() == pytest.approx(1)
    assert all(mode.shape["m"] == 1 for mode in found if mode not in resting)


def test_participation_of_a_mode_whose_nodes_rest_is_of_its_rods() -> None:
    """sin(k pi x) on two rods of length 1, the ground moves at x = 0: the integral of it times 1 - x/2 is 1/(k pi)."""
    parts = [{"motion": "acceleration", "name": "g"}, {"rod": 1}, {"mass": "1/3"}, {"rod": 1}, "fixed"]
    for mode in wavesym.modes(chain(*parts), 6):
        k = round(mode.omega / pi)
        if abs(mode.omega / pi - k) < 1e-12:
            assert abs(mode.loads["g"].factor) == pytest.approx(1 / (k * pi), rel=1e-12)


def test_a_dashpot_makes_frequencies_complex() -> None:
    """A held rod of impedance 1 that ends in a dashpot r: exp(2 i w) = -(1 - r)/(1 + r), so Im w is constant."""
    r = 0.5
    found = wavesym.modes(chain("fixed", {"rod": 1}, {"joint": True, "dashpot": "1/2"}), 4)
    assert found.complete
    decay = -np.log((1 - r) / (1 + r)) / 2
    for n, mode in enumerate(found, 1):
        w = complex((2 * n - 1) * pi / 2, decay)
        assert mode.omega == pytest.approx(abs(w), rel=1e-12)
        assert mode.damping == pytest.approx(w.imag / abs(w), rel=1e-12)
        assert abs(mode.decay - decay) <= mode.radius + 4e-16
    assert f"{decay:.7g}" in found.text().splitlines()[1].split()
    assert "decay [1/tau]" in found.text().splitlines()[0]
    assert [row["decay"] for row in json.loads(found.json())["modes"]] == [mode.decay for mode in found]
    held = wavesym.modes(chain("fixed", {"rod": 1}, "free"), 2)
    assert "decay" not in held.text()
    assert [mode.decay for mode in held] == [0.0, 0.0]
    assert held.csv().splitlines()[0].split(",")[4:7] == ["damping", "decay", "radius"]


@pytest.mark.parametrize(("spring", "decay"), [("400 N/m", 3.0), ("8 N/m", 3 - sqrt(5))])
def test_decay_is_that_of_a_mass_on_a_spring_and_a_dashpot(spring: str, decay: float) -> None:
    """2 s^2 + 12 s + k = 0, in kg, N and s: the real part, and of two real roots the slower one."""
    parts = ["fixed", {"spring": spring, "dashpot": "12 N*s/m"}, {"mass": "2 kg", "name": "m"}]
    output = {"until": "1 s", "velocity": ["m"]}
    scene = Scene(name="bob", units={"time": "ms"}, system={"type": "chain", "parts": parts}, output=output)
    first = wavesym.modes(scene, 1)[0]
    assert first.decay == pytest.approx(decay, rel=1e-14)
    assert first.decay == pytest.approx(first.damping * first.omega, rel=1e-14)


@pytest.mark.slow
def test_many_layers_are_as_one() -> None:
    """A rod in 80 pieces, held at one end, half its impedance as a dashpot at the other: as in one piece."""
    found = wavesym.modes(
        chain("fixed", *[{"rod": 1}, {"joint": True}] * 79, {"rod": 1}, {"joint": True, "dashpot": "1/2"}), 3
    )
    decay = -np.log(1 / 3) / 2
    for n, mode in enumerate(found, 1):
        w = complex((2 * n - 1) * pi / 2, decay) / 80
        assert mode.omega == pytest.approx(abs(w), rel=1e-12)
        assert mode.damping == pytest.approx(w.imag / abs(w), rel=1e-12)


def test_what_only_a_dashpot_holds_stays_where_it_is_put() -> None:
    """A free rod of impedance 1 with a dashpot of 2: w (exp(2 i w) - (1 - 2)/(1 + 2)) = 0."""
    shift, *found = wavesym.modes(chain("free", {"rod": 1}, {"joint": True, "dashpot": 2}), 4)
    assert (shift.omega, shift.damping, set(shift.shape.values())) == (0.0, 1.0, {1.0})
    assert len(found) == 3
    for n, mode in enumerate(found):
        w = complex(pi * (n + 0.5), np.log(3) / 2)
        assert mode.omega == pytest.approx(abs(w), rel=1e-12)


def test_in_units_they_are_per_second() -> None:
    """A mass on a column that weighs nothing to speak of."""
    parts = ["fixed", {"rod": "1 m", "A": "1 cm^2", "E": "210 GPa", "rho": "1e-6 kg/m^3"}, {"mass": "100 kg"}]
    system = {"type": "chain", "parts": parts}
    scene = Scene(name="bob", units={}, system=system, output={"until": "1 us", "velocity": ["1 m"]})
    (mode,) = wavesym.modes(scene, 1)
    assert mode.omega == pytest.approx(sqrt(2.1e7 / 100), rel=1e-9)
    assert mode.hz == pytest.approx(mode.omega / 2 / pi, rel=1e-15)
    assert mode.effective_mass == pytest.approx(1, rel=1e-9)


def test_damping_of_modes_is_that_of_the_scene() -> None:
    frame = Scene.from_toml("building_m2").with_({"system.base": "ground", "system.damping": ["1/10", "1/50"]})
    assert [mode.damping for mode in wavesym.modes(frame, 4)] == [0.1, 0.02, 0.02, 0.02]
    assert all(mode.decay == mode.damping * mode.omega for mode in wavesym.modes(frame, 4))
    slow = wavesym.modes(frame.with_({"system.damping": "500 %"}), 1)[0]  # s^2 + 10 w s + w^2 = 0
    assert slow.decay**2 - 10 * slow.omega * slow.decay + slow.omega**2 == pytest.approx(0, abs=1e-14)
    assert slow.decay < slow.omega


def test_rayleigh_damping_may_name_modes_that_are_not_asked_for() -> None:
    frame = Scene.from_toml("building_m2").with_({"system.base": "ground"})
    damped = frame.with_({"system.damping": {"modes": [1, 3], "ratio": "1/20"}})
    for count in (1, 2, 3):
        first = [mode.damping for mode in wavesym.modes(damped, 3)]
        assert [mode.damping for mode in wavesym.modes(damped, count)] == pytest.approx(first[:count], rel=1e-12)
        assert first[::2] == pytest.approx([0.05, 0.05])


PUBLISHED = {
    "friswell963": [0, 10.304, 20.479, 24.423],
    "five": [0.2439 / 2 / pi, 0.6689 / 2 / pi, 1 / 2 / pi, 1.286 / 2 / pi, 1.685 / 2 / pi],
    "turbine": [0, 177.7 / 60, 220.2 / 60, 1282.6 / 60],
}
"""Friswell et al. 2010, 9.6.3; five storeys, holooly.com, fig. 18.8-9; Gunter and Chen 2001, ex. 8.1, in Hz."""


@pytest.mark.parametrize("name", PUBLISHED)
def test_published_frequencies(name: str) -> None:
    file = Path(__file__).parents[2].parent / "shared" / "cases" / f"{name}.toml"
    if not file.exists():
        pytest.skip("the shared cases are not beside the repository")
    found = wavesym.modes(file, len(PUBLISHED[name]))
    assert found.frequencies == pytest.approx(PUBLISHED[name], rel=3e-4)


def test_below_a_frequency_there_are_all() -> None:
    """tan w = 1/w of a rod with its own mass at the end."""
    scene = chain("fixed", {"rod": 1}, {"mass": 1})
    found = wavesym.modes(scene, below=100)
    assert len(found) == 32
    for n, mode in enumerate(found):
        w = n * pi + atan(1 / mode.omega)
        assert mode.omega == pytest.approx(w, rel=1e-14)
    assert len(wavesym.modes(scene, below=found[-1].omega * (1 - 1e-12))) == 31
    for wrong in ({"count": 0}, {"below": -1.0}, {"below": float("nan")}):
        with pytest.raises(wavesym.WavesymError, match="is not positive"):
            wavesym.modes(scene, **wrong)  # type: ignore[arg-type]
    with pytest.raises(wavesym.CostError, match="the limit is 2000"):
        wavesym.modes(scene, 5000)
    with pytest.raises(wavesym.UnservedError, match="contact"):
        wavesym.modes(chain("free", {"rod": 1}, "contact", {"rod": 1}, "free"))


def test_the_command_needs_neither_loads_nor_outputs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("rod.toml").write_text('name = "rod"\n[system]\ntype = "chain"\nparts = ["fixed", { rod = 1 }, "free"]\n')
    assert main(["modes", "rod.toml", "--count", "2", "--format", "json", "--shapes"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert (said["complete"], said["time_unit"]) == (True, None)
    assert [mode["number"] for mode in said["modes"]] == [1, 2]
    assert said["modes"][0]["omega"] == pytest.approx(pi / 2, rel=1e-15)
    assert list(said["modes"][0]["shape"].values()) == [0, 1]
    assert {"number", "omega", "hz", "period", "damping", "radius"} <= said["modes"][0].keys()
    assert main(["modes", "rod.toml", "--below", "5", "--format", "csv", "-o", "rod.csv"]) == 0
    assert Path("rod.csv").read_text().count("\n") == 3
    assert main(["modes", "rod.toml", "-o", "rod.svg"]) == 0
    assert "none is missed" in capsys.readouterr().out
    assert Path("rod.svg").stat().st_size > 1000
    assert main(["modes", "rod.toml", "-o", "rod.bmp"]) == 2
    assert (
        "rod.bmp is not a picture nor a table; write a name that ends in .svg, .png, .pdf," in capsys.readouterr().err
    )
    assert not Path("rod.bmp").exists()
    assert main(["modes", "rod.toml", "--count", "2", "--below", "3"]) == 2
    assert main(["run", "rod.toml"]) == 2
    assert "rod.toml: output: missing; write a table" in capsys.readouterr().err


def test_a_spring_beside_a_free_rod_is_no_ring() -> None:
    """It is at rest in every second mode of the rod, at which K has a pole: a small mass lets it be told."""
    held = {"rod": 1, "spring": 2}
    with pytest.raises(wavesym.UnservedError, match=r"two frequencies meet near 6\.28319, .*a mass, however small"):
        wavesym.modes(chain("free", held, "free"), 3)
    found = wavesym.modes(chain({"mass": "1e-12"}, held, "free"), 3)
    # ends move against each other, the middle is at rest: half the rod, and twice the spring at its end
    assert found[1].omega / np.tan(found[1].omega / 2) == pytest.approx(-4, rel=1e-9)
    assert found[2].omega == pytest.approx(2 * np.pi, rel=1e-11)


def test_arms_of_one_length_have_modes_that_move_no_support() -> None:
    """Three held rods from one mass: at pi two modes leave the mass at rest, and what their supports bear is 0."""
    parts = ["fixed", {"rod": 1}, {"mass": 1, "name": "hub"}, {"rod": 1}, "fixed"]
    arm = {"from": "hub", "name": "arm", "parts": [{"rod": 1}, "fixed"]}
    scene = Scene(
        name="star", system={"type": "chain", "parts": parts, "branch": [arm]}, output={"until": 1, "strain": [0]}
    )
    found = wavesym.modes(scene, 3)
    assert [mode.omega for mode in found][1:] == pytest.approx([np.pi, np.pi], rel=1e-15)
    assert [mode.effective_mass for mode in found][1:] == pytest.approx([0, 0], abs=1e-20)


def test_participation_under_each_motion_and_force() -> None:
    """A column on moving ground: 4/((2 n - 1) pi), alternating; masses between two grounds and a force: dense."""
    column = wavesym.modes(chain({"motion": "acceleration", "name": "g"}, {"rod": 1}, "free"), 30)
    odd = np.arange(1, 61, 2)
    assert [mode.loads["g"].factor for mode in column] == pytest.approx(4 / (odd * pi) * (-1) ** (odd // 2), rel=1e-12)
    assert [mode.loads["g"].effective_mass for mode in column] == pytest.approx(8 / (odd * pi) ** 2, rel=1e-12)
    parts = [
        {"motion": "acceleration", "name": "a"},
        {"spring": 2},
        {"mass": 1, "name": "m"},
        {"spring": 1},
        {"mass": 3},
        {"spring": 4},
        {"motion": "velocity", "name": "b"},
    ]
    load = [{"at": "m", "times": [0], "steps": [1]}]
    system, output = {"type": "chain", "parts": parts}, {"until": 1, "velocity": ["m"]}
    found = wavesym.modes(Scene(name="two", system=system, load=load, output=output))
    mass, stiffness = np.diag([1.0, 3.0]), np.array([[3.0, -1.0], [-1.0, 5.0]])
    w2, shapes = np.linalg.eig(np.linalg.solve(mass, stiffness))
    for mode, k in zip(found, np.argsort(w2), strict=True):
        q = shapes[:, k] / shapes[np.argmax(np.abs(shapes[:, k])), k]
        moving = q @ mass @ q
        for name, pull in (("a", [2.0, 0.0]), ("b", [0.0, 4.0])):
            r = np.linalg.solve(stiffness, pull)
            assert mode.loads[name].factor == pytest.approx(q @ mass @ r / moving, rel=1e-12)
            part = (q @ mass @ r) ** 2 / moving / (r @ mass @ r)
            assert mode.loads[name].effective_mass == pytest.approx(part, rel=1e-12)
        assert (mode.loads["m"].factor, mode.loads["m"].effective_mass) == (pytest.approx(q[0], rel=1e-12), None)


def test_shapes_along_rods_are_sines_where_rods_are_cut_too(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Between fixed ends no node moves; and a branch."""
    held = wavesym.modes(chain("fixed", {"rod": 1}, {"rod": 1}, "fixed"), 3, points=9)
    (line,) = held.line_shapes
    for n, moved in enumerate(line.displacements, 1):
        right = np.sin(n * pi * line.x / 2)
        assert moved.real / np.sign(moved.real @ right) == pytest.approx(right / np.abs(right).max(), abs=1e-12)
    monkeypatch.chdir(tmp_path)
    branch = "[[system.branch]]\nfrom = 'n'\nname = 'b'\nparts = [{ rod = 1 }, 'free']\n"
    parts = "['fixed', { rod = 1 }, { mass = 1, name = 'n' }, { rod = 2 }, 'free']"
    Path("t.toml").write_text(f"name = 't'\n[system]\ntype = 'chain'\nparts = {parts}\n{branch}")
    assert main(["modes", "t.toml", "--count", "2", "--points", "5", "--format", "csv"]) == 0
    rows = [row.split(",") for row in capsys.readouterr().out.splitlines()]
    assert [row[0] for row in rows] == ["line", *[""] * 10, *["b"] * 5]
    assert main(["modes", "t.toml", "--count", "2", "--points", "5", "--format", "json"]) == 0
    said = json.loads(capsys.readouterr().out)
    w = said["modes"][0]["omega"]
    main_line, side = (each["shapes"][0] for each in said["along"])
    assert max(map(abs, main_line)) == 1
    node = main_line[4]
    far = np.array(main_line[5:])
    assert far == pytest.approx(node * np.cos(w * (2 - np.linspace(0, 2, 5))) / np.cos(2 * w), rel=1e-9)
    assert np.array(side) == pytest.approx(node * np.cos(w * (1 - np.linspace(0, 1, 5))) / np.cos(w), rel=1e-9)
    assert main(["modes", "t.toml", "--points", "5"]) == 2
    assert "--format json or csv" in capsys.readouterr().err


def test_a_scene_of_a_chain_alone_has_modes_and_nothing_else(tmp_path: Path) -> None:
    """From a file, a text, or keywords; with and without units; what needs outputs says so, and no traceback."""
    text = 'name = "bare"\n[system]\ntype = "chain"\nparts = ["fixed", { rod = 1 }, { mass = 1 }]\n'
    (tmp_path / "bare.toml").write_text(text)
    chain_alone = {"type": "chain", "parts": ["fixed", {"rod": 1}, {"mass": 1}]}
    scenes = [
        wavesym.Scene.from_toml(tmp_path / "bare.toml"),
        wavesym.Scene.from_toml(text),
        wavesym.Scene(name="bare", system=chain_alone),
    ]
    for scene in scenes:
        w = scene.modes(2)[1].omega
        assert np.cos(w) == pytest.approx(w * np.sin(w), rel=1e-12)
        assert scene.with_({"system.parts[1].rod": 2}).modes(1)[0].omega < w
        assert "until" not in repr(scene)
        assert wavesym.Scene(**scene.model_dump()) == scene
        for use in (wavesym.run, wavesym.summary, wavesym.frf, wavesym.peaks, wavesym.spectrum, wavesym.plot):
            with pytest.raises(wavesym.SceneError, match="output: missing; write a table"):
                use(scene)
    rod = {"rod": "2 m", "speed": "100 m/s", "impedance": "3 kN*s/m"}
    shear = wavesym.Scene(name="u", units={"kind": "shear"}, system={"type": "chain", "parts": ["fixed", rod, "free"]})
    assert shear.modes(1)[0].hz == pytest.approx(12.5, rel=1e-14)
    ranges = wavesym.modes(shear, 1, ranges={"system.parts[1].speed": ("100 m/s", "200 m/s")})
    assert ranges[0].high == pytest.approx(2 * ranges[0].low, rel=1e-14)


def test_participation_in_a_free_chain_with_a_gear_is_that_of_a_dense_eigenproblem() -> None:
    """The rigid motion first, in which the branch turns twice as fast; forces on a mass and on the branch."""
    parts = [{"mass": 2, "name": "a"}, {"spring": 3}, {"mass": 1, "name": "b"}, {"spring": 5}, {"mass": 4, "name": "c"}]
    branch = [{"from": "b", "name": "d", "ratio": 2, "parts": [{"spring": 7}, {"mass": "1/2", "name": "e"}]}]
    load = [{"at": at, "times": [0], "steps": [1]} for at in ("a", "e")]
    system = {"type": "chain", "parts": parts, "branch": branch}
    found = wavesym.modes(Scene(name="f", system=system, load=load, output={"until": 1, "velocity": ["a"]}))
    pulls = np.array([[1, -1, 0, 0], [0, 1, -1, 0], [0, 2, 0, -1]], float)
    stiffness, mass = pulls.T @ np.diag([3.0, 5.0, 7.0]) @ pulls, np.diag([2.0, 1.0, 4.0, 0.5])
    w2, shapes = np.linalg.eig(np.linalg.solve(mass, stiffness))
    assert (len(found), found[0].omega) == (4, 0.0)
    for mode, k in zip(found, np.argsort(w2), strict=True):
        q = shapes[:, k] / shapes[np.argmax(np.abs(shapes[:, k])), k]
        assert mode.omega == pytest.approx(np.sqrt(max(w2[k], 0.0)), rel=1e-12, abs=1e-7)
        assert [mode.loads[at].factor for at in ("a", "e")] == pytest.approx([q[0], q[3]], rel=1e-9)
        assert mode.effective_mass is None
    assert found[0].loads["e"].factor == pytest.approx(2 * found[0].loads["a"].factor, rel=1e-14)


def test_participation_at_the_end_of_a_free_rod_is_that_of_cosines() -> None:
    """1 in each, and for a force in its middle 1, 0, -1, 0, ..., where ends move by 1."""
    load = [{"at": at, "times": [0], "steps": [1]} for at in ("l", "m")]
    parts = [{"joint": True, "name": "l"}, {"rod": 1}, {"joint": True, "name": "m"}, {"rod": 1}, "free"]
    scene = Scene(name="r", system={"type": "chain", "parts": parts}, load=load, output={"until": 1, "velocity": [0]})
    found = wavesym.modes(scene, 6)
    assert [mode.omega for mode in found] == pytest.approx([n * pi / 2 for n in range(6)], rel=1e-14)
    assert [abs(mode.loads["l"].factor) for mode in found] == pytest.approx([1] * 6, rel=1e-12)
    middles = [mode.loads["m"].factor * np.sign(mode.loads["l"].factor) for mode in found]
    assert middles == pytest.approx([1, 0, -1, 0, 1, 0], abs=1e-12)


@pytest.mark.parametrize(
    "link",
    [
        {"spring": 7, "gap": ["-1/3", "1/5"], "dashpot": "1/2"},
        {"spring": 7, "only": "push", "dashpot": "1/2"},
        {"spring": 7, "yield": 1, "dashpot": "1/2"},
        {"friction": "1/4", "dashpot": 1},
        {"contact": "1/4"},
    ],
)
def test_a_law_with_a_corner_has_no_modes_beside_dashpots_either(link: dict[str, object]) -> None:
    """They were served as if every law were linear for good: both sides of a gap at once."""
    beyond = [{"rod": 1}, "free"] if "contact" in link else [{"mass": 1}]
    parts = ["fixed", {"rod": 1}, {"mass": 2, "dashpot": 1, "name": "c"}, link, *beyond]
    scene = wavesym.Scene(name="corner", system={"type": "chain", "parts": parts})
    with pytest.raises(wavesym.UnservedError, match=r"at .* is not supported by modes"):
        wavesym.modes(scene, 2)
