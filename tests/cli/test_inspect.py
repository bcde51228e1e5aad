"""`wavesym inspect`: what it says is what the stages have, a refused scene is shown, and a wrong one is refused."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import fields, replace
from fractions import Fraction
from functools import cache
from itertools import product
from pathlib import Path
from typing import Any

import pytest
from flint import fmpq

import wavesym
from tests.support.scenes import NAMED
from wavesym.cli import inspect as command
from wavesym.cli import main
from wavesym.derivation.rules import Linear
from wavesym.documents.inspection import document, laws
from wavesym.documents.inspection.document import inspection
from wavesym.documents.inspection.model import model_sections
from wavesym.documents.inspection.section import Display, Facts, Listing
from wavesym.documents.inspection.text import MOST_ROWS, section_lines
from wavesym.errors import CostError, ToleranceError, WavesymError
from wavesym.exact.contacts.events import contact_ends
from wavesym.exact.motion import Motion
from wavesym.programs import choice
from wavesym.programs.choice import choose
from wavesym.programs.making import make
from wavesym.programs.request import Request
from wavesym.scene import Scene, builtin_names, lower

STAGES = ("summary", "scene", "model", "laws", "table", "program")


def scene(name: str = "building_m2", **changes: object) -> Scene:
    return Scene.from_toml(name).with_({f"output.{key}": value for key, value in changes.items()})


def told(given: Scene, stage: str = "summary") -> dict[str, Any]:
    read: dict[str, Any] = json.loads(inspection(given, stage, "json"))
    assert (read["name"], read["stage"]) == (given.name, stage)
    return read


def short(name: str) -> Scene:
    """A built-in scene, no longer than it takes to show all that is said of it: contacts of collisions end late."""
    return scene(name) if name == "collision_m4" else scene(name, until=3)


@cache
def builtin(name: str, stage: str = "summary") -> dict[str, Any]:
    return told(short(name), stage)


def by(rows: list[dict[str, Any]], *keys: str) -> dict[object, dict[str, Any]]:
    return {tuple(row[key] for key in keys) if keys[1:] else row[keys[0]]: row for row in rows}


TRIED = ("program", "precision", "optimize")


# a named system and a chain that is written out; the others when there is time
ALWAYS = ("collision_m4", "stepped_shaft")
SCENES = [name if name in ALWAYS else pytest.param(name, marks=pytest.mark.slow) for name in builtin_names()]


def is_quick(stage: str, name: str) -> bool:
    """Whether a stage is shown in quick runs: where all programs are tried, only of the chain."""
    return name in (ALWAYS[1:] if stage in ("summary", "program") else ALWAYS)


@pytest.mark.parametrize(
    ("stage", "name"),
    [
        pytest.param(stage, name, marks=[pytest.mark.slow] * (not is_quick(stage, name)))
        for stage, name in product(STAGES, builtin_names())
    ],
)
def test_every_stage_of_every_scene(name: str, stage: str) -> None:
    """In JSON and text, the same sections with the same values in lines that are not long."""
    text = inspection(short(name), stage)
    assert text.startswith(f"{name}: {stage}\n\n")
    assert max(map(len, text.splitlines())) <= 120
    assert not re.search(r" $", text, re.MULTILINE)
    read = builtin(name, stage)
    assert text.count("\n\n") == len(read) - 2, "sections"
    for section in read.values():
        for row in section if isinstance(section, list) else ():
            words = [str(value) for value in row.values() if isinstance(value, str) and " " not in value]
            assert all(word in text for word in words[:MOST_ROWS] if len(section) <= MOST_ROWS)


def test_the_scene_is_what_the_user_said() -> None:
    for name in builtin_names():
        given = Scene.from_toml(name)
        read = told(given, "scene")
        fields = {key: read[key] for key in ("name", "system", "load", "output")}
        assert Scene(**fields) == given


def test_the_rates_are_those_of_the_paper() -> None:
    """2 kappa at a floor, kappa at the roof; kappa_1 and kappa_1 J_1/J_2 at the discs of a drive."""
    nodes = by(builtin("building_m2", "model")["nodes"], "x")
    assert [nodes[x]["rate"] for x in range(3)] == [None, "6/5", "1/5"]
    assert [nodes[x]["kind"] for x in range(3)] == ["prescribed force", "body", "body"]
    discs = by(builtin("drive_m1", "model")["nodes"], "x")
    assert [discs[x]["rate"] for x in range(2)] == ["1", "1/2"]
    bodies = builtin("collision_m4", "model")["nodes"]
    assert [node["rate"] for node in bodies] == [None, "1/5", None, "2/5", None]
    assert [node["kind"] for node in bodies] == ["free end", "body", "contact", "body", "free end"]
    ground = told(Scene.from_toml("building_half_roof"), "model")
    assert ground["nodes"][0]["kind"] == "prescribed velocity"


@pytest.mark.parametrize("name", NAMED)
def test_the_model_is_told_as_it_is(name: str) -> None:
    scene, read = short(name), builtin(name, "model")
    model, chain = lower(scene), scene.system.chain
    assert read["model"]["sha256"] == model.labels.sha256
    assert Fraction(read["model"]["until"]) == Fraction(str(model.until))
    assert read["model"]["tolerance"] == str(model.tolerance)
    assert len(read["nodes"]) == len(read["rods"]) + 1 == chain.m + 1
    for row, node in zip(read["nodes"], chain.nodes, strict=True):
        for key in ("inertia", "alpha", "beta", "damping"):
            assert row[key] == str(getattr(node, key))
        assert row["contact"] == node.contact
        assert row["loads"] == {load.source: [str(c) for c in load.coefficients] for load in node.loads}
    assert read["loads"] == [{"source": p.source, "time": str(p.time), "weight": str(p.weight)} for p in model.loads]
    for row, probe in zip(read["outputs"], model.probes, strict=True):
        assert (row["name"], row["quantity"], row["rod"]) == (probe.name, probe.quantity, probe.rod)
        assert row["place"] == str(probe.place)


@pytest.mark.parametrize("name", builtin_names())
def test_every_field_of_every_part_is_there(name: str) -> None:
    network, read = lower(short(name)).network, builtin(name, "model")
    for key, parts in (("points", network.points), ("bars", network.bars), ("links", network.links)):
        assert len(read[key]) == len(parts)
        for row, part in zip(read[key], parts, strict=True):
            own = {field.name: getattr(part, field.name) for field in fields(part)}
            assert own.keys() < row.keys()
            numbers = {field: number for field, number in own.items() if isinstance(number, fmpq)}
            assert {field: row[field] for field in numbers} == {field: str(n) for field, n in numbers.items()}
            texts = own.keys() & {"left", "right", "motion", "name", "place"}
            assert {field: row[field] for field in texts} == {field: own[field] for field in texts}


def test_a_scene_in_units_without_loads_is_shown() -> None:
    rod = {"length": "1 m", "A": "8 cm^2", "E": "210 GPa", "rho": "7850 kg/m^3"}
    bodies = [{"left": rod, "right": rod, "mass": "12 kg", "velocity": v} for v in ("5 m/s", "0 m/s")]
    system = {"type": "collision", "body": bodies}
    given = Scene(name="c", units={}, system=system, output={"until": 3, "velocity": [0]})
    assert told(given, "scene")["load"] == []


def test_horizons_are_numbers_of_their_formats() -> None:
    read = told(scene(until="1/10"), "model")["model"]
    assert read["until"] == "1/10"
    assert read["horizon_double"] == 0.1
    assert read["horizon_single"] == 0.10000000149011612


def test_what_cannot_be_felt_is_left_out() -> None:
    near = scene("drive_equal", until="1/4", strain=["1/2"])
    read = told(near)
    assert read["light_cone"] == {"modelled": [0, 1], "left_out": 2}
    assert [joint["joint"] for joint in read["joints"]] == [0, 1]
    assert {row["rod"] for row in told(near, "laws")["functions"]} == {1}
    assert "left_out  2 of 4 joints" in inspection(near)


def test_the_law_of_a_joint_by_hand() -> None:
    """Floor 1: U_tt + 2 kappa U_t = 2 kappa (a + b); roof: U_tt + kappa U_t = 2 kappa a."""
    joints = by(told(scene(), "laws")["joints"], "joint")
    assert [joints[k]["polynomial"]["rates"] for k in range(3)] == [[], ["6/5"], ["1/5"]]
    assert [joints[k]["ends"] for k in range(3)] == [1, 2, 1]
    ratios = [[Fraction(joints[k][name][0][0]) for name in "CM"] for k in (1, 2)]
    assert [damping / mass for damping, mass in ratios] == [Fraction(6, 5), Fraction(1, 5)]


def value(linear: dict[str, str], at: Fraction | int) -> Fraction:
    return Fraction(linear["constant"]) + Fraction(linear["slope"]) * at


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", NAMED)
def test_the_recurrences_hold_for_the_table(name: str) -> None:
    """Every coefficient that `tables` prints fits the recurrences in numbers, and so do the jumps."""
    given = short(name)
    rows = wavesym.tables(given, intervals=4)
    table = {(r.source, r.function, r.rod, r.interval, r.rate, r.power): r.value for r in rows}
    rates, powers = {r.rate for r in rows}, range(max(r.power for r in rows) + 1)

    def left(of: dict[str, Any], *at: object, g: Fraction, k: int) -> Fraction:
        here, following = (table.get((*at, g, power), Fraction(0)) for power in (k, k + 1))
        return value(of["same"], g) * here + value(of["raised"], k) * following

    def jump(of: dict[str, Any], *at: object) -> Fraction:
        return Fraction(of["jump"]) * sum((table.get((*at, g, 0), Fraction(0)) for g in rates), Fraction(0))

    for law, source, n in product(builtin(name, "laws")["functions"], {r.source for r in rows}, range(1, 5)):
        own = law["own"], source, law["function"], law["rod"], n
        terms = [(term, source, term["function"], term["rod"], n - term["back"]) for term in law["terms"]]
        for g, k in product(rates, powers):
            loads = [Fraction(load["value"]) for load in law["loads"] if begins(load, source, n, k) and g == 0]
            assert left(*own, g=g, k=k) == sum(loads) + sum(left(*term, g=g, k=k) for term in terms)
        if law["own"]["jump"] != "0":
            assert jump(*own) == sum(jump(*term) for term in terms)


def begins(load: dict[str, Any], source: str, n: int, k: int) -> bool:
    return (load["source"], load["back"] + 1, load["power"]) == (source, n, k)


@pytest.mark.parametrize("name", NAMED)
def test_the_size_of_the_table(name: str) -> None:
    rows = wavesym.tables(short(name))
    read = builtin(name, "table")
    assert read["table"]["coefficients"] == len(rows)
    for function in read["functions"]:
        mine = [row for row in rows if all(getattr(row, key) == function[key] for key in ("function", "rod", "source"))]
        assert function["coefficients"] == len(mine)
        assert function["rates"] == [str(rate) for rate in sorted({row.rate for row in mine})]
        assert function["intervals"] >= max((row.interval for row in mine), default=0)


@pytest.mark.parametrize("changes", [{}, {"strain": ["1/3"]}, {"until": "7/3", "strain": [0, "1/3"]}])
def test_the_knots_are_where_segments_start(changes: dict[str, object]) -> None:
    model = lower(scene("drive_m1", **changes))
    motion = Motion(model, model.until)
    for probe, row in zip(model.probes, told(scene("drive_m1", **changes), "table")["breakpoints"], strict=True):
        starts = list(map(str, motion.starts(probe)))
        assert row["count"] == len(starts)
        assert row["first"] == starts[:8]


def tables_in(source: str) -> dict[str, tuple[str, int]]:
    """The type and the length of every table in a generated C file."""
    found = re.findall(r"^static const (\w+) (\w+)\[\] = \{(.*?)^\};", source, re.MULTILINE | re.DOTALL)
    return {name: (kind, len(re.findall(r"[^\s,]+", body))) for kind, name, body in found}


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", ["building_m2", "collision_m4", "drive_m1"])
def test_tables_are_as_long_as_those_in_c(name: str, tmp_path: Path) -> None:
    given = short(name)
    for path in wavesym.generate(given, tmp_path):
        if path.suffix == ".c" and "selftest" not in path.name:
            tables = tables_in(path.read_text())
    read = builtin(name, "program")
    assert {row["name"]: row["length"] for row in read["tables"]} == {
        name: count for name, (_, count) in tables.items()
    }
    size = sum(count * (4 if kind == "int" else 8) for kind, count in tables.values())
    assert size == pytest.approx(read["program"]["bytes"], rel=0.04), "but for what finds the place, and a block"


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", SCENES)
def test_the_program_is_the_one_that_is_generated(name: str) -> None:
    model, read = lower(short(name)), builtin(name, "program")
    made = make(model)
    program = read["program"]
    assert (program["kind"], program["bytes"], program["reason"]) == (made.kernel, made.bytes, made.provenance.reason)
    assert program["bound"] == made.error_bound <= float(Fraction(str(model.tolerance)))
    assert read["constants"] == made.constants
    assert read["outputs"] == [{"name": o.name, "bound": o.bound, "largest": o.largest} for o in made.outputs]
    assert read["contacts"] == [{"x": e.x, "tau": e.digits, "refusal": None} for e in contact_ends(model)]
    rows = by(read["tried"], *TRIED)
    assert rows == by(builtin(name)["tried"], *TRIED)
    small = make(model, Request(optimize="size"))
    row = rows.get((small.kernel, "double", "size")) or rows[small.kernel, "double", "speed"]
    assert row["bytes"] == small.bytes < made.bytes
    assert rows["march", "double", "speed"]["refusal"].startswith("not tried: another program meets the tolerance")


@pytest.mark.slow
def test_single_precision() -> None:
    given = scene("drive_m1", tolerance="1e-4")
    rows = by(told(given)["tried"], *TRIED)
    for optimize in ("speed", "size"):
        made = make(lower(given), Request("pieces", "single", optimize=optimize))
        row = rows["pieces", "single", optimize]
        assert (row["bytes"], row["bound"], row["refusal"]) == (made.bytes, made.error_bound, None)
    missed = by(builtin("drive_m1")["tried"], *TRIED)["closed", "single", "speed"]
    with pytest.raises(ToleranceError) as error:
        choose(lower(short("drive_m1")), "closed", "single")
    assert str(error.value).endswith(f"(closed: {missed['refusal']})")


@pytest.mark.slow
def test_a_scene_that_is_refused(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """Its refusals are those of the errors, numbers included; the exit status is 0."""
    given = scene(until=10**6)
    rows = by(told(given, "program")["tried"], *TRIED)
    for kind in ("closed", "pieces", "march"):
        with pytest.raises(CostError) as error:
            choose(lower(given), kind)
        if kind != "closed":  # on which more is spent where it is asked for
            assert rows[kind, "double", "speed"]["refusal"] == str(error.value)
    with pytest.raises(WavesymError) as error:
        make(lower(given))
    assert told(given)["program"] == {"refusal": str(error.value)}
    assert "the limit is 10000" in told(given, "table")["table"]["refusal"]
    assert "coefficients of about" in told(scene(until=300), "table")["table"]["refusal"]
    assert all(row["count"] is None and "the limit is" in row["refusal"] for row in told(given, "table")["breakpoints"])
    file = tmp_path / "far.toml"
    file.write_text(_toml("building_m2").replace("until = 12", "until = 1e6"))
    for stage in ("scene", "laws", "program"):
        assert main(["inspect", str(file), "--stage", stage]) == 0
        out, err = capsys.readouterr()
        assert out.startswith(f"building_m2: {stage}\n")
        assert err == ""
    assert main(["inspect", str(file)]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "generate would refuse this scene" in said
    assert " ".join(rows["pieces", "double", "speed"]["refusal"].split()) in said


def test_contacts_that_are_not_known_in_time(monkeypatch: pytest.MonkeyPatch) -> None:
    def costly(_: object) -> None:
        raise CostError("output.until: 9 coins, at most 5 expected (a shorter horizon helps)")

    monkeypatch.setattr("wavesym.documents.inspection.program.contact_ends", costly)
    given = scene("collision_m4", until=2)
    (row,) = told(given)["contacts"]
    assert row["refusal"].startswith("output.until: 9 coins")
    assert "for which generate refuses the scene" in inspection(given)


@pytest.mark.slow
def test_what_takes_long_is_not_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    tried = []
    attempt: Callable[..., choice.Attempt] = choice.attempt

    def counted(model: object, kind: str, precision: str = "double", **more: Any) -> choice.Attempt:
        tried.append((kind, precision))
        return attempt(model, kind, precision, **more)  # type: ignore[arg-type]

    monkeypatch.setattr("wavesym.documents.inspection.program.attempt", counted)
    monkeypatch.setattr("wavesym.documents.inspection.program.MOST_BYTES", 10_000)
    rows = by(told(scene())["tried"], *TRIED)
    assert tried == [("closed", "single")]
    refusal = rows["pieces", "single", "speed"]["refusal"]
    assert re.match(r"not tried, nor the smallest tables: to fit \d+ bytes once more takes long", refusal)
    assert ("pieces", "double", "size") not in rows
    monkeypatch.setattr("wavesym.documents.inspection.program.MOST_MARCHED", 1e3)
    monkeypatch.setattr("wavesym.documents.inspection.program.best", choice.best)
    far = told(scene(until=1000))
    row = by(far["tried"], *TRIED)["march", "single", "speed"]
    assert re.match(r"not tried: a march would take \S+ operations; the limit is 1.0e\+03", row["refusal"])


def test_a_changed_model_is_seen() -> None:
    """One node's inertia, one weight, one place: each changes what is said of it, and nothing else does."""
    model, own = lower(scene()), scene().system.chain
    first = list(model_sections(model, own))
    heavier = replace(own.nodes[1], inertia=fmpq(2))
    chain = replace(own)
    chain.__dict__["nodes"] = (own.nodes[0], heavier, own.nodes[2])
    changed = {section.key: section for section in model_sections(model, chain)}
    assert [section.key for section in first if section != changed[section.key]] == ["nodes"]
    assert _rows(changed["nodes"])[1]["rate"] == "3/5"
    points = list(model.network.points)
    points[1] = replace(points[1], mass=2 * points[1].mass)
    other = replace(model, network=replace(model.network, points=tuple(points)))
    every = zip(laws.law_sections(model, own), laws.law_sections(other, own), strict=True)
    assert {section.key for section, changed in every if section != changed} == {"joints"}
    load = replace(model.loads[0], weight=fmpq(7))
    heavy = {s.key: s for s in model_sections(replace(model, loads=(load, *model.loads[1:])), own)}
    assert [section.key for section in first if section != heavy[section.key]] == ["loads"]
    probe = replace(model.probes[0], place=fmpq(1, 4))
    moved = {s.key: s for s in model_sections(model.watching([probe, *model.probes[1:]]), own)}
    assert [section.key for section in first if section != moved[section.key]] == ["outputs"]


def _rows(section: Facts | Listing) -> list[Any]:
    assert isinstance(section, Listing)
    return list(section.rows)


def test_a_program_with_another_bound_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    pieces = choice.MAKERS["pieces"]

    def coarse(*asked: Any) -> Any:
        form = pieces(*asked)
        return replace(form, outputs=tuple(replace(output, bound=0.5) for output in form.outputs))  # type: ignore[type-var]

    monkeypatch.setitem(choice.MAKERS, "pieces", coarse)
    read = told(scene(until=3))
    assert read["program"]["kind"] == "closed"
    row = by(read["tried"], *TRIED)["pieces", "double", "speed"]
    assert (row["bound"], row["refusal"]) == (0.5, "rounding leaves a bound of 0.5 for strain@0.5")


def test_long_lists_are_cut_in_text_and_whole_in_json() -> None:
    samples = [str(k % 7) for k in range(3000)]
    record = Scene(
        name="record",
        system={"type": "building", "m": 60, "kappa": [1] * 61, "base": "ground"},
        load=[{"spacing": "1/5", "samples": samples}],
        output={"until": 1e7, "tolerance": "1e-6", "strain": ["1/2"]},
    )
    assert told(record, "scene")["load"][0]["samples"] == samples
    assert "  samples = 0, 1, 2, 3, 4, 5, 6, 0, ... and 2992 more\n" in inspection(record, "scene")
    loads = told(record, "model")["loads"]
    assert len(loads) == len(lower(record).loads) > 800
    text = inspection(record, "model")
    assert f"  ... and {len(loads) - MOST_ROWS} more\n" in text
    assert f"  ... and {61 - MOST_ROWS} more\n" in text
    assert len(told(record, "laws")["functions"]) == 120
    assert len(text.splitlines()) < 150


def test_layout() -> None:
    listing = Listing("k", "Rows", [{"a": "1/2", "bc": None, "why": "said"}, {"a": 10, "bc": True}], ("why",))
    assert list(section_lines(listing)) == ["", "Rows:", "  a    bc", "  1/2  -", "      said", "  10   yes"]
    assert list(section_lines(Listing("k", "Rows", []))) == ["", "Rows:", "  none"]
    facts = Facts("k", "Values", {"one": Display([0, 5], "0..5"), "other": {"1": "2/3"}})
    assert list(section_lines(facts)) == ["", "Values:", "  one    0..5", "  other  1: 2/3"]


@pytest.mark.parametrize(
    ("linear", "expected"),
    [((0, 0), "0"), ((0, 1), "g"), ((0, -1), "-g"), ((2, -1), "2 - g"), ((1, fmpq(3, 2)), "1 + 3/2 g")],
)
def test_a_linear_factor_as_one_writes_it(linear: tuple[int, int], expected: str) -> None:
    constant, slope = map(fmpq, linear)
    assert laws._linear_text(Linear(constant, slope), "g") == expected


def test_the_options_are_the_stages() -> None:
    assert list(document._STAGES) == command.STAGES


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        ([], "wavesym inspect: Missing argument 'SCENE'"),
        (["bad.toml"], "bad.toml: system.inertia: 1 numbers; write 2 (m + 1)"),
        (["bad.toml", "--stage", "laws"], "bad.toml: system.inertia: 1 numbers; write 2 (m + 1)"),
        (["nothing.toml"], "nothing.toml: No such file"),
        (["drive_m1", "--stage", "tables"], "wavesym inspect: Invalid value for '--stage': 'tables' is not one of"),
        (["drive_m1", "--format", "latex"], "wavesym inspect: Invalid value for '--format': 'latex' is not one of"),
    ],
)
def test_bad_input_is_one_line(
    arguments: list[str],
    expected: str,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("bad.toml").write_text(_toml("drive_m1").replace("inertia = [1, 2]", "inertia = [1]"))
    assert main(["inspect", *arguments]) == 2
    out, line = capsys.readouterr()
    assert out == ""
    assert line.startswith(expected)
    assert line.count("\n") == 1


def _toml(name: str) -> str:
    return (Path(wavesym.__file__).parent / "scene" / "builtin" / f"{name}.toml").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", ["drive_m1", pytest.param("geared_drive", marks=pytest.mark.slow)])
def test_a_stream_is_told_as_it_would_be_made(name: str, tmp_path: Path) -> None:
    """By the header, which counts for those who call it, and by its manifest."""
    said = builtin(name, "program")["stream"]
    wavesym.generate(short(name), tmp_path, stream=True)
    header = " ".join((tmp_path / f"{name}.h").read_text().replace("\n *", "").split())
    manifest = json.loads((tmp_path / f"{name}.json").read_text())
    assert f"_DEGREE = {said['degree']}," in header
    assert f"costs at most {said['panel_work']} multiplications" in header
    assert f"a step about {said['step_work']}," in header
    slots = int(re.findall(r"_SLOTS = (\d+)", header)[0])
    assert said["state_bytes"] == 8 * slots * (said["degree"] + 1)
    assert (said["panel"], said["inputs"], said["direct"]) == tuple(
        manifest[key] for key in ("panel", "loads", "direct")
    )


def test_a_scene_that_is_no_stream_says_why() -> None:
    samples = {"body": 1, "spacing": "1/2", "samples": [0, 1, 0]}
    damped = Scene.from_toml("drive_m1").with_({"system.damping": 0.05, "load": [samples], "output.tolerance": "1e-2"})
    assert told(damped)["stream"] == {
        "refusal": "system.damping: supported by modes only (write --evaluator modes, or leave it out)"
    }


@pytest.mark.slow
def test_what_the_model_is_comes_before_programs_are_tried(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    seen = []

    def attempts(model: object) -> tuple[object, ...]:
        seen.append(capsys.readouterr().out)
        return choice.attempts(model)  # type: ignore[arg-type]

    monkeypatch.setattr("wavesym.documents.inspection.document.attempts", attempts)
    assert main(["inspect", "drive_m1", "--stage", "summary"]) == 0
    rest = capsys.readouterr().out
    assert "Outputs: a quantity at a place" in seen[0]
    assert "Programs tried" not in seen[0]
    assert "Programs tried" in rest
    assert seen[0] + rest == wavesym.api.inspect(scene("drive_m1"))


def test_periods_beside_dashpots_are_those_of_modes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """With damping ratios, in seconds whatever the unit of time; many rods have the command named that finds them."""
    scene = tmp_path / "pile.toml"
    assert main(["init", "pile", "-o", str(scene)]) == 0
    bare = re.sub(r", yield = \"\d+ kN\"|, only = \"push\"", "", scene.read_text()).replace("20 ms", "1 ms")
    scene.write_text(bare)
    found = [row for row in wavesym.modes(scene) if row.period and row.damping < 1][:3]
    capsys.readouterr()
    assert main(["inspect", str(scene), "--format", "json"]) == 0
    assert json.loads(capsys.readouterr().out)["units"]["periods"] == [row.period for row in found]
    assert main(["inspect", str(scene)]) == 0
    text = " ".join(capsys.readouterr().out.split())
    assert f"T1 = {1000 * found[0].period:.6g} ms ({100 * found[0].damping:.3g} %)" in text  # type: ignore[operator]
    rods = ", ".join(['{ rod = "0.1 m", E = "35 GPa", A = "0.1225 m^2", rho = "2450 kg/m^3" }'] * 60)
    scene.write_text(re.sub(r'\{ rod = "6 m".*name = "lower_half" \}', rods, bare))
    assert main(["inspect", str(scene)]) == 0
    assert "beside dashpots; `wavesym modes pile.toml` has them" in " ".join(capsys.readouterr().out.split())
