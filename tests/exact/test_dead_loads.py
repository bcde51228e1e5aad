"""Weight along a chain, static balance at first and preloads, against closed forms and lumps that just fall."""

from __future__ import annotations

from fractions import Fraction
from math import sqrt
from typing import Any

import numpy as np
import pytest

import wavesym
from wavesym.errors import SceneError, UnservedError
from wavesym.exact.contacts.events import events
from wavesym.exact.losses import losses
from wavesym.interactive import Scene
from wavesym.numbers.arrays import Array
from wavesym.scene import lower


def chain(parts: list[Any], output: dict[str, Any], load: list[Any] | None = None, **system: Any) -> Scene:
    table = {"type": "chain", "parts": parts, **system}
    return Scene(name="heavy", system=table, load=load or [], output={"until": 10, **output})


def test_what_falls_freely_is_not_strained() -> None:
    parts = [{"rod": 1}, {"mass": 3}, {"rod": "3/2", "impedance": 2, "speed": "1/2"}]
    found = chain(parts, {"strain": ["1/2", "1+"], "velocity": ["1/4"], "displacement": ["2"]}, gravity="1/7").run()
    assert not np.any(found["strain@1/2"])
    assert not np.any(found["strain@1+"])
    assert np.array_equal(found["velocity@1/4"], found.time / 7)
    assert np.allclose(found["displacement@2"], found.time**2 / 14, rtol=3e-16, atol=0)


@pytest.mark.parametrize("tau", [0.3, 0.9, 1.4, 2.0, 2.5, 3.9, 4.0])
def test_a_rod_that_is_hung_up_swings_between_nothing_and_twice_its_own_stretch(tau: float) -> None:
    found = chain(["fixed", {"rod": 1}], {"displacement": ["1"], "strain": ["0"]}, gravity="1/10").run([tau])
    free = 0.05 * tau**2
    until = free - 0.1 * max(tau - 1, 0) ** 2 + 0.1 * max(tau - 3, 0) ** 2
    assert found["displacement@1"][0] == pytest.approx(until, abs=2e-16)
    assert found["strain@0"][0] == pytest.approx(0.1 * (tau if tau <= 2 else 4 - tau), abs=2e-16)  # g tau / c, back


def test_what_is_in_balance_stays_there_exactly() -> None:
    parts = [
        "fixed",
        {"rod": 1, "impedance": 2},
        {"mass": 3, "spring": "1/2", "friction": "1/9", "name": "m"},
        {"rod": 2, "speed": "1/2"},
        {"joint": True, "name": "j"},
        {"spring": 4, "yield": 5},
        {"mass": 1, "name": "n"},
        {"spring": 3, "only": "push"},
        "fixed",
    ]
    output = {"velocity": ["m", "n"], "force": ["0", "1/2", "1-", "1+", "3-"]}
    found = chain(parts, output, gravity="1/10", initial="static").run()
    assert not np.any(found["velocity@m"])
    assert not np.any(found["velocity@n"])
    # by hand: springs 2, 1/4, 4, 3 one after another, 1/2 beside; weights of 3, 2 and 4 (of rods) and 1, rods by halves
    k = [[Fraction(11, 4), Fraction(-1, 4), 0], [Fraction(-1, 4), Fraction(17, 4), -4], [0, -4, Fraction(7)]]
    f = [Fraction(1, 10) * (3 + 1 + 2), Fraction(1, 10) * 2, Fraction(1, 10)]
    u = [Fraction(str(x)) for x in _solve(k, f)]
    for place, value in (
        ("0", 2 * u[0] + Fraction(1, 10)),
        ("1/2", 2 * u[0]),
        ("1-", 2 * u[0] - Fraction(1, 10)),
        ("1+", (u[1] - u[0]) / 4 + Fraction(2, 10)),
        ("3-", (u[1] - u[0]) / 4 - Fraction(2, 10)),
    ):
        assert np.all(found[f"force@{place}"] == float(value)), place


def _solve(rows: list[list[Any]], right: list[Fraction]) -> list[Fraction]:
    """Gauss, in fractions."""
    table = [[Fraction(c) for c in row] + [value] for row, value in zip(rows, right, strict=True)]
    for k, pivot in enumerate(table):
        for other in table:
            if other is not pivot:
                factor = other[k] / pivot[k]
                other[:] = [a - factor * b for a, b in zip(other, pivot, strict=True)]
    return [row[-1] / row[k] for k, row in enumerate(table)]


def test_what_comes_to_rest_is_in_the_balance() -> None:
    parts = ["fixed", {"rod": 1}, {"mass": 2, "spring": 1, "dashpot": 2, "name": "m"}, {"rod": 1, "dashpot": 1}]
    parts += [{"mass": 1, "dashpot": 1, "name": "n"}, {"spring": 2, "yield": 9}, "fixed"]
    output = {"until": 80, "displacement": ["m", "n"], "force": ["0", "1+"]}
    fallen = chain(parts, output, gravity="1/3").run([80.0])
    resting = chain(parts, output, gravity="1/3", initial="static").run([80.0])
    for place in ("0", "1+"):
        assert fallen[f"force@{place}"][0] == pytest.approx(resting[f"force@{place}"][0], abs=5e-3)
    assert fallen["displacement@m"][0] > 0.1
    assert resting["displacement@m"][0] == 0


@pytest.mark.quick(1)
@pytest.mark.parametrize("gap", ["1/2", "1e-9"])
def test_what_falls_on_a_floor_or_a_spring_meets_it_when_it_has_fallen_so_far(gap: str) -> None:
    when = sqrt(2 * float(Fraction(gap)) * 10)
    rod = chain([{"rod": 1}, {"contact": gap}, "fixed"], {"displacement": ["0"]}, gravity="1/10")
    mass = chain(
        [{"mass": 2, "name": "m"}, {"spring": 3, "only": "push", "gap": gap}, "fixed"],
        {"displacement": ["m"]},
        gravity="1/10",
    )
    for scene in (rod, mass):
        first, *_ = events(lower(scene))
        assert first.kind in ("closes", "engages")
        assert float(first.tau.mid()) == pytest.approx(when, rel=1e-15)


def test_a_play_is_as_wide_when_it_carries_a_weight() -> None:
    """Its spring pushes with 2/5 in the balance: it releases where it gets 1/5 longer, and engages 1 beyond that."""
    parts = ["fixed", {"rod": 1}, {"mass": 1, "name": "a"}, {"spring": 2, "gap": [1, 2]}, {"mass": 1, "name": "b"}]
    load = [{"at": "b", "times": [0], "steps": [14]}]
    output = {"until": 3, "tolerance": 1e-9, "displacement": ["a", "b"]}
    system = {"type": "chain", "gravity": 1, "initial": "static", "parts": [*parts, {"rod": 1}, "fixed"]}
    scene = wavesym.Scene(name="play", system=system, load=load, output=output)
    known = wavesym.run(scene).events
    assert [event.kind for event in known[:2]] == ["releases", "engages"]
    a, b = wavesym.evaluator(scene)([event.double for event in known[:2]])
    assert (b - a).tolist() == pytest.approx([1 / 5, 6 / 5], abs=1e-9)


@pytest.mark.parametrize(
    ("friction", "slides"), [("1/5", False), ("0.2000001", False), ("0.1999999", True), ("1/10", True)]
)
def test_a_block_slides_down_where_its_weight_is_more_than_friction(friction: str, slides: bool) -> None:
    scene = chain([{"mass": 2, "friction": friction, "name": "m"}], {"until": 4, "displacement": ["m"]}, gravity="1/10")
    found = scene.run([4.0])["displacement@m"][0]
    assert found == pytest.approx((0.1 - float(Fraction(friction)) / 2) * 8 if slides else 0, rel=1e-12)


def test_a_preload_of_a_linear_spring_is_a_pair_of_loads() -> None:
    parts: list[Any] = [{"mass": 2, "name": "m"}, {"spring": 3}, {"mass": 1, "name": "n"}, {"rod": 1}]
    loads = [{"at": at, "times": [0], "steps": [size]} for at, size in (("m", "1/3"), ("n", "-1/3"))]
    output = {"displacement": ["m", "n"]}
    loaded = chain(parts, output, loads).run()
    strained = chain([parts[0], {"spring": 3, "preload": "1/3"}, *parts[2:]], output).run()
    for name in ("displacement@m", "displacement@n"):
        assert np.array_equal(loaded[name], strained[name])


@pytest.mark.slow
@pytest.mark.parametrize("preload", ["1/4", "-1/2", "1", "-2"])
def test_a_preload_of_a_spring_that_yields_moves_its_limits(preload: str) -> None:
    def parts(pull: Fraction, push: Fraction, more: dict[str, Any]) -> list[Any]:
        link = {"spring": 3, "yield": [str(pull), str(push)], **more}
        return [{"mass": 2, "velocity": -1, "name": "m"}, link, {"mass": 1, "name": "n"}, {"rod": 1}]

    force = Fraction(preload)
    output = {"until": 6, "displacement": ["m", "n"]}
    loads = [{"at": at, "times": [0], "steps": [str(size)]} for at, size in (("m", force), ("n", -force))]
    strained = chain(parts(Fraction(1), Fraction(2), {"preload": preload}), output)
    moved = chain(parts(1 - force, 2 + force, {}), output, loads)
    assert [(e.kind, e.double) for e in events(lower(strained))] == [(e.kind, e.double) for e in events(lower(moved))]
    for name in ("displacement@m", "displacement@n"):
        assert np.array_equal(strained.run()[name], moved.run()[name])
    assert losses(lower(strained))[0].set.overlaps(losses(lower(moved))[0].set)


def test_a_preload_of_a_spring_of_one_side_is_a_gap_below_nothing() -> None:
    def parts(link: dict[str, Any]) -> list[Any]:
        return [{"mass": 2, "velocity": -1, "name": "m"}, {"spring": 3, **link}, "fixed"]

    strained = chain(parts({"only": "push", "preload": "-1/4"}), {"displacement": ["m"]})
    placed = chain(parts({"gap": ["1/12", 99]}), {"displacement": ["m"]})
    assert np.array_equal(strained.run()["displacement@m"], placed.run()["displacement@m"])


REFUSED = [
    ([{"mass": 1, "name": "m"}, {"rod": 1}], {}, "nothing holds it"),
    ([{"mass": 1, "dashpot": 1, "name": "m"}], {}, "nothing holds it"),
    ([{"mass": 1, "friction": 9, "name": "m"}, {"rod": 1}], {}, "nothing holds it"),
    (["fixed", "contact", {"rod": 1}], {}, "would have to pull"),
    (["fixed", {"spring": 1, "only": "push"}, {"mass": 1, "name": "m"}], {}, "would have to pull"),
    (["fixed", {"spring": 1, "yield": "1/100"}, {"mass": 1, "name": "m"}], {}, "write more yield"),
    (["fixed", {"rod": 1, "strain": "1/9"}], {}, "leave it out"),
    (
        ["fixed", {"rod": 1}, {"mass": 1, "name": "m"}],
        {"branch": [{"from": "m", "name": "b", "ratio": 2, "parts": [{"rod": 1}]}]},
        "branch",
    ),
]


@pytest.mark.parametrize(("parts", "more", "why"), REFUSED)
def test_without_one_balance_it_is_refused(parts: list[Any], more: dict[str, Any], why: str) -> None:
    with pytest.raises(SceneError, match=r"system\.\w+:.*" + why):
        chain(parts, {"displacement": ["0"]}, gravity="1/10", initial="static", **more)


@pytest.mark.parametrize(
    ("link", "why"),
    [
        ({"spring": 1, "yield": 1, "preload": 2}, "beyond"),
        ({"spring": 1, "only": "push", "preload": 1}, "beyond"),
        ({"spring": 1, "only": "push", "gap": 1, "preload": -1}, "leave one of them out"),
        ({"dashpot": 1, "preload": 1}, "there is none"),
    ],
)
def test_a_preload_that_a_spring_cannot_have_is_refused(link: dict[str, Any], why: str) -> None:
    with pytest.raises(SceneError, match=why):
        chain([{"mass": 1}, link, {"mass": 1, "name": "m"}], {"displacement": ["m"]})


@pytest.mark.parametrize("evaluator", ["march", "modes", "closed"])
def test_other_programs_refuse_weight(evaluator: str, tmp_path: Any) -> None:
    scene = chain(["fixed", {"rod": 1}, {"mass": 1, "name": "m"}], {"displacement": ["m"]}, gravity="1/10")
    with pytest.raises(UnservedError, match="gravity"):
        wavesym.generate(scene, tmp_path, evaluator=evaluator)


UNITS = {"length": "mm", "time": "ms", "force": "kN"}
PILE: list[Any] = [
    {"mass": "4 t", "velocity": "5 m/s", "name": "ram"},
    {"spring": "1 GN/m", "only": "push"},
    {"mass": "500 kg", "name": "cap"},
    {"rod": "6 m", "A": "600 cm^2", "E": "30 GPa", "rho": "2400 kg/m^3"},
    {"joint": True, "spring": "100 MN/m", "yield": "300 kN", "name": "shaft"},
    {"rod": "6 m", "A": "600 cm^2", "E": "30 GPa", "rho": "2400 kg/m^3"},
    {"joint": True, "name": "toe"},
    {"spring": "200 MN/m", "yield": ["0 N", "600 kN"]},
    "fixed",
]


@pytest.mark.slow
def test_a_heavy_pile_moves_as_lumps_that_just_fall() -> None:
    system = {"type": "chain", "gravity": "9.81 m/s^2", "initial": "static", "parts": PILE}
    output = {"until": "30 ms", "displacement": ["ram", "toe-"], "force": ["3 m"]}
    scene = Scene(name="pile", units=UNITS, system=system, output=output)
    times = np.linspace(0.0, 0.03, 61)
    found = scene.run(1000 * times)
    ram, toe, force = _lumps(120, times)
    assert np.max(np.abs(found["displacement@ram"] - 1e3 * ram)) < 0.03
    assert np.max(np.abs(found["displacement@toe-"] - 1e3 * toe)) < 0.12
    assert found["force@3 m"][0] == pytest.approx(1e-3 * force[0], abs=5e-3)
    assert np.sqrt(np.mean((found["force@3 m"] - 1e-3 * force) ** 2)) < 60


def _lumps(cells: int, times: Array) -> tuple[Array, Array, Array]:
    """The ram, the toe (m) and the force (N) at 3 m of the pile as so many lumps, by central differences."""
    h = 12.0 / cells
    stiffness, mass = np.full(cells, 30e9 * 0.06 / h), np.full(cells + 1, 2400 * 0.06 * h)
    mass[[0, -1]] /= 2
    mass[0] += 500
    gravity, step = 9.81, 0.4 * h / sqrt(30e9 / 2400)
    shaft = cells // 2
    matrix = np.diag(np.append(stiffness, 0.0) + np.append(0.0, stiffness))
    matrix -= np.diag(stiffness, 1) + np.diag(stiffness, -1)
    matrix[shaft, shaft] += 100e6
    matrix[-1, -1] += 200e6
    start = np.linalg.solve(matrix, gravity * mass)
    u, v, ram, ram_v = start.copy(), np.zeros(cells + 1), start[0], 5.0
    pulls, slack = np.array([100e6 * start[shaft], 200e6 * start[-1]]), []
    now = 0.0
    for time in times:
        while now < time - step / 2:
            soil = np.clip(pulls, [-300e3, 0.0], [300e3, 600e3])
            cushion = 1e9 * max(ram - u[0], 0.0)
            inner = stiffness * np.diff(u)
            acting = gravity * mass + np.append(inner, 0.0) - np.append(0.0, inner)
            acting[0] += cushion
            acting[[shaft, -1]] -= soil
            v += step * acting / mass
            ram_v += step * (gravity - cushion / 4000)
            u, ram, now = u + step * v, ram + step * ram_v, now + step
            pulls = np.clip(soil + step * np.array([100e6, 200e6]) * v[[shaft, -1]], [-300e3, 0.0], [300e3, 600e3])
        k = cells // 4
        slack.append(
            (ram - start[0], u[-1] - start[-1], (stiffness[k] + stiffness[k - 1]) / 2 * (u[k + 1] - u[k - 1]) / 2)
        )
    moved = np.array(slack)
    return moved[:, 0], moved[:, 1], moved[:, 2]


@pytest.mark.slow
def test_a_blow_that_dies_away_under_weight_leaves_its_contact_closed() -> None:
    """All falls alike, and the contact pushes with exp(-tau) until its wave is back: more bits follow it further."""
    parts = [{"mass": 1, "velocity": 1, "name": "a"}, "contact", {"rod": 500}, {"mass": 10**9}]
    system = {"type": "chain", "gravity": 1, "parts": parts}
    scene = wavesym.Scene(name="blow", system=system, output={"until": 990, "velocity": ["a"]})
    result = wavesym.run(scene, times=[10, 990])
    assert result.events == ()
    assert result["velocity@a"] == pytest.approx([10 + np.exp(-10), 990], rel=1e-15)
