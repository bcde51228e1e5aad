"""What it takes until a program is there: whole commands, and how time and tables grow."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any

import numpy as np

from tools.bench.commands import ran
from tools.bench.harness import EVERY, flags_cell, many
from wavesym.lab.timing import medians
from wavesym.programs.choice import choose
from wavesym.programs.making import make
from wavesym.programs.request import Request
from wavesym.scene import Scene, lower
from wavesym.targets.files import files


def scene(name: str, until: float, system: dict[str, Any], load: Sequence[dict[str, Any]], **output: Any) -> Scene:
    """A scene from its parts."""
    return Scene(name=name, system=system, load=list(load), output={"until": until, **output})


def rows(folder: Path, labels: str) -> Iterator[Sequence[str]]:
    """What, wall time in s, peak MB, and what was chosen."""
    for label in labels:
        yield _generate_row(f"{label}, as above", (folder / f"{label.lower()}.toml").read_text(encoding="utf-8"))
    shafts = [f"{20 + i}/40" for i in range(49)]
    discs = [f"{30 + (7 * i) % 23}/30" for i in range(50)]
    drive = {"type": "drive", "m": 49, "kappa": shafts, "inertia": discs}
    load = {"body": 1, "times": [0], "steps": [1]}
    train = scene("discs", 100, drive, [load], strain=["1/2", "49/2"], velocity=["97/2"])
    yield _generate_row("drive of 50 unequal discs to tau = 100", _toml(train))
    yield _generate_row("50 unequal rods, lengths 9/10 to 13/10, to tau = 50", _toml(_rods()))
    tower = {"type": "building", "m": 10, "kappa": ["1/100"] * 11, "base": "ground"}
    step = {"times": [0], "a": [1], "b": [0]}
    tall = scene("tower", 20_000, tower, [step], tolerance="1e-6", strain=["1/2"], velocity=[10])
    yield _generate_row("building of 10 storeys to tau = 20 000", _toml(tall), "march")
    made = files(make(lower(tall), Request(evaluator="march")))
    for flags, seconds in zip(EVERY, medians([many(tall, made, flags, calls=1) for flags in EVERY]), strict=True):
        yield f"one run of its C, 10 001 samples, {flags_cell(flags)}", f"{seconds:.3f}", "", "march"


def rows_beyond_imports() -> Iterator[Sequence[str]]:
    """Whole commands; the least of a few turns of each, of which what else runs disturbs few."""
    names = ("building_m2", "drive_m1", "collision_m4")
    imports = [sys.executable, "-c", "import sympy, numpy"]
    with TemporaryDirectory() as folder:
        generating = [[sys.executable, "-m", "wavesym", "generate", name, "-o", folder] for name in names]
        turns = [[ran(command).seconds for command in (imports, *generating)] for _ in range(9)]
    bare, *seconds = map(min, zip(*turns, strict=True))
    yield "the imports", f"{bare:.2f}", ""
    for name, each in zip(names, seconds, strict=True):
        yield name, f"{each:.2f}", f"{each - bare:.2f}"


def _rods() -> Scene:
    """A push on the first of 51 masses, between rods of five lengths and five impedances."""
    parts: list[dict[str, Any]] = [{"mass": 1, "name": "first"}]
    for k in range(50):
        parts.append({"rod": f"{9 + (k * k + k // 3) % 5}/10", "impedance": f"{8 + 7 * k % 5}/10"})
        parts.append({"mass": f"{5 + 3 * k % 7}/10"})
    push = {"at": "first", "times": [0], "steps": [1]}
    return scene("rods", 50, {"type": "chain", "parts": parts}, [push], velocity=["first"])


def _generate_row(label: str, text: str, evaluator: str = "auto") -> Sequence[str]:
    """Wall time and peak memory of `wavesym generate`, start-up included, and what it chose."""
    with TemporaryDirectory() as directory:
        path = Path(directory, "scene.toml")
        path.write_text(text, encoding="utf-8")
        command = [sys.executable, "-m", "wavesym", "generate", str(path), "-o", directory, "--evaluator", evaluator]
        done = ran(command)
        cells = label, f"{done.seconds:.2f}", f"{done.megabytes:.0f}"
        if not done.well:
            return *cells, "refused"
        header = next(Path(directory).glob("*.h")).read_text(encoding="utf-8")
        chosen = next(line for line in header.splitlines() if line.startswith(" * Evaluator: "))
    return *cells, chosen.removeprefix(" * Evaluator: ")


def _toml(each: Scene) -> str:
    """A scene as TOML; what a user would write."""
    fields = each.model_dump(exclude_defaults=True)

    def value(item: object) -> str:
        if isinstance(item, Mapping):
            return "{ " + ", ".join(f"{key} = {value(one)}" for key, one in item.items()) + " }"
        if isinstance(item, list | tuple):
            return "[" + ", ".join(map(value, item)) + "]"
        return str(item) if isinstance(item, int) else f'"{item}"'

    def table(name: str, items: dict[str, object]) -> str:
        return f"{name}\n" + "".join(f"{key} = {value(item)}\n" for key, item in items.items())

    loads = "".join(table("[[load]]", load) for load in fields["load"])
    name = table("", {"name": fields["name"]})
    return name + table("[system]", fields["system"]) + loads + table("[output]", fields["output"])


def growth_rows() -> Iterator[Sequence[str]]:
    """Exponents of time and of bytes, and what they are fitted against."""
    step = {"times": [0], "a": [1], "b": [0]}

    def tower(m: int, until: float, tolerance: str) -> Scene:
        kappas = [f"{10 + i}/20" for i in range(m + 1)]
        system = {"type": "building", "m": m, "kappa": kappas, "base": "ground"}
        return scene("tower", until, system, [step], tolerance=tolerance, strain=["1/2", f"{2 * m - 1}/2"])

    for name, values, scene_of in (
        ("m", (4, 8, 16, 32), lambda m: tower(m, 40, "1e-10")),
        ("horizon", (10, 20, 40, 80), lambda until: tower(4, until, "1e-10")),
        ("digits", (4, 6, 9, 13), lambda digits: tower(4, 20, f"1e-{digits}")),
    ):
        times, sizes = [], []
        for each in map(scene_of, values):
            start = perf_counter()
            sizes.append(choose(lower(each), "pieces").evaluator.bytes)
            times.append(perf_counter() - start)
        exponents = (np.polyfit(np.log(values), np.log(costs), 1)[0] for costs in (times, sizes))
        yield name, f"{values[0]} to {values[-1]}", *(f"{exponent:.2f}" for exponent in exponents)
