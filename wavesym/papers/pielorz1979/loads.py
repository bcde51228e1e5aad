"""(3.1), (3.2) and the loads of Table 1: what a load with several pieces does to the node that it is bound to."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import Any

from flint import fmpq, fmpq_poly

from wavesym.papers import exact_tables as tables
from wavesym.papers.entries import Entry
from wavesym.papers.evaluation import MeaninglessError, Scope, sides, span
from wavesym.papers.pielorz1979.scenes import example
from wavesym.papers.pielorz1979.truth import Step
from wavesym.papers.reader import read_range
from wavesym.papers.record import Case, Example, Reading, Test, case
from wavesym.papers.tree import Call, Number, Symbol, Tree, latex
from wavesym.scene import Scene

Pieces = Mapping[str, tuple[Step, ...]]
"""The pieces of every source of a scene, by its name."""
RODS = read_range(r"i = 1, 2, \dots, m")
"""What the rows of Table 1 are of, where nothing else is said."""


def drive(m: int) -> Scene:
    """A drive with 1, 2, 3, 1, ... pieces of moment on its bodies, each at times of its own."""
    moments = [
        {
            "body": body,
            "times": [f"{k * (body + 1)}/4" for k in range(1 + body % 3)],
            "steps": [f"{(-1) ** k * (body + 2)}/{k + 2}" for k in range(1 + body % 3)],
        }
        for body in range(1, m + 2)
    ]
    system = {"type": "drive", "m": m, "kappa": range(1, m + 1), "inertia": range(2, m + 3)}
    return Scene(name="moments", system=system, load=moments, output={"until": 3, "strain": [0]})


def building(m: int) -> Scene:
    """A building on a base whose acceleration has three pieces."""
    base = {"times": [0, "1/2", 2], "a": [1, "-1/3", "3/5"], "b": ["2/5", "1/7", -1]}
    system = {"type": "building", "m": m, "kappa": range(1, m + 2), "base": "force"}
    return Scene(name="quake", system=system, load=[base], output={"until": 3, "strain": ["1/2"]})


def acting(scene: Scene, sources: tuple[str, ...], t: fmpq) -> fmpq:
    """What acts on the node of some sources at t, just after any jump, in what a unit of the first of them gives."""
    loaded = scene.system.chain.loaded
    units = {source: fmpq_poly(list(loaded[source][1].coefficients)) for source in sources}
    total = sum(
        (
            part.weight * units[part.source](t - part.time)
            for load in scene.load
            for part in load.units()
            if part.source in units and part.time <= t
        ),
        fmpq(0),
    )
    return total / units[sources[0]](fmpq(0))


def pieces(scene: Scene) -> Pieces:
    """The numbers of a scene's loads, as they were given."""
    found: dict[str, tuple[Step, ...]] = {}
    for load in scene.load:
        for part in load.units():
            found[part.source] = (*found.get(part.source, ()), Step(part.time, part.weight))
    return found


class _Loaded(Scope):
    """The letters of (3.1) and (3.2): pieces by number, and the whole load by what it does."""

    def __init__(self, scene: Scene) -> None:
        super().__init__({"m": scene.system.m})
        self.scene, self._pieces = scene, pieces(scene)

    def symbol(self, symbol: Symbol) -> Any:
        match symbol:
            case Symbol("M", "", 0, (body, k)):
                return self._piece(f"M{self.whole(body)}", self.whole(k)).weight
            case Symbol("t", "", 0, (body, k)):
                return self._piece(f"M{self.whole(body)}", self.whole(k)).time
            case Symbol("m", "", 0, (body,)):
                number = self.whole(body)
                return len(self._of("a" if self._on_base and number == 1 else f"M{number}")) - 1
            case Symbol("a" | "b", "", 0, (k,)):
                return self._piece(symbol.name, self.whole(k)).weight
            case Symbol("t", "", 0, (k,)):
                return self._piece("a", self.whole(k)).time
            case Symbol("y", r"\ddot", 0, (Number("0"),)):
                return acting(self.scene, ("a", "b"), self.bound["t"])
        return super().symbol(symbol)

    def call(self, call: Call) -> Any:
        match call:
            case Call(Symbol("M", "", 0, (body,)), (t,)) if f"M{self.whole(body)}" in self._pieces:
                return acting(self.scene, (f"M{self.whole(body)}",), fmpq(self.value(t)))
        return super().call(call)

    @property
    def _on_base(self) -> bool:
        return "a" in self._pieces

    def _of(self, source: str) -> tuple[Step, ...]:
        if source not in self._pieces:
            raise MeaninglessError(f"there is no load {source}")
        return self._pieces[source]

    def _piece(self, source: str, k: int) -> Step:
        if not 0 <= k < len(self._of(source)):
            raise MeaninglessError(f"{source} has no piece number {k}")
        return self._of(source)[k]


def moments(entry: Entry) -> Test:
    """(3.1)."""

    def cases(reading: Reading) -> Iterator[Case]:
        (bodies,) = reading.ranges
        for m in (1, 2, 3):
            scope = _Loaded(drive(m))
            named = span(bodies, scope)
            yield Case({"m": m, "bodies": latex(bodies)}, named, tuple(range(1, m + 2)), telling=False)
            for body in named:
                scope.bound["i"] = body
                yield from _sides(reading, scope, {"m": m, "i": body}, (f"M{body}",))

    return Test("the unit loads of the bodies, bound by a scene with several pieces, right-hand limits", cases)


def base(entry: Entry) -> Test:
    """(3.2)."""
    return Test(
        "the unit loads of the foundation, bound by a scene with several pieces, right-hand limits",
        lambda reading: _sides(reading, _Loaded(building(2)), {"m": 2}, ("a", "b")),
    )


def _sides(reading: Reading, scope: _Loaded, at: Mapping[str, object], sources: tuple[str, ...]) -> Iterator[Case]:
    """Both sides, each against what acts on the node: it is called what the left one says, and is the right one."""
    left, right = sides(reading.formula)
    for quarter in range(13):
        scope.bound["t"] = t = fmpq(quarter, 4)
        true = acting(scope.scene, sources, t)
        yield case({**at, "t": t, "side": latex(left)}, partial(scope.value, left), true, telling=False)
        yield case({**at, "t": t}, partial(scope.value, right), true)


def bodies(entry: Entry) -> Test:
    """The loads S_i of Table 1, of the body at the left end of rod i: (4.4) counts bodies so."""
    name = entry.about["example"]

    def cases(reading: Reading) -> Iterator[Case]:
        named = reading.ranges[0] if reading.ranges else RODS
        for m in {"I": (4, 6), "II": (1, 2, 3), "III": (2, 3)}[name]:
            yield from _named(reading, named, m)

    def _named(reading: Reading, named: Tree, m: int) -> Iterator[Case]:
        scope = _Loaded(SCENES[name](m))
        nodes = scope.scene.system.chain.nodes
        rigid = {x: node.loads for x, node in enumerate(nodes) if node.inertia}
        numbers = span(named, scope)
        for i, quarter in ((i, quarter) for i in numbers for quarter in range(5)):
            scope.bound |= {"i": i, "t": fmpq(quarter, 4)}
            sources = tuple(load.source for load in rigid.get(i - 1, ()))
            true = acting(scope.scene, sources, scope.bound["t"]) if sources else fmpq(0)
            yield case({"m": m, "i": i, "t": scope.bound["t"]}, partial(scope.value, reading.formula), true)
        loaded = {x + 1 for x, loads in rigid.items() if loads}
        true_numbers = tuple(sorted({*range(1, m + 1), *loaded}))
        yield Case({"m": m, "rods and loaded bodies": latex(named)}, numbers, true_numbers, example=_last_moment(m))

    return Test("the loads of the rigid bodies of a chain", cases)


def _last_moment(m: int) -> Callable[[], Example]:
    return example(
        tables.drive(m),
        {f"M{m + 1}": (Step(fmpq(0), fmpq(1)),)},
        3,
        {"velocity": [str(m)]},
        "wavesym run SCENE --samples 7",
        f"velocity@{m} is not 0: M_{m + 1} moves the drive, and no cell has it for i = 1, ..., {m}",
    )


def collision(m: int) -> Scene:
    """Bodies that collide, no loads."""
    system = {"type": "collision", "m": m, "kappa": [1] * (m // 2), "velocity": range(m // 2, 0, -1)}
    return Scene(name="collision", system=system, output={"until": 3, "strain": ["1/2"]})


SCENES = {"I": collision, "II": drive, "III": building}
