"""Scenes in units obey the laws that a book has in SI, written here in floating point from the quantities alone.

Until something comes back, a wave is d'Alembert's: behind a front that moves at c, the force is -Z v, the strain -v/c.
At a node with mass m, m v' is what the rods on both sides push.
"""

from __future__ import annotations

from cmath import cos, sin
from collections.abc import Callable, Mapping
from functools import partial
from math import exp, pi, sqrt
from typing import Any

import pytest

from wavesym.errors import SceneError
from wavesym.mechanics.clock import Clock
from wavesym.results.response import Response
from wavesym.scene import Scene, lower
from wavesym.scene.lowering import named_chain
from wavesym.scene.physical.scale import Scale
from wavesym.systems.building import Columns
from wavesym.systems.dimensionless import LoadUnit
from wavesym.systems.drive import PhysicalDrive
from wavesym.systems.elastic import Rods

CLOSE = 1e-13


def values(scene: Mapping[str, Any], time: float) -> dict[str, float]:
    """The outputs at a time in seconds, by name."""
    model = lower(Scene(name="good", **{"units": {}, **scene}))
    assert model.clock
    (found,) = Response(model)([model.clock.tau(time, model.until)]).T
    return dict(zip([probe.name for probe in model.probes], map(float, found), strict=True))


def heavy(w: float, z: float, mass: float, s: float) -> float:
    """How fast a mass is, pushed for a time s towards w, by impedances z in all."""
    return w * (1 - exp(-z * s / mass))


# a building, 2 storeys
K, M, H, FLOOR, ACC = 678e6, 10871.0, 3.5, 350e3, 1.5
Z, T = sqrt(K * M), sqrt(M / K)
STOREY = {"height": "3.5 m", "stiffness": "678 MN/m", "column_mass": "10.871 t", "floor_mass": "350 t"}
SHAKEN = [{"times": ["0 s"], "a": ["1.5 m/s^2"], "b": ["0 m/s^3"]}]


def shaken(w: float, lam: float, s: float) -> float:
    """The answer of v' + lam v = w s, from 0."""
    return w / lam * (s - (1 - exp(-lam * s)) / lam)


@pytest.mark.parametrize("other", [False, True])
def test_storeys_on_ground_that_moves(other: bool) -> None:
    k2, m2 = (300e6, 9e3) if other else (K, M)
    above = STOREY | {"stiffness": "300 MN/m", "column_mass": "9 t"} if other else STOREY
    system = {"type": "building", "base": "ground", "storey": [STOREY, above]}
    output = {"until": "30 ms", "strain": ["0", "1+"], "velocity": [0, 1], "displacement": [0]}
    output |= {"acceleration": [1], "force": ["0", "1+"], "drift": [1], "relative": [1]}
    found = values({"system": system, "load": SHAKEN, "output": output}, 1.7 * T)
    t, s = 1.7 * T, 0.7 * T
    z2, c1, c2 = sqrt(k2 * m2), H / T, H / sqrt(m2 / k2)
    assert found["velocity@0"] == pytest.approx(ACC * t, rel=CLOSE)
    assert found["displacement@0"] == pytest.approx(ACC * t**2 / 2, rel=CLOSE)
    assert found["strain@0"] == pytest.approx(-ACC * t / c1, rel=CLOSE)
    assert found["force@0"] == pytest.approx(-Z * ACC * t, rel=CLOSE)
    lam = (Z + z2) / FLOOR
    v1 = shaken(2 * Z * ACC / FLOOR, lam, s)
    assert found["velocity@1"] == pytest.approx(v1, rel=1e-10)  # the small difference of what is large
    assert found["acceleration@1"] == pytest.approx(2 * Z * ACC * s / FLOOR - lam * v1, rel=CLOSE)
    assert found["strain@1+"] == pytest.approx(-v1 / c2, rel=1e-10)
    assert found["force@1+"] == pytest.approx(-z2 * v1, rel=1e-10)
    u1 = 2 * Z * ACC / FLOOR / lam * (s**2 / 2 - s / lam + (1 - exp(-lam * s)) / lam**2)
    assert found["relative@1"] == pytest.approx(u1 - ACC * t**2 / 2, rel=1e-10)
    assert found["drift@1"] == found["relative@1"]


@pytest.mark.parametrize("count", [1, 2])
def test_a_foundation_that_pushes(count: int) -> None:
    system = {"type": "building", "base": "force", "foundation_mass": "500 t", "storey": [STOREY | {"count": count}]}
    output = {"until": "30 ms", "strain": ["0"], "velocity": [0], "force": [0]}
    found = values({"system": system, "load": SHAKEN, "output": output}, 1.3 * T)
    assert found["force@0"] == pytest.approx(500e3 * ACC, rel=CLOSE)
    assert found["strain@0"] == pytest.approx(500e3 * ACC / (K * H), rel=CLOSE)
    assert found["velocity@0"] == pytest.approx(-500e3 * ACC / Z, rel=CLOSE)


def test_columns_and_walls_are_as_stiff_and_heavy_as_books_say() -> None:
    columns = {"n": 20, "E": "210 GPa", "I": "57680 cm^4", "A": "198 cm^2", "rho": "7850 kg/m^3"}
    wall = {"k": "5/6", "G": "12 GPa", "A": "2 m^2", "rho": "2.5 t/m^3"}
    stiffness = 12 * 20 * 210e9 * 57680e-8 / H**3, 5 / 6 * 12e9 * 2 / H
    mass = 20 * 198e-4 * 7850 * H, 2500 * 2 * H
    for made, k, m in zip(({"columns": columns}, {"shear": wall}), stiffness, mass, strict=True):
        storey = {"height": "3.5 m", "floor_mass": "350 t", **made}
        system = {"type": "building", "base": "ground", "storey": [storey]}
        scene = Scene(name="a", units={}, system=system, output={"until": 1, "strain": [0], "force": [0]})
        assert scene.scale
        assert float(scene.scale.seconds) == pytest.approx(sqrt(m / k), rel=1e-15)
        strain, force = (float(probe.factor) for probe in lower(scene).probes)
        assert force / strain == pytest.approx(k * H, rel=1e-15)


# a drive: two shafts of steel, 50 and 40 mm thick
G, RHO, L = 80e9, 7850.0, 1.2
J1, J2 = pi / 32 * 0.05**4, pi / 32 * (0.04**4 - 0.01**4)
SHAFT = {"length": "1.2 m", "diameter": "50 mm", "G": "80 GPa", "rho": "7850 kg/m^3"}
DISCS = [{"inertia": f"{j} kg*m^2"} for j in ("0.3", "0.7", "0.2")]


def test_a_bore_of_nothing_is_none() -> None:
    system = {"type": "drive", "shaft": [SHAFT], "disc": DISCS[:2]}
    rod = {"rod": "1.2 m", **{key: SHAFT[key] for key in ("diameter", "G", "rho")}}
    chain = {"type": "chain", "parts": [{"mass": "1 kg*m^2"}, rod]}
    for each, units, path in ((system, {}, "shaft"), (chain, {"kind": "torsional"}, "parts")):
        full = Scene(name="s", units=units, system=each, output={"until": 3, "strain": [0] if not units else ["0 m+"]})
        at = f"system.{path}[{0 if path == 'shaft' else 1}].bore"
        assert named_chain(full.with_({at: "0 mm"})) == named_chain(full)


@pytest.mark.parametrize("length", ["1.2 m", "0.9 m"])
@pytest.mark.parametrize("body", [1, 3])
def test_a_drive_turns(length: str, body: int) -> None:
    thin = SHAFT | {"length": length, "diameter": "40 mm", "bore": "10 mm"}
    output = {"until": "2 ms", "strain": ["0", "2"], "velocity": [0, 1, 2], "force": [0], "displacement": [0]}
    load = [{"body": body, "times": ["0 s"], "steps": ["15 N*m"]}]
    system = {"type": "drive", "shaft": [SHAFT, thin], "disc": DISCS}
    c, delay = sqrt(G / RHO), L / sqrt(G / RHO)
    z1, z2 = J1 * sqrt(G * RHO), J2 * sqrt(G * RHO)
    if body == 3:  # against positive rotation; a wave takes its time through the thin shaft
        delay = float(length.split()[0]) / c
        found = values({"system": system, "load": load, "output": output}, 1.5 * delay)
        assert found["velocity@2"] == pytest.approx(-heavy(15 / z2, z2, 0.2, 1.5 * delay), rel=1e-12)
        assert found["strain@2"] == pytest.approx(-heavy(15 / z2, z2, 0.2, 1.5 * delay) / c, rel=1e-12)
        return
    found = values({"system": system, "load": load, "output": output}, 1.5 * delay)
    omega = heavy(15 / z1, z1, 0.3, 1.5 * delay)
    assert found["velocity@0"] == pytest.approx(omega, rel=1e-12)
    assert found["strain@0"] == pytest.approx(-omega / c, rel=1e-12)
    assert found["force@0"] == pytest.approx(-z1 * omega, rel=1e-12)
    s, lam, mu = 0.5 * delay, z1 / 0.3, (z1 + z2) / 0.7
    second = 2 * 15 / 0.7 * ((1 - exp(-mu * s)) / mu - (exp(-lam * s) - exp(-mu * s)) / (mu - lam))
    assert found["velocity@1"] == pytest.approx(second, rel=1e-9)


def rod(length: str = "1.2 m", area: str = "8 cm^2") -> dict[str, str]:
    return {"length": length, "A": area, "E": "210 GPa", "rho": "7850 kg/m^3"}


@pytest.mark.parametrize(
    ("second", "contacts"),
    [(rod(), "closed"), (rod(), "open"), (rod("0.9 m", "4 cm^2"), "closed"), (rod("0.9 m"), "open")],
)
def test_bodies_collide(second: dict[str, str], contacts: str) -> None:
    bodies = [
        {"left": rod(), "right": rod(), "mass": "12 kg", "velocity": "5 m/s"},
        {"left": second, "right": second, "mass": "7 kg", "velocity": "-1 m/s"},
    ]
    output = {"until": "0.5 ms", "force": ["2"], "strain": ["2-"], "velocity": ["2-", 1], "displacement": [1]}
    system = {"type": "collision", "body": bodies, "contacts": contacts}
    if contacts == "open":
        output["force"] = ["2-"]
    c, z1 = sqrt(210e9 / 7850), 8e-4 * sqrt(210e9 * 7850)
    z2 = float(second["A"].split()[0]) * 1e-4 * sqrt(210e9 * 7850)
    t = 1.25 * 1.2 / c
    found = values({"system": system, "output": output}, 0.5 * 1.2 / c)
    assert found[f"force@{output['force'][0]}"] == pytest.approx(-z1 * z2 / (z1 + z2) * 6, rel=CLOSE)
    shared = (5 * z1 - z2) / (z1 + z2)
    assert found["velocity@2-"] == pytest.approx(shared, rel=CLOSE)
    assert found["strain@2-"] == pytest.approx((shared - 5) / c, rel=CLOSE)
    assert found["displacement@1"] == pytest.approx(5 * 0.5 * 1.2 / c, rel=CLOSE)
    found = values({"system": system, "output": output}, t)
    assert found["velocity@1"] == pytest.approx(5 + heavy(shared - 5, 2 * z1, 12, 0.25 * 1.2 / c), rel=1e-12)


STEEL = {"rod": "2 m", "A": "8 cm^2", "E": "210 GPa", "rho": "7850 kg/m^3"}
THIN = STEEL | {"rod": "1 m", "A": "2 cm^2"}
C, Z1, Z2 = sqrt(210e9 / 7850), 8e-4 * sqrt(210e9 * 7850), 2e-4 * sqrt(210e9 * 7850)
PUSH = {"at": "tip", "times": ["0 s"], "steps": ["12 kN"]}
TIP = {"joint": True, "name": "tip"}


def chain(
    parts: list[Any], load: dict[str, Any], time: float, units: dict[str, str], until: str = "1 ms", **output: Any
) -> dict[str, float]:
    system = {"type": "chain", "parts": parts}
    return values({"units": units, "system": system, "load": [load], "output": {"until": until, **output}}, time)


def test_a_stepped_bar_against_a_mass_with_spring_and_dashpot() -> None:
    mass, stiffness, dashpot = 3.0, 5e7, 2e3
    end = {"mass": "3 kg", "spring": "50 MN/m", "dashpot": "2 kN*s/m", "name": "end"}
    t = 3.9 / C  # the push has been at the end for 0.9 m / C
    places = {"velocity": ["tip", "2 m", "end"], "displacement": ["3 m"], "strain": ["0.05 m"], "force": ["1.5 m"]}
    found = chain([TIP, STEEL, THIN, end], PUSH, t, {}, **places)
    w = 12e3 / Z1
    assert found["velocity@tip"] == pytest.approx(w, rel=CLOSE)
    through = 2 * Z1 / (Z1 + Z2) * w
    assert found["velocity@2 m"] == pytest.approx(through, rel=CLOSE)
    assert found["strain@0.05 m"] == pytest.approx(-w / C, rel=CLOSE)
    # 1.5 m is behind the front that comes back from 2 m
    assert found["force@1.5 m"] == pytest.approx(-Z1 * (w - (through - w)), rel=CLOSE)
    # m u'' + (dashpot + Z2) u' + stiffness u = 2 Z2 w
    s, damping = t - 3 / C, dashpot + Z2
    decay, turns = damping / 2 / mass, complex(stiffness / mass - (damping / 2 / mass) ** 2) ** 0.5
    still = 2 * Z2 * through / stiffness
    moved = still * (1 - exp(-decay * s) * (cos(turns * s) + decay / turns * sin(turns * s)))
    assert found["displacement@3 m"] == pytest.approx(moved.real, rel=1e-9)
    speed = still * exp(-decay * s) * (turns + decay**2 / turns) * sin(turns * s)
    assert found["velocity@end"] == pytest.approx(speed.real, rel=1e-9)


def test_at_last_a_push_is_held_by_the_stiffness_of_what_it_pushes_against() -> None:
    parts = [
        TIP | {"dashpot": "20 kN*s/m"},
        STEEL | {"rod": "20 m"},
        {"spring": "30 MN/m", "dashpot": "8 kN*s/m"},
        THIN | {"rod": "10 m"},
        {"joint": True, "spring": "50 MN/m", "dashpot": "8 kN*s/m"},
    ]
    found = chain(parts, PUSH, 0.1, {"length": "mm", "force": "kN"}, "0.1 s", displacement=["tip"], force=["1 m"])
    stiff = 1 / (20 / (210e9 * 8e-4) + 10 / (210e9 * 2e-4) + 1 / 30e6 + 1 / 50e6)
    assert found["displacement@tip"] == pytest.approx(12e3 / stiff * 1e3, rel=1e-3)
    assert found["force@1 m"] == pytest.approx(-12, rel=1e-3)


def test_a_spring_between_rods() -> None:
    parts = [TIP, STEEL, {"spring": "30 MN/m"}, THIN]
    found = chain(parts, PUSH, 2.5 / C, {}, force=["2 m-", "2 m+"], velocity=["2 m+"])
    soft, w = 1 / Z1 + 1 / Z2, 12e3 / Z1
    held = -2 * w / soft * (1 - exp(-30e6 * soft * 0.5 / C))
    assert found["force@2 m-"] == pytest.approx(held, rel=1e-12)
    assert found["velocity@2 m+"] == pytest.approx(-held / Z2, rel=1e-12)


@pytest.mark.parametrize(
    ("motion", "step", "speed"), [("velocity", "3 ft/s", 0.9144), ("acceleration", "2 m/s^2", 2 * 1.9e-4)]
)
def test_an_end_that_moves_as_it_is_told(motion: str, step: str, speed: float) -> None:
    load = {"at": "0 m", "times": ["0 s"], "steps": [step]}
    found = chain([{"motion": motion}, STEEL, "absorbing"], load, 1.9e-4, {}, velocity=["0 m"], strain=["0 m"])
    assert found["velocity@0 m"] == pytest.approx(speed, rel=CLOSE)
    assert found["strain@0 m"] == pytest.approx(-speed / C, rel=CLOSE)


def test_a_gap_closes_when_it_is_passed_and_rods_may_be_said_by_their_waves() -> None:
    parts = [
        {"rod": "1 m", "impedance": "40 kN*s/m", "speed": "5000 m/s", "velocity": "4 m/s", "name": "striker"},
        {"contact": "2 mm"},
        {"rod": "2 m", "impedance": "10 kN*s/m", "speed": "4000 m/s"},
    ]
    output = {"until": "1 ms", "force": ["1 m+"]}
    scene = Scene(name="a", units={}, system={"type": "chain", "parts": parts}, output=output)
    model = lower(scene)
    first = Response(model).events[0]
    assert model.clock
    assert first.double * float(model.clock.seconds) == pytest.approx(0.5e-3, rel=CLOSE)
    (force,) = Response(model)([model.clock.tau(0.51e-3, model.until)])[:, 0]
    assert force == pytest.approx(-4 / (1 / 40e3 + 1 / 10e3), rel=CLOSE)


def test_torsion_counts_angles_and_moments() -> None:
    twisted = {"rod": "1.2 m", "diameter": "50 mm", "G": "80 GPa", "rho": "7850 kg/m^3"}
    branch = {"from": "gear", "name": "b", "ratio": 2, "parts": [twisted | {"diameter": "40 mm", "bore": "10 mm"}]}
    parts = [{"mass": "0.3 kg*m^2", "name": "motor"}, twisted, {"joint": True, "name": "gear"}, twisted]
    load = {"at": "motor", "times": ["0 s"], "steps": ["15 N*m"]}
    units = {"kind": "torsional", "angle": "deg", "velocity": "rpm", "moment": "kN*m", "length": "mm"}
    output = {
        "until": "1 ms",
        "strain": ["0 m"],
        "velocity": ["motor", "gear", "b:0.1 m"],
        "force": ["0 m"],
        "displacement": ["motor"],
    }
    scene = {
        "units": units,
        "system": {"type": "chain", "parts": parts, "branch": [branch]},
        "load": [load],
        "output": output,
    }
    c = sqrt(G / RHO)
    z1, z2 = J1 * sqrt(G * RHO), J2 * sqrt(G * RHO)
    t = 1.5 * L / c
    found, lam = values(scene, t), z1 / 0.3
    omega = 15 / z1 * (1 - exp(-lam * t))
    degrees, rpm = 180 / pi, 60 / (2 * pi)
    assert found["velocity@motor"] == pytest.approx(omega * rpm, rel=1e-12)
    assert found["displacement@motor"] == pytest.approx(15 / z1 * (t - (1 - exp(-lam * t)) / lam) * degrees, rel=1e-12)
    assert found["strain@0 m"] == pytest.approx(-omega / c * degrees / 1000, rel=1e-12)
    assert found["force@0 m"] == pytest.approx(-z1 * omega / 1000, rel=1e-12)
    wave = 15 / z1 * (1 - exp(-lam * (t - L / c)))
    assert found["velocity@gear"] == pytest.approx(2 * z1 * wave / (2 * z1 + 4 * z2) * rpm, rel=1e-12)
    wave = 15 / z1 * (1 - exp(-lam * (t - 1.3 / c)))
    assert found["velocity@b:0.1 m"] == pytest.approx(2 * 2 * z1 * wave / (2 * z1 + 4 * z2) * rpm, rel=1e-12)


def test_what_is_strained_at_first_lets_go() -> None:
    strained = STEEL | {"strain": "0.001"}
    load = {"at": "2 m", "times": ["0 s"], "steps": ["0 N"]}
    found = chain([strained, THIN], load, 0.5 / C, {}, velocity=["0 m"], force=["0.3 m", "1 m"])
    assert found["velocity@0 m"] == pytest.approx(0.001 * C, rel=CLOSE)  # the free end springs towards the rod
    assert found["force@1 m"] == pytest.approx(210e9 * 8e-4 * 0.001, rel=CLOSE)
    assert found["force@0.3 m"] == 0


def test_shear_and_twist_of_other_rods() -> None:
    for units, made, c, z in (
        (
            {"kind": "shear"},
            {"A": "2 m^2", "G": "45 MPa", "rho": "1.8 t/m^3"},
            sqrt(45e6 / 1800),
            2 * sqrt(45e6 * 1800),
        ),
        (
            {"kind": "shear"},
            {"A": "2 m^2", "G": "12 GPa", "rho": "2.5 t/m^3", "k": "5/6"},
            sqrt(1e10 / 2500),
            2 * sqrt(1e10 * 2500),
        ),
        (
            {"kind": "torsional"},
            {"J": "3 cm^4", "G": "80 GPa", "rho": "7850 kg/m^3"},
            sqrt(80e9 / 7850),
            3e-8 * sqrt(80e9 * 7850),
        ),
    ):
        step = "12 N*m" if units["kind"] == "torsional" else "12 N"
        load = {"at": "0 m", "times": ["0 s"], "steps": [step]}
        found = chain(
            [TIP, {"rod": "5 m", **made}, "absorbing"],
            load,
            4 / c,
            units,
            "0.1 s",
            velocity=["3 m", "5 m"],
            force=["3 m"],
        )
        assert found["velocity@3 m"] == pytest.approx(12 / z, rel=CLOSE)
        assert found["velocity@5 m"] == 0
        assert found["force@3 m"] == pytest.approx(-12, rel=CLOSE)


def softer(self: Columns, height: Any) -> Any:
    """Columns whose heads may turn."""
    return 3 * self.n * self.E * self.I / height**3


def lighter(self: Rods, number: int) -> Any:
    """Impedances without the ratio of delays."""
    return self.all[number].mass / self.first.mass


def unsigned(self: PhysicalDrive, load: Mapping[str, Any], unit: Any) -> LoadUnit:
    """The last moment with the sign of the others."""
    return LoadUnit("moment", "moment rate", unit, {"body": "at"}, {"at": load["body"] - 1})


@pytest.mark.parametrize(
    ("home", "name", "wrong", "law"),
    [
        (Columns, "stiffness", softer, test_columns_and_walls_are_as_stiff_and_heavy_as_books_say),
        (Rods, "impedance", lighter, partial(test_storeys_on_ground_that_moves, True)),
        (Rods, "impedance", lighter, partial(test_bodies_collide, rod("0.9 m", "4 cm^2"), "closed")),
        (PhysicalDrive, "_on_node", unsigned, partial(test_a_drive_turns, "0.9 m", 3)),
        (Scale, "factor", lambda self, quantity, rod: 1, partial(test_a_foundation_that_pushes, 1)),
        (Clock, "tau", lambda self, time, until: time, test_torsion_counts_angles_and_moments),
    ],
)
def test_what_breaks_a_law_is_seen(
    home: type, name: str, wrong: Any, law: Callable[[], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    law()
    monkeypatch.setattr(home, name, wrong)
    with pytest.raises(AssertionError):
        law()


@pytest.mark.parametrize(
    ("kind", "modulus", "section"),
    [
        ("shear", {"G": "58.32 MPa"}, {"A": "1 m^2"}),
        ("longitudinal", {"E": "58.32 MPa"}, {"A": "3 m^2"}),
        ("torsional", {"G": "58.32 MPa"}, {"diameter": "2 m"}),
    ],
)
def test_a_wave_speed_stands_for_the_modulus(kind: str, modulus: dict[str, str], section: dict[str, str]) -> None:
    """1800 kg/m^3 (180 m/s)^2 is 58.32 MPa: bars are the same fractions, and so is the time that results are in."""

    def column(stiff: dict[str, str]) -> Any:
        rods = [{"rod": length, "rho": "1800 kg/m^3", **section, **stiff} for length in ("4 m", "6 m")]
        system = {"type": "chain", "parts": ["free", *rods, "fixed"]}
        output = {"until": "0.1 s", "velocity": ["0 m"]}
        return lower(Scene(name="good", units={"kind": kind}, system=system, output=output))

    measured, derived, faster = (column(stiff) for stiff in ({"speed": "180 m/s"}, modulus, {"speed": "181 m/s"}))
    assert (measured.network, measured.clock) == (derived.network, derived.clock)
    assert (faster.network, faster.clock) != (derived.network, derived.clock)
    for twice in (modulus, {"k": "5/6"} if kind == "shear" else modulus):
        with pytest.raises(SceneError, match=f"{next(iter(twice))}: stands beside speed"):
            column({"speed": "180 m/s", **twice})
