"""Scenes in units: exact whatever the units are, rounded once where it is said, refused in a line that says where."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from math import isqrt
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
import pytest
from flint import fmpq
from hypothesis import given, settings
from hypothesis import strategies as st

import wavesym
from wavesym import api
from wavesym.cli import main
from wavesym.documents.inspection.units import remarks
from wavesym.errors import SceneError, UnservedError
from wavesym.fields.numbers import decimal_text
from wavesym.fields.rounding import decimal, polar_moment, root, rounded_root
from wavesym.fields.table import Faults
from wavesym.mechanics.clock import Clock
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import fraction
from wavesym.scene import Scene, lower
from wavesym.scene.explicit_text import explicit_text
from wavesym.scene.lowering import named_chain
from wavesym.scene.physical.scene import physical

FRAMES = Path(wavesym.__file__).parents[1] / "examples" / "frames"
STOREY = {"height": "3.5 m", "stiffness": "678 MN/m", "column_mass": "10.871 t", "floor_mass": "350 t"}
BUILDING = {
    "units": {},
    "name": "good",
    "system": {"type": "building", "base": "ground", "storey": [STOREY | {"count": 2}]},
    "load": [{"times": ["0 s", "20 ms"], "a": ["0.1 g", "-0.1 g"], "b": ["0 g/s", "0.5 g/s"]}],
    "output": {"until": "50 ms", "velocity": [2], "force": [0], "drift": [1]},
}
FRAME = """name = "frame"
[units]
[system]
type = "building"
base = "ground"
[[system.storey]]
count = 2
height = "3.5 m"
stiffness = "678 MN/m"
column_mass = "10.871 t"
floor_mass = "350 t"
[[load]]
times = ["0 s"]
a = ["0.3 g"]
"""
SHAFT = {"length": "1.2 m", "diameter": "50 mm", "G": "80 GPa", "rho": "7850 kg/m^3"}
DRIVE = {
    "units": {},
    "name": "good",
    "system": {"type": "drive", "shaft": [SHAFT, SHAFT], "disc": [{"inertia": "0.3 kg*m^2"}] * 3},
    "load": [{"body": 1, "times": ["0 s"], "steps": ["15 N*m"]}],
    "output": {"until": "2 ms", "velocity": [2]},
}
ROD = {"length": "1.2 m", "A": "8 cm^2", "E": "210 GPa", "rho": "7850 kg/m^3"}
BODY = {"left": ROD, "right": ROD, "mass": "12 kg", "velocity": "5 m/s"}
COLLISION = {
    "units": {},
    "name": "good",
    "system": {"type": "collision", "body": [BODY, BODY | {"velocity": "0 m/s"}]},
    "output": {"until": "2 ms", "velocity": [1]},
}
BAR = {"rod": "1.2 m", "A": "8 cm^2", "E": "210 GPa", "rho": "7850 kg/m^3", "name": "bar"}
CHAIN = {
    "units": {},
    "name": "good",
    "system": {
        "type": "chain",
        "parts": [{"mass": "12 kg", "name": "hammer", "velocity": "1 m/s"}, BAR, {"mass": "3 kg", "spring": "50 MN/m"}],
        "branch": [
            {"from": "hammer", "name": "arm", "parts": [{"rod": "30 cm", "impedance": "4 kN*s/m", "speed": "5 km/s"}]}
        ],
    },
    "load": [{"at": "1.2 m", "spacing": "0.1 ms", "samples": [0, 1, "1/2"], "unit": "kN"}],
    "output": {"until": "2 ms", "velocity": ["hammer", "arm:0.3 m"], "strain": ["0.2 m"], "drift": [1]},
}
ALL = {"building": BUILDING, "drive": DRIVE, "collision": COLLISION, "chain": CHAIN}
EVERY = pytest.mark.parametrize("name", list(ALL))


def changed(scene: Mapping[str, Any], path: str, value: object) -> dict[str, Any]:
    """A scene with another value at "system.storey.0.height"; None takes the key away."""
    made: dict[str, Any] = json.loads(json.dumps(scene))
    *inner, last = [int(key) if key.isdigit() else key for key in path.split(".")]
    table: Any = made
    for key in inner:
        table = table[key]
    if value is None:
        del table[last]
    else:
        table[last] = value
    return made


def refused(scene: Mapping[str, Any]) -> SceneError:
    start = process_time()
    with pytest.raises(SceneError) as error:
        Scene(**scene)
    assert process_time() - start < 1
    line = str(error.value)
    assert line.isascii()
    assert line.isprintable()
    assert len(line) < 300
    return error.value


@EVERY
def test_good_scenes_are_good(name: str) -> None:
    assert lower(Scene(**ALL[name])).clock


@pytest.mark.parametrize(("until", "noted"), [(30, True), ("1/2", True), ("30 s", False), ("50 ms", False)])
def test_a_horizon_of_tau_says_which_time_that_is(until: object, noted: bool) -> None:
    model = lower(Scene(**BUILDING | {"output": BUILDING["output"] | {"until": until}}))
    assert model.clock
    line = f'output.until: {until} is taken as tau, {model.clock.format(model.until)}; write "{until} s" if seconds are'
    assert [note.startswith(line) for note in model.labels.notes] == [True] * noted


@pytest.mark.parametrize(
    ("name", "kappa", "seconds", "horizon"), [("steel", 0.031, 4.00e-3, 7787), ("concrete", 0.093, 7.07e-3, 4413)]
)
def test_frames_are_what_engineers_make_of_them(name: str, kappa: float, seconds: float, horizon: int) -> None:
    model = lower(Scene.from_toml(FRAMES / f"{name}.toml").with_({"output.until": "31.18 s"}))
    assert model.clock
    assert float(model.letters["kappa"][1]) == pytest.approx(kappa, abs=5e-4)
    assert float(model.clock.seconds) == pytest.approx(seconds, abs=5e-6)
    assert model.horizon() == pytest.approx(horizon, abs=1)


UNITS = {
    "m": (("m", 1), ("ft", Fraction(3048, 10000)), ("mm", Fraction(1, 1000)), ("inch", Fraction(254, 10000))),
    "s": (("s", 1), ("ms", Fraction(1, 1000)), ("min", 60)),
    "kg": (("kg", 1), ("t", 1000), ("lb", Fraction(45359237, 10**8))),
    "N": (("N", 1), ("kN", 1000), ("kip", Fraction(45359237, 10**8) * 1000 * Fraction(980665, 10**5))),
}


@st.composite
def factors(draw: st.DrawFn) -> dict[str, tuple[str, Fraction]]:
    return {name: draw(st.sampled_from(others)) for name, others in UNITS.items()}


def in_units(value: Any, given: Mapping[str, tuple[str, Fraction]]) -> Any:
    """A scene in SI base units with its quantities in others, exactly: "3 N/m" as "p/q kip/ft"."""
    match value:
        case dict():
            return {key: in_units(each, given) for key, each in value.items()}
        case list():
            return [in_units(each, given) for each in value]
    number, space, unit = value.partition(" ") if isinstance(value, str) else ("", "", "")
    if not space:
        return value
    factor, names, sign = Fraction(1), [], "*"
    for part in unit.replace("/", " / ").replace("*", " * ").split():
        if part in "*/":
            sign = part
            continue
        base, _, power = part.partition("^")
        name, size = given[base]
        factor *= Fraction(size) ** (int(power or 1) * (1 if sign == "*" else -1))
        names.append(f"{sign}{name}{'^' if power else ''}{power}")
    return f"{Fraction(number) / factor} {''.join(names)[1:]}"


SIZES = st.integers(1, 10**6).map(lambda k: Fraction(k, 1000))


@st.composite
def frames(draw: st.DrawFn) -> dict[str, Any]:
    """A frame or a bar, in SI base units."""

    def some(unit: str) -> str:
        return f"{draw(SIZES)} {unit}"

    if draw(st.booleans()):
        storeys = [
            {"height": some("m"), "stiffness": some("N/m"), "column_mass": some("kg"), "floor_mass": some("kg")}
            for _ in range(draw(st.integers(1, 2)))
        ]
        system: dict[str, Any] = {"type": "building", "base": "force", "foundation_mass": some("kg"), "storey": storeys}
        load = {"times": ["0 s", some("s")], "a": [some("m/s^2"), some("m/s^2")], "b": [some("m/s^3"), some("m/s^3")]}
        output: dict[str, Any] = {"until": some("s"), "strain": [0], "velocity": [1], "force": [0]}
    else:
        rods = [{"rod": some("m"), "A": some("m^2"), "E": some("N/m^2"), "rho": some("kg/m^3")} for _ in range(2)]
        end = {"mass": some("kg"), "spring": some("N/m"), "dashpot": some("N*s/m"), "name": "end"}
        system = {"type": "chain", "parts": [{"joint": True, "name": "tip"}, *rods, end]}
        load = {"at": "tip", "times": ["0 s"], "steps": [some("N")], "ramps": [some("N/s")]}
        output = {"until": some("s"), "velocity": ["end"], "displacement": ["tip"], "strain": ["0 m"]}
    return {"name": "drawn", "units": {}, "system": system, "load": [load], "output": output}


def bare(model: Model) -> Model:
    """Without what it is called."""
    return replace(model, labels=replace(model.labels, loads=(), system={}))


@settings(max_examples=15, deadline=None)
@given(frames(), factors())
def test_units_can_be_mixed_and_change_nothing(scene: dict[str, Any], given: dict[str, tuple[str, Fraction]]) -> None:
    """Where places are no lengths, even the hash is the same."""
    one, other = lower(Scene(**scene)), lower(Scene(**in_units(scene, given)))
    assert scene["system"]["type"] == "chain" or other.labels.sha256 == one.labels.sha256
    assert bare(other).network == bare(one).network
    assert (other.loads, other.until, other.clock) == (one.loads, one.until, one.clock)
    assert [(p.rod, p.place, p.factor, p.unit) for p in other.probes] == [
        (p.rod, p.place, p.factor, p.unit) for p in one.probes
    ]


@given(st.fractions(min_value=Fraction(1, 10**40), max_value=10**40))
def test_a_root_is_the_nearest_of_17_digits(square: Fraction) -> None:
    if not square:
        return
    found = rounded_root(square)
    unit = Fraction(10) ** (len(str(isqrt(int(square * 10**90)))) - 45 - 17)
    assert (found / unit).denominator == 1
    assert (found - unit / 2) ** 2 <= square <= (found + unit / 2) ** 2
    assert root(square**2) == square


@given(st.fractions(min_value=Fraction(1, 10**9), max_value=10**9))
def test_decimals_round_to_even(number: Fraction) -> None:
    from decimal import ROUND_HALF_EVEN, Context, Decimal

    exactly = Context(prec=17, rounding=ROUND_HALF_EVEN).divide(Decimal(number.numerator), Decimal(number.denominator))
    assert decimal(number) == Fraction(exactly)
    assert Fraction(decimal_text(decimal(number))) == decimal(number)


def test_pi_is_right_to_the_last_digit() -> None:
    exact = Fraction(314159265358979323846264338327950288419716939937510, 10**50)
    assert polar_moment(Fraction(1, 20), Fraction(1, 100)) == decimal(
        exact / 32 * (Fraction(1, 20) ** 4 - Fraction(1, 100) ** 4)
    )


@given(SIZES, SIZES)
def test_the_delay_is_the_only_rounding_of_equal_storeys(mass: Fraction, stiffness: Fraction) -> None:
    storey = STOREY | {"count": 3, "column_mass": f"{mass} kg", "stiffness": f"{stiffness} N/m"}
    model = lower(Scene(**changed(BUILDING, "system.storey", [storey])))
    assert model.clock
    assert abs(fraction(model.clock.seconds) ** 2 * stiffness / mass - 1) < Fraction(1, 10**16)
    assert {fraction(kappa) for _, kappa, _ in model.parameters.numbers["kappa"]} == {mass / 350000}


def test_delays_of_one_material_stay_commensurable() -> None:
    parts = [{"mass": "12 kg"}, BAR, BAR | {"rod": "1.8 m", "A": "2 cm^2", "name": "other"}]
    bars = lower(
        Scene(
            **changed(
                changed(changed(CHAIN, "system.parts", parts), "system.branch", None),
                "output",
                {"until": 1, "velocity": ["0 m"]},
            )
        )
    ).network.bars
    assert [bar.delay for bar in bars] == [1, fmpq(3, 2)]
    assert [bar.impedance for bar in bars] == [1, fmpq(1, 4)]


@EVERY
def test_what_is_said_can_be_read_again_and_changed(name: str) -> None:
    scene = Scene(**ALL[name])
    assert lower(Scene(**scene.model_dump())) == lower(scene)
    assert lower(Scene(**json.loads(scene.model_dump_json()))) == lower(scene)
    longer = scene.with_({"output.until": "3 ms"})
    assert lower(longer).until != lower(scene).until
    assert lower(longer).labels.sha256 != lower(scene).labels.sha256
    assert lower(longer.with_({"output.until": scene.model_dump()["output"]["until"]})) == lower(scene)
    assert lower(scene.with_({"units.time": "ms"})).labels.sha256 != lower(scene).labels.sha256


def test_a_storey_can_be_changed() -> None:
    scene = Scene(**BUILDING)
    assert (
        lower(scene.with_({"system.storey[0].floor_mass": "700 t"})).parameters.numbers["kappa"][1].value
        == lower(scene).parameters.numbers["kappa"][1].value / 2
    )
    with pytest.raises(SceneError, match=r"system\.storey\[0\]\.floor_mass: \"7 m\" is a length, not a mass"):
        scene.with_({"system.storey[0].floor_mass": "7 m"})


@pytest.mark.parametrize("other", [{}, {"stiffness": "300 MN/m", "height": "3 m"}])
@pytest.mark.parametrize("base", ["ground", "force"])
def test_a_building_written_out_is_the_same_building(other: dict[str, str], base: str, tmp_path: Path) -> None:
    system: dict[str, Any] = {"type": "building", "base": base, "storey": [STOREY, STOREY | other]}
    if base == "force":
        system["foundation_mass"] = "500 t"
    one, other = both_ways(changed(BUILDING, "system", system), tmp_path)
    assert one == other


@pytest.mark.parametrize("base", ["ground", "force"])
def test_a_building_of_unequal_storeys_is_a_building(base: str) -> None:
    """It says so, and knows its foundation: where storeys hardly differ, it moves as the one where they do not."""
    system: dict[str, Any] = {"type": "building", "base": base, "storey": [STOREY, STOREY]}
    if base == "force":
        system["foundation_mass"] = "500 t"
    output = {"until": "50 ms", "displacement": [0, 2], "relative": [1, 2], "drift": [1, 2]}
    equal = Scene(**(BUILDING | {"system": system, "output": output}))
    hardly = STOREY | {"stiffness": "678000000.001 N/m"}
    unequal = Scene(**(BUILDING | {"system": system | {"storey": [STOREY, hardly]}, "output": output}))
    models = lower(equal), lower(unequal)
    assert named_chain(unequal) is None
    assert {model.labels.system["type"] for model in models} == {unequal.system.type} == {"building"}
    taus = np.linspace(0, models[1].horizon(), 9)
    one, other = (wavesym.evaluator(scene)(taus) for scene in (equal, unequal))
    assert np.abs(one - other).max() < 1e-9 * np.abs(one).max() < np.abs(one[2]).max()
    np.testing.assert_allclose(other[5], other[1] - other[0], atol=1e-15)  # relative@2, the roof less the foundation


@pytest.mark.parametrize("name", ["drive", "collision"])
def test_others_of_unequal_rods_are_still_what_they_are(name: str) -> None:
    path = "system.shaft.1.length" if name == "drive" else "system.body.0.left.length"
    scene = Scene(**changed(ALL[name], path, "0.9 m"))
    assert (named_chain(scene), lower(scene).labels.system["type"]) == (None, name)
    with pytest.raises(
        UnservedError, match=f"system.type: {name} of rods that differ, which is a chain, has no --walks"
    ):
        api.walks(scene, None, 2)
    with pytest.raises(SceneError, match=r"output.relative\[0\]: 1, but a .* has no foundation"):
        scene.with_({"output.relative": [1]})


@pytest.mark.parametrize("name", ["drive", "collision"])
@pytest.mark.parametrize("other", [False, True])
def test_others_written_out_are_the_same(name: str, other: bool, tmp_path: Path) -> None:
    scene = ALL[name]
    if other:
        path = "system.shaft.1.length" if name == "drive" else "system.body.0.left.length"
        scene = changed(scene, path, "0.9 m")
    one, written = both_ways(scene, tmp_path)
    assert one == written


def both_ways(given: Mapping[str, Any], folder: Path) -> list[list[list[str]]]:
    """The numbers of a scene, some of them not 0, and those of what it is as a chain."""
    scene = Scene(**given)
    (folder / "chain.toml").write_text(explicit_text(scene))
    written = Scene.from_toml(folder / "chain.toml")
    one, other = ([line.split(",") for line in api.run_csv(each, 7)] for each in (scene, written))
    assert any(float(cell) for line in one[1:] for cell in line[1:])
    return [one[1:], other[1:]]


REFUSED = [
    ("building", "units", 3, "units", "is not a table"),
    ("building", "units.colour", "m", "units.colour", "unknown key"),
    ("building", "units.length", "s", "units.length", '"s" is a time, not a length; write one such as "3.5 m"'),
    ("building", "units.length", 5, "units.length", '5 is not a unit; write one such as "m"'),
    ("building", "units.kind", "shear", "units.kind", "only chains have a choice, a building has none"),
    (
        "chain",
        "units.kind",
        "bending",
        "units.kind",
        '"bending" is not a kind of waves; write "longitudinal", "torsional" or "shear"',
    ),
    ("building", "system", 3, "system", "is not a table"),
    ("building", "system.type", None, "system.type", 'missing; write "collision", "drive", "building" or "chain"'),
    (
        "building",
        "system.type",
        "ship",
        "system.type",
        '"ship" is not a system; write "collision", "drive", "building" or "chain"',
    ),
    ("building", "system.base", None, "system.base", "missing"),
    ("building", "system.base", "rock", "system.base", '"rock" is not a base; write "force" or "ground"'),
    ("building", "system.kappa", [1], "system.kappa", "unknown key"),
    ("building", "system.foundation_mass", "3 t", "system.foundation_mass", "leave it out"),
    (
        "building",
        "system.base",
        "force",
        "system.foundation_mass",
        'missing, and base = "force" needs it; write a mass such as "350 t"',
    ),
    ("building", "system.storey", [], "system.storey", "no storey; write at least one [[system.storey]]"),
    ("building", "system.storey", {}, "system.storey", "is not a list"),
    (
        "building",
        "system.storey.0.count",
        0,
        "system.storey[0].count",
        "0 is out of range; write 1 to 10000 storeys in all",
    ),
    ("building", "system.storey.0.count", 10**9, "system.storey[0].count", "write 1 to 10000 storeys in all"),
    ("building", "system.storey.0.count", "3", "system.storey[0].count", "is not an integer"),
    (
        "building",
        "system.storey.0.height",
        3.5,
        "system.storey[0].height",
        '3.5 is not a length; write one such as "3.5 m"',
    ),
    (
        "building",
        "system.storey.0.height",
        "3.5 kg",
        "system.storey[0].height",
        '"3.5 kg" is a mass, not a length; write one such as "3.5 m"',
    ),
    (
        "building",
        "system.storey.0.height",
        "-3.5 m",
        "system.storey[0].height",
        '"-3.5 m" is not positive; write a length above 0',
    ),
    ("building", "system.storey.0.height", "3 m**999999999", "system.storey[0].height", "powers up to ^9"),
    ("building", "system.storey.0.height", "1e999999999 m", "system.storey[0].height", "an exponent from"),
    ("building", "system.storey.0.height", "nan m", "system.storey[0].height", "a length"),
    ("building", "system.storey.0.height", "3 \u00e5", "system.storey[0].height", '"3 \\xe5" is not a quantity'),
    ("building", "system.storey.0.height", None, "system.storey[0].height", 'missing; write a length such as "3.5 m"'),
    (
        "building",
        "system.storey.0.floor_mass",
        "3 g*m",
        "system.storey[0].floor_mass",
        '"3 g*m" is m*kg, not a mass; write one such as "350 t"',
    ),
    (
        "building",
        "system.storey.0.column_mass",
        None,
        "system.storey[0].column_mass",
        'missing; write a mass such as "10.9 t"',
    ),
    (
        "building",
        "system.storey.0.stiffness",
        None,
        "system.storey[0].stiffness",
        "missing; write stiffness, columns or shear",
    ),
    (
        "building",
        "system.storey.0.columns",
        {"n": 1, "E": "1 Pa", "I": "1 m^4"},
        "system.storey[0].columns",
        "stands beside stiffness; write one of them",
    ),
    ("building", "load.0.times.0", 1, "load[0].times[0]", '1 is not a time; write one such as "20 ms"'),
    ("building", "system.storey.0.height", 0, "system.storey[0].height", "0 is not positive; write a length above 0"),
    (
        "building",
        "system.storey.0.column_mass",
        "0 t",
        "system.storey[0].column_mass",
        "columns without mass have no waves",
    ),
    (
        "building",
        "load.0.times.0",
        "30 ms",
        "load[0].times[1]",
        '"20 ms" is not later than the "30 ms" before it; write times in rising order',
    ),
    ("building", "load.0.times.0", "-1 s", "load[0].times[0]", '"-1 s" is negative; write a time of 0 or more'),
    (
        "building",
        "load.0.a.1",
        "3 m/s",
        "load[0].a[1]",
        '"3 m/s" is a velocity, not an acceleration; write one such as "0.3 g"',
    ),
    (
        "building",
        "load.0.b.1",
        "3 g",
        "load[0].b[1]",
        '"3 g" is an acceleration, not a jerk; write one such as "2 m/s^3"',
    ),
    ("building", "load.0.a", ["1 g"], "load[0].a", "1 numbers for 2 times"),
    ("building", "load.0.unit", "g", "load[0].unit", "leave it out"),
    (
        "building",
        "load.0",
        {"spacing": "1 s", "samples": [1]},
        "load[0].unit",
        'missing; write the unit of the samples, such as "g"',
    ),
    (
        "building",
        "load.0",
        {"spacing": "1 s", "samples": [1], "unit": "m"},
        "load[0].unit",
        '"m" is a length, not an acceleration; write one such as "0.3 g"',
    ),
    (
        "building",
        "load.0",
        {"spacing": 1, "samples": [1], "unit": "g"},
        "load[0].spacing",
        '1 is not a time; write one such as "20 ms"',
    ),
    (
        "building",
        "load.0",
        {"spacing": "1 s", "samples": ["1 g"], "unit": "g"},
        "load[0].samples[0]",
        "is not a number",
    ),
    ("building", "load.0", {"record": "nowhere.at2"}, "load[0].record", "nowhere.at2"),
    ("building", "load.0", {"record": 3}, "load[0].record", "3 is not a path"),
    (
        "building",
        "load.0",
        {"spacing": "1 s", "samples": [1], "unit": "g", "start": "1 s"},
        "load[0].start",
        "unknown key",
    ),
    ("building", "output.until", "3 m", "output.until", '"3 m" is a length, not a time; write one such as "20 ms"'),
    ("building", "output.until", "1e12 s", "output.until", "2.49735e+14 of tau, too long a horizon"),
    ("building", "output.until", "0 s", "output.until", '"0 s" is not positive; write a time above 0'),
    ("building", "output.velocity", ["2 m"], "output.velocity[0]", "is not a number"),
    (
        "building",
        "output.velocity",
        [3],
        "output.velocity[0]",
        "3 is not on the chain; write a position from 0, the foundation, to 2, the roof",
    ),
    ("drive", "system.disc", [{"inertia": "1 kg*m^2"}], "system.disc", "1 discs; write 3 (one more than shafts)"),
    (
        "drive",
        "system.disc.0.inertia",
        "1 kg",
        "system.disc[0].inertia",
        '"1 kg" is a mass, not a moment of inertia; write one such as "12 kg*m^2"',
    ),
    ("drive", "system.shaft", [], "system.shaft", "no shaft; write at least one"),
    (
        "drive",
        "system.shaft.0.bore",
        "5 cm",
        "system.shaft[0].bore",
        "as wide as the shaft or wider; write a bore below the diameter",
    ),
    ("drive", "system.shaft.0.J", "5 cm^4", "system.shaft[0].diameter", "stands beside J; write one of them"),
    ("drive", "system.shaft.0.diameter", None, "system.shaft[0].J", "missing; write J or diameter"),
    (
        "drive",
        "load.0.steps.0",
        "15 N",
        "load[0].steps[0]",
        '"15 N" is a force, not a moment; write one such as "15 kN*m"',
    ),
    ("drive", "load.0.body", 4, "load[0].body", "4 is not the number of a body; write 1 to 3"),
    ("collision", "system.body", [BODY], "system.body", "1 bodies; write at least 2"),
    (
        "collision",
        "system.body.1.velocity",
        "6 m/s",
        "system.body[1].velocity",
        "more than the 5 m/s of the body on its left, and they would part; write that or less",
    ),
    (
        "collision",
        "system.body.1.left.E",
        "6 kN",
        "system.body[1].left.E",
        '"6 kN" is a force, not a modulus; write one such as "210 GPa"',
    ),
    ("collision", "system.contacts", "ajar", "system.contacts", '"ajar" is unknown; write "closed" or "open"'),
    ("collision", "load", [{"times": ["0 s"]}], "load[0]", "a collision has its velocities; leave [[load]] out"),
    ("chain", "system.parts.1.E", None, "system.parts[1].E", 'missing; write a modulus such as "210 GPa"'),
    ("chain", "system.parts.1.G", "80 GPa", "system.parts[1].G", "unknown key"),
    (
        "chain",
        "system.parts.1.speed",
        "5 km/s",
        "system.parts[1].E",
        "stands beside speed; a rod has impedance and speed, or speed, rho and A, or E, A and rho: leave the other out",
    ),
    ("chain", "system.parts.1.strain", "1 m", "system.parts[1].strain", "is not a number"),
    ("chain", "system.parts.1.velocity", 1, "system.parts[1].velocity", "a velocity"),
    (
        "chain",
        "system.parts.0.mass",
        "12 kg*m^2",
        "system.parts[0].mass",
        '"12 kg*m^2" is a moment of inertia, not a mass; write one such as "350 t"',
    ),
    ("chain", "system.parts.0.mass", "0 kg", "system.parts[0].mass", '"0 kg" is not positive; write a mass above 0'),
    (
        "chain",
        "system.parts.2.spring",
        "-1 N/m",
        "system.parts[2].spring",
        '"-1 N/m" is negative; write a stiffness of 0 or more',
    ),
    ("chain", "system.parts.2.inertia", "-1 N/m", "system.parts[2].inertia", "unknown key"),
    ("chain", "system.parts", [{"mass": "1 kg"}], "system.branch[0].from", '"hammer" is not a node before it'),
    ("chain", "system.parts", ["loose"], "system.parts[0]", "free, fixed, absorbing"),
    (
        "chain",
        "system.branch.0.parts.0.impedance",
        "1 N",
        "system.branch[0].parts[0].impedance",
        '"1 N" is a force, not a damping constant; write one such as "40 kN*s/m"',
    ),
    (
        "chain",
        "system.branch.0.from",
        "nobody",
        "system.branch[0].from",
        "is not a node before it; write the name of one",
    ),
    ("chain", "load.0.at", "5 m", "load[0].at", '"5 m" is not on the chain; write a place from 0 to 1.2 m'),
    ("chain", "load.0.at", 1, "load[0].at", '1 is not a place; write one such as "1.2 m", or the name of a node'),
    ("chain", "load.0.at", "1.2", "load[0].at", "a length"),
    ("chain", "load.0.at", None, "load[0].at", "missing"),
    (
        "chain",
        "load.0.unit",
        "m/s^2",
        "load[0].unit",
        '"m/s^2" is an acceleration, not a force; write one such as "12 kN"',
    ),
    ("chain", "output.velocity", ["arm:0.4 m"], "output.velocity[0]", "from 0 to 0.3 m"),
    (
        "chain",
        "output.velocity",
        [1],
        "output.velocity[0]",
        '1 is not a place; write one such as "1.2 m", or the name of a node',
    ),
    ("chain", "output.velocity", ["nobody"], "output.velocity[0]", "the name of a node or branch"),
    ("chain", "output.drift", ["1 m"], "output.drift[0]", '"1 m" is not a number'),
]


@pytest.mark.parametrize(("name", "path", "value", "where", "what"), REFUSED)
def test_wrong_scenes_are_refused_where_they_are_wrong(
    name: str, path: str, value: object, where: str, what: str
) -> None:
    error = refused(changed(ALL[name], path, value))
    assert error.path == where
    assert what in error.what


def test_a_mass_without_branches_needs_what_holds_it() -> None:
    error = refused(changed(changed(CHAIN, "system.parts", [{"mass": "1 kg"}]), "system.branch", None))
    assert (error.path, error.what) == ("system.parts", "no rod, spring or dashpot; write at least one")


def paths(value: Any, path: str = "") -> list[str]:
    """Of all keys and items in a scene."""
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    found = [(f"{path}.{key}".lstrip("."), each) for key, each in inner]
    return [at for here, each in found for at in (here, *paths(each, here))]


RUBBISH = [
    None,
    True,
    -1,
    0,
    "x",
    "",
    [],
    {},
    "1 m",
    "-1 m",
    ["1 m"],
    {"a": 1},
    float("nan"),
    "1e400 m",
    "fixed",
    "9" * 200,
]
RUBBISH += [{"rod": "1 m"}, {"mass": "1 kg"}, {"motion": "velocity"}, [[]], "1 m+", "a:1 m", "\ud800", "1 s", [1, 2, 3]]


@pytest.mark.parametrize("zero", [0, 0.0, "0", "0/3", "0.0"])
def test_zero_needs_no_unit(zero: object) -> None:
    scene = changed(changed(BUILDING, "load.0.times.0", zero), "load.0.b.0", zero)
    assert Scene(**scene).load == Scene(**BUILDING).load


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_rubbish_is_refused_in_a_line(data: st.DataObject) -> None:
    scene = ALL[data.draw(st.sampled_from(list(ALL)))]
    rubbish = changed(scene, data.draw(st.sampled_from(paths(scene))), data.draw(st.sampled_from(RUBBISH)))
    try:
        lower(Scene(**rubbish))
    except SceneError as error:
        text = str(error)
    else:
        return
    assert text.isascii()
    assert all(line.isprintable() for line in text.split("\n"))


def test_a_refusal_names_the_file_and_nothing_is_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = (FRAMES / "steel.toml").read_text().replace('"350 t"', '"350 kN"')
    (tmp_path / "bad.toml").write_text(text)
    assert main(["run", str(tmp_path / "bad.toml"), "-o", str(tmp_path / "out.csv")]) == 2
    where, what = capsys.readouterr().err.split(": ", 1)
    assert where == str(tmp_path / "bad.toml")
    assert what == 'system.storey[0].floor_mass: "350 kN" is a force, not a mass; write one such as "350 t" (line 19)\n'
    assert not (tmp_path / "out.csv").exists()


def table(scene: Scene, at: list[float] | None = None) -> list[list[str]]:
    return [line.rstrip("\n").split(",") for line in api.run_csv(scene, 6, at)]


def test_results_speak_seconds_and_units() -> None:
    scene = Scene(**BUILDING)
    head, *rows = table(scene)
    assert head == ["time", "velocity@2 [m/s]", "force@0 [N]", "drift@1 [m]"]
    assert [row[0] for row in rows] == ["0.0", "0.01", "0.02", "0.03", "0.04", "0.05"]
    assert table(scene, [0.01, 0.02, 0.05]) == [head, rows[1], rows[2], rows[5]]
    told = {"time": "ms", "length": "mm", "force": "kN", "velocity": "km/hour"}
    head, *others = table(Scene(**(BUILDING | {"units": told})))
    assert head == ["time [ms]", "velocity@2 [km/hour]", "force@0 [kN]", "drift@1 [mm]"]
    for row, other in zip(rows, others, strict=True):
        time, velocity, force, drift = (float(cell) for cell in row)
        assert list(map(float, other)) == pytest.approx(
            [time * 1e3, velocity * 3.6, force / 1e3, drift * 1e3], rel=1e-15
        )


def test_what_begins_at_a_decimal_has_begun_then() -> None:
    """Whether a double of tau is below the instant or not: the acceleration of the ground jumps at 20 ms."""
    for time in ("20 ms", "7 ms", "13.7 ms", "1/3 s", "11.11 ms"):
        load = [{"times": [time], "a": ["1 m/s^2"], "b": ["0 g/s"]}]
        scene = Scene(**(BUILDING | {"load": load, "output": {"until": "0.5 s", "velocity": [0]}}))
        model = lower(scene)
        assert model.clock
        (first,) = model.loads
        decimal_time = 1 / 3 if time == "1/3 s" else float(time.split()[0]) / 1000
        tau = model.clock.tau(decimal_time, model.until)
        exact = Fraction(repr(decimal_time)) / fraction(model.clock.seconds)
        assert Fraction(tau) >= exact
        assert time == "1/3 s" or Fraction(tau) >= fraction(first.time)
    _, *rows = table(Scene(**(BUILDING | {"output": {"until": "1/3 s", "velocity": [0]}})), [1 / 3, 0.4])
    assert rows[0][1] != "nan"
    assert rows[1][1] == "nan"


def test_programs_keep_tau_and_say_what_it_is(tmp_path: Path) -> None:
    scene = Scene(**BUILDING)
    wavesym.generate(scene, tmp_path, language="all")
    header, manifest = (tmp_path / "good.h").read_text(), json.loads((tmp_path / "good.json").read_text())
    seconds = float(lower(scene).clock.seconds)  # type: ignore[union-attr]
    assert f"#define GOOD_SECONDS_PER_TAU {seconds!r}\n" in header
    assert " *   force@0 [N] " in header
    assert Fraction(manifest["seconds_per_tau"]) == fraction(lower(scene).clock.seconds)  # type: ignore[union-attr]
    assert [output["unit"] for output in manifest["outputs"]] == ["m/s", "N", "m"]
    namespace: dict[str, Any] = {}
    exec((tmp_path / "good.py").read_text(), namespace)
    assert namespace["SECONDS_PER_TAU"] == seconds
    assert namespace["UNITS"] == ("m/s", "N", "m")
    taus = [0.5, 3.0, 7.7]
    response = wavesym.evaluator(scene)
    assert (response.units, response.seconds_per_tau) == (namespace["UNITS"], seconds)
    expected = response(taus)
    assert abs(namespace["evaluate"](taus) - expected).max() <= 1e-9 * abs(expected).max()


def test_programs_without_units_do_not_speak_of_them(tmp_path: Path) -> None:
    wavesym.generate(Scene.from_toml("building_m2"), tmp_path, language="all")
    for path in tmp_path.iterdir():
        text = path.read_text()
        assert "SECONDS" not in text
        assert '"unit"' not in text


@pytest.mark.slow
def test_inspections_speak_of_the_structure() -> None:
    scene = Scene.from_toml(FRAMES / "steel.toml").with_({"output.until": "20 ms"})
    units = json.loads(api.inspect(scene, format="json"))["units"]
    assert units["physics_up_to"] == pytest.approx(125, abs=0.5)
    assert units["horizon"]["time"] == 0.02
    # ten equal masses on springs that have a third of their own mass at each end: a textbook's shear frame
    from math import pi, sin, sqrt

    stiffness = 12 * 20 * 210e9 * 57680e-8 / 3.5**3
    heavier = [1 / (2 * sqrt(stiffness / mass) * sin(pi / 42) / (2 * pi)) for mass in (350e3, 350e3 + 10871)]
    assert heavier[0] < units["periods"][0] < heavier[1]


def test_remarks_are_made_of_what_is_odd() -> None:
    stout = [ROD | {"length": "5 cm"}, ROD]
    body = BODY | {"left": stout[0], "right": stout[0], "mass": "1 t"}
    scene = changed(COLLISION, "system.body", [body, body | {"velocity": "0 m/s", "mass": "10 g"}])
    said = list(remarks(physical(scene, Faults())))
    assert any(line.startswith("rods 1 to 4 are 1.77 times as long as wide") for line in said)
    assert any(line.startswith("kappa = 31.4 of rod 2, above 10") for line in said)
    assert any(line.startswith("kappa = ") and "of rod 1, " not in line for line in said)
    assert not list(remarks(physical(BUILDING, Faults())))


def test_what_is_refused_later_speaks_of_seconds_too(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Engines know only tau; who gave seconds and g reads of these."""
    file = tmp_path / "frame.toml"
    file.write_text(FRAME + '[output]\nuntil = "2000 s"\ndrift = [1]\n')
    said = []
    for evaluator in ("pieces", "modes"):
        assert main(["generate", str(file), "--evaluator", evaluator, "--check"]) == 2
        said.append(capsys.readouterr().err)
    assert re.search(r"3 nodes times [0-9.e+]+ units of tau \(2000 s\) are", said[0])
    assert "load: a jumps by 2.94199 m/s^2 at 0 s, and modes support no jump" in said[1]
    assert "`start`, one spacing, of a record" in said[1]
    another = '[[system.storey]]\nheight = "3 m"\nstiffness = "1 GN/m"\ncolumn_mass = "9 t"\nfloor_mass = "300 t"\n'
    differing = tmp_path / "differing.toml"
    differing.write_text(file.read_text().replace("[[load]]", another + "[[load]]"))
    assert main(["generate", str(differing), "--evaluator", "modes", "--check"]) == 2
    assert "load: what acts at 0 jumps by 2.94199 m/s^2 at 0 s" in capsys.readouterr().err
    file.write_text(file.read_text().replace("10.871 t", "1e200 kg").replace("350 t", "1e-200 kg"))
    assert main(["run", str(file)]) == 2
    assert capsys.readouterr().err.startswith(f"{file}: system: its quantities make kappa[0]: a number of about 400")


def test_taus_in_a_message_have_their_times_beside_them() -> None:
    clock = Clock(fmpq(1, 8), fmpq(125), "ms")
    assert clock.append_times("a bound to tau = 1.6e+1 for x") == "a bound to tau = 1.6e+1 (2000 ms) for x"
    assert clock.append_times("by tau = 58.5, at most 3 expected.") == "by tau = 58.5 (7312.5 ms), at most 3 expected."
    assert clock.append_times("from tau = 4. 3 nodes times 8 units of tau") == (
        "from tau = 4 (500 ms). 3 nodes times 8 units of tau (1000 ms)"
    )
    assert clock.append_times("a tau that is no number") == "a tau that is no number"


def test_places_of_pictures_have_units() -> None:
    pytest.importorskip("matplotlib")
    from matplotlib.figure import Figure

    from wavesym.pictures.xt import _lengths

    axes = Figure().add_subplot()
    axes.set_xlim(0, 2.5)
    _lengths(axes, "arm:x in mm", 1200)
    assert axes.get_xlabel() == "arm:x in mm"
    for x, label in zip(axes.get_xticks(), axes.get_xticklabels(), strict=True):
        assert float(label.get_text()) == pytest.approx(x * 1200, abs=1e-9)


@pytest.mark.parametrize(("rods", "whole"), [(1, 1.2), (3, 0.7), (3, 0.6), (5, 2.4), (9, 3.0), (55, 3.5)])
def test_a_picture_has_a_tick_at_its_end(rods: int, whole: float) -> None:
    """Where that is a round length, whatever doubles make of so many rods of a part of it."""
    pytest.importorskip("matplotlib")
    from matplotlib.figure import Figure

    from wavesym.pictures.xt import _lengths

    axes = Figure().add_subplot()
    axes.set_xlim(0, rods)
    _lengths(axes, "x in m", whole / rods)
    assert (axes.get_xticks()[-1], axes.get_xticklabels()[-1].get_text()) == (rods, f"{whole:g}")
    assert axes.get_xlim() == (0, rods)


@pytest.mark.slow
def test_colours_of_pictures_have_units() -> None:
    pytest.importorskip("matplotlib")
    from wavesym.pictures import xt

    scene = Scene(**CHAIN)
    figure = xt.draw(lower(scene), scene.system.lines, scene.physical)
    assert {each.get_xlabel() for each in figure.axes} >= {"arm:x in m", "x in m"}
    words = {each.get_text() for each in figure.texts}
    assert words >= {"Velocity in m/s", "Force in N: pull red, push blue", "Good: waves over place and time"}
    assert {each.get_ylabel() for each in figure.axes} >= {"t in s"}


@pytest.mark.slow
def test_scenes_without_units_do_not_wait_for_pint() -> None:
    code = "import sys, wavesym; wavesym.tables(wavesym.Scene.from_toml('drive_m1')); assert 'pint' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True, cwd=FRAMES.parents[1])


def test_a_delay_that_is_rational_is_exact() -> None:
    """15 m at 450 m/s: samples 0.02 s apart are 3/5 of it, and not an ulp beside."""
    parts = [{"rod": "15 m", "speed": "450 m/s", "impedance": "1 kN*s/m", "name": "a"}, {"joint": True, "name": "top"}]
    load = {"at": "top", "spacing": "0.02 s", "samples": [0, 1, 0], "unit": "kN"}
    output = {"until": "1 s", "velocity": ["top"]}
    system = {"type": "chain", "parts": parts}
    model = lower(Scene(name="column", units={"kind": "shear"}, system=system, load=[load], output=output))
    assert model.clock is not None
    assert model.clock.seconds == fmpq(1, 30)
    assert model.spacing == fmpq(3, 5)


def test_a_shaft_is_as_slender_as_its_length_over_its_diameter() -> None:
    shaft = {"rod": "70 cm", "diameter": "200 mm", "G": "80 GPa", "rho": "7850 kg/m^3"}
    scene = {
        "name": "shaft",
        "units": {"kind": "torsional", "length": "m", "time": "ms"},
        "system": {"type": "chain", "parts": [{"joint": True, "name": "end"}, shaft, "fixed"]},
        "load": [{"at": "end", "times": ["0 s"], "steps": ["1 kN*m"]}],
        "output": {"until": "1 ms", "tolerance": 1e-9, "velocity": ["0 m"]},
    }
    said = list(remarks(physical(scene, Faults())))
    assert any(line.startswith("rod 1 is 3.5 times as long as wide") for line in said)
