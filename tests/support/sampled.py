"""Loads given sample by sample, at any instants: sums of exact responses to a unit step and a unit ramp of each.

Samples and times are doubles as a stream takes them, but nothing is rounded here: kinks are fractions, responses balls
from solvers that share no code with the package.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

import numpy as np
from flint import arb, ctx, fmpq
from numpy.typing import NDArray

import wavesym
from tests.support.laplace import Laplace
from tests.support.streamed import Stream
from tests.support.truth import Truth

Response = Callable[[int, Fraction], arb]
"""An output, by number, at a time since its load began."""
_BITS = 128


@dataclass
class Record:
    """What was given and read: `changes` of each load are (instant, jump, change of slope); `seen` is how many of them
    there were when the outputs in a row of `found` were read."""

    changes: list[list[tuple[Fraction, Fraction, Fraction]]]
    seen: list[list[int]] = field(default_factory=list)
    tau: list[Fraction] = field(default_factory=list)
    found: list[NDArray[np.float64]] = field(default_factory=list)
    status: list[int] = field(default_factory=list)
    lost: list[float] = field(default_factory=list)


def driven(stream: Stream, steps: Sequence[float], loads: Sequence[Sequence[float]], *, held: bool) -> Record:
    """Step a stream: each load goes straight to the next of its values, or jumps there and is held."""
    count = len(loads[0])
    now, slope = [Fraction(0)] * count, [Fraction(0)] * count
    record, tau = Record([[] for _ in range(count)]), Fraction(0)
    for dtau, row in zip(steps, loads, strict=True):
        if held:
            stream.step(0.0, row)
        for j, value in enumerate(map(Fraction, row)):
            rise = Fraction(0) if held else (value - now[j]) / Fraction(dtau)
            record.changes[j].append((tau, value - now[j] if held else Fraction(0), rise - slope[j]))
            now[j], slope[j] = value, rise
        status, out = stream.step(dtau, row)
        tau += Fraction(dtau)
        record.seen.append([len(changes) for changes in record.changes])
        record.tau.append(tau)
        record.found.append(out)
        record.status.append(status)
        record.lost.append(stream.lost)
    return record


class Superposed:
    """The exact outputs of a scene under any samples, up to `until`.

    Args:
        scene: A drive or a building, or the table of a chain; its loads do not matter.
        places: Where each load acts, as in the load table of a scene.
        until: In tau.
    """

    def __init__(
        self, scene: wavesym.Scene | dict[str, Any], places: Sequence[dict[str, Any]], until: Fraction
    ) -> None:
        of = _named if isinstance(scene, wavesym.Scene) else _chain
        self._rest, self.outputs = of(scene, [], until)
        self._units = [
            (of(scene, [place | _load(scene, 1, 0)], until)[0], of(scene, [place | _load(scene, 0, 1)], until)[0])
            for place in places
        ]

    def values(self, record: Record, rows: Sequence[int]) -> NDArray[np.float64]:
        """What the outputs were at some of the instants that a record has, (outputs, instants)."""
        with ctx.workprec(_BITS):
            columns = [[self._value(record, row, output) for output in range(len(self.outputs))] for row in rows]
        return np.array(columns).T

    def _value(self, record: Record, row: int, output: int) -> float:
        tau = record.tau[row]
        rest = self._rest(output, tau)
        total = rest
        for (step, ramp), changes, count in zip(self._units, record.changes, record.seen[row], strict=True):
            for instant, jump, bend in changes[:count]:
                for response, size in ((step, jump), (ramp, bend)):
                    if size:
                        since = tau - instant
                        total += _ball(size) * (response(output, since) - self._rest(output, since))
        return float(total.mid())

    def missed(self, record: Record, every: int = 1) -> NDArray[np.float64]:
        """The largest error of each output at every so many instants, relative to its largest value there."""
        rows = range(every - 1, len(record.tau), every)
        true = self.values(record, rows)
        largest = np.max(np.abs(true), axis=1)
        wrong = np.max(np.abs(np.array(record.found)[list(rows)].T - true), axis=1)
        return wrong / np.where(largest > 0, largest, 1)


def _ball(number: Fraction) -> arb:
    return arb(fmpq(*number.as_integer_ratio()))


def _load(scene: wavesym.Scene | dict[str, Any], step: int, ramp: int) -> dict[str, Any]:
    building = isinstance(scene, wavesym.Scene) and scene.system.type == "building"
    names = ("a", "b") if building else ("steps", "ramps")
    return {"times": [0], names[0]: [step], names[1]: [ramp]}


def _named(scene: wavesym.Scene, loads: list[dict[str, Any]], until: Fraction) -> tuple[Response, list[str]]:
    made = scene.with_({"load": loads, "output.until": until})
    truth = Truth(made, until)
    return lambda output, tau: truth.value(output, tau), [str(output) for output in made.outputs]


def _chain(table: dict[str, Any], loads: list[dict[str, Any]], until: Fraction) -> tuple[Response, list[str]]:
    truth = Laplace(table | {"load": loads}, until)
    terms = [truth.terms(*name) for name in _shown(table)]
    return lambda output, tau: terms[output].value(tau), [f"{quantity}@{place}" for quantity, place in _shown(table)]


def _shown(table: dict[str, Any]) -> Iterator[tuple[str, Any]]:
    for quantity in ("strain", "velocity", "displacement"):
        yield from ((quantity, place) for place in table["output"].get(quantity, ()))
