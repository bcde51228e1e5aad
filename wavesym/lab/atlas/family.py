"""What a family of curves is: points that say how wrong a method is, how wrong it may be, and whether it refuses."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from io import StringIO

Progress = Callable[[str], None]


@dataclass(frozen=True)
class AtlasPoint:
    """The `error` of a curve at x, NaN where there is no value; all dimensionless.

    `bound` is what the error is proved to stay below, infinite where nothing is proved; `refused` says why the method
    would not be used there, and is empty where it would.
    """

    panel: str
    curve: str
    x: float
    error: float
    bound: float = math.inf
    refusal: str = ""


@dataclass(frozen=True)
class Axis:
    """An axis. `zero`, where given, is the place on a logarithmic one that stands for exactly 0."""

    label: str
    scale: str = "log"
    zero: float | None = None
    falling: bool = False


@dataclass(frozen=True)
class CurveFamily:
    """Curves in one or more panels that share their axes, from `least` to `most`.

    `name` names the files, `title` says what is seen, `note` how to read it.
    """

    name: str
    title: str
    x: Axis
    y: str
    points: tuple[AtlasPoint, ...]
    note: str = ""
    least: float = 1e-17
    most: float = 1e2

    def curve(self, panel: str, name: str) -> list[AtlasPoint]:
        """The points of one curve, in order."""
        return [point for point in self.points if (point.panel, point.curve) == (panel, name)]

    def curves(self, panel: str) -> list[str]:
        """The curves of a panel, in order."""
        return _distinct(point.curve for point in self.points if point.panel == panel)

    @property
    def panels(self) -> list[str]:
        """The panels, in order."""
        return _distinct(point.panel for point in self.points)


def to_csv(family: CurveFamily) -> str:
    """All points; a bound that is infinite and an error that is no number are left empty."""
    text = StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["panel", "curve", "x", "error", "bound", "refused"])
    for point in family.points:
        writer.writerow(
            [point.panel, point.curve, f"{point.x:g}", *map(_digits, (point.error, point.bound)), point.refusal]
        )
    return text.getvalue()


def _digits(value: float) -> str:
    return f"{value:.3g}" if math.isfinite(value) else ""


def _distinct(names: Iterable[str]) -> list[str]:
    return list(dict.fromkeys(names))
