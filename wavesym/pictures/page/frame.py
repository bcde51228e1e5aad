"""Axes of a small picture: where values are, and numbers that one reads off."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, floor, log10

from wavesym.pictures.page.svg import Svg, concatenate, line, text
from wavesym.pictures.ticks import omitted_power, power_text, tick_text

_NICE = (1, 2, 2.5, 5, 10)


@dataclass(frozen=True)
class PlotAxis:
    """From `low` to `high`, between the pixels `start` and `end`."""

    low: float
    high: float
    start: float
    end: float

    def pixel(self, value: float) -> float:
        """The pixel of a value."""
        return self.start + (value - self.low) / (self.high - self.low) * (self.end - self.start)

    @property
    def power(self) -> int:
        """That of ten which is left out of long numbers, 0 for short ones."""
        return omitted_power(self.low, self.high)

    def ticks(self, most: int, power: int = 0) -> list[tuple[float, str]]:
        """At most so many round numbers on the axis, as they are written without 10**power."""
        size = self.high - self.low
        coarse = 10.0 ** floor(log10(size / most))
        step = next(nice * coarse for nice in _NICE if size / (nice * coarse) <= most)
        first, last = ceil(self.low / step - 1e-9), floor(self.high / step + 1e-9)
        return [(k * step, tick_text(k * step / 10.0**power, step / 10.0**power)) for k in range(first, last + 1)]


def spread(low: float, high: float, room: float) -> tuple[float, float]:
    """An interval with so much more on both sides, relative to its length; around a single value one that has it."""
    size = (high - low) or abs(high) or 1.0
    return low - room * size, high + room * size


@dataclass(frozen=True)
class Frame:
    """Two axes and what is written beside them; `places` upward and `x_places` take the place of ticks."""

    x: PlotAxis
    y: PlotAxis
    x_title: str
    y_title: str
    places: Sequence[tuple[float, str]] | None = None
    x_places: Sequence[tuple[float, str]] | None = None

    def draw(self, numbers: bool = True) -> Svg:
        """The grid, the numbers (those of x only where `numbers` are asked for) and the titles."""
        left, right, top, bottom = self.x.start, self.x.end, self.y.end, self.y.start
        parts = []
        for value, number in self.x.ticks(10) if self.x_places is None else self.x_places:
            at = self.x.pixel(value)
            parts.append(line(at, top, at, bottom, "grid"))
            if numbers:
                parts.append(text(at, bottom + 16, number))
        upward: Sequence[tuple[float, str]] = self.places or []
        if self.places is None:
            power = self.y.power
            upward = [(at, number) for at, number in self.y.ticks(max(3, int((bottom - top) / 32)), power)]
            if power:
                parts.append(text(left - 6, top - 1, power_text(power), "end"))
        for value, number in upward:
            at = self.y.pixel(value)
            parts.append(line(left, at, right, at, "grid"))
            parts.append(text(left - 6, at + 4, number, "end"))
        if self.places is None and self.y.low < 0 < self.y.high:
            parts.append(line(left, self.y.pixel(0), right, self.y.pixel(0), "zero"))
        if numbers:
            parts.append(text((left + right) / 2, bottom + 34, self.x_title))
        middle = (top + bottom) / 2
        for k, words in enumerate(self.y_title.split("\n")):
            parts.append(text(14 + 15 * k, middle, words, transform=f"rotate(-90 {14 + 15 * k} {middle:g})"))
        return concatenate(*parts)
