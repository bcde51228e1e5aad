"""Places as people read them: in rod lengths, or in the unit of length of a scene that has one."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction


@dataclass(frozen=True)
class LengthUnit:
    """A unit of length: one of x is `size` times as long. `text` is its name."""

    size: Fraction
    text: str


def in_unit(x: Fraction, unit: LengthUnit | None) -> float:
    """A place as a number: of the unit, or of x where there is none."""
    return float(x * unit.size) if unit else float(x)


def place_text(x: Fraction, line: str = "", side: str = "", unit: LengthUnit | None = None) -> str:
    """A place as its scene would write it: "3/2", "a:1.2 m+".

    Args:
        x: from the start of its line, in lengths of the first rod; exact.
        line: the name of a branch, empty for the main line.
        side: "-", "+" or nothing.
        unit: that of a scene with units whose places are lengths.
    """
    where = str(x) if unit is None else f"{in_unit(x, unit):.12g} {unit.text}"
    return f"{line}{line and ':'}{where}{side}"


def axis_text(line: str = "", unit: LengthUnit | None = None) -> str:
    """What places along a line are called at an axis: "x", "a:x in mm"."""
    return f"{line}{line and ':'}x{'' if unit is None else f' in {unit.text}'}"
