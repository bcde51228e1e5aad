"""Section 5: the statements about Figs. 6, 7 and 8, measured on the exact motion.

The load curves of Figs. 7 and 8 are not in the text: a statement is tried on several shapes of load, and what it says
holds, or for which of them it does. Words are taken as numbers: two curves differ "slightly" where they are nowhere
further apart than a third of the largest value, "clearly" where they somewhere are by more than half. A curve swings
where it goes by a twentieth of its largest value before it turns.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavesym.exact.contact import contact_ends
from wavesym.exact.reference import Reference
from wavesym.papers.record import Case, Claim, Slip, shown
from wavesym.scene import Scene, lower

Array = NDArray[np.float64]
Curves = Mapping[str, Array]

SAMPLES = 801
SLIGHT, CLEAR = 1 / 3, 1 / 2
SWING = 1 / 20
UNTIL = 20

# (times, a, b) of (3.2), in tau; for moments (3.1) only steps
_MOMENTS = {
    "step": ([0], [1]),
    "pulse of length 2": ([0, 2], [1, -1]),
    "pulse of length 10": ([0, 10], [1, -1]),
    "stairs up": ([0, 1, 2, 3], ["1/4", "1/4", "1/4", "1/4"]),
    "stairs down": ([0, 1, 2, 3], [1, "-1/4", "-1/4", "-1/2"]),
}
_QUAKES = {
    "step": ([0], [1], [0]),
    "ramp": ([0], [0], [1]),
    "pulse of length 2": ([0, 2], [1, -1], [0, 0]),
    "triangle of length 4": ([0, 2, 4], [0, 0, 0], [1, -2, 1]),
    "one slow swing": ([0, 2, 6, 8], [0, 0, 0, 0], ["1/2", -1, 1, "-1/2"]),
    "fast zigzag": ([0, 1, 2, 3, 4, 5, 6], [0] * 7, [1, -2, "5/2", -3, "5/2", "-3/2", "1/2"]),
}


class MeasuredPoint(NamedTuple):
    """A place on a curve: the output, and which of its instants."""

    output: str
    instant: int


class Finding(NamedTuple):
    """What was measured, and where: each spot is a point, or two that lie as far apart as the measure says."""

    value: float
    spots: tuple[tuple[MeasuredPoint, ...], ...] = ()


Measure = Callable[[Curves], Finding]


@dataclass(frozen=True)
class Said:
    """A statement about curves: what is measured, when that is what is said, and for which loads it is said."""

    measured: Measure
    true: Callable[[float], bool]
    loads: tuple[str, ...]


@dataclass(frozen=True)
class FigureStatement:
    """A sentence of section 5."""

    figure: int
    text: str
    measured: Measure
    true: Callable[[float], bool]
    meaning: str

    @property
    def findings(self) -> dict[str, Finding]:
        """What is measured under each load that its figure is tried with."""
        return {load: self.measured(curves(self.figure, load)) for load in loads(self.figure)}


def _apart(*names: str) -> Measure:
    """The largest distance of curves, in their largest value."""

    def measured(c: Curves) -> Finding:
        together = np.array([c[name] for name in names])
        distance = np.ptp(together, axis=0)
        k = int(np.argmax(distance))
        return Finding(float(distance[k] / np.max(np.abs(together))), (_across(c, names, k),))

    return measured


def _across(c: Curves, names: tuple[str, ...], k: int) -> tuple[MeasuredPoint, ...]:
    """The lowest and the highest of curves at an instant."""
    low, *_, high = sorted(names, key=lambda name: float(c[name][k]))
    return MeasuredPoint(low, k), MeasuredPoint(high, k)


def _at_most(bound: float) -> Callable[[float], bool]:
    return lambda value: value <= bound


def _more_than(bound: float) -> Callable[[float], bool]:
    return lambda value: value > bound


def _peaks(one: str, other: str) -> Measure:
    """The largest absolute value of one curve over that of the other."""

    def measured(c: Curves) -> Finding:
        tops = {name: int(np.argmax(np.abs(c[name]))) for name in (one, other)}
        high, low = (abs(c[name][k]) for name, k in tops.items())
        return Finding(float(high / low), tuple((MeasuredPoint(*top),) for top in tops.items()))

    return measured


def _turn(name: str, sign: int) -> Measure:
    """How far a curve goes one way first and back later, the smaller of both in its largest value."""

    def measured(c: Curves) -> Finding:
        curve = sign * c[name]
        top = int(np.argmax(curve))
        value = min(curve[top] - curve[0], curve[top] - curve[-1]) / np.max(np.abs(curve))
        return Finding(float(value), ((MeasuredPoint(name, top),),))

    return measured


def _outside(inner: str, one: str, other: str) -> Measure:
    """How far a curve leaves the band between two others, in their largest value; where it does not, the band."""

    def measured(c: Curves) -> Finding:
        low, high = np.minimum(c[one], c[other]), np.maximum(c[one], c[other])
        beyond = np.maximum(c[inner] - high, low - c[inner])
        worst = int(np.argmax(beyond))
        band = _across(c, (one, other), int(np.argmax(high - low)))
        return Finding(
            float(beyond[worst] / np.max(np.abs(high))),
            ((MeasuredPoint(inner, worst),) if beyond[worst] > 0 else band,),
        )

    return measured


def _spread(names: tuple[str, ...]) -> Measure:
    """The spread of curves at their end, in the largest of them there."""

    def measured(c: Curves) -> Finding:
        ends = [c[name][-1] for name in names]
        return Finding(float(np.ptp(ends) / max(map(abs, ends))), (_across(c, names, SAMPLES - 1),))

    return measured


def _unevenness(*names: str) -> Measure:
    """The largest swing between successive turning points over the smallest; 0 where there are fewer than three swings.

    The smallest over several curves.
    """

    def one(name: str, curve: Array) -> Finding:
        turns = _turns(curve.tolist(), SWING * float(np.max(np.abs(curve))))
        swings = sorted(pairwise(turns), key=lambda ends: abs(curve[ends[1]] - curve[ends[0]]))
        if len(swings) < 3:
            return Finding(0.0)
        small, large = (abs(curve[b] - curve[a]) for a, b in (swings[0], swings[-1]))
        spots = tuple((MeasuredPoint(name, a), MeasuredPoint(name, b)) for a, b in (swings[-1], swings[0]))
        return Finding(float(large / small), spots)

    return _both(*(lambda c, name=name: one(name, c[name]) for name in names), worst=min)


def _turns(curve: Sequence[float], least: float) -> list[int]:
    """Where a curve turns, after going one way and before going the other, each time by at least `least`."""
    turns: list[int] = []
    low = high = way = 0
    for k, value in enumerate(curve):
        low, high = (k if value < curve[low] else low), (k if value > curve[high] else high)
        if way >= 0 and curve[high] - value >= least:
            turns += [high] * way
            low, way = k, -1
        elif way <= 0 and value - curve[low] >= least:
            turns += [low] * -way
            high, way = k, 1
    return turns


def _both(*measures: Measure, worst: Callable[[Any], float] = max) -> Measure:
    """The worst of several measures, and where each of them is."""

    def measured(c: Curves) -> Finding:
        found = [measure(c) for measure in measures]
        spots = dict.fromkeys(spot for finding in found for spot in finding.spots)
        return Finding(worst(finding.value for finding in found), tuple(spots))

    return measured


_SLIGHTLY, _CLEARLY = f"at most {SLIGHT:.3g}", f"more than {CLEAR:.3g}"
_INNER = ("displacement@3/2", "displacement@2", "displacement@5/2")

STATEMENTS: tuple[FigureStatement, ...] = (
    FigureStatement(
        6,
        "the strain at x = 2 differs considerably from that at x = 1-",
        _apart("strain@2", "strain@1-"),
        _more_than(CLEAR),
        f"largest distance {_CLEARLY} of the largest value",
    ),
    FigureStatement(
        6,
        "the strain at x = 2 differs considerably from that at x = 3+",
        _apart("strain@2", "strain@3+"),
        _more_than(CLEAR),
        f"largest distance {_CLEARLY} of the largest value",
    ),
    FigureStatement(
        6,
        "the displacements of x = 0 and x = 1 differ slightly",
        _apart("displacement@0", "displacement@1"),
        _at_most(SLIGHT),
        f"largest distance {_SLIGHTLY} of the largest value",
    ),
    FigureStatement(
        6,
        "so do those of x = 3 and x = 4",
        _apart("displacement@3", "displacement@4"),
        _at_most(SLIGHT),
        f"largest distance {_SLIGHTLY} of the largest value",
    ),
    FigureStatement(
        6,
        "the displacements of x = 0; 1 rise at first and fall later",
        _both(_turn("displacement@0", 1), _turn("displacement@1", 1), worst=min),
        _more_than(0.01),
        "rise and fall, the smaller more than 0.01 of the largest value",
    ),
    FigureStatement(
        6,
        "those of x = 3; 4 the other way round",
        _both(_turn("displacement@3", -1), _turn("displacement@4", -1), worst=min),
        _more_than(0.01),
        "fall and rise, the smaller more than 0.01 of the largest value",
    ),
    FigureStatement(
        6,
        "the displacements of x = 1.5; 2; 2.5 lie between those of x = 1 and x = 3",
        _both(*(_outside(name, "displacement@1", "displacement@3") for name in _INNER)),
        _at_most(1e-12),
        "nowhere outside",
    ),
    FigureStatement(
        6,
        "at the end of the collision the displacements differ slightly",
        _spread(("displacement@1", *_INNER, "displacement@3")),
        _at_most(SLIGHT),
        f"spread {_SLIGHTLY} of the largest value",
    ),
    FigureStatement(
        7,
        "the strains at x = 0; 0.5; 1 differ slightly",
        _apart("strain@0", "strain@0.5", "strain@1"),
        _at_most(SLIGHT),
        f"largest distance {_SLIGHTLY} of the largest value",
    ),
    FigureStatement(
        7,
        "the displacement of x = 0 differs clearly from that of x = 1",
        _apart("displacement@0", "displacement@1"),
        _more_than(CLEAR),
        f"largest distance {_CLEARLY} of the largest value",
    ),
    FigureStatement(
        8,
        "the larger velocities occur at x = 0.5",
        _peaks("velocity@0.5", "velocity@1.5"),
        _more_than(1),
        "ratio of the largest values, x = 0.5 to x = 1.5, more than 1",
    ),
    FigureStatement(
        8,
        "the larger strains occur at x = 0.5",
        _peaks("strain@0.5", "strain@1.5"),
        _more_than(1),
        "ratio of the largest values, x = 0.5 to x = 1.5, more than 1",
    ),
    *(
        FigureStatement(
            8,
            f"the {many} are irregular oscillations",
            _unevenness(f"{one}@0.5", f"{one}@1.5"),
            _more_than(1.5),
            f"at least three swings of {SWING:.3g} of the largest value or more, the largest more than 1.5 times the "
            "smallest",
        )
        for one, many in (("velocity", "velocities"), ("strain", "strains"), ("displacement", "displacements"))
    ),
)


def claims() -> Iterator[Claim[Any]]:
    """The statements of section 5, numbered on from those of section 4; the number 8.85 last."""
    for id, statement in numbered().items():
        yield _claim(id, statement)
    yield _end(END)


_BEFORE = 13
END = f"text.{_BEFORE + len(STATEMENTS) + 1}"
"""The id of the number 8.85."""


def numbered() -> dict[str, FigureStatement]:
    """The statements by id."""
    return {f"text.{number}": statement for number, statement in enumerate(STATEMENTS, _BEFORE + 1)}


def loads(figure: int) -> tuple[str, ...]:
    """The shapes of load that a figure is tried with."""
    return {6: ("impact",), 7: tuple(_MOMENTS), 8: tuple(_QUAKES)}[figure]


@cache
def curves(figure: int, load: str) -> Curves:
    """The outputs of a figure's scene, at its instants."""
    reference = Reference(lower(scene(figure, load)))
    values = reference.values(instants(reference.tau_max).tolist())
    return {output.name: np.array(row) for output, row in zip(reference.model.probes, values, strict=True)}


def instants(until: float) -> Array:
    """The tau at which curves are compared."""
    return np.linspace(0, until, SAMPLES)


def scene(figure: int, load: str) -> Scene:
    """What the paper says of a figure, under a load."""
    if figure == 6:
        return _collision(
            str(contact_end()), {"strain": ["1-", 2, "3+"], "displacement": [0, 1, "3/2", 2, "5/2", 3, 4]}
        )
    if figure == 7:
        times, steps = _MOMENTS[load]
        return Scene(
            name="figure_7",
            system={"type": "drive", "m": 1, "kappa": [1], "inertia": [1, 2]},  # gamma_1 = 1, gamma_2 = 1/2
            load=[{"body": body, "times": times, "steps": steps} for body in (1, 2)],
            output={"until": UNTIL, "strain": [0, 0.5, 1], "displacement": [0, 1]},
        )
    times, a, b = _QUAKES[load]
    places = [0.5, 1.5]
    return Scene(
        name="figure_8",
        system={"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": "force"},
        load=[{"times": times, "a": a, "b": b}],
        output={"until": UNTIL, "velocity": places, "strain": places, "displacement": places},
    )


def _collision(until: str, output: Mapping[str, Any]) -> Scene:
    return Scene(
        name="figure_6",
        system={"type": "collision", "m": 4, "kappa": ["1/10", "1/5"], "velocity": [1, "-1/2"]},
        output={"until": until, **output},
    )


@cache
def contact_end() -> float:
    """When the contact at x = 2 of Fig. 6 opens."""
    (end,) = contact_ends(lower(_collision("12", {"strain": [2]})))
    return float(end.digits)


def _cases(statement: FigureStatement, said: Said) -> Iterator[Case]:
    for load in said.loads:
        value = said.measured(curves(statement.figure, load)).value
        yield Case({"load": load, "measured": value, "claim": statement.meaning}, True, said.true(value))


def _claim(id: str, statement: FigureStatement) -> Claim[Said]:
    tried = loads(statement.figure)
    values = {load: finding.value for load, finding in statement.findings.items()}
    true = tuple(load for load, value in values.items() if statement.true(value))
    said = Said(statement.measured, statement.true, tried)
    right = Said(statement.measured, statement.true, true)
    others = tuple(load for load in tried if load not in true)
    slip = Slip(
        "convention",
        f"for the loads {', '.join(true)}",
        right,
        f"The load curve is not in the text. False for {', '.join(others)}.",
    )
    return Claim(
        id,
        f"section 5, Fig. {statement.figure}",
        statement.text,
        "",
        f"the exact motion at {SAMPLES} instants{' (the base of (4.5))' if statement.figure == 8 else ''}: "
        f"{statement.meaning}; loads: {', '.join(tried)}",
        partial(_cases, statement),
        said,
        {"the contrary": Said(statement.measured, lambda value: not statement.true(value), true or tried)},
        slip if others else None,
        note=f"Measured: {', '.join(f'{load} {shown(value)}' for load, value in values.items())}.",
    )


def _end(id: str) -> Claim[str]:
    """The number of section 5, as it is printed: to two places."""
    exact = contact_end()

    def cases(printed: str) -> Iterator[Case]:
        yield Case({"x": 2, "claim": "first return of the contact strain to 0, two places"}, printed, f"{exact:.2f}")

    return Claim(
        id,
        "section 5, Fig. 6",
        "8.85",
        "",
        "when the contact at x = 2 opens, in ball arithmetic",
        cases,
        "8.85",
        {"8.95": "8.95"},
        Slip("misprint", f"{exact:.2f}", f"{exact:.2f}", f"Read off the figure, by {exact - 8.85:.2g} too early."),
    )
