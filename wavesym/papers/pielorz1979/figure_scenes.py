"""Figs. 6, 7 and 8: the scenes that their captions describe, the loads tried on them, and the curves that come of it.

The numbers come from the captions' strings, in the data. Curves are the exact motion, rounded last: a load's curve is
that of unit steps and ramps, shifted and added.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
from flint import fmpq

from wavesym.errors import SceneError
from wavesym.exact.contacts.events import contact_ends
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.node import Parameters
from wavesym.numbers.arrays import Array
from wavesym.papers.evaluation import MeaninglessError, Scope, items, sides, without_brackets
from wavesym.papers.pielorz1979.chains import Exact, LoadStep, exact_tables
from wavesym.papers.pielorz1979.transcript import entry
from wavesym.papers.reader import read_formula
from wavesym.papers.record import format_value
from wavesym.papers.tree import Number, Product, Symbol, Tree, latex
from wavesym.scene import Scene, lower
from wavesym.scene.lowering import named_chain
from wavesym.systems.drive import DRIVE

SAMPLES = 201
UNTIL = 20
"""Until when Figs. 7 and 8 are looked at; Fig. 6 ends with the contact."""

PLOTTED: Mapping[int, Mapping[str, Sequence[str]]] = {
    6: {"strain": ("1-", "2", "3+"), "displacement": ("0", "1", "1.5", "2", "2.5", "3", "4")},
    7: {"strain": ("0", "0.5", "1"), "displacement": ("0", "1")},
    8: {"velocity": ("0.5", "1.5"), "strain": ("0.5", "1.5"), "displacement": ("0.5", "1.5")},
}
"""The curves of each figure."""


class TriedLoad(NamedTuple):
    """A shape of load: what each source does, piece by piece."""

    name: str
    pieces: tuple[tuple[str, tuple[LoadStep, ...]], ...]


SENSES: Mapping[str, int] = {"M_1 = M_2": 1, "M_1 = -M_2": -1}
"""Equal moments are opposed, as (4.4) counts the last one against positive rotation."""


def _rational(text: str) -> fmpq:
    return fmpq(*map(int, text.split("/")))


def _steps(pieces: Iterable[tuple[str, str]], sign: int = 1) -> tuple[LoadStep, ...]:
    return tuple(LoadStep(_rational(time), sign * _rational(weight)) for time, weight in pieces)


_LOADS = tomllib.loads(Path(__file__).with_name("figure_loads.toml").read_text(encoding="utf-8"))


@cache
def loads(figure: int, sense: int = 1) -> tuple[TriedLoad, ...]:
    """The loads that a figure is tried with; of two moments the second has a `sense`."""
    return tuple(
        TriedLoad(name, tuple((source, _steps(pieces, sense if source == "M2" else 1)) for source in sources.split()))
        for name, given in _LOADS[str(figure)].items()
        for sources, pieces in given.items()
    )


@dataclass(frozen=True)
class FigureScene:
    """What a caption describes: a figure, and its quantities: letter, index (0 where there is none), value."""

    figure: int
    quantities: tuple[tuple[str, int, fmpq], ...]

    def curve(self, load: TriedLoad, quantity: str, place: str) -> Array:
        """An output under a load at the instants. MeaninglessError where there is none."""
        total = np.zeros(SAMPLES)
        for source, steps in load.pieces:
            unit = _unit_curve(self, source, quantity, place)
            for step in steps:
                late = int(step.time * (SAMPLES - 1) / UNTIL)
                total[late:] += float(step.weight) * unit[: SAMPLES - late]
        return total

    @property
    def instants(self) -> Array:
        """The tau of a curve."""
        return np.linspace(0, float(contact_end(self)) if self.figure == 6 else UNTIL, SAMPLES)

    def scene(
        self, load: TriedLoad, plotted: Mapping[str, Sequence[str]] | None = None, until: str | None = None
    ) -> Scene:
        """The scene under a load, with the curves of its figure or others. MeaninglessError where it is none."""
        end = until or (contact_end(self) if self.figure == 6 else str(UNTIL))
        acting: list[Mapping[str, object]] = []
        for source, steps in load.pieces:
            times, weights = [str(step.time) for step in steps], [str(step.weight) for step in steps]
            if self.figure == 7:
                acting.append({"body": int(source.removeprefix("M")), "times": times, "steps": weights})
            elif self.figure == 8:
                none = ["0"] * len(steps)
                acting.append({"times": times, **{kind: weights if kind == source else none for kind in "ab"}})
        try:
            return Scene(
                name=f"figure_{self.figure}",
                system=_system(self),
                load=acting,
                output={"until": end, **(plotted or PLOTTED[self.figure])},
            )
        except SceneError as error:
            raise MeaninglessError(str(error)) from None


@cache
def _exact_tables(described: FigureScene) -> Exact:
    """The exact tables of the chain as far as UNTIL needs them. MeaninglessError where it is none."""
    chain = named_chain(described.scene(loads(described.figure)[0]))
    assert chain is not None  # as the paper has it
    return exact_tables(chain, UNTIL + 2)  # g is taken as late as at UNTIL + 1


@cache
def _unit_curve(described: FigureScene, source: str, quantity: str, place: str) -> Array:
    """An output under a unit of a source, by the exact tables. MeaninglessError where it is no output."""
    unit = TriedLoad("unit", ((source, _steps([("0", "1")])),))
    try:
        (output,) = lower(described.scene(unit, {quantity: (place,)})).probes
    except SceneError as error:
        raise MeaninglessError(str(error)) from None
    rod, x, tau = output.rod, output.rod - 1 + float(output.place), described.instants
    clock, is_moved = _exact_tables(described).chain.rod(rod), quantity == "displacement"
    f, g = (_wave(described, source, letter, rod, x, 0 if is_moved else 1) for letter in "fg")
    velocity = float(clock.velocity)
    return {"strain": g - f, "velocity": f + g + velocity, "displacement": f + g + velocity * tau}[quantity]


@cache
def _wave(described: FigureScene, source: str, letter: str, rod: int, x: float, order: int) -> Array:
    """f or g of a rod at x, under a unit of a source, at the instants."""
    exact = _exact_tables(described)
    clock = exact.chain.rod(rod)
    late = float(clock.tau0) + (x - float(clock.x0)) * (1 if letter == "f" else -1)
    return np.array(exact.sample(source, letter, rod, (described.instants - late).tolist(), order))


@cache
def contact_end(described: FigureScene) -> str:
    """When the contact at x = 2 of Fig. 6 opens, to 20 digits. MeaninglessError where it does not."""
    ends = contact_ends(lower(described.scene(loads(6)[0], {"strain": ("2",)}, str(UNTIL))))
    if not ends:
        raise MeaninglessError("the contact does not open")
    return ends[0].digits


def read_caption(figure: int, formula: Tree) -> FigureScene:
    """What equations such as kappa_1 = 0.1 describe; m, where it is not given, is as large as the indices need.

    MeaninglessError where they are no quantities.
    """
    found: dict[tuple[str, int], fmpq] = {}
    scope = Scope()
    for equation in items(formula):
        left, right = sides(equation)
        match without_brackets(left):
            case Symbol() as symbol:
                factor: Tree = Number("1")
            case Product((Number() as factor, Symbol() as symbol)):
                pass
            case other:
                raise MeaninglessError(f"{latex(other)} is no quantity")
        name = symbol.accent + symbol.name, (*scope.indices(symbol), 0)[0]
        if name in found:
            raise MeaninglessError(f"{latex(symbol)} is given twice")
        found[name] = fmpq(scope.value(right)) / scope.value(factor)
    last = max((index for _, index in found), default=0)
    found.setdefault(("m", 0), fmpq(last + {6: 1, 7: -1, 8: 0}[figure]))
    return FigureScene(figure, tuple((letter, index, value) for (letter, index), value in sorted(found.items())))


def _system(described: FigureScene) -> Mapping[str, object]:
    """The system of a scene. MeaninglessError where quantities are missing, or are too many."""
    values = {(letter, index): value for letter, index, value in described.quantities}

    def take(letter: str, indices: Iterable[int]) -> list[fmpq]:
        if missing := [index for index in indices if (letter, index) not in values]:
            raise MeaninglessError(f"no {letter}_{missing[0]}")
        return [values.pop((letter, index)) for index in indices]

    (size,) = take("m", (0,))
    if size.denom() != 1 or size < 1:
        raise MeaninglessError(f"m = {size}")
    m = int(size.numer())
    made: dict[str, object]
    if described.figure == 6:
        bodies = range(1, m, 2)
        kappa, velocity = take(r"\kappa", bodies), take(r"\barv", bodies)
        made = {"type": "collision", "kappa": list(map(str, kappa)), "velocity": list(map(str, velocity))}
    elif described.figure == 7:
        made = {"type": "drive", **_drive(take(r"\gamma", range(1, m + 2)))}
    else:
        made = {"type": "building", "kappa": list(map(str, take(r"\kappa", range(m + 1)))), "base": "force"}
    if values:
        raise MeaninglessError(f"m = {m} has no {', no '.join(f'{letter}_{index}' for letter, index in values)}")
    return {"m": m, **made}


def _drive(rates: Sequence[fmpq]) -> Mapping[str, object]:
    """One shaft with bodies of these rates: a body's rate goes with kappa_1, and against its inertia."""
    if len(rates) != 2 or not all(rates):
        raise MeaninglessError(f"rates {format_value(tuple(rates))} for the two bodies of one shaft")
    equal = Chain(DRIVE, 1, Parameters(kappa={1: fmpq(1)}, inertia={1: fmpq(1), 2: fmpq(1)}))
    first, second = (fmpq(node.alpha + node.beta) / 2 for node in equal.nodes)
    kappa = rates[0] / first
    return {"kappa": [str(kappa)], "inertia": ["1", str(kappa * second / rates[1])]}


@cache
def figure(number: int) -> FigureScene:
    """What the caption of a figure describes."""
    return read_caption(number, read_formula(entry(f"Fig.{number}.caption").printed))
