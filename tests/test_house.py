"""The house is as it is told: each stage is taken once, no room is too large."""

from __future__ import annotations

import gc
import re
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

import wavesym
from wavesym import api
from wavesym.errors import WavesymError
from wavesym.exact import reference
from wavesym.exact.contacts import schedule
from wavesym.mechanics import chain
from wavesym.mechanics.network import Network
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


CACHED_METHOD = re.compile(
    r"@(?:functools\.)?(?:lru_)?cache\b(?!d).*\n(?:\s+@.*\n)*\s+def (\w+)\(\s*(?:self|cls)\b", re.MULTILINE
)


def cached_methods(text: str) -> list[str]:
    """Methods whose answers the class keeps: with these it keeps every object for ever."""
    return CACHED_METHOD.findall(text)


def test_no_class_keeps_what_its_objects_answer() -> None:
    assert [(str(path), found) for path, text in sources() if (found := cached_methods(text))] == []


@pytest.mark.parametrize("written", ["cache", "lru_cache(maxsize=4)", "functools.cache"])
def test_a_class_that_keeps_what_its_objects_answer_is_seen(written: str) -> None:
    text = f"class Law:\n    @cached_property\n    def mass(self): ...\n    @{written}\n    def answer(self, n): ...\n"
    assert cached_methods(text) == ["answer"]


def test_networks_go_when_nobody_needs_them() -> None:
    """Of a chain that was run and whose tables were written."""
    parts = [{"rod": 1}, {"mass": "3/7"}, {"rod": "2/3"}, "fixed"]
    load = [{"at": "0", "times": [0], "steps": [1]}]
    scene = Scene(
        name="gone", system={"type": "chain", "parts": parts}, load=load, output={"until": 3, "velocity": ["1"]}
    )
    before = live_networks()
    assert len(list(api.run_csv(scene, 5))) > 5
    api.tables(scene, intervals=2)
    api.summary(scene)
    del scene
    assert live_networks() <= before


def live_networks() -> int:
    gc.collect()
    return sum(isinstance(each, Network) for each in gc.get_objects())


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


@pytest.fixture
def searches(monkeypatch: pytest.MonkeyPatch) -> list[object]:
    """Each search for what contacts and other corners do."""
    made: list[object] = []
    begin = schedule.Search.__init__

    def counting(self: schedule.Search, *given: Any) -> None:
        made.append(given)
        begin(self, *given)

    monkeypatch.setattr(schedule.Search, "__init__", counting)
    schedule.outcome.cache_clear()
    return made


WAYS: dict[str, tuple[Callable[[Scene, Path], object], dict[str, int]]] = {
    "run": (lambda scene, _: wavesym.run(scene, samples=9), {"exact values": 1}),
    "run as csv": (lambda scene, _: list(api.run_csv(scene, 9)), {"exact values": 1}),
    "evaluator": (lambda scene, _: api.evaluator(scene)([1.0]), {"exact values": 1}),
    "summary": (lambda scene, _: (api.summary(scene), api.scene_notes(scene)), {"exact extremes": 1}),
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
        lambda scene, folder: (api.report(scene, folder / "page.html"), api.scene_notes(scene)),
        {"exact extremes": 1, "march": 2, "modes": 1},
    ),
    "verify": (lambda scene, _: api.verify([scene], "closed"), {"closed": 1, "exact values": 2}),
}
"""What people do, and how many engines that takes; a scene is lowered once, whatever it is."""


@pytest.mark.quick(3)
@pytest.mark.parametrize("way", WAYS)
def test_each_stage_is_taken_once(stages: Counter[str], way: str, tmp_path: Path) -> None:
    scene = Scene.from_toml("drive_m1")
    call, engines = WAYS[way]
    call(scene, tmp_path)
    assert stages == {"lower": 1, "nodes": scene.system.m + 1, **engines}


PILE = """
name = "pile"
[system]
type = "chain"
parts = [
  { mass = 1, velocity = 1, name = "ram" },
  { spring = 3, only = "push" },
  { mass = "1/3", name = "cap" },
  { rod = 2 },
  { joint = true, spring = 4, yield = "1/10", name = "shaft" },
  { rod = 9 },
  "contact",
  { rod = 2 },
  { joint = true, friction = "1/20", name = "toe" },
]
[output]
until = "5.3"
displacement = ["ram"]
"""
"""An output that feels less than all of a chain whose contacts, springs and friction have corners."""

LAYERED = """
name = "layered"
[system]
type = "chain"
parts = [
  { rod = "0.2", velocity = 1 },
  "contact",
  { rod = 1 },
  { rod = "0.0003925", impedance = "0.222" },
  { rod = "0.0018971", impedance = "0.0306" },
  { rod = 1 },
]
[output]
until = 3
strain = ["0.7"]
"""
"""Fronts between its layers make a million stretches."""


@pytest.mark.quick(1)
@pytest.mark.parametrize("way", [each for each in WAYS if each not in ("inspect", "verify")])
def test_what_corners_do_is_searched_for_once(searches: list[object], way: str, tmp_path: Path) -> None:
    """Also for the largest drift, and for pictures of all of the chain. (`inspect` has two precisions, so two ends of
    the horizon; `verify` knows another end, too.)"""
    call, _ = WAYS[way]
    call(Scene.from_toml(PILE), tmp_path)
    assert len(searches) == 1


@pytest.mark.slow
@pytest.mark.parametrize("way", ["report", "run", "summary", "generate", "plot"])
def test_a_refusal_of_what_corners_do_is_searched_for_once(searches: list[object], way: str, tmp_path: Path) -> None:
    """Each program that is tried asks what contacts do."""
    call, _ = WAYS[way]
    with pytest.raises(WavesymError, match="stretches"):
        call(Scene.from_toml(LAYERED), tmp_path)
    assert len(searches) == 1
