"""The house is as it is told: each stage is taken once, no room is too large."""

from __future__ import annotations

import ast
import re
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

import wavesym
from wavesym import api
from wavesym.exact import reference
from wavesym.mechanics import chain
from wavesym.programs import choice
from wavesym.results import summary as summaries
from wavesym.scene import Scene, lowering

PACKAGE = Path(wavesym.__file__).parent
TEMPLATES = PACKAGE.parent / "templates"
LARGEST = 1 / 5
"""Of all lines, what one room may have."""


def sources() -> Iterator[tuple[Path, str]]:
    for path in sorted(PACKAGE.rglob("*.py")):
        yield path.relative_to(PACKAGE), path.read_text(encoding="utf-8")


def test_no_room_has_more_than_a_fifth_of_the_lines() -> None:
    rooms: Counter[str] = Counter()
    for path, text in sources():
        rooms[room_of(path)] += text.count("\n")
    templates = (path for path in TEMPLATES.rglob("*") if path.is_file())
    rooms["templates"] = sum(path.read_text(encoding="utf-8").count("\n") for path in templates)
    (room, most), *_ = rooms.most_common(1)
    assert most <= LARGEST * rooms.total(), room


def room_of(path: Path) -> str:
    """The first folder; a paper's own folder is a room of its own."""
    room, *inner = path.parts
    return f"{room}/{inner[0]}" if room == "papers" and len(inner) > 1 and inner[0] != "pages" else room


def test_the_door_is_files_that_are_read_at_once() -> None:
    assert max(text.count("\n") for path, text in sources() if path.parts[0] == "api") <= 350


@pytest.fixture
def stages(monkeypatch: pytest.MonkeyPatch) -> Counter[str]:
    """How often scenes are lowered, nodes of chains written out, and each engine made."""
    counted: Counter[str] = Counter()

    def count(room: object, name: str, stage: str) -> None:
        right = getattr(room, name)

        def counting(*given: object, **named: object) -> object:
            counted[stage] += 1
            return right(*given, **named)

        monkeypatch.setattr(room, name, counting)

    count(lowering, "_build_model", "lower")
    count(chain, "_exact_node", "nodes")
    count(reference.Reference, "__init__", "exact values")
    count(summaries, "extremes_and_averages", "exact extremes")
    for kind, maker in choice.MAKERS.items():

        def counting(*given: object, kind: str = kind, maker: Any = maker) -> object:
            counted[kind] += 1
            return maker(*given)

        monkeypatch.setitem(choice.MAKERS, kind, counting)
    return counted


WAYS: dict[str, tuple[Callable[[Scene, Path], object], dict[str, int]]] = {
    "run": (lambda scene, _: wavesym.run(scene, samples=9), {"exact values": 1}),
    "run as csv": (lambda scene, _: list(api.run_csv(scene, 9)), {"exact values": 1}),
    "evaluator": (lambda scene, _: api.evaluator(scene)([1.0]), {"exact values": 1}),
    "summary": (lambda scene, _: (api.summary(scene), api.unexpected_lines(scene)), {"exact extremes": 1}),
    "generate": (
        lambda scene, folder: (api.generate(scene, folder, "all"), api.scene_notes(scene)),
        {"closed": 1, "pieces": 1, "exact values": 1},
    ),
    "plot": (lambda scene, folder: api.plot(scene, folder / "history.svg"), {"march": 1}),
    "plot envelope": (lambda scene, folder: api.plot(scene, folder / "envelope.svg", "envelope"), {"march": 1}),
    # in both precisions, and pieces with small tables, too
    "inspect": (lambda scene, _: api.inspect(scene, "program"), {"closed": 2, "pieces": 4}),
    # modes and a march for other models of the same scene, of which `advise` says how far they are off
    "report": (
        lambda scene, folder: (api.report(scene, folder / "page.html"), api.unexpected_lines(scene)),
        {"exact extremes": 1, "march": 2, "modes": 1},
    ),
    "verify": (lambda scene, _: api.verify([scene], "closed"), {"closed": 1, "exact values": 2}),
}
"""What people do, and how many engines that takes; a scene is lowered once, whatever it is."""


@pytest.mark.parametrize("way", WAYS)
def test_each_stage_is_taken_once(stages: Counter[str], way: str, tmp_path: Path) -> None:
    scene = Scene.from_toml("drive_m1")
    call, engines = WAYS[way]
    call(scene, tmp_path)
    assert stages == {"lower": 1, "nodes": scene.system.m + 1, **engines}


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
    "wavesym/targets/c/closed.py: closed": "the closed form",
}
_OTHER_ROOMS = ("wavesym/programs", "wavesym/exact/contacts", "wavesym/exact/modes")
"""Rooms that are not yet named by the field's words."""


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
    for node in ast.walk(root):
        if isinstance(node, ast.ClassDef | ast.FunctionDef):
            decorators = map(ast.unparse, node.decorator_list)
            if not any(decorator.endswith("property") for decorator in decorators):
                yield node.name


def test_what_is_named_says_what_it_is_or_does() -> None:
    found = set()
    for folder in (PACKAGE, PACKAGE.parent / "tools"):
        for path in sorted(folder.rglob("*.py")):
            file = path.relative_to(PACKAGE.parent).as_posix()
            if not file.startswith(_OTHER_ROOMS):
                tree = ast.parse(path.read_text(encoding="utf-8"))
                found |= {f"{file}: {name}" for name in names(path, tree) if is_participle_or_preposition(name)}
    assert found == _NAMED_OTHERWISE.keys()


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
