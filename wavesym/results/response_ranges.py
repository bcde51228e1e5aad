"""Frequency responses over a box of parameters: at each frequency amplitudes between which all of the box lie.

The parameters are masses, springs and dashpots: numbers of points and links that are linear in them, while rods, and
with them all trigonometric functions, stay. The response of a part of the box is computed with its numbers as balls;
parts are halved, each across the side that widens it most, until what they enclose is hardly wider than what single
sets of the box reach.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product
from typing import Any

import numpy as np
from flint import acb, arb, ctx, fmpq
from numpy.typing import NDArray

from wavesym.errors import CostError, UnservedError, WavesymError
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Network
from wavesym.numbers.doubles import upper_double
from wavesym.results.presentation import csv_line
from wavesym.results.transfer import HarmonicLoad, Transfer, angular
from wavesym.scene import Scene, lower

Numbers = tuple[fmpq, ...]
Part = tuple[tuple[fmpq, fmpq], ...]
"""Of each parameter from where to where between the ends of its range, 0 and 1."""

_BITS = 128
_WIDER = 0.1  # of the largest amplitude: by so much an enclosure may be wider than what is reached
_MOST_PARTS = 1024  # at one frequency
_QUANTITY = re.compile(r"\s*([-+0-9.eE/]+)\s*(.*)")


@dataclass(frozen=True)
class ResponseRanges:
    """Amplitudes over a box; `wavesym.frf(..., ranges=...)` makes it.

    `low` and `high`, (outputs, n), enclose those of every set in the box: proved, and wider than what is reached by at
    most 10 % of the largest.
    """

    name: str
    load: str
    load_unit: str
    frequency: NDArray[np.float64]
    frequency_label: str
    outputs: tuple[str, ...]
    units: tuple[str, ...]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    box: Mapping[str, tuple[str, str]]
    scene_notes: tuple[str, ...] = ()

    def csv(self) -> Iterator[str]:
        """Lines of CSV: the frequency, then the least and the greatest amplitude of each output."""
        yield csv_line([self.frequency_label, *(f"{name}.{end}" for name in self.outputs for end in ("low", "high"))])
        ends = np.stack([self.low, self.high], axis=1).reshape(2 * len(self.outputs), -1)
        for f, row in zip(self.frequency.tolist(), ends.T.tolist(), strict=True):
            yield csv_line([f, *row])

    def json(self) -> str:
        """As JSON: `frequency`, `box`, and of each output `low` and `high`."""
        outputs = [
            {"name": name, "unit": unit, "low": low, "high": high}
            for name, unit, low, high in zip(
                self.outputs, self.units, self.low.tolist(), self.high.tolist(), strict=True
            )
        ]
        about = {"load": self.load, "load_unit": self.load_unit, "frequency_label": self.frequency_label}
        box = {path: list(ends) for path, ends in self.box.items()}
        found = {"name": self.name, **about, "box": box, "frequency": self.frequency.tolist(), "outputs": outputs}
        return json.dumps(found, indent=2) + "\n"

    @property
    def notes(self) -> tuple[str, ...]:
        """How the scene was read, and what the numbers are: lines for people."""
        box = ", ".join(f"{path} from {low} to {high}" for path, (low, high) in self.box.items())
        about = f"amplitudes over {box}: enclosed, and no more than {_WIDER:.0%} of the largest wider than is reached"
        return (*self.scene_notes, about)


@dataclass(frozen=True)
class _Box:
    """A model, its numbers at the low ends of all ranges, and each parameter's `increments` of them."""

    model: Model
    low: Numbers
    increments: tuple[Numbers, ...]

    def amplitudes(self, load: HarmonicLoad, part: Part, w: arb) -> list[arb]:
        """Those of the outputs in a part of the box, at a frequency; what does not vary is exact."""
        numbers = []
        for k, low in enumerate(self.low):
            number = arb(low)
            for (first, last), added in zip(part, self.increments, strict=True):
                if added[k] != 0:
                    number = number + arb(first * added[k]).union(arb(last * added[k]))
            numbers.append(number if any(added[k] != 0 for added in self.increments) else low)
        network = _with_numbers(self.model.network, numbers)
        return [abs(acb(each)) for each in Transfer(replace(self.model, network=network), load)(w)]


def response_ranges(
    scene: Scene, load: HarmonicLoad, box: Mapping[str, tuple[Any, Any]], frequencies: Sequence[float]
) -> ResponseRanges:
    """The ranges of amplitudes over a box.

    Args:
        scene: a chain without modal damping and contacts that open.
        load: which load.
        box: of each path, as in `scene.with_`, the least and the greatest value, as a scene has them.
        frequencies: (n,), in Hz, or in rad per tau without [units].

    Raises:
        UnservedError: for parameters that are no masses, springs or dashpots, and for modal damping.
        CostError: where no enclosure is found, as where a natural frequency without damping lies in the box.
        WavesymError: for ranges that are none.
    """
    texts = {path: (str(first), str(last)) for path, (first, last) in box.items()}
    found = _box(scene, texts)
    model = found.model
    ends = [_enclose(found, load, f) for f in frequencies]
    return ResponseRanges(
        scene.name,
        load.label,
        load.unit,
        np.array(frequencies, np.float64),
        "omega" if model.clock is None else "frequency [Hz]",
        tuple(probe.name for probe in model.probes),
        tuple(probe.unit for probe in model.probes),
        np.array([low for low, _ in ends]).T.reshape(len(model.probes), -1),
        np.array([high for _, high in ends]).T.reshape(len(model.probes), -1),
        texts,
        model.labels.structure_notes,
    )


def _box(scene: Scene, box: Mapping[str, tuple[str, str]]) -> _Box:
    """The model over a box, exact. UnservedError where its numbers are not linear in the parameters."""
    low = {path: ends[0] for path, ends in box.items()}
    model = lower(scene.with_(low), in_time=False)
    if model.damping is not None and model.damping.acts:
        raise UnservedError(
            "system.damping: that of modes is not supported with --range (write dashpots, or leave damping out)"
        )
    own = _numbers(model.network)
    added = []
    for path, (first, last) in box.items():
        middle, end = (
            lower(scene.with_({**low, path: value}), in_time=False) for value in (_middle(path, first, last), last)
        )
        numbers = [_numbers(each.network) for each in (middle, end)]
        if any(_without_numbers(each) != _without_numbers(model) for each in (middle, end)) or any(
            2 * m != a + b for a, m, b in zip(own, *numbers, strict=True)
        ):
            raise UnservedError(
                f"--range {path}: responses are enclosed over masses, springs and dashpots only, in which numbers are "
                "linear; what changes waves, or a ratio as kappa, makes enclosures useless (sweep over it instead)"
            )
        added.append(tuple(b - a for a, b in zip(own, numbers[1], strict=True)))
    least = (
        value + sum((min(each[k], fmpq(0)) for each in added), fmpq(0))
        for k, value in enumerate(own)
        if any(each[k] != 0 for each in added)
    )
    if any(bool(value <= 0) for value in least):
        raise WavesymError(f"--range: a mass, spring or dashpot would be 0 or less ({', '.join(box)}); begin above 0")
    return _Box(model, own, tuple(added))


def _middle(path: str, first: str, last: str) -> str:
    """Halfway between both ends of a range, as a scene has it."""
    ends = [_QUANTITY.fullmatch(text) for text in (first, last)]
    try:
        (low, unit), (high, other) = (each.groups() for each in ends if each)
        least, greatest = Fraction(low), Fraction(high)
    except (ValueError, ZeroDivisionError):
        unit, other = "", None
    if unit != other:
        raise WavesymError(f"--range {path}={first}..{last}: write two numbers, in one unit")
    if least > greatest:
        raise WavesymError(f"--range {path}={first}..{last}: the first end is above the second; write the lesser first")
    return f"{(least + greatest) / 2} {unit}".strip()


def _numbers(network: Network) -> Numbers:
    """Masses, dashpots and springs of points, then those of links."""
    points = ((p.mass, p.damping, p.stiffness) for p in network.points)
    return tuple(fmpq(x) for each in (*points, *((k.damping, k.stiffness) for k in network.links)) for x in each)


def _with_numbers(network: Network, numbers: Sequence[Any]) -> Network:
    """With other numbers, exact or balls."""
    given = iter(numbers)
    points = tuple(
        replace(point, mass=next(given), damping=next(given), stiffness=next(given)) for point in network.points
    )
    links = tuple(replace(link, damping=next(given), stiffness=next(given)) for link in network.links)
    return Network(points, network.bars, links)


def _without_numbers(model: Model) -> object:
    """What stays of a model whatever these numbers are."""
    zeros = [fmpq(0)] * len(_numbers(model.network))
    return _with_numbers(model.network, zeros), model.probes, model.clock and model.clock.seconds


def _enclose(box: _Box, load: HarmonicLoad, frequency: float) -> tuple[list[float], list[float]]:
    """The least and the greatest amplitude of each output over the box. CostError."""
    ends = fmpq(0), fmpq(1)
    with ctx.workprec(_BITS):
        w = angular(box.model, frequency)

        def amplitudes(part: Part) -> list[arb]:
            return box.amplitudes(load, part, w)

        whole: Part = (ends,) * len(box.increments)
        corners = [amplitudes(tuple((t, t) for t in corner)) for corner in product(ends, repeat=len(whole))]
        reached = [(min(map(_lower, each)), max(map(_upper, each))) for each in zip(*corners, strict=True)]
        parts = {whole: amplitudes(whole)}
        while True:
            low, high = (
                [end(map(of, each)) for each in zip(*parts.values(), strict=True)]
                for end, of in ((min, _lower), (max, _upper))
            )
            wide = [
                k
                for k, (least, most) in enumerate(reached)
                if not (high[k] - most <= _WIDER * most and least - low[k] <= _WIDER * most) and high[k] > 0
            ]
            if not wide:
                return low, high
            if len(parts) >= _MOST_PARTS:
                raise CostError(
                    f"--range: at {frequency:g} an amplitude is enclosed in no {len(parts)} parts of the box, as where "
                    f"a natural frequency lies in the box, the limit is {_MOST_PARTS} (smaller ranges, a dashpot, or "
                    "other frequencies help)"
                )
            k = wide[0]
            worst = next(
                (part for part, of in parts.items() if _upper(of[k]) - reached[k][1] > _WIDER * reached[k][1]), None
            ) or min(parts, key=lambda part: _lower(parts[part][k]))
            del parts[worst]
            for half in _halves(worst, amplitudes, k):
                parts[half] = amplitudes(half)
                inside = amplitudes(tuple(((a + b) / 2, (a + b) / 2) for a, b in half))
                reached = [
                    (min(least, _lower(each)), max(most, _upper(each)))
                    for (least, most), each in zip(reached, inside, strict=True)
                ]


def _halves(part: Part, amplitudes: Callable[[Part], list[arb]], output: int) -> tuple[Part, Part]:
    """A part, cut across the side without whose width the amplitude of an output is known best."""

    def narrow(side: int, *ends: fmpq) -> Part:
        return (*part[:side], (ends[0], ends[-1]), *part[side + 1 :])

    middles = [(first + last) / 2 for first, last in part]
    open_sides = [side for side, (first, last) in enumerate(part) if first != last]

    def width(side: int) -> float:
        found = amplitudes(narrow(side, middles[side]))[output]
        return _upper(found) - _lower(found)

    side = min(open_sides, key=lambda k: (width(k), part[k][0] - part[k][1]))
    return narrow(side, part[side][0], middles[side]), narrow(side, middles[side], part[side][1])


def _lower(value: arb) -> float:
    return max(0.0, -upper_double(-value)) if value.is_finite() else 0.0


def _upper(value: arb) -> float:
    return upper_double(value) if value.is_finite() else float("inf")
