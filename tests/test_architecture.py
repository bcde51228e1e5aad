"""docs/architecture.md is true: it names every room, and imports keep to the order and the walls that it states.

Names of functions, classes and files say what something is or does, by a noun or a verb.
"""

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


@cache
def modules() -> list[tuple[str, Path, ast.Module]]:
    """Every file of the package and of tools: its name in the tree, its path, and what stands in it."""
    return [
        (path.relative_to(PACKAGE.parent).as_posix(), path, ast.parse(path.read_text(encoding="utf-8")))
        for folder in (PACKAGE, PACKAGE.parent / "tools")
        for path in sorted(folder.rglob("*.py"))
    ]


def statements(root: ast.AST) -> Iterator[ast.AST]:
    """All statements of a file, wherever in it, and none of the expressions in them, which are many more."""
    for field in ("body", "orelse", "handlers", "finalbody", "cases"):
        for node in getattr(root, field, ()):
            yield node
            if not isinstance(node, ast.Expr):
                yield from statements(node)


def imported(root: ast.Module) -> Iterator[str]:
    """The modules that a file imports, wherever in it."""
    for node in statements(root):
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
        for _, path, root in modules()
        if path.is_relative_to(PACKAGE)
        for module in imported(root)
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
    (module,) = imported(ast.parse(source))
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
    (module,) = imported(ast.parse("def late():\n    from sympy.core import add"))
    assert beyond(WALLS, iter([("exact/late.py", "exact", module)])) == {("exact/late.py", "sympy")}


_PARTICIPLES = re.compile(
    r"\w{2,}ed|(re|un)?(told|said|heard|felt|made|found|left|sent|lost|kept|held|meant|met|written|given|taken|known"
    r"|shown|grown|drawn|begun|driven|chosen|seen|done|spent|built|brought|sought|swung|struck|stuck|understood)"
)
_PREPOSITIONS = {
    *("of", "at", "in", "on", "by", "for", "from", "to", "with", "without", "within", "between", "beyond", "before"),
    *(
        "after",
        "above",
        "below",
        "under",
        "over",
        "through",
        "along",
        "beside",
        "among",
        "onto",
        "until",
        "since",
        "up",
    ),
    *("out", "down", "off", "near", "alone", "apart", "away", "together", "once", "there", "here", "inside", "outside"),
}
_NOUNS_AND_VERBS = {"speed", "feed", "seed", "need", "embed", "exceed"}
_NAMED_OTHERWISE = {
    "wavesym/scene/scene.py: with_": "what users write",
    "wavesym/papers/reader.py: above_alone": "a rule of the grammar",
    "wavesym/papers/reader.py: below": "a rule of the grammar",
}
_FIELDS_NAMED_OTHERWISE = {
    **dict.fromkeys(("left", "before", "after"), "where something is, beside right, after and before"),
    **dict.fromkeys(("until", "_until"), "the key of a scene"),
    "from_": "a key of a scene",
    "at": "Peak.at, which users read",
    "by": "SetGradients.by, which users read",
    "between": "a key of what `summary` and `derive` write",
    **dict.fromkeys(("of", "given", "sent"), "keys of what `derive` writes"),
    "dissipated": "a key of what `summary` writes",
    "printed": "a key of the papers' data: what is printed",
    "marked": "a key of the papers' data: the text with its marks",
    **dict.fromkeys(("computed", "done", "failed", "together", "written"), "a key of a sweep's files"),
}


def is_participle_or_preposition(name: str) -> bool:
    """Whether no word of a name is a noun, a verb or an adjective, as `told`, `Felt` or `left_out`."""
    words = re.findall(r"[A-Z]?[a-z]+|[A-Z]+|\d+", name)
    return bool(words) and all(
        word.lower() in _PREPOSITIONS or (_PARTICIPLES.fullmatch(word.lower()) and word.lower() not in _NOUNS_AND_VERBS)
        for word in words
    )


def names(path: Path, root: ast.Module) -> Iterator[str]:
    """A file, its classes and its functions; not properties, which may say in what state something is."""
    yield path.stem
    for node in statements(root):
        if isinstance(node, ast.ClassDef | ast.FunctionDef):
            decorators = map(ast.unparse, node.decorator_list)
            if not any(decorator.endswith("property") for decorator in decorators):
                yield node.name


def fields(root: ast.Module) -> Iterator[str]:
    """The fields of classes but those that are true or false, which say in what state something is."""
    for node in statements(root):
        if isinstance(node, ast.ClassDef):
            for line in node.body:
                match line:
                    case ast.AnnAssign(target=ast.Name(id=name), annotation=kind) if ast.unparse(kind) != "bool":
                        yield name


def test_what_is_named_says_what_it_is_or_does() -> None:
    found = {
        f"{file}: {name}"
        for file, path, root in modules()
        for name in names(path, root)
        if is_participle_or_preposition(name)
    }
    assert found == _NAMED_OTHERWISE.keys()


def test_a_field_says_what_it_is() -> None:
    found = {
        f"{file}: {name}"
        for file, _, root in modules()
        for name in fields(root)
        if is_participle_or_preposition(name) and name not in _FIELDS_NAMED_OTHERWISE
    }
    assert found == set()


def test_a_field_that_does_not_is_seen() -> None:
    found = fields(ast.parse("class Law:\n    of: str\n    given: int\n    closed: bool\n    rate: float"))
    assert [name for name in found if is_participle_or_preposition(name)] == ["of", "given"]


@pytest.mark.parametrize(
    "name", ["told", "_said", "left_out", "of", "_at", "Felt", "WrittenOut", "looked_up", "redrawn"]
)
def test_a_name_without_a_noun_or_a_verb_is_seen(name: str) -> None:
    assert is_participle_or_preposition(name)


@pytest.mark.parametrize(
    "name", ["speed", "with_units", "AppliedLoad", "fixed_part", "read", "is_damped", "_x", "at_front"]
)
def test_a_name_with_one_is_not(name: str) -> None:
    assert not is_participle_or_preposition(name)
