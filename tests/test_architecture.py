"""docs/architecture.md is true: it names every room, and imports keep to the order and the walls that it states."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from pathlib import Path

import pytest

import wavesym
from tests.test_documents import blocks, document

PACKAGE = Path(wavesym.__file__).parent
PAGE = document("docs/architecture.md")
ROOMS = {path.stem for path in PACKAGE.iterdir() if path.suffix == ".py" or (path / "__init__.py").exists()}
ROOMS -= {"__init__", "__main__"}  # the doors of the house


def lines(language: str) -> list[list[str]]:
    """The words of each line of the page's one block of a kind."""
    (block,) = (block for block in blocks(PAGE) if block.language == language)
    return [line.split() for line in block.text.splitlines()]


ORDER = {room: number for number, rooms in enumerate(lines("order")) for room in rooms}
BESIDE = ""
"""Stands for the files of `exact` that are in none of its rooms."""
EXACT = {room: number for number, rooms in enumerate([*lines("exact"), [BESIDE]]) for room in rooms}
EXCEPTIONS = {(room, other) for room, other, *_ in lines("exceptions")}
WALLS = {library: set(rooms) for library, *rooms in lines("walls")}


def imported(source: str) -> Iterator[str]:
    """The modules that a source imports, wherever in it."""
    for node in ast.walk(ast.parse(source)):
        match node:
            case ast.Import(names):
                yield from (name.name for name in names)
            case ast.ImportFrom("wavesym" | "wavesym.exact" as package, names):
                yield from (f"{package}.{name.name}" for name in names)
            case ast.ImportFrom(str(module)):
                yield module


@cache
def uses() -> list[tuple[str, str, str]]:
    """Each import in the package: its file, its room, and the module."""
    return [
        (path.relative_to(PACKAGE).as_posix(), path.relative_to(PACKAGE).parts[0].removesuffix(".py"), module)
        for path in sorted(PACKAGE.rglob("*.py"))
        for module in imported(path.read_text(encoding="utf-8"))
    ]


def against(order: Mapping[str, int], found: Iterable[tuple[str, str, str]]) -> set[tuple[str, str]]:
    """The rooms that import from one that is not above them in the order, each with that one."""
    arrows = {(room, module.split(".")[1]) for _, room, module in found if module.startswith("wavesym.")}
    return {
        (room, other)
        for room, other in arrows
        if room in order and other in order and room != other and order[other] >= order[room]
    }


def within_exact(found: Iterable[tuple[str, str, str]]) -> Iterator[tuple[str, str, str]]:
    """The imports inside of `exact`, told as if its rooms were those of the house."""
    for file, _, module in found:
        if file.startswith("exact/") and module.startswith("wavesym.exact."):
            room, other = (name if name in EXACT else BESIDE for name in (file.split("/")[1], module.split(".")[2]))
            yield file, room, f"wavesym.{other}"


def beyond(walls: Mapping[str, set[str]], found: Iterable[tuple[str, str, str]]) -> set[tuple[str, str]]:
    """The files that import a library in a room where it does not belong, each with the library."""
    return {
        (file, library)
        for file, room, module in found
        if (library := module.split(".")[0]) in walls and room not in walls[library]
    }


def test_every_room_is_named_once() -> None:
    assert sorted(room for rooms in lines("order") for room in rooms) == sorted(ROOMS)
    assert re.findall(r"^\| `(\w+)` \|", PAGE, re.MULTILINE) == [
        *(room for rooms in lines("order") for room in rooms)
    ], "the table of rooms has another order than the list"


def test_the_words_of_the_house_are_defined() -> None:
    defined = set(re.findall(r"^- \*\*(.+?)\*\*", PAGE, re.MULTILINE))
    words = [
        "window",
        "breakpoint",
        "probe",
        "walk",
        "panel",
        "piece",
        "march",
        "spine",
        "node",
        "rate",
        "ball",
        "horizon",
    ]
    assert defined >= {*words, "horizon", "light cone", "unit response", "formal continuation"}


def test_imports_keep_to_the_order() -> None:
    assert against(ORDER, uses()) == EXCEPTIONS


def test_the_rooms_of_exact_are_named_and_keep_to_their_order() -> None:
    assert {path.parent.name for path in (PACKAGE / "exact").glob("*/__init__.py")} == EXACT.keys() - {BESIDE}
    assert against(EXACT, within_exact(uses())) == set()


def test_libraries_stay_behind_their_walls() -> None:
    assert beyond(WALLS, uses()) == set()
    assert set(WALLS) <= {module.split(".")[0] for _, _, module in uses()}


@pytest.mark.parametrize(
    ("room", "source"), [("mechanics", "from wavesym.cli import main"), ("exact", "import wavesym.targets")]
)
def test_an_arrow_that_runs_up_is_seen(room: str, source: str) -> None:
    (module,) = imported(source)
    assert against(ORDER, iter([("file.py", room, module)])) == {(room, module.split(".")[1])}


@pytest.mark.parametrize(
    ("room", "module"), [("joints", "tables.ball"), ("contacts", "motion"), ("modes", "joints.joint_law")]
)
def test_an_arrow_that_runs_up_in_exact_is_seen(room: str, module: str) -> None:
    found = [
        (f"exact/{room}/file.py", "exact", f"wavesym.exact.{module}"),
        ("exact/field.py", "exact", "wavesym.exact.joints.joint_law"),
    ]
    assert {name for name, _ in against(EXACT, within_exact(iter(found)))} == {room}


def test_a_library_beyond_its_wall_is_seen() -> None:
    (module,) = imported("def late():\n    from sympy.core import add")
    assert beyond(WALLS, iter([("exact/late.py", "exact", module)])) == {("exact/late.py", "sympy")}
