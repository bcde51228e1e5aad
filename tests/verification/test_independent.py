"""What integrators read of a scene: what programs start from, where that is right, and else something else."""

from __future__ import annotations

import inspect
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings

from tests.support.drawn import scenes
from wavesym import api
from wavesym.cli import main
from wavesym.errors import UnservedError
from wavesym.scene import Scene, builtin_names, lower
from wavesym.systems import SYSTEMS, building, chain_places, collision, drawing, drive, explicit
from wavesym.verification.collocation import integrate
from wavesym.verification.independent import READERS, independent_model
from wavesym.verification.integrations import collocation
from wavesym.verification.problem import Problem, corner_problem
from wavesym.verification.reference import known_outputs

EVERY_PART: dict[str, Any] = {
    "name": "parts",
    "system": {
        "type": "chain",
        "parts": [
            {"mass": 4, "velocity": 1, "name": "hammer"},
            {"rod": 1, "strain": "1/5", "velocity": 1},
            {"rod": "3/2", "impedance": 2, "speed": "3/2", "spring": "1/3", "dashpot": "1/7"},
            {"mass": "1/2", "dashpot": "1/10", "name": "gear", "velocity": 0},
            {"spring": 3, "dashpot": "1/4"},
            {"joint": True, "name": "end", "spring": "1/2"},
            {"rod": "1/2"},
            "absorbing",
        ],
        "branch": [
            {"from": "gear", "name": "a", "ratio": -2, "parts": [{"rod": 1, "impedance": "1/2"}, {"mass": 1}]},
            {"from": "end", "name": "b", "parts": [{"spring": 1}, {"mass": 1, "name": "hung"}, {"rod": 2}, "fixed"]},
        ],
    },
    "load": [
        {"at": "hammer", "times": [0, "3/2"], "steps": [1, -1], "ramps": [0, "1/3"]},
        {"at": "a:1", "spacing": "1/2", "samples": [1, 2, -1]},
        {"at": "hammer", "times": ["1/3"], "ramps": [1]},
    ],
    "output": {
        "until": 3,
        "strain": ["1-", "1+", "1/2", "a:0", "gear-", "b:0+"],
        "velocity": ["hammer", "end", "a:1/2", "a:0", "hung", "5/2-"],
        "displacement": ["gear", "3"],
        "acceleration": ["hung", "a:1"],
        "force": ["1-", "b:1"],
        "drift": [1, "a:1", "b:1"],
    },
}
MOVED: dict[str, Any] = {
    "name": "moved",
    "system": {
        "type": "chain",
        "parts": [
            {"motion": "acceleration", "velocity": "1/2", "name": "base"},
            {"rod": 1},
            {"mass": 1},
            {"spring": 1},
            {"motion": "velocity", "name": "top"},
        ],
    },
    "load": [{"at": "base", "times": [0, 1], "steps": [1, -2]}, {"at": "top", "times": [0], "ramps": [1]}],
    "output": {"until": 3, "velocity": ["base", "1-"], "displacement": ["1+"]},
}
TOUCHING: dict[str, Any] = {
    "name": "touching",
    "system": {
        "type": "chain",
        "parts": [
            {"mass": 1, "velocity": 1},
            {"rod": 1, "velocity": 1},
            {"contact": "1/3"},
            {"rod": 2},
            "contact",
            "fixed",
        ],
    },
    "output": {"until": 3, "velocity": ["1-", "1+"], "strain": ["3"]},
}
OPEN: dict[str, Any] = {
    "name": "opened",
    "system": {"type": "collision", "m": 4, "kappa": ["1/3", 2], "velocity": [1, "-1/2"], "contacts": "open"},
    "output": {"until": 3, "velocity": ["2-", "2+"], "strain": ["3+"]},
}


def numbers(made: Problem) -> list[Any]:
    """All that a problem is made of, in units of its first impedance; of points without mass only what is felt."""
    unit, heavy = made.impedance[0], made.mass > 0
    taus = np.linspace(0, 3, 37)
    loads = made.loads(taus)
    loads[made.is_free] /= unit
    parts = [
        made.mass / unit,
        made.damping / unit,
        made.stiffness / unit,
        made.impedance / unit,
        loads,
        made.velocity * heavy,
    ]
    return [*parts, made.ends, made.ratios, made.speed, made.start_velocity, made.start_strain, made.gaps, made.parting]


def assert_same(scene: Scene) -> None:
    """The same network under the same loads, and the same outputs of it."""
    model = lower(scene)
    own = independent_model(scene, model)
    theirs, ours = corner_problem(model), corner_problem(own)
    for one, other in zip(numbers(theirs), numbers(ours), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-14, atol=1e-14)
    until = min(float(model.until), 3.0)
    taus = np.linspace(0, until, 23)
    motion = integrate(ours, until, 16)
    read = (np.array([motion.evaluate(reading, taus.tolist()) for reading in made.readings]) for made in (ours, theirs))
    ours_out, theirs_out = (made.outputs(values, taus) for made, values in zip((ours, theirs), read, strict=True))
    np.testing.assert_allclose(ours_out, theirs_out, rtol=1e-9, atol=1e-9)  # where programs have them


@pytest.mark.parametrize("name", builtin_names())
def test_built_in_scenes_are_read_alike(name: str) -> None:
    assert_same(Scene.from_toml(name))


@pytest.mark.parametrize("fields", [EVERY_PART, MOVED, TOUCHING, OPEN], ids=lambda fields: fields["name"])
def test_every_part_is_read_alike(fields: dict[str, Any]) -> None:
    assert_same(Scene(**fields))


@settings(max_examples=25)
@given(scenes())
def test_random_scenes_are_read_alike(scene: Scene) -> None:
    assert_same(scene)


def test_a_record_is_read_alike(tmp_path: Path) -> None:
    (tmp_path / "record.csv").write_text("time,a\n1,3\n1.5,-2\n2,1\n")
    system = {"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": "ground"}
    load = [{"record": str(tmp_path / "record.csv"), "scale": "1/2"}]
    assert_same(Scene(name="recorded", system=system, load=load, output={"until": 4, "velocity": [1], "relative": [2]}))


BUILDING = {
    "name": "fault",
    "system": {"type": "building", "m": 2, "kappa": [1, "1/2", "1/3"], "base": "ground"},
    "load": [{"times": [0], "a": [1], "b": [0]}],
    "output": {"until": 3, "tolerance": "1e-4", "velocity": [2]},
}
FORCED = BUILDING | {"system": {**BUILDING["system"], "base": "force"}}
DRIVE = {
    "name": "fault",
    "system": {"type": "drive", "m": 1, "kappa": [1], "inertia": [1, 2]},
    "load": [{"body": 2, "times": [0], "steps": [1]}],
    "output": {"until": 3, "tolerance": "1e-4", "velocity": [0]},
}
COLLISION = {
    "name": "fault",
    "system": {"type": "collision", "m": 4, "kappa": [1, 2], "velocity": [1, 0]},
    "output": {"until": 3, "tolerance": "1e-4", "velocity": [3]},
}
CHAIN = {
    "name": "fault",
    "system": {
        "type": "chain",
        "parts": [{"mass": 1, "name": "a"}, {"rod": 1}, {"rod": 1, "impedance": 2}, {"mass": 1}],
    },
    "load": [{"at": "a", "times": [0], "steps": [1]}],
    "output": {"until": 3, "tolerance": "1e-4", "velocity": ["1/4"], "strain": ["3/2"]},
}
FAULTS = {
    "floors of a building": (building, BUILDING, "alpha=2 * p.kappa[i], beta", "alpha=3 * p.kappa[i], beta"),
    "its base": (building, FORCED, "(-1 / p.kappa[0],)", "(1 / p.kappa[0],)"),
    "discs of a drive": (drive, DRIVE, "p.inertia[i] / p.inertia[i + 1]", "p.inertia[i + 1] / p.inertia[i]"),
    "its last moment": (drive, DRIVE, "sign=-1", "sign=1"),
    "bodies of a collision": (collision, COLLISION, "alpha=2 * p.kappa[i]", "alpha=p.kappa[i]"),
    "its velocities": (collision, COLLISION, "velocity=p.velocity[m - 1]", "velocity=p.velocity[1]"),
    "rods of a chain": (drawing, CHAIN, "rational(part.impedance),", "rational(part.impedance**2),"),
    "places on it": (chain_places, CHAIN, "Place(x, 0, line, rod + 1, (x -", "Place(x, 0, line, rod + 1, 1 - (x -"),
}
QUICK = ("floors of a building", "its last moment", "rods of a chain", "places on it")


def put_in(fault: str, monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """The module of a system with one text of it replaced, in the place of the right one; a scene that is wrong now."""
    module, fields, right, wrong = FAULTS[fault]
    text = inspect.getsource(module)
    assert right in text
    changed = ModuleType(module.__name__)
    exec(compile(text.replace(right, wrong), str(module.__file__), "exec"), vars(changed))  # the project's own text
    match module.__name__.rpartition(".")[2]:
        case "drawing":
            monkeypatch.setattr(explicit, "draw_parts", changed.draw_parts)
        case "chain_places":
            monkeypatch.setattr(explicit, "place", changed.place)
        case kind:
            monkeypatch.setitem(SYSTEMS, kind, getattr(changed, kind.title()))
    return fields


@pytest.mark.parametrize(
    "fault", [each if each in QUICK else pytest.param(each, marks=pytest.mark.slow) for each in FAULTS]
)
def test_what_programs_start_from_is_not_what_integrators_do(fault: str, monkeypatch: pytest.MonkeyPatch) -> None:
    fields = put_in(fault, monkeypatch)
    scene = Scene(**fields)
    model = lower(scene)
    assert not all(outcome.passed for outcome in collocation(known_outputs(model, independent_model(scene, model))))
    assert all(outcome.passed for outcome in collocation(known_outputs(model)))  # from the same wrong nodes


def test_verify_exits_with_1(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = """name = "fault"
        system = { type = "building", m = 2, kappa = [1, "1/2", "1/3"], base = "ground" }
        load = [{ times = [0], a = [1], b = [0] }]
        output = { until = 3, tolerance = 1e-4, velocity = [2] }"""
    (tmp_path / "fault.toml").write_text(text)
    order = ["verify", str(tmp_path / "fault.toml"), "--evaluator", "pieces"]
    assert main(order) == 0
    put_in("floors of a building", monkeypatch)
    assert main(order) == 1
    blocks = capsys.readouterr().out.split("\n\n")
    programs, integrations = [block for block in blocks if block.startswith("scene ") and "FAIL" in block]
    assert programs.count("FAIL") == 2  # NumPy and C, which agree with exact values
    assert integrations.count("FAIL") == 1


def test_a_system_that_is_not_read_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(READERS, "drive")
    with pytest.raises(UnservedError, match=r"system.type: drive is not supported by integrators"):
        api.verify([Scene.from_toml("drive_m1")])
