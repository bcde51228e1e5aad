"""The signs of mechanics, each as wide as it says, drawn about a middle line: masses, springs, dashpots, supports."""

from __future__ import annotations

from wavesym.pictures.page.svg import Svg, box, concatenate, element, line, polyline, text

HALF = 16.0  # of the height of a mass
_COIL, _TEETH = 5.0, 6
_LONGEST = 52.0  # of a spring or a dashpot


def mass(x: float, y: float, width: float, half: float) -> Svg:
    """A rigid body."""
    return box(x, y - half, width, 2 * half, "mass")


def spring(x: float, y: float, width: float) -> Svg:
    """A coil from left to right."""
    lead, step = 0.15 * width, 0.7 * width / _TEETH
    teeth = [(x + lead + (k + 0.5) * step, y + (_COIL if k % 2 else -_COIL)) for k in range(_TEETH)]
    return polyline([(x, y), (x + lead, y), *teeth, (x + width - lead, y), (x + width, y)], "wire")


def dashpot(x: float, y: float, width: float) -> Svg:
    """A piston in a pot."""
    low, high = x + 0.35 * width, x + 0.75 * width
    pot = polyline([(low, y - 6), (high, y - 6), (high, y + 6), (low, y + 6)], "wire")
    piston = line(x + 0.5 * width, y - 4, x + 0.5 * width, y + 4, "wire")
    return concatenate(line(x, y, x + 0.5 * width, y, "wire"), piston, pot, line(high, y, x + width, y, "wire"))


def link(x: float, y: float, width: float, *, elastic: bool, damped: bool) -> Svg:
    """A spring, a dashpot, or both side by side between two upright lines; with long leads where there is room."""
    if width > _LONGEST:
        lead = (width - _LONGEST) / 2
        inner = link(x + lead, y, _LONGEST, elastic=elastic, damped=damped)
        return concatenate(line(x, y, x + lead, y, "wire"), inner, line(x + width - lead, y, x + width, y, "wire"))
    if elastic and damped:
        ends = concatenate(line(x, y - 10, x, y + 10, "wire"), line(x + width, y - 10, x + width, y + 10, "wire"))
        return concatenate(spring(x, y - 10, width), dashpot(x, y + 10, width), ends)
    return spring(x, y, width) if elastic else dashpot(x, y, width)


def contact(x: float, y: float, width: float) -> Svg:
    """Two faces that push and do not pull."""
    faces = (line(x + k * width, y - HALF, x + k * width, y + HALF, "wire") for k in (0.15, 0.85))
    return concatenate(*faces)


def wall(x: float, y: float, side: int) -> Svg:
    """What is fixed: a face, and hatches on its left (-1) or right (1)."""
    hatches = (line(x, y + k, x + 8 * side, y + k + 8, "thin") for k in range(-18, 14, 6))
    return concatenate(line(x, y - 20, x, y + 20, "face"), *hatches)


def ground(x: float, y: float) -> Svg:
    """The ground below a place."""
    hatches = (line(x + k, y, x + k - 5, y + 6, "thin") for k in range(-8, 13, 5))
    return concatenate(line(x - 12, y, x + 12, y, "face"), *hatches)


def sole(x: float, y: float) -> Svg:
    """What rubs on the ground below a place."""
    return concatenate(box(x - 9, y, 18, 6, "rod"), ground(x, y + 7))


def ground_link(x: float, y: float, *, elastic: bool, damped: bool) -> Svg:
    """A spring, a dashpot or both from a place down to the ground."""
    inner = link(0, 0, 36, elastic=elastic, damped=damped)
    return concatenate(element("g", inner, transform=f"translate({x:.1f} {y:.1f}) rotate(90)"), ground(x, y + 36))


def motion_arrow(x: float, y: float, words: str) -> Svg:
    """An arrow both ways: an end whose motion is prescribed."""
    arrow = polyline([(x - 12, y - 3), (x - 17, y), (x - 12, y + 3)], "act")
    other = polyline([(x + 12, y - 3), (x + 17, y), (x + 12, y + 3)], "act")
    return concatenate(line(x - 17, y, x + 17, y, "act"), arrow, other, text(x, y + 16, words, class_="act"))


def load_arrow(x: float, y: float) -> Svg:
    """An arrow to the right that ends at a place: a load."""
    head = polyline([(x - 6, y - 4), (x, y), (x - 6, y + 4)], "act")
    return concatenate(line(x - 26, y, x, y, "act"), head)
